"""Whatever a results folder holds, `flexscale data` ends with its own sentences and exit codes."""

from __future__ import annotations

import random
import shutil
import sys
from pathlib import Path

import pytest

from flexscale.cli import main
from flexscale.datasets.entry import Entry
from tests.datasets.results_mutations import mutate
from tests.datasets.results_samples import one_sweep

COMMANDS = (
    ["list"],
    ["list", "--json"],
    ["show", "{id}"],
    ["show", "{id}", "--json"],
    ["check"],
    ["check", "--json"],
    ["export", "{id}", "--to", "{to}"],
    ["export", "{id}", "--to", "{to}", "--format", "csv"],
)


def exit_code(arguments: list[str], monkeypatch: pytest.MonkeyPatch) -> int:
    monkeypatch.setattr(sys, "argv", ["flexscale", "data", *arguments])
    with pytest.raises(SystemExit) as caught:
        main.main()
    return int(caught.value.code or 0)


def hold(root: Path, entry: Entry, commands: object, monkeypatch, capsys) -> list[str]:
    """Run the commands; texts of what was not one of our own errors."""
    faults = []
    (root / "out").mkdir(exist_ok=True)
    for command in COMMANDS:
        words = [word.format(id=entry.id, to=root / "out") for word in command]
        code = exit_code([*words, "--results", str(root)], monkeypatch)
        told = capsys.readouterr()
        if code not in (0, 2, 4) or "Traceback" in told.err:
            faults.append(f"{command}: exit code {code}, {told.err[-600:]}")
        if any(ord(letter) in (0x1B, 0x9B, 0x07, 0x202E) for letter in told.out + told.err):
            faults.append(f"{command}: control characters in {told.out + told.err!r:.300}")
    return faults


@pytest.mark.parametrize(
    "seed", [*range(4), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(4, 12))]
)
def test_mutated_results_are_sentences(
    seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    rng = random.Random(seed)
    entry = one_sweep(tmp_path / "sound")
    told = ""
    shutil.copytree(tmp_path / "sound", tmp_path / "results")
    folder = tmp_path / "results" / "local" / entry.row["path"]
    for _ in range(rng.choice((1, 1, 2, 3))):
        try:
            told += mutate(folder, rng) + "; "
        except (OSError, ValueError, KeyError, RuntimeError):  # no longer to be opened
            break
    faults = hold(tmp_path / "results", entry, COMMANDS, monkeypatch, capsys)
    outside = [path.name for path in tmp_path.iterdir()]
    assert not faults, f"{told}: {faults}"
    assert sorted(outside) == ["results", "sound"]
