"""Sweeps: a pattern bent in many directions, to both sides, to many curvatures."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from flexscale.datasets.build import build_sweep_dataset
from flexscale.errors import UnitRangeError, UnknownNameError, suggest
from flexscale.homogenize.cell_problem import CellModel, CellProblem
from flexscale.homogenize.labels import pattern_scalars
from flexscale.homogenize.line import SIDE_SIGNS, Line, follow_line
from flexscale.homogenize.tangent import solve_tangent
from flexscale.mechanics.contact_options import ContactOptions
from flexscale.mechanics.energy import FloatArray
from flexscale.mesh.options import MeshOptions
from flexscale.mesh.periodic_mesh import PeriodicMesh
from flexscale.patterns import Pattern
from flexscale.solve.newton import SolverOptions
from flexscale.status import SolveStatus

if TYPE_CHECKING:
    import xarray as xr

#: Each worker process computes with one thread: same recipe, same bits.
SINGLE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)


class Checkpoint(Protocol):
    """Keeps finished samples, so that a kill loses only those in work. Must be picklable."""

    def load(self, line_key: str) -> list[dict[str, Any]]:
        """Finished samples of a line, in order."""

    def append(self, line_key: str, sample: dict[str, Any]) -> None:
        """Keep one more sample of a line."""


@dataclass(frozen=True)
class SampleEvent:
    """Progress: a sample is finished.

    Attributes
    ----------
    done, total, n_failed : samples finished, in all, and not converged so far.
    side, direction, curvature, status : the sample; degree and mm-1.
    seconds : since the sweep began.
    """

    done: int
    total: int
    n_failed: int
    side: str
    direction: float
    curvature: float
    status: SolveStatus
    seconds: float


def sweep(
    pattern: Pattern,
    directions: Sequence[float],
    curvatures: Sequence[float],
    sides: Sequence[str] = ("closing", "opening"),
    *,
    mesh: MeshOptions | None = None,
    solver: SolverOptions | None = None,
    contact: ContactOptions | None = None,
    workers: int | None = None,
    checkpoint: Checkpoint | None = None,
    on_sample: Callable[[SampleEvent], None] | None = None,
) -> xr.Dataset:
    """Energy density and moment over side, direction and curvature.

    Parameters
    ----------
    pattern : the scale pattern.
    directions : degree in [0, 180), measured from the x axis of the pattern's coordinates.
    curvatures : mm-1, non-negative and increasing.
    sides : of "closing", "opening".
    mesh, solver, contact : element sizes, solver and contact options; the defaults if not given.
    workers : processes, each with one thread; as many as there are cores if not given.
    checkpoint : keeps samples as they finish, and gives back those of an interrupted sweep.
    on_sample : called in this process as samples (with several workers: lines) finish.

    Returns
    -------
    xarray.Dataset of kind sweep/1 (see `datasets.schema`). Samples that did not converge hold NaN
    and a `status`. The moment is the derivative of the energy density by the curvature's magnitude.

    Raises
    ------
    UnitRangeError, UnknownNameError : see `check_sweep`; before anything is solved.
    """
    mesh, solver = mesh or MeshOptions(), solver or SolverOptions()
    check_sweep(pattern, directions, curvatures, sides)
    kappa = tuple(float(k) for k in curvatures)
    lines = [Line(side, float(direction), kappa) for side in sides for direction in directions]
    contact = contact or ContactOptions()
    problem = CellProblem.from_pattern(
        pattern, mesh, contact=contact, linear_solver=solver.linear_solver
    )
    workers = min(workers or os.cpu_count() or 1, len(lines))
    if workers > 1:
        solve_tangent(problem)  # compiles and caches the kernels once, before processes start
        results = _in_processes(problem, lines, solver, checkpoint, workers)
    else:
        results = _in_turn(problem, lines, solver, checkpoint)
    samples = _collect(results, lines, on_sample)
    options = {
        "mesh": mesh.to_config(),
        "solver": solver.to_config(),
        "contact": contact.to_config(),
    }
    return _build_dataset(
        pattern, pattern_scalars(pattern, mesh), options, samples, (sides, directions, kappa)
    )


def check_sweep(
    pattern: Pattern,
    directions: Sequence[float],
    curvatures: Sequence[float],
    sides: Sequence[str],
) -> None:
    """Refuse a sweep that cannot be run, before anything is meshed or solved.

    Raises
    ------
    UnknownNameError : a side other than "closing" and "opening".
    UnitRangeError : a direction outside [0, 180) degree, a curvature that is negative, not finite
        or out of order, nothing to compute, or a curvature at which the cylinder folds through the
        scales.
    """
    for side in sides:
        if side not in SIDE_SIGNS:
            raise UnknownNameError(f"There is no side {side!r}. {suggest(side, SIDE_SIGNS)}")
    for values, name in ((sides, "sides"), (directions, "directions"), (curvatures, "curvatures")):
        if len(values) == 0 or len(set(values)) != len(values):
            raise UnitRangeError(f"A sweep needs one or more distinct {name}, not {list(values)}.")
    for direction in directions:
        if not 0.0 <= direction < 180.0:
            raise UnitRangeError(
                f"The direction {direction:g} degree is outside [0, 180): bending is the same "
                "after half a turn."
            )
    kappa = np.asarray(curvatures, dtype=float)
    if not (np.isfinite(kappa).all() and (kappa >= 0.0).all() and (np.diff(kappa) > 0.0).all()):
        raise UnitRangeError(
            f"Curvatures must be finite, non-negative and increasing, in mm-1, not "
            f"{list(curvatures)}; the side says to which side the sheet is bent."
        )
    if "closing" in sides and kappa[-1] * pattern.scale_height >= 1.0:
        raise UnitRangeError(
            f"At a closing curvature of {kappa[-1]:g} mm-1 the bending center lies inside the "
            f"scales, which are {pattern.scale_height:g} mm high: stay below "
            f"{1.0 / pattern.scale_height:g} mm-1."
        )


def _run_line(
    problem: CellProblem, line: Line, solver: SolverOptions, checkpoint: Checkpoint | None
) -> Iterator[dict[str, Any]]:
    finished = checkpoint.load(line.key)[: len(line.curvatures)] if checkpoint else []
    yield from finished
    for sample in follow_line(problem, line, solver, finished):
        if checkpoint:
            checkpoint.append(line.key, sample)
        yield sample


def _in_turn(
    problem: CellProblem,
    lines: Sequence[Line],
    solver: SolverOptions,
    checkpoint: Checkpoint | None,
) -> Iterator[tuple[Line, dict[str, Any]]]:
    for line in lines:
        for sample in _run_line(problem, line, solver, checkpoint):
            yield line, sample


_worker_problem: CellProblem | None = None


def _start_worker(mesh: PeriodicMesh, model: CellModel) -> None:
    global _worker_problem
    _worker_problem = CellProblem(mesh, model)


def _work_line(
    line: Line, solver: SolverOptions, checkpoint: Checkpoint | None
) -> list[dict[str, Any]]:
    assert _worker_problem is not None
    samples = list(_run_line(_worker_problem, line, solver, checkpoint))
    return [{k: v for k, v in s.items() if k not in ("state", "rate")} for s in samples]


def _in_processes(
    problem: CellProblem,
    lines: Sequence[Line],
    solver: SolverOptions,
    checkpoint: Checkpoint | None,
    workers: int,
) -> Iterator[tuple[Line, dict[str, Any]]]:
    from loky import ProcessPoolExecutor  # needs no __main__ guard in the user's script

    arguments = (problem.mesh, problem.model)
    pool = ProcessPoolExecutor(
        workers, initializer=_start_worker, initargs=arguments, env=SINGLE_THREAD
    )
    try:
        futures = {pool.submit(_work_line, line, solver, checkpoint): line for line in lines}
        for future in as_completed(futures):
            for sample in future.result():
                yield futures[future], sample
    finally:
        pool.shutdown(wait=True, kill_workers=True)


def _collect(
    results: Iterator[tuple[Line, dict[str, Any]]],
    lines: Sequence[Line],
    on_sample: Callable[[SampleEvent], None] | None,
) -> dict[tuple[str, float], list[dict[str, Any]]]:
    start = time.perf_counter()
    total = sum(len(line.curvatures) for line in lines)
    failed = 0
    samples: dict[tuple[str, float], list[dict[str, Any]]] = {}
    for done, (line, sample) in enumerate(results, start=1):
        samples.setdefault((line.side, line.direction), []).append(sample)
        status = SolveStatus(sample["status"])
        failed += status != SolveStatus.converged
        if on_sample:
            seconds = time.perf_counter() - start
            on_sample(
                SampleEvent(
                    done,
                    total,
                    failed,
                    line.side,
                    line.direction,
                    sample["curvature"],
                    status,
                    seconds,
                )
            )
    return samples


def _build_dataset(
    pattern: Pattern,
    scalars: dict[str, float | str],
    options: dict[str, Any],
    samples: dict[tuple[str, float], list[dict[str, Any]]],
    axes: tuple[Sequence[str], Sequence[float], Sequence[float]],
) -> xr.Dataset:
    sides, directions, curvatures = axes
    shape = (len(sides), len(directions), len(curvatures))

    def array(
        name: str, missing: float, dtype: type = float, extra: tuple[int, ...] = ()
    ) -> FloatArray:
        out: FloatArray = np.full((*shape, *extra), missing, dtype=dtype)
        for i, side in enumerate(sides):
            for j, direction in enumerate(directions):
                for k, sample in enumerate(samples[side, float(direction)]):
                    out[i, j, k] = sample.get(name, missing)
        return out

    reals: tuple[str, ...] = ("energy_density", "moment", "residual_norm", "mean_offset")
    names: tuple[str, ...] = ("membrane", "bending", "scales")
    counts: tuple[str, ...] = ("newton_iterations", "negative_eigenvalues", "saddles_left")
    if options["contact"]["enabled"]:
        names += ("contact",)
        reals += ("min_gap", "contact_force", "barrier_stiffness")
        counts += ("contact_pairs",)
    parts = tuple(f"energy_density_{name}" for name in names)
    arrays: dict[str, Any] = {name: array(name, np.nan) for name in (*reals, *parts)}
    arrays["stretch"] = array("stretch", np.nan, extra=(3,))
    for name in counts:
        arrays[name] = array(name, 0, np.int32)
    arrays["status"] = array("status", int(SolveStatus.not_run), np.int8)
    config = {
        "pattern": pattern.to_config(),
        **options,
        "sides": list(sides),
        "directions": [float(d) for d in directions],
        "curvatures": list(curvatures),
    }
    return build_sweep_dataset(
        sides, directions, curvatures, arrays, scalars=scalars, config=config
    )
