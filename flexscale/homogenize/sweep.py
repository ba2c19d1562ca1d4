"""Sweeps: a pattern bent in many directions, to both sides, to many curvatures."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from flexscale import checks
from flexscale.checks import checked, flag, function, series, whole
from flexscale.errors import UnitRangeError
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.build import build_problem
from flexscale.homogenize.checkpoint import Checkpoint
from flexscale.homogenize.errors_at_rest import note_errors
from flexscale.homogenize.labels import pattern_scalars
from flexscale.homogenize.native_model import NativeModel, native_model
from flexscale.homogenize.run_lines import Counts, Teller, run_in_processes
from flexscale.homogenize.sample import Sample
from flexscale.homogenize.sweep_dataset import build_dataset_of
from flexscale.homogenize.symmetry import check_line, find_sources, symmetry_error
from flexscale.homogenize.tangent import solve_tangent
from flexscale.mechanics.load_series import require_bends
from flexscale.patterns import Pattern
from flexscale.sides import SOME_SIDES
from flexscale.status import SolveStatus

if TYPE_CHECKING:
    import xarray as xr


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


@checked(
    pattern=checks.PATTERN,
    directions=series("degree"),
    curvatures=series("mm-1"),
    sides=SOME_SIDES,
    model=native_model,
    symmetry=flag,
    workers=whole(1, 1024),
    checkpoint=checks.CHECKPOINT,
    on_sample=function,
)
def sweep(
    pattern: Pattern,
    directions: Sequence[float],
    curvatures: Sequence[float],
    sides: Sequence[str] = ("closing", "opening"),
    *,
    model: NativeModel | str = "joints",
    symmetry: bool = True,
    workers: int | None = None,
    checkpoint: Checkpoint | None = None,
    on_sample: Callable[[SampleEvent], None] | None = None,
) -> xr.Dataset:
    """Energy density and moment over side, direction and curvature.

    Parameters
    ----------
    pattern : the scale pattern.
    directions : degree in [0, 180), along which the sheet curves, measured from the x axis of the
        pattern's coordinates: bent in 0°, it is a piece of a tube whose axis, and every fold line,
        runs across, at 90°. One number is a series of one, here and in `curvatures`.
    curvatures : mm-1, non-negative and increasing.
    sides : "closing", "opening", or both.
    model : the native model, or the name of one with its default options.
    symmetry : solve one of all directions that the pattern's symmetry makes equivalent, and one
        sample in another as a check; False solves all.
    workers : processes, each with one thread; if not given as many as there are cores, and one for
        the solid.
    checkpoint : keeps samples as they finish, and gives back those of an interrupted sweep.
    on_sample : called in this process as samples finish.

    Returns
    -------
    xarray.Dataset of kind sweep/1 (see `datasets.schema`). Samples that did not converge hold NaN
    and a `status`. The moment is the derivative of the energy density [N mm per mm2] by the
    curvature's magnitude [mm-1], and so in N: N mm for each mm of the sheet's width.
    `symmetry_source` tells which direction was solved.

    Raises
    ------
    UnitRangeError, UnknownNameError : see `check_sweep`; before anything is solved.
    MeshError : the mesh is too far from the pattern's symmetry to rely on it.
    ProcessEndedError : a process that solved samples was killed or crashed.
    """
    native = native_model(model)
    check_sweep(pattern, directions, curvatures, sides)
    kappa = tuple(curvatures)
    sources = find_sources(pattern, directions, symmetry)
    solved = dict.fromkeys(source.direction for source in sources)
    lines = [Line(side, direction, kappa) for side in sides for direction in solved]
    check = check_line(sides, directions, sources, next((k for k in kappa if k > 0.0), 0.0))
    if check is not None:
        lines.append(check)
    problem = build_problem(pattern, native)
    # Each process holds a cell of its own, and a solid one takes gigabytes.
    most = 1 if native.name == "solid" else os.cpu_count() or 1
    tangent = solve_tangent(problem)  # this compiles and caches kernels before processes start
    found = run_in_processes(
        problem, lines, native.solver, checkpoint, telling(on_sample), workers=workers or most
    )
    samples = {(line.side, line.direction): ended for line, ended in found.items()}
    options = native.to_config() | problem.facts | {"symmetry": symmetry}
    axes = (sides, directions, kappa)
    dataset = build_dataset_of(
        pattern, pattern_scalars(pattern, native), options, samples, axes, sources
    )
    note_errors(dataset, pattern, native, problem, tangent)
    if check is not None:
        error = symmetry_error(check, directions, sources, samples)
        dataset["symmetry_source"].attrs["comment"] = (
            f"checked in direction {check.direction:g} degree at {check.curvatures[0]:g} mm-1: "
            f"relative difference in energy {error:.1e}"
        )
    return dataset


def telling(on_sample: Callable[[SampleEvent], None] | None) -> Teller[Line] | None:
    """What tells a caller of samples."""
    if on_sample is None:
        return None

    def tell(line: Line, sample: Sample, counts: Counts) -> None:
        done, total, failed, seconds = counts
        curvature, status = sample["curvature"], SolveStatus(sample["status"])
        on_sample(
            SampleEvent(done, total, failed, line.side, line.direction, curvature, status, seconds)
        )

    return tell


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
    UnitRangeError : a direction outside [0, 180) degree or given twice, a curvature that is
        negative or out of order, or a curvature at which the cylinder folds through the scales.
    """
    check_directions(directions)
    require_bends(curvatures)
    if "closing" in sides:
        check_folds(pattern, curvatures[-1])


def check_directions(directions: Sequence[float]) -> None:
    """Refuse directions [degree] outside [0, 180), and one that is given twice.

    Raises
    ------
    UnitRangeError : there is one.
    """
    for direction in directions:
        if not 0.0 <= direction < 180.0:
            raise UnitRangeError(
                f"The direction {direction:g} degree is outside [0, 180): bending is the same "
                "after half a turn."
            )
    if len(set(directions)) != len(directions):
        raise UnitRangeError("directions must be distinct: give each once.")


def check_folds(pattern: Pattern, curvature: float) -> None:
    """Refuse a closing curvature [mm-1] at which the sheet folds through its scales.

    Raises
    ------
    UnitRangeError : it does.
    """
    if curvature * pattern.scale_height >= 1.0:
        raise UnitRangeError(
            f"At a closing curvature of {curvature:g} mm-1 the bending center lies inside the "
            f"scales, which are {pattern.scale_height:g} mm high: stay below "
            f"{1.0 / pattern.scale_height:g} mm-1."
        )
