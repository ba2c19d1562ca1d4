"""Terminals of any encoding, machines without a home, signals: no command fails on them."""

from __future__ import annotations

import io
import os
import signal
import sys
import time
from pathlib import Path

import pytest
import typer.main

from flexscale.cli import doctor, main
from flexscale.cli.terminal import Interrupted, interruptible

ROOT = Path(__file__).parents[2]


def every_command() -> list[list[str]]:
    """Names of all commands, with their groups."""
    found, groups = [], [([], typer.main.get_command(main.app))]
    while groups:
        names, command = groups.pop()
        found.append(names)
        for name, part in getattr(command, "commands", {}).items():
            groups.append(([*names, name], part))
    return sorted(found)


def said_by(
    monkeypatch: pytest.MonkeyPatch, encoding: str, arguments: list[str]
) -> tuple[int, str, str]:
    """Exit code and output of a command on a terminal that has nothing but this encoding."""
    streams = [io.TextIOWrapper(io.BytesIO(), encoding=encoding) for _ in range(2)]
    monkeypatch.setattr(sys, "argv", ["flexscale", *arguments])
    monkeypatch.setattr(sys, "stdout", streams[0])
    monkeypatch.setattr(sys, "stderr", streams[1])
    with pytest.raises(SystemExit) as caught:
        main.main()
    for stream in streams:
        stream.flush()
    # Help goes through a library that takes ASCII for a mistake, and writes UTF-8.
    told = "utf-8" if encoding == "ascii" else encoding
    out, err = (stream.buffer.getvalue().decode(told) for stream in streams)
    return int(caught.value.code or 0), out, err


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "cp1252", "utf-8"])
def test_help_of_every_command_on_every_terminal(
    monkeypatch: pytest.MonkeyPatch, encoding: str
) -> None:
    commands = every_command()
    assert ["data", "findings"] in commands
    assert len(commands) > 15
    for command in commands:
        code, out, err = said_by(monkeypatch, encoding, [*command, "--help"])
        assert (code, err) == (0, ""), command
        assert "Usage" in out


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", "--fields"],
        ["run", str(ROOT / "workflows" / "quickstart.yaml"), "--dry-run"],
        ["run", "größe.yaml"],
        ["data", "list", "κ=3"],
        ["data", "list", "kind=fit"],
        ["data", "findings", "isotropic-to-tetragonal"],
        ["data", "show", "sweep:é"],
        pytest.param(["tiling", "list"], marks=pytest.mark.slow),  # the symmetry of 93 families
        ["tiling", "list", "IH07"],
        ["figures", "κ"],
        ["fabricate", "κ"],
        ["doctor"],
    ],
    ids=lambda words: " ".join(words[:2]),
)
def test_commands_say_what_they_say_on_every_terminal(
    monkeypatch: pytest.MonkeyPatch, arguments: list[str], shipped_results: Path
) -> None:
    monkeypatch.setattr(doctor, "_findings", lambda: [doctor.Finding("ok", "κ", "°")])
    there = ["--results", str(shipped_results)]
    given = [*arguments, *(there if arguments[0] in ("data", "figures") else [])]
    code, out, err = said_by(monkeypatch, "utf-8", given)
    assert "this is a bug" not in err
    plain = [text.encode("ascii", "backslashreplace").decode() for text in (out, err)]
    assert said_by(monkeypatch, "ascii", given) == (code, *plain)


def test_plots_of_commands_need_no_window(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    assert said_by(monkeypatch, "utf-8", ["--help"])[0] == 0
    assert os.environ["MPLBACKEND"] == "Agg"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_interrupts_once(number: signal.Signals) -> None:
    before = signal.getsignal(number)
    cleaned = False

    def work() -> None:
        nonlocal cleaned
        try:
            os.kill(os.getpid(), number)
            time.sleep(5)
        finally:
            os.kill(os.getpid(), number)
            time.sleep(0.01)
            cleaned = True

    with pytest.raises(Interrupted), interruptible():
        work()
    assert cleaned
    assert signal.getsignal(number) == before


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_any_interrupted_command_ends_with_130(
    monkeypatch: pytest.MonkeyPatch, number: signal.Signals
) -> None:
    monkeypatch.setattr(doctor, "_findings", lambda: os.kill(os.getpid(), number))
    code, out, err = said_by(monkeypatch, "utf-8", ["doctor"])
    assert (code, out) == (130, "")
    assert "interrupted; finished work is kept" in err


@pytest.mark.parametrize(
    ("error", "sentence"),
    [
        (OSError(28, "No space left on device", "/data/x"), "/data/x: No space left on device; fr"),
        (OSError(30, "Read-only file system", "/data"), "/data: Read-only file system; choose a"),
        (PermissionError(13, "Permission denied", "/data"), "Permission denied; choose a folder"),
        (MemoryError(), "There is not enough memory"),
        (RuntimeError("can't start new thread"), "There is not enough memory"),
    ],
)
def test_what_the_machine_refuses_is_no_bug(
    monkeypatch: pytest.MonkeyPatch, error: Exception, sentence: str
) -> None:
    def fail() -> None:
        raise error

    monkeypatch.setattr(doctor, "_findings", fail)
    code, _, err = said_by(monkeypatch, "utf-8", ["doctor"])
    assert code == 4
    assert err.startswith("flexscale: ")
    assert sentence in err
