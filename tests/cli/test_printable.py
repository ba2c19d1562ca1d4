"""Text out of files reaches the terminal without what would steer it."""

from __future__ import annotations

import sys
import unicodedata
from pathlib import Path

import pytest

from flexscale.cli import main
from flexscale.cli.printable import printable, printable_streams, terminal_stream


def test_every_steering_character_is_written_out_and_nothing_else() -> None:
    for code in (*range(0x300), *range(0x2000, 0x2070), 0x061C):
        letter = chr(code)
        told = printable(f"a{letter}b")
        steers = unicodedata.category(letter) == "Cc" and letter not in "\t\n"
        steers |= unicodedata.bidirectional(letter) in (
            *("LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI"),
        )
        if steers:
            assert letter not in told
            assert told.startswith("a\\")
    for text in ("κ = 0.02 mm⁻¹", "30°\tclosing\n", "é × −1", "日本"):
        assert printable(text) == text


def test_streams_are_cleaned_and_given_back(capsys: pytest.CaptureFixture[str]) -> None:
    before = sys.stdout, sys.stderr
    with printable_streams():
        print("\x1b[2Jred\x9b", end="\n")
        print("\u202egnp", file=sys.stderr)
        sys.stdout.writelines(["\x07", "x"])
        assert terminal_stream() is before[1], "a progress bar draws on the terminal itself"
    assert (sys.stdout, sys.stderr) == before
    told = capsys.readouterr()
    assert told.out == "\\x1b[2Jred\\x9b\n\\x07x"
    assert told.err == "\\u202egnp\n"


def test_commands_write_through_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "local" / "sweep" / "\x1b[31m" / "\x9b2J" / ("\x07" * 12)
    folder.mkdir(parents=True)
    for command in (["list"], ["check"], ["show", "\x1b]0;x\x07"]):
        arguments = ["flexscale", "data", *command, "--results", str(tmp_path)]
        monkeypatch.setattr(sys, "argv", arguments)
        with pytest.raises(SystemExit):
            main.main()
        told = capsys.readouterr()
        assert "\\x1b" in told.out + told.err
        assert not any(letter in told.out + told.err for letter in "\x1b\x9b\x07")
