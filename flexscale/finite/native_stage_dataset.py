"""Strips of scales on the stage over side and shortening, as a dataset."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from flexscale import checks
from flexscale.checks import ANGLE, checked, function, length, series
from flexscale.datasets.device_variables import build_rig_dataset
from flexscale.datasets.kinds.native_rig import NATIVE_RIG
from flexscale.datasets.kinds.sweep import NO_CONTACT_COMMENT
from flexscale.finite.native_stage import NativeStage
from flexscale.finite.stage_line import follow_shortenings
from flexscale.homogenize.checkpoint import Checkpoint, load_finished
from flexscale.homogenize.labels import pattern_scalars
from flexscale.homogenize.native_model import NativeModel, native_model
from flexscale.mechanics.load_series import SHORTENINGS, require_shortenings
from flexscale.mesh.estimate import require_moderate_sheet
from flexscale.patterns import Pattern
from flexscale.patterns.clipped import clip_pattern
from flexscale.sides import SOME_SIDES
from flexscale.solve.solver_options import SolverOptions
from flexscale.status import SolveStatus

if TYPE_CHECKING:
    import xarray as xr

#: Variables of the stage that are entries of a sample, real and counted.
_REAL = ("force", "energy", "deflection", "min_gap")
_COUNTED = ("newton_iterations", "negative_eigenvalues", "contact_pairs")


@dataclass(frozen=True)
class ShorteningEvent:
    """Progress: a sample is finished.

    Attributes
    ----------
    done, total, n_failed : samples finished, in all, and not converged so far.
    side, direction, shortening, status : the sample; degree and mm.
    seconds : since the first side began.
    """

    done: int
    total: int
    n_failed: int
    side: str
    direction: float
    shortening: float
    status: SolveStatus
    seconds: float


@checked(
    pattern=checks.PATTERN,
    length=length("strip length"),
    width=length("strip width"),
    shortenings=series("mm", "shortening"),
    direction=ANGLE,
    sides=SOME_SIDES,
    model=native_model,
    checkpoint=checks.CHECKPOINT,
    on_sample=function,
)
def simulate_native_stage(
    pattern: Pattern,
    *,
    length: float = 100.0,
    width: float = 50.0,
    shortenings: Sequence[float] = SHORTENINGS,
    direction: float = 0.0,
    sides: Sequence[str] = ("closing", "opening"),
    model: NativeModel | str = "shell",
    checkpoint: Checkpoint | None = None,
    on_sample: Callable[[ShorteningEvent], None] | None = None,
) -> xr.Dataset:
    """Bring the two hinges of a strip of the native model closer (Figs. 10, 11).

    `simulate_stage` does the same with a macro model. Scales that an end cuts turn about its hinge
    as one; the strip's sides are free. See `NativeStage`.

    Parameters
    ----------
    pattern : the scale pattern.
    length, width : mm; the hinges are at both ends of the length.
    shortenings : mm, increasing from above 0; one number is a series of one.
    direction : degree, of the strip's length in the pattern's coordinates.
    sides : "closing", "opening", or both: to which the strip is bent at the first shortening.
    model : the native model, or the name of one with its default options.
    checkpoint : keeps samples as they finish, and gives back those of an interrupted run.
    on_sample : called as samples finish.

    Returns
    -------
    xarray.Dataset of kind native_rig; samples that did not converge hold NaN and a `stage_status`.

    Raises
    ------
    PatternError, MeshError : the strip cannot be cut from the pattern, or not be meshed.
    BadInputError : shortenings that do not increase or reach the length, a size or direction out of
        range, an unknown side, or options that only a periodic cell has.
    """
    native = native_model(model)
    asked = require_shortenings(shortenings, length).tolist()
    require_moderate_sheet(pattern, native.mesh, length, width)
    tiles = clip_pattern(pattern, length, width, direction, glued=False)
    stage = NativeStage(pattern, tiles, native)
    samples: dict[str, list[dict[str, Any]]] = {side: [] for side in sides}
    start, done, failed = time.perf_counter(), 0, 0
    for side in sides:
        for sample in _run_side(stage, asked, side, native.solver, checkpoint):
            samples[side].append(sample)
            status = SolveStatus(sample["status"])
            done, failed = done + 1, failed + (status != SolveStatus.converged)
            if on_sample:
                on_sample(
                    ShorteningEvent(
                        done, len(sides) * len(asked), failed, side, direction,
                        sample["shortening"], status, time.perf_counter() - start,
                    )
                )  # fmt: skip

    def table(name: str, missing: float) -> np.ndarray:
        return np.array([[s.get(name, missing) for s in row] for row in samples.values()])

    arrays: dict[str, Any] = {name: table(name, np.nan) for name in _REAL}
    arrays |= {name: table(name, 0).astype(np.int32) for name in _COUNTED}
    arrays["status"] = table("status", 0).astype(np.int8)
    sizes = {"length": length, "width": width, "direction": direction}
    dataset = build_rig_dataset(
        NATIVE_RIG,
        sides,
        {"stage": {"shortening": asked, **sizes, **arrays}},
        scalars=pattern_scalars(pattern, native),
        config={"pattern": pattern.to_config(), **native.to_config()},
        numbers={"n_scales": len(stage.tiles.copies), "n_unknowns": len(stage.active)},
    )
    if not native.contact.enabled:
        dataset["stage_min_gap"].attrs["comment"] = NO_CONTACT_COMMENT
    return dataset


def _run_side(
    stage: NativeStage,
    shortenings: Sequence[float],
    side: str,
    solver: SolverOptions,
    checkpoint: Checkpoint | None,
) -> Iterator[dict[str, Any]]:
    """Samples of one side, those kept before first."""
    key = f"stage-{side}"
    finished = load_finished(
        checkpoint, key, ("shortening", shortenings), stage.embedding.n_unknowns, _REAL[:2]
    )
    yield from finished
    for sample in follow_shortenings(stage, shortenings, side, solver, finished):
        if checkpoint is not None:
            checkpoint.append(key, sample)
        yield sample
