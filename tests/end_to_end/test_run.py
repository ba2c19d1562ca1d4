"""`flexscale run` from an experiment file to stored datasets and pictures, kills included."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import psutil
import pytest

from benchmarks.kills import ROLES, kill_one
from flexscale.datasets.registry import open_registry
from flexscale.datasets.store import Store

ROOT = Path(__file__).parents[2]
#: Of this the runs are made that are stopped: two datasets, which the whole experiment has too.
SWEEP_ALONE = """
patterns:
  square: {family: IH76}
native: shell
mesh: {along: 4, corner: 1, scale_size: 10, scale_layers: 1, scale_order: 1}
sweep: {directions: [0, 45], curvatures: [0, 0.0005, 0.001, 0.002, 0.003, 0.004]}
"""
FILE = f"""{SWEEP_ALONE}
tangent: {{}}
shape: [{{direction: 45, curvature: 0.004}}]
figures: [tangent]
"""
PICTURES = ("polar", "curves", "tangent", "shape")
SAMPLES = "local/.staging/*/line-*/*.npz"
PATIENCE = 180.0  # s; a run takes about 10 once the kernels are compiled, 60 before


def start(
    file: Path, results: Path, *options: str, solver: str | None = None
) -> subprocess.Popen[str]:
    """`flexscale run` in a process of its own, on the linear solver named if any."""
    environment = dict(os.environ) | ({"FLEXSCALE_LINEAR_SOLVER": solver} if solver else {})
    command = [sys.executable, "-m", "flexscale.cli", "run", str(file), "--results", str(results)]
    return subprocess.Popen(
        [*command, "--cores", "2", *options],
        cwd=ROOT,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def run(file: Path, results: Path, *options: str) -> tuple[int, str, str]:
    """Exit code, stdout and stderr of a whole run."""
    process = start(file, results, *options)
    try:
        out, err = process.communicate(timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        process.terminate()
        process.communicate()
        raise
    return process.returncode, out, err


def digests(results: Path) -> dict[str, str]:
    """Dataset id -> content digest."""
    return {entry.id: entry.content_digest for entry in open_registry(results)}


def sweep_alone(results: Path) -> dict[str, str]:
    """What a whole run has in common with one of the sweep alone."""
    return {k: v for k, v in digests(results).items() if k.split(":")[0] in ("cell", "sweep")}


def wait_for(results: Path, pattern: str, number: int, process: subprocess.Popen[str]) -> int:
    """Wait until so many files are there while the run goes on; returns how many it found."""
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        found = len(list(results.glob(pattern)))
        if found >= number:
            return found
        assert process.poll() is None, "the run ended before it could be stopped"
        time.sleep(0.02)
    raise AssertionError(f"{pattern} did not appear")


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("experiment") / "small.yaml"
    path.write_text(FILE)
    return path


@pytest.fixture(scope="module")
def sweep_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("experiment") / "sweep.yaml"
    path.write_text(SWEEP_ALONE)
    return path


@pytest.fixture(scope="module")
def finished(file: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of an undisturbed run."""
    results = tmp_path_factory.mktemp("undisturbed")
    code, out, err = run(file, results)
    assert code == 0, err
    assert out.count("\n") == 5
    assert "reused" not in out
    assert "sweep" in err  # progress, on stderr
    return results


def test_run_stores_what_was_asked_for(finished: Path) -> None:
    registry = open_registry(finished)
    assert sorted(entry.kind for entry in registry) == ["cell", "shape", "sweep", "tangent"]
    sweep = registry.one(kind="sweep", pattern="square")
    assert dict(sweep.sizes) == {"side": 2, "direction": 2, "curvature": 6, "component": 3}
    assert (sweep["status"] == 0).all()
    cell = registry.find(kind="cell").one()
    assert json.loads(sweep.attrs["flexscale_inputs"]) == [cell.id]


def test_moment_starts_with_the_tangent(finished: Path) -> None:
    registry = open_registry(finished)
    sweep, tangent = registry.one(kind="sweep"), registry.one(kind="tangent")
    for direction in (0.0, 45.0):
        moment = sweep["moment"].sel(direction=direction).mean("side")
        coarse, fine = (float(moment.sel(curvature=kappa)) / kappa for kappa in (0.001, 0.0005))
        # M/kappa of the mean of both sides is a + O(kappa^2), extrapolated; at 0.001 mm-1 that
        # term is 5 % of a, and the next one about its square.
        stiffness = float(tangent["stiffness"].sel(direction=direction))
        assert (4.0 * fine - coarse) / 3.0 == pytest.approx(stiffness, rel=5e-3)


def test_shape_shows_the_curvature_asked_for(finished: Path) -> None:
    shape = open_registry(finished).one(kind="shape")
    assert shape["sample_curvature"].values.tolist() == [0.004]
    assert shape["sample_direction"].values.tolist() == [45.0]
    displacement = shape["displacement"].values[0]
    assert np.isfinite(displacement).all()
    # A chord L of a circle rises by kappa L^2 / 8; here L is the cell's diagonal, sqrt(2) x 10 mm.
    rise = 0.004 * 200.0 / 8.0
    assert 0.3 * rise < np.abs(displacement[:, 2]).max() < 3.0 * rise


def check_picture(results: Path, name: str) -> None:
    """It is there, and names its dataset."""
    (facts,) = (results / "local" / "figures").glob(f"square-{name}-*.json")
    for ending in (".png", ".pdf"):
        assert facts.with_suffix(ending).stat().st_size > 3000
    source = json.loads(facts.read_text())["sources"][0]["id"]
    assert source in digests(results)
    assert facts.stem == f"square-{name}-{source.split(':')[1]}"


def test_a_picture_names_its_dataset(finished: Path) -> None:
    check_picture(finished, "tangent")


@pytest.mark.slow
def test_pictures_of_every_kind_are_drawn_of_what_is_there(finished: Path, tmp_path: Path) -> None:
    results, file = tmp_path / "results", tmp_path / "pictures.yaml"
    shutil.copytree(finished, results)
    file.write_text(FILE.replace("[tangent]", f"[{', '.join(PICTURES)}]"))
    code, out, err = run(file, results)
    assert code == 0, err
    assert out.count("\n") == 8
    assert out.count("reused") == 5
    for name in PICTURES:
        check_picture(results, name)


def test_second_run_does_nothing(file: Path, finished: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in finished.rglob("*") if path.is_file()}
    code, out, err = run(file, finished)
    assert code == 0
    assert out.count("reused") == 5
    assert err == ""
    assert {p: p.stat().st_mtime_ns for p in finished.rglob("*") if p.is_file()} == before


@pytest.mark.parametrize(
    "sign", [signal.SIGINT, pytest.param(signal.SIGKILL, marks=pytest.mark.slow)]
)
def test_a_stopped_run_goes_on_to_the_same_bits(
    sweep_file: Path, finished: Path, tmp_path: Path, sign: signal.Signals
) -> None:
    process = start(sweep_file, tmp_path)
    wait_for(tmp_path, "local/.workflow/lock", 1, process)
    code, _, err = run(sweep_file, tmp_path)
    assert code == 4
    assert f"Another flexscale run (process {process.pid} on {os.uname().nodename}" in err
    n_before = wait_for(tmp_path, SAMPLES, 3, process)
    family = psutil.Process(process.pid).children(recursive=True)
    process.send_signal(sign)
    err = process.communicate(timeout=30)[1]
    if sign == signal.SIGINT:
        assert process.returncode == 130
        assert "finished work is kept" in err
    gone, alive = psutil.wait_procs(family, timeout=15)
    assert (len(gone), alive) == (len(family), [])
    assert len(list(tmp_path.glob(SAMPLES))) >= n_before
    assert not list(tmp_path.glob("local/sweep"))

    code, out, err = run(sweep_file, tmp_path)
    assert code == 0, err
    assert "cell         IH76/square         reused" in out
    assert digests(tmp_path) == sweep_alone(finished)


@pytest.mark.parametrize(
    "role",
    [
        "worker",
        *(pytest.param(role, marks=pytest.mark.slow) for role in ROLES if role != "worker"),
    ],
)
def test_any_process_may_be_killed(
    file: Path, sweep_file: Path, finished: Path, tmp_path: Path, role: str
) -> None:
    """As soon as it is there, as the kernel does when memory is short."""
    expected = digests(finished)
    if role == "worker":
        file, expected = sweep_file, sweep_alone(finished)
    kill, code, said = kill_one(file, tmp_path, role, signal.SIGKILL, delay=0.0)
    assert kill is not None
    assert (kill.hung, kill.told, kill.left, kill.lost) == (False, True, 0, 0), said
    if role == "worker":
        assert code == 4
        assert "sweep IH76/square: A process that solved samples of the sweep" in said
        assert "signal 9 (SIGKILL), as systems do when memory is short" in said
    code, _, err = run(file, tmp_path)
    assert code == 0, err
    assert digests(tmp_path) == expected


@pytest.mark.slow
def test_a_removed_dataset_is_made_again(file: Path, finished: Path) -> None:
    before = digests(finished)
    store = Store(finished)
    entry = open_registry(finished).find(kind="tangent").one()
    for path in entry.folder.iterdir():
        path.unlink()
    entry.folder.rmdir()
    code, out, err = run(file, store.root)
    assert code == 0, err
    assert out.count("reused") == 3  # all but the tangent and its figure
    assert digests(finished) == before


@pytest.fixture(scope="module")
def hard(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Experiment file of a sweep that does not converge everywhere."""
    file = tmp_path_factory.mktemp("hard") / "hard.yaml"
    file.write_text(
        "patterns: {square: {family: IH76}}\n"
        "native: shell\n"
        "mesh: {along: 4, corner: 1, scale_size: 10, scale_layers: 1, scale_order: 1}\n"
        "solver: {max_iterations: 1}\n"
        "sweep: {sides: [closing], directions: [45], curvatures: [0, 0.1]}\n"
        "figures: [curves]\n"
    )
    return file


@pytest.fixture(scope="module")
def unconverged(hard: Path) -> tuple[int, str, str]:
    """Of its first run."""
    return run(hard, hard.parent / "results")


def test_samples_that_do_not_converge_are_told_and_the_rest_goes_on(
    hard: Path, unconverged: tuple[int, str, str]
) -> None:
    (code, out, err), results = unconverged, hard.parent / "results"
    assert code == 3, err
    sweep = open_registry(results).one(kind="sweep")
    failed = int((sweep["status"] != 0).sum())
    assert failed == 1
    assert "2 samples, 1 not converged" in out
    assert "direction 45 degree, closing, curvature 0.1 mm-1" in err
    assert list((results / "local" / "figures").glob("square-curves-*.png"))


@pytest.mark.slow
def test_samples_that_did_not_converge_are_told_again(
    hard: Path, unconverged: tuple[int, str, str]
) -> None:
    assert (unconverged[0], run(hard, hard.parent / "results")[0]) == (3, 3)
