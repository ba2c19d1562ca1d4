"""Tensor sweeps: a pattern bent by curvature tensors, dome, cylinder and saddle, to both sides."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexscale import checks
from flexscale.checks import checked, choice, flag, function, series, whole
from flexscale.datasets.variables import CLOSING_DOME, IN_PLANE, OPENING_DOME
from flexscale.errors import UnitRangeError
from flexscale.homogenize.checkpoint import Checkpoint
from flexscale.homogenize.errors_at_rest import note_errors
from flexscale.homogenize.joint_cell import JointCell
from flexscale.homogenize.labels import pattern_scalars
from flexscale.homogenize.native_model import NativeModel, native_model, require_joints
from flexscale.homogenize.run_lines import Counts, Teller, run_in_processes
from flexscale.homogenize.sample import Sample
from flexscale.homogenize.sweep import check_directions, check_folds
from flexscale.homogenize.symmetry import Source, find_sources
from flexscale.homogenize.tangent import solve_tangent
from flexscale.homogenize.tensor_line import TensorLine
from flexscale.homogenize.tensor_sweep_dataset import Rays, build_dataset_of
from flexscale.mechanics.load_series import (
    RAY_CURVATURES,
    RAY_DIRECTIONS,
    RAY_SHAPES,
    require_bends,
)
from flexscale.patterns import Pattern
from flexscale.status import SolveStatus

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class TensorSampleEvent:
    """Progress: a sample is finished.

    Attributes
    ----------
    done, total, n_failed : samples finished, in all, and not converged so far.
    direction, shape, curvature, status : the sample; degree and mm-1.
    seconds : since the sweep began.
    """

    done: int
    total: int
    n_failed: int
    direction: float
    shape: float
    curvature: float
    status: SolveStatus
    seconds: float


@checked(
    pattern=checks.PATTERN,
    directions=series("degree"),
    shapes=series("degree"),
    curvatures=series("mm-1"),
    in_plane=choice("way to hold a sheet in its plane", IN_PLANE),
    model=native_model,
    symmetry=flag,
    workers=whole(1, 1024),
    checkpoint=checks.CHECKPOINT,
    on_sample=function,
)
def tensor_sweep(
    pattern: Pattern,
    directions: Sequence[float] = RAY_DIRECTIONS,
    shapes: Sequence[float] = RAY_SHAPES,
    curvatures: Sequence[float] = RAY_CURVATURES,
    *,
    in_plane: str = "free",
    model: NativeModel | str = "joints",
    symmetry: bool = True,
    workers: int | None = None,
    checkpoint: Checkpoint | None = None,
    on_sample: Callable[[TensorSampleEvent], None] | None = None,
) -> xr.Dataset:
    """Energy density and moments of curvature tensors, over direction, shape and curvature.

    The tensor is k = R(direction) diag(k1, k2) R(direction)ᵀ with k1 = curvature cos(shape) and
    k2 = curvature sin(shape), positive where the sheet closes. Every direction and shape is a ray
    that is followed from the flat sheet.

    Parameters
    ----------
    pattern : the scale pattern.
    directions : degree in [0, 180), of the larger principal curvature k1, from the x axis of the
        pattern's coordinates. One number is a series of one, here and in the next two.
    shapes : degree in [-135, 45]: -135 a dome that opens, -90 a cylinder that opens, -45 a saddle,
        0 a cylinder that closes, 45 a dome that closes. Domes, which have no direction, are solved
        once.
    curvatures : mm-1, non-negative and increasing: roots of k1² + k2².
    in_plane : "free", the lattice stretches without force, as in `sweep`; or "held", it keeps its
        rest lengths, and forces in the plane are told.
    model : the native model, "joints"; others cannot be bent two ways.
    symmetry : solve one of all directions that the pattern's symmetry makes equivalent.
    workers : processes, each with one thread; if not given as many as there are cores.
    checkpoint : keeps samples as they finish, and gives back those of an interrupted sweep.
    on_sample : called in this process as samples finish.

    Returns
    -------
    xarray.Dataset of kind tensor_sweep/1. Samples that did not converge hold NaN and a `status`.
    Moments [N] are derivatives of the energy density [N mm-1] by k_xx, k_yy and 2 k_xy.

    Raises
    ------
    ConfigError : another native model.
    UnitRangeError : see `check_tensor_sweep`; before anything is solved.
    ProcessEndedError : a process that solved samples was killed or crashed.
    """
    native = native_model(model)
    require_joints(native, "Tensor sweeps")
    check_tensor_sweep(pattern, directions, shapes, curvatures)
    sources = ray_sources(pattern, directions, shapes, symmetry)
    rays = Rays(tuple(directions), tuple(shapes), tuple(curvatures), sources)
    free = JointCell.from_pattern(pattern, native)
    problem = free if in_plane == "free" else JointCell(pattern, free.laws, native, stretches=False)
    tangent = solve_tangent(free)  # this compiles and caches kernels before processes start
    workers = workers or os.cpu_count() or 1
    samples = run_in_processes(
        problem, rays.lines, native.solver, checkpoint, _telling(on_sample), workers=workers
    )
    stiffness = tangent.matrix if in_plane == "free" else tangent.held
    assert stiffness is not None
    dataset = build_dataset_of(
        rays,
        samples,
        stiffness,
        in_plane=in_plane,
        scalars=pattern_scalars(pattern, native),
        config={
            "pattern": pattern.to_config(),
            **native.to_config(),
            **problem.facts,
            "symmetry": symmetry,
            "in_plane": in_plane,
        },
    )
    note_errors(dataset, pattern, native, problem, tangent)
    return dataset


def ray_sources(
    pattern: Pattern, directions: Sequence[float], shapes: Sequence[float], symmetric: bool
) -> tuple[tuple[Source, ...], ...]:
    """Where the numbers of each direction and shape come from; domes from the first direction."""
    every = find_sources(pattern, directions, symmetric)
    dome, domes = Source(float(directions[0]), np.eye(2)), (OPENING_DOME, CLOSING_DOME)
    return tuple(tuple(dome if shape in domes else source for shape in shapes) for source in every)


def check_tensor_sweep(
    pattern: Pattern,
    directions: Sequence[float],
    shapes: Sequence[float],
    curvatures: Sequence[float],
) -> None:
    """Refuse a tensor sweep that cannot be run, before anything is solved.

    Raises
    ------
    UnitRangeError : a direction outside [0, 180) degree or a shape outside [-135, 45], one given
        twice, a curvature that is negative or out of order, or one at which the sheet folds through
        the scales.
    """
    check_directions(directions)
    for shape in shapes:
        if not OPENING_DOME <= shape <= CLOSING_DOME:
            raise UnitRangeError(
                f"The shape {shape:g} degree is outside [-135, 45], where the first principal "
                "curvature is the larger one: turn the direction by 90 degree."
            )
    if len(set(shapes)) != len(shapes):
        raise UnitRangeError("shapes must be distinct: give each once.")
    require_bends(curvatures)
    check_folds(pattern, curvatures[-1] * max(np.cos(np.radians(shapes))))


def _telling(
    on_sample: Callable[[TensorSampleEvent], None] | None,
) -> Teller[TensorLine] | None:
    if on_sample is None:
        return None

    def tell(line: TensorLine, sample: Sample, counts: Counts) -> None:
        done, total, failed, seconds = counts
        curvature, status = sample["curvature"], SolveStatus(sample["status"])
        on_sample(
            TensorSampleEvent(
                done, total, failed, line.direction, line.shape, curvature, status, seconds
            )
        )

    return tell
