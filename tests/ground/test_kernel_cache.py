"""Compiled kernels are kept in one folder for each state of what they are compiled from."""

from __future__ import annotations

import ast
import os
import shutil
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest

from flexscale import kernel_cache

PACKAGE = Path(kernel_cache.__file__).parent


@pytest.fixture
def at(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """Where numba is told to keep kernels; the setting is undone at the end."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    numba = sys.modules.get("numba")
    if numba is not None:
        monkeypatch.setattr(numba.config, "CACHE_DIR", numba.config.CACHE_DIR)
    return tmp_path


def given() -> Path:
    kernel_cache.provide_kernel_cache()
    return Path(os.environ["NUMBA_CACHE_DIR"])


def run(code: str, at: Path | None = None, **environment: str) -> str:
    """What a new process prints, without this one's place for kernels."""
    inherited = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=at,
        env=inherited | environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


KERNEL = """
from numba import njit
from flexscale.mechanics.{module} import Pair, difference

@njit(cache=True)
def probe(pair: Pair) -> float:
    return difference(pair.first, pair.second)
"""
CALLED = """
from typing import NamedTuple
from numba import njit

class Pair(NamedTuple):
    first: float
    second: float

@njit(cache=True)
def difference(first, second):
    return {formula}
"""
CALL = "from flexscale.mechanics.probe import probe, Pair; print(probe(Pair(3.0, 2.0)))"


def test_kernels_follow_what_they_call_and_the_types_they_take(tmp_path: Path) -> None:
    """The file of the kernel itself stays as it is, or its type moves to another module."""
    mechanics = tmp_path / "flexscale" / "mechanics"
    mechanics.mkdir(parents=True)
    for name in ("__init__.py", "kernel_cache.py"):
        shutil.copy(PACKAGE / name, tmp_path / "flexscale")
    (mechanics / "__init__.py").touch()
    there = {"PYTHONPATH": str(tmp_path), "PYTHONDONTWRITEBYTECODE": "1"}

    (mechanics / "probe.py").write_text(KERNEL.format(module="called"))
    (mechanics / "called.py").write_text(CALLED.format(formula="first - second"))
    assert run(CALL, tmp_path, **there) == "1.0"
    assert list((tmp_path / "flexscale").rglob("*.nbc"))

    (mechanics / "called.py").write_text(CALLED.format(formula="second - first"))
    assert run(CALL, tmp_path, **there) == "-1.0"

    (mechanics / "called.py").rename(mechanics / "moved.py")
    (mechanics / "probe.py").write_text(KERNEL.format(module="moved"))
    assert run(CALL, tmp_path, **there) == "-1.0"


def test_the_state_is_that_of_sources_of_kernels_alone(tmp_path: Path) -> None:
    for file in ("simplices.py", "mechanics/jets.py", "cli/main.py"):
        (tmp_path / file).parent.mkdir(exist_ok=True)
        shutil.copy(PACKAGE / file, tmp_path / file)
    states = [kernel_cache.kernel_state(tmp_path)]
    for file in ("cli/main.py", "simplices.py", "mechanics/jets.py"):
        (tmp_path / file).write_text((tmp_path / file).read_text() + "# changed\n")
        states.append(kernel_cache.kernel_state(tmp_path))
    (tmp_path / "simplices.py").rename(tmp_path / "other.py")
    states.append(kernel_cache.kernel_state(tmp_path))
    assert states[1] == states[0]
    assert len({*states[1:]}) == 4


def kernels_of(tree: ast.Module) -> list[ast.FunctionDef]:
    return [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef)
        and any("njit" in ast.unparse(decorator) for decorator in node.decorator_list)
    ]


def sources_of(tree: ast.Module) -> dict[str, Path]:
    """The file of each name that a module imports from this package."""
    found = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("flexscale"):
            module = PACKAGE.parent.joinpath(*str(node.module).split("."))
            for alias in node.names:
                file = module / f"{alias.name}.py" if module.is_dir() else module.with_suffix(".py")
                found[alias.asname or alias.name] = file
    return found


def test_kernels_are_compiled_from_those_sources_alone() -> None:
    """Whatever a kernel names (functions, constants, types) comes from a file that counts."""
    counted = set(kernel_cache.kernel_sources(PACKAGE))
    n_kernels = 0
    for path in PACKAGE.rglob("*.py"):
        text = path.read_text()
        if "njit" not in text:
            continue
        tree = ast.parse(text)
        kernels, sources = kernels_of(tree), sources_of(tree)
        n_kernels += len(kernels)
        assert not kernels or path in counted, path
        for node in (node for kernel in kernels for node in ast.walk(kernel)):
            if isinstance(node, ast.Name) and node.id in sources:
                assert sources[node.id] in counted, (path, node.id)
    assert n_kernels > 100


def test_all_processes_of_one_state_share_a_folder(at: Path) -> None:
    folder = given()
    assert folder.parent == at
    assert given() == folder
    assert run("import flexscale, numba; print(numba.config.CACHE_DIR)",
               NUMBA_CACHE_DIR=str(folder)) == str(folder)  # fmt: skip


def test_numba_is_told_even_when_it_is_loaded_already(tmp_path: Path) -> None:
    code = "import numba, flexscale; print(numba.config.CACHE_DIR)"
    assert Path(run(code, NUMBA_CACHE_DIR=str(tmp_path))).parent == tmp_path


def test_folders_out_of_use_are_removed(at: Path) -> None:
    now, unused = time.time(), at / "kernels-unused"
    for name, age in [("unused", 25 * 3600), ("recent", 3600)]:
        folder = at / f"kernels-{name}"
        folder.mkdir()
        (folder / "kernel.nbc").touch()
        os.utime(folder, (now - age, now - age))
    (at / "of_others").mkdir()
    os.utime(at / "of_others", (0, 0))
    folder = given()
    assert {path.name for path in at.iterdir()} == {"kernels-recent", "of_others"}

    folder.mkdir()
    os.utime(folder, (0, 0))
    unused.mkdir()
    os.utime(unused, (0, 0))
    given()
    assert folder.stat().st_mtime > now - 60  # it is in use, so no later state removes it
    assert unused.exists()  # nothing is looked for while the state stays


def test_there_is_a_place_for_kernels_where_numba_finds_none(
    monkeypatch: pytest.MonkeyPatch, at: Path
) -> None:
    import tempfile

    monkeypatch.setattr(kernel_cache, "_places", lambda: [Path("/dev/null/cache")])
    monkeypatch.setattr(tempfile, "tempdir", str(at))
    place = given().parent
    assert place.parent == at
    assert stat.S_IMODE(place.stat().st_mode) == 0o700
    assert given().parent == place
    place.chmod(0o777)  # others could put in what we then run
    other = given().parent
    assert other != place
    assert stat.S_IMODE(other.stat().st_mode) == 0o700


#: Only a temporary folder can be written, as numba finds out by writing there.
NO_HOME = """
import os, sys, tempfile
allowed, write = os.environ["TMPDIR"], tempfile.TemporaryFile
def guarded(*arguments, dir=None, **options):
    if dir is not None and not str(dir).startswith(allowed):
        raise PermissionError(13, "Permission denied", dir)
    return write(*arguments, dir=dir, **options)
tempfile.TemporaryFile = guarded
os.access = lambda path, mode: str(path).startswith(allowed)
import flexscale.mechanics.linear_law
print(os.environ["NUMBA_CACHE_DIR"])
"""


def test_kernels_load_for_somebody_without_a_home(tmp_path: Path) -> None:
    """In an installation that is not theirs."""
    said = run(NO_HOME, TMPDIR=str(tmp_path), HOME="/dev/null")
    assert Path(said).parent == tmp_path / f"flexscale-kernels-{os.getuid()}"
