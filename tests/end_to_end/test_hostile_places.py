"""Results folders and experiment files of others, and odd environments: nothing of theirs runs."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from flexscale.datasets.registry import open_registry
from flexscale.errors import ConfigError
from flexscale.steps.experiment import load_experiment

ROOT = Path(__file__).parents[2]
FILE = """
patterns:
  square: {family: IH76}
native: shell
mesh: {along: 4, corner: 1, scale_size: 10, scale_layers: 1, scale_order: 1}
tangent: {}
figures: [tangent]
"""
#: Expressions of the engine's configuration files, which it evaluates where it is let.
EXPRESSION = """
__use_yte__: true
cores: ?__import__("pathlib").Path({mark!r}).touch() or 1
"""


def set_traps(folder: Path, mark: Path) -> None:
    """Fill a folder with what others might run: modules, profiles, rules, kept objects."""
    for name in ("psutil", "yaml", "numpy", "yte", "json", "sitecustomize", "usercustomize"):
        (folder / f"{name}.py").write_text(f"open({str(mark)!r}, 'w')\nraise SystemExit(9)\n")
    for place in ("profiles/default/config.yaml", "config/config.yaml", "config.yaml"):
        (folder / place).parent.mkdir(parents=True, exist_ok=True)
        (folder / place).write_text(EXPRESSION.format(mark=str(mark)))
    (folder / "Snakefile").write_text(f"open({str(mark)!r}, 'w')\n")
    for kept in (".snakemake/iocache", ".workflow/done"):
        (folder / kept).mkdir(parents=True)
    (folder / ".snakemake/iocache/latest.pkl").write_bytes(
        f"cposix\nsystem\n(S'touch {mark}'\ntR.".encode()
    )


def test_a_folder_of_traps_in_an_odd_environment(tmp_path: Path) -> None:
    """An experiment runs to its end, with its picture, and springs none of them."""
    results, mark = tmp_path / "of {others} and 'mine'", tmp_path / "sprung"
    local = results / "local"
    local.mkdir(parents=True)
    set_traps(local, mark)
    file = tmp_path / "small.yaml"
    file.write_text(FILE)
    # The environment itself lies on a path with a space.
    environment = tmp_path / "my environments" / "venv"
    environment.parent.mkdir()
    environment.symlink_to(sys.prefix)
    python = environment / "bin" / Path(sys.executable).name
    odd = {
        "SNAKEMAKE_PROFILE": "a-profile-of-mine",
        "MPLBACKEND": "module://matplotlib_inline.backend_inline_of_mine",
        "HOME": "/dev/null",
        "PYTHONPATH": str(ROOT),
        "PYTHONIOENCODING": "latin-1",
        "PYTHONUTF8": "0",
        "LC_ALL": "POSIX",
    }
    done = subprocess.run(
        [python, "-P", "-m", "flexscale.cli", "run", file, "--results", results, "--cores", "2"],
        cwd=local,
        env=dict(os.environ) | odd,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert not mark.exists()
    assert sorted(entry.kind for entry in open_registry(results)) == ["cell", "tangent"]
    assert len(list((local / "figures").glob("square-tangent*.png"))) == 1
    assert list((local / ".staging").iterdir()) == []


def test_an_experiment_file_is_read_and_never_run(tmp_path: Path) -> None:
    """Neither by `flexscale run` nor where the engine is called directly."""
    mark, file = tmp_path / "sprung", tmp_path / "theirs.yaml"
    file.write_text(FILE + EXPRESSION.format(mark=str(mark)))
    with pytest.raises(ConfigError, match="__use_yte__"):
        load_experiment(file)
    empty = tmp_path / "empty"
    empty.mkdir()
    command = [sys.executable, "-P", "-m", "snakemake", "--dry-run", "--directory", str(empty)]
    command += ["--snakefile", str(ROOT / "workflows" / "Snakefile"), "--workflow-profile", "none"]
    command += ["--config", f"experiment={file}", f"results={tmp_path / 'results'}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "__use_yte__" in done.stdout + done.stderr
    assert not mark.exists()
