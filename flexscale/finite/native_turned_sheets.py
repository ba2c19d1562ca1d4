"""Native sheets with the pattern turned on them, as a dataset (Fig. 14)."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from flexscale.datasets.kinds.native_turned_sheet import NATIVE_TURNED_SHEET
from flexscale.datasets.kinds.sweep import NO_CONTACT_COMMENT
from flexscale.datasets.sheet_variables import TURNED, build_turned_dataset
from flexscale.finite.native_sheet_dataset import simulate_native_sheet
from flexscale.homogenize.checkpoint import Checkpoint
from flexscale.homogenize.labels import pattern_scalars
from flexscale.homogenize.native_model import NativeModel
from flexscale.homogenize.sweep import SampleEvent
from flexscale.patterns.pattern import Pattern

if TYPE_CHECKING:
    import xarray as xr

OnSample = Callable[[SampleEvent], None]


def turn_native_sheets(
    pattern: Pattern,
    size: tuple[float, float],
    curvature: float,
    directions: Sequence[float],
    sides: Sequence[str],
    native: NativeModel,
    *,
    checkpoint: Checkpoint | None = None,
    on_sample: OnSample | None = None,
) -> xr.Dataset:
    """Bend one sheet of scales a direction between end strips; see `simulate_native_sheet`.

    Parameters
    ----------
    size : length and width, mm.
    curvature : mm-1, positive.
    directions : degree in [0, 180), increasing, of the lengths in the pattern's coordinates.
    sides : of "closing", "opening".
    native : the native model, of joints.

    Returns
    -------
    xarray.Dataset of kind native_turned_sheet; sheets that did not converge hold NaN and a status.

    Raises
    ------
    PatternError, ConfigError, BadInputError : as of `simulate_native_sheet`.
    """
    count = _Count(len(sides), len(directions), on_sample)
    sheets = [
        simulate_native_sheet(
            pattern,
            *size,
            curvatures=(curvature,),
            direction=direction,
            side=sides,
            model=native,
            checkpoint=checkpoint and _OfDirection(checkpoint, direction),
            on_sample=on_sample and count.teller(place, direction),
        ).isel(curvature=0)
        for place, direction in enumerate(directions)
    ]
    arrays = {
        variable.name: np.stack([sheet[variable.name].values for sheet in sheets], axis=-1)
        for variable in NATIVE_TURNED_SHEET.variables
        if variable.dims in (TURNED, ("direction",))
    }
    dataset = build_turned_dataset(
        NATIVE_TURNED_SHEET,
        sides,
        directions,
        arrays,
        curvature=curvature,
        length=size[0],
        width=size[1],
        scalars=pattern_scalars(pattern, native),
        config={"pattern": pattern.to_config(), **native.to_config()},
    )
    if not native.contact.enabled:
        dataset["min_gap"].attrs["comment"] = NO_CONTACT_COMMENT
    return dataset


class _Count:
    """Counts samples over all sheets, each of which counts its own."""

    def __init__(self, n_sides: int, n_sheets: int, on_sample: OnSample | None) -> None:
        self.n_sides, self.n_sheets, self.on_sample = n_sides, n_sheets, on_sample
        self.failed, self.start = 0, time.perf_counter()

    def teller(self, place: int, direction: float) -> OnSample:
        """What the sheet at a place tells, told as one of all."""
        failed = self.failed

        def tell(event: SampleEvent) -> None:
            self.failed = failed + event.n_failed
            assert self.on_sample is not None
            self.on_sample(
                dataclasses.replace(
                    event,
                    done=place * self.n_sides + event.done,
                    total=self.n_sheets * self.n_sides,
                    n_failed=self.failed,
                    direction=direction,
                    seconds=time.perf_counter() - self.start,
                )
            )

        return tell


class _OfDirection:
    """A checkpoint's lines of one of several sheets."""

    def __init__(self, checkpoint: Checkpoint, direction: float) -> None:
        self.checkpoint, self.name = checkpoint, f"sheet-{direction!r}"

    def load(
        self, line_key: str, fits: Callable[[int, dict[str, Any]], bool]
    ) -> list[dict[str, Any]]:
        """As of `Checkpoint`."""
        return self.checkpoint.load(f"{self.name}-{line_key}", fits)

    def append(self, line_key: str, sample: Mapping[str, Any]) -> None:
        """As of `Checkpoint`."""
        self.checkpoint.append(f"{self.name}-{line_key}", sample)
