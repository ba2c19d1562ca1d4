"""Sweeps: bad input, resumption bit for bit, processes, samples that do not converge."""

from __future__ import annotations

import numpy as np
import pytest

import flexscale as fs
from flexscale.datasets.checks import check_dataset
from flexscale.datasets.identity import content_digest
from flexscale.datasets.staging import FileCheckpoint
from flexscale.errors import UnitRangeError, UnknownNameError
from flexscale.homogenize.shape import solve_shapes
from flexscale.status import SolveStatus

PATTERN = fs.Pattern(fs.Tiling("IH76"))
COARSE = fs.MeshOptions(along=4.0, corner=1.0, scale_size=10.0, scale_layers=1, scale_order=1)
CURVATURES = [0.0, 0.002, 0.004]


def run(directions=(0.0, 30.0), **options):
    return fs.sweep(
        PATTERN, list(directions), CURVATURES, **options, model=fs.NativeModel("shell", mesh=COARSE)
    )


@pytest.fixture(scope="module")
def reference():
    return run(workers=1)


def test_dataset_keeps_its_schema(reference):
    check_dataset(reference, "sweep")
    assert reference.energy_density.dims == ("side", "direction", "curvature")
    assert (reference.status == 0).all()
    flat = reference.sel(curvature=0.0)
    assert np.abs(flat.energy_density).max() < 1e-20
    assert np.abs(flat.moment).max() < 1e-9
    parts = sum(reference[f"energy_density_{p}"] for p in ("membrane", "bending", "scales"))
    assert parts.values == pytest.approx(reference.energy_density.values, rel=1e-12)
    assert reference.stretch.sel(curvature=0.0).values == pytest.approx(
        np.broadcast_to([1.0, 1.0, 0.0], (2, 2, 3)), abs=1e-12
    )


def test_moment_is_positive_to_both_sides(reference):
    """It is the derivative of the energy by the magnitude of the curvature."""
    assert (reference.moment.sel(curvature=0.004) > 0.0).all()


def test_processes_change_nothing(reference):
    assert content_digest(run(workers=2)) == content_digest(reference)


@pytest.mark.parametrize(
    "limits", [(4,), pytest.param((1, 8), marks=pytest.mark.slow)], ids=["one", "more"]
)
def test_resumed_sweep_is_identical(reference, tmp_path, limits):
    """Killed after any sample and started again: the same bits."""

    class Killed(Exception):
        pass

    for allowed in limits:
        checkpoint = FileCheckpoint(tmp_path / str(allowed))

        def stop(event, limit=allowed):
            if event.done == limit:
                raise Killed

        with pytest.raises(Killed):
            run(workers=1, checkpoint=checkpoint, on_sample=stop)
        events = []
        resumed = run(workers=1, checkpoint=checkpoint, on_sample=events.append)
        assert content_digest(resumed) == content_digest(reference)
        assert [event.done for event in events] == list(range(1, 13))


LINE = "closing-0.0"


@pytest.fixture(scope="module")
def samples(tmp_path_factory):
    kept = FileCheckpoint(tmp_path_factory.mktemp("samples"))
    run(directions=[0.0], sides=["closing"], workers=1, checkpoint=kept)
    return kept.load(LINE)


SPOILT = [
    {"state": np.zeros(3)},
    {"state": "text"},
    {"rate": np.full(1, np.nan)},
    {"energy_density": "much"},
    {"energy_density": None},
    {"stretch": np.zeros(2)},
    {"curvature": 0.003},
    {"status": 99},
    {"status": "converged"},
]


@pytest.mark.parametrize("spoilt", SPOILT, ids=lambda change: str(*change))
def test_samples_of_something_else_are_computed_anew(samples, reference, tmp_path, caplog, spoilt):
    """A sound file of the wrong contents, as another mesh or another hand leaves it."""
    first, second, third = samples
    kept = FileCheckpoint(tmp_path)
    for sample in (first, second | spoilt, third):
        kept.append(LINE, sample)
    resumed = run(directions=[0.0], sides=["closing"], workers=1, checkpoint=kept)
    assert resumed.energy_density.values == pytest.approx(
        reference.energy_density.sel(side=["closing"], direction=[0.0]).values, abs=0.0
    )
    assert "is of something else" in caplog.text
    assert [sample["curvature"] for sample in kept.load(LINE)] == CURVATURES


def test_unconverged_samples_are_labelled_and_empty():
    """Two Newton iterations are not enough for a long step: status, NaN, and no silent stop."""
    data = fs.sweep(
        PATTERN,
        [45.0],
        [0.001, 0.03, 0.04],
        ["opening"],
        workers=1,
        model=fs.NativeModel(
            "shell", mesh=COARSE, solver=fs.SolverOptions(max_iterations=1, tolerance=1e-14)
        ),
    )
    status = data.status.values.ravel()
    assert status[0] == SolveStatus.max_iterations
    assert (status[1:] == SolveStatus.not_run).all()
    assert data.moment.isnull().all()
    assert data.energy_density.isnull().all()


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        (([], [0.001]), UnitRangeError, "directions"),
        (([0.0], []), UnitRangeError, "curvatures"),
        (([180.0], [0.001]), UnitRangeError, "180 degree"),
        (([0.0], [-0.001]), UnitRangeError, "mm-1"),
        (([0.0], [0.002, 0.001]), UnitRangeError, "must increase, but 0.001"),
        (([0.0], [float("nan")]), UnitRangeError, "finite"),
        (([0.0], [0.25]), UnitRangeError, "4 mm high"),
        (([0.0, 0.0], [0.001]), UnitRangeError, "distinct"),
    ],
)
def test_bad_sweeps_are_refused_before_any_solve(arguments, error, words):
    with pytest.raises(error, match=words):
        fs.sweep(PATTERN, *arguments)


def test_unknown_side_is_refused():
    with pytest.raises(UnknownNameError, match="closing"):
        fs.sweep(PATTERN, [0.0], [0.001], ["closed"])


def test_shapes_follow_the_cylinder():
    """Flat scales on a parabola of mean offset 0 deviate by kappa P^2/12 at most, at the gaps."""
    data = solve_shapes(
        PATTERN,
        [("closing", 0.0, 0.002), ("opening", 90.0, 0.002)],
        native=fs.NativeModel("shell", mesh=COARSE),
    )
    check_dataset(data, "shape")
    assert data.sample_curvature.values == pytest.approx([0.002, -0.002])
    points = data.points.values + data.displacement.values
    base = np.abs(data.points.values[:, 2]) < 1e-12
    for k, (axis, sign) in enumerate([(0, 1.0), (1, -1.0)]):
        height = points[k, base, 2] - sign * 0.5 * 0.002 * points[k, base, axis] ** 2
        assert np.abs(height).max() == pytest.approx(0.002 * 100.0 / 12.0, rel=0.15)
