"""Scales on joints on the testing devices, as datasets: disc on the mandrel, strip on stage."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from flexscale import checks
from flexscale.arrays import FloatArray
from flexscale.checks import ANGLE, checked, function, length, series
from flexscale.datasets.device_variables import build_rig_dataset
from flexscale.datasets.kinds.native_rig import NATIVE_RIG
from flexscale.datasets.kinds.sweep import NO_CONTACT_COMMENT
from flexscale.errors import UnitRangeError
from flexscale.finite.driven_sheet import KEPT, DrivenSheet, follow_loads
from flexscale.finite.native_disc import NativeDisc
from flexscale.finite.native_stage import NativeStage
from flexscale.finite.sheet_scales import require_moderate_scales
from flexscale.homogenize.checkpoint import Checkpoint, load_finished
from flexscale.homogenize.labels import pattern_scalars
from flexscale.homogenize.native_model import NativeModel, native_model, require_joints
from flexscale.mechanics.load_series import (
    RIM_ANGLES,
    SHORTENINGS,
    finite_series,
    require_shortenings,
)
from flexscale.patterns.pattern import Pattern
from flexscale.sides import SIDE_SIGNS, SOME_SIDES
from flexscale.status import SolveStatus

if TYPE_CHECKING:
    import xarray as xr

HUB = 10.0  # mm; the paper gives none
_REAL = ("force", "energy", "min_gap")
_COUNTED = ("newton_iterations", "negative_eigenvalues", "contact_pairs", "outside_range")
_UNITS = {"mandrel": "degree", "stage": "mm"}

Samples = list[dict[str, Any]]


@dataclass(frozen=True)
class LoadEvent:
    """Progress: a sample is finished.

    Attributes
    ----------
    done, total, n_failed : samples finished, in all, and not converged so far.
    side, status : of the sample.
    device, place, unit : where it is: around the rim of the mandrel's disc, or a shortening on the
        stage.
    seconds : since the first sample began.
    """

    done: int
    total: int
    n_failed: int
    side: str
    device: str
    place: float
    unit: str
    status: SolveStatus
    seconds: float


class Progress:
    """Counts samples and tells whoever asked."""

    def __init__(self, total: int, on_sample: Callable[[LoadEvent], None] | None) -> None:
        self.total, self.on_sample = total, on_sample
        self.done, self.failed, self.start = 0, 0, time.perf_counter()

    def tell(self, side: str, device: str, place: float, sample: Mapping[str, Any]) -> None:
        """One more sample is finished."""
        status = SolveStatus(sample["status"])
        self.done, self.failed = self.done + 1, self.failed + (status != SolveStatus.converged)
        if self.on_sample:
            seconds = time.perf_counter() - self.start
            counts = (self.done, self.total, self.failed)
            unit = _UNITS[device]
            self.on_sample(LoadEvent(*counts, side, device, place, unit, status, seconds))


@checked(
    pattern=checks.PATTERN,
    length=length("strip length"),
    width=length("strip width"),
    shortenings=series("mm", "shortening"),
    direction=ANGLE,
    sides=SOME_SIDES,
    offset=checks.place,
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
    offset: Sequence[float] = (0.0, 0.0),
    model: NativeModel | str = "joints",
    checkpoint: Checkpoint | None = None,
    on_sample: Callable[[LoadEvent], None] | None = None,
) -> xr.Dataset:
    """Bring the two hinges of a strip of scales on joints closer (Figs. 10, 11).

    `simulate_stage` does the same with a macro model. No friction, no weight. See `NativeStage`.

    Parameters
    ----------
    pattern : the scale pattern.
    length, width : mm; the hinges are at both ends of the length.
    shortenings : mm, increasing from above 0; one number is a series of one.
    direction : degree, of the strip's length in the pattern's coordinates.
    sides : "closing", "opening", or both: to which the strip is bent at the first shortening.
    offset : (2,) mm, point of the pattern that lies in the middle of the strip.
    model : the native model, of joints, or its name with its default options.
    checkpoint : keeps samples as they finish, and gives back those of an interrupted run.
    on_sample : called as samples finish.

    Returns
    -------
    xarray.Dataset of kind native_rig; samples that did not converge hold NaN and a `stage_status`.

    Raises
    ------
    PatternError : the strip cannot be cut from the pattern, or joints cannot be computed.
    ConfigError : another native model.
    BadInputError : shortenings that do not increase or reach the length, a size or direction out of
        range, an unknown side, or more scales than memory holds.
    """
    native = native_model(model)
    progress = Progress(len(sides) * len(finite_series(shortenings, "shortening", "mm")), on_sample)
    sizes: dict[str, Any] = {"length": length, "width": width, "direction": direction}
    sizes["offset"] = offset
    found = stage_arrays(pattern, shortenings, sides, native, checkpoint, progress, **sizes)
    return rig_dataset(pattern, native, sides, {"stage": found})


@checked(
    pattern=checks.PATTERN,
    radius=length("disc radius"),
    hub=length("hub radius"),
    indentation=length(),
    angles=series("degree", "mandrel angle"),
    sides=SOME_SIDES,
    model=native_model,
    checkpoint=checks.CHECKPOINT,
    on_sample=function,
)
def simulate_native_mandrel(
    pattern: Pattern,
    *,
    radius: float = 100.0,
    hub: float = HUB,
    indentation: float = 15.0,
    angles: Sequence[float] = RIM_ANGLES,
    sides: Sequence[str] = ("closing", "opening"),
    model: NativeModel | str = "joints",
    checkpoint: Checkpoint | None = None,
    on_sample: Callable[[LoadEvent], None] | None = None,
) -> xr.Dataset:
    """Push the rim of a disc of scales on joints, clamped at its hub (Figs. 6, 9).

    `simulate_mandrel` does the same with a macro model. No friction, no weight. See `NativeDisc`.

    Parameters
    ----------
    pattern : the scale pattern; a center of its symmetry lies in the middle of the disc.
    radius, hub : mm.
    indentation : mm, by which a point of the rim is pushed normal to the disc.
    angles : degree in [0, 360), increasing, in the pattern's coordinates. Of angles that a turn of
        the pattern about its center takes to one another, one is solved.
    sides : "closing" pushes towards the scales, "opening" away from them.
    model : the native model, of joints, or its name with its default options.
    checkpoint : keeps samples as they finish, and gives back those of an interrupted run.
    on_sample : called as samples finish.

    Returns
    -------
    xarray.Dataset of kind native_rig; where no equilibrium was found it holds NaN and a
    `mandrel_status`.

    Raises
    ------
    PatternError : the disc cannot be cut from the pattern, or joints cannot be computed.
    ConfigError : another native model.
    BadInputError : the hub is too large, or more scales than memory holds.
    UnitRangeError : a size, indentation or angle out of range.
    """
    native = native_model(model)
    progress = Progress(len(sides) * len(finite_series(angles, "angle", "degree")), on_sample)
    found = mandrel_arrays(
        pattern, angles, sides, native, checkpoint, progress,
        radius=radius, hub=hub, indentation=indentation,
    )  # fmt: skip
    return rig_dataset(pattern, native, sides, {"mandrel": found})


#: Variables of a device, and what else they depend on.
Found = tuple[dict[str, Any], dict[str, Any]]


def stage_arrays(
    pattern: Pattern,
    shortenings: Sequence[float],
    sides: Sequence[str],
    native: NativeModel,
    checkpoint: Checkpoint | None,
    progress: Progress,
    *,
    length: float,
    width: float,
    direction: float,
    offset: Sequence[float] = (0.0, 0.0),
) -> Found:
    """Variables of the stage, and what else they depend on."""
    require_joints(native)
    asked = require_shortenings(shortenings, length).tolist()
    require_moderate_scales(pattern, length * width)
    stage = NativeStage(pattern, length, width, direction, offset, native)
    samples: dict[str, Samples] = {side: [] for side in sides}
    for side in sides:
        sign = SIDE_SIGNS[side]
        key = f"stage-{side}"
        kept = _finished(checkpoint, key, asked, stage)
        start = None if kept else stage.clear_arc(asked[0], sign)
        for sample in _run(stage, key, asked, native, checkpoint, kept, start):
            if "state" in sample:
                sample["deflection"] = -sign * stage.deflection(sample["state"])
            samples[side].append(sample)
            progress.tell(side, "stage", sample["load"], sample)
    arrays = _table(list(samples.values()), (*_REAL, "deflection"))
    sizes = {"length": length, "width": width, "direction": direction}
    facts = {"offset": [float(value) for value in offset], **stage.facts}
    return {"shortening": asked, **sizes, **arrays, **_numbers(stage)}, facts


def mandrel_arrays(
    pattern: Pattern,
    angles: Sequence[float],
    sides: Sequence[str],
    native: NativeModel,
    checkpoint: Checkpoint | None,
    progress: Progress,
    *,
    radius: float,
    hub: float,
    indentation: float,
) -> Found:
    """Variables of the mandrel, and what else they depend on."""
    require_joints(native)
    asked = finite_series(angles, "mandrel angle", "degree")
    if asked[0] < 0.0 or asked[-1] >= 360.0 or (np.diff(asked) <= 0.0).any():
        raise UnitRangeError("Angles around the rim increase from 0 to below 360 degree.")
    disc = NativeDisc(pattern, radius, hub, native)
    period = 360.0 / disc.rotation_order
    solved, place = np.unique(np.round(asked % period, 6) % period, return_inverse=True)
    rows: list[Samples] = []
    for side in sides:
        found = []
        for angle in solved.tolist():
            disc.probe(angle, SIDE_SIGNS[side])
            key = f"mandrel-{side}-{angle!r}"
            kept = _finished(checkpoint, key, [indentation], disc)
            found += list(_run(disc, key, [indentation], native, checkpoint, kept))
            for at in asked[np.flatnonzero(place == len(found) - 1)]:
                progress.tell(side, "mandrel", float(at), found[-1])
        rows.append([found[k] for k in place])
    sizes = {"radius": radius, "hub": hub, "indentation": indentation}
    arrays = {**sizes, **_table(rows, _REAL), **_numbers(disc)}
    return {"angle": asked, **arrays}, disc.facts


def _finished(
    checkpoint: Checkpoint | None, key: str, loads: Sequence[float], sheet: DrivenSheet
) -> Samples:
    axis, needed = ("load", loads), {*KEPT[4:], "min_gap", "barrier_stiffness"}
    if sheet.contact is None:
        needed = set(KEPT[4:])
    return load_finished(checkpoint, key, axis, sheet.embedding.n_unknowns, needed)


def _run(
    sheet: DrivenSheet,
    key: str,
    loads: Sequence[float],
    native: NativeModel,
    checkpoint: Checkpoint | None,
    kept: Samples,
    start: FloatArray | None = None,
) -> Iterator[dict[str, Any]]:
    """Samples at loads, those kept before first."""
    yield from kept
    for sample in follow_loads(sheet, loads, native.solver, kept, start):
        if checkpoint is not None:
            checkpoint.append(key, sample)
        yield sample


def _table(rows: Sequence[Samples], real: Sequence[str]) -> dict[str, Any]:
    """(n_sides, n) of each variable."""

    def entries(name: str, missing: float) -> np.ndarray:
        return np.array([[sample.get(name, missing) for sample in row] for row in rows])

    arrays: dict[str, Any] = {name: entries(name, np.nan) for name in real}
    arrays |= {name: entries(name, 0).astype(np.int32) for name in _COUNTED}
    return arrays | {"status": entries("status", 0).astype(np.int8)}


def _numbers(sheet: DrivenSheet) -> dict[str, int]:
    return {"n_scales": len(sheet.sheet.laid.tiles), "n_unknowns": len(sheet.active)}


def rig_dataset(
    pattern: Pattern, native: NativeModel, sides: Sequence[str], devices: Mapping[str, Found]
) -> xr.Dataset:
    """Dataset of kind native_rig, of what was found on one device or both."""
    facts: dict[str, Any] = {}
    for _, found in devices.values():
        facts |= found
    dataset = build_rig_dataset(
        NATIVE_RIG,
        sides,
        {device: arrays for device, (arrays, _) in devices.items()},
        scalars=pattern_scalars(pattern, native),
        config={"pattern": pattern.to_config(), **native.to_config(), **facts},
    )
    if not native.contact.enabled:
        for device in devices:
            dataset[f"{device}_min_gap"].attrs["comment"] = NO_CONTACT_COMMENT
    return dataset
