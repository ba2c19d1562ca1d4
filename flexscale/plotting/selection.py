"""Which samples of a labelled dataset a figure shows, and clear refusals when it cannot."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from flexscale.checks import choices
from flexscale.datasets.given import require_variables as require_variables
from flexscale.errors import BadInputError
from flexscale.plotting.style import unit_text
from flexscale.sides import SIDES
from flexscale.units import require_series


def pick_sides(dataset: xr.Dataset, sides: str | Sequence[str] | None) -> list[str]:
    """Sides to draw, in the order asked for; all that the dataset has when None.

    Raises
    ------
    UnknownNameError : a side the dataset does not have.
    """
    present = [str(side) for side in np.atleast_1d(dataset["side"].values)]
    if sides is None:
        return [side for side in SIDES if side in present]
    return list(choices("side", present)(sides, "sides"))


def pick_values(
    coordinate: xr.DataArray,
    wanted: float | Sequence[float] | None,
    *,
    n_default: int,
    skip_zero: bool = False,
) -> np.ndarray:
    """Indices of the samples nearest to the wanted values.

    Parameters
    ----------
    coordinate : (n,) increasing samples, for instance `sweep.curvature`.
    wanted : values in the coordinate's units, each within half a step of a sample; None takes at
        most `n_default` samples in even steps.
    n_default : number of samples when `wanted` is None.
    skip_zero : by default take no sample at 0 (at curvature 0 the moment is 0), and step down
        from the last sample instead of up from the first.

    Returns
    -------
    (k,) indices into the coordinate, k >= 1.

    Raises
    ------
    BadInputError : a wanted value lies between samples or outside of them.
    """
    samples = np.asarray(coordinate.values, dtype=float)
    if wanted is None:
        candidates = np.arange(len(samples))
        if skip_zero and np.any(samples != 0.0):
            candidates = np.flatnonzero(samples != 0.0)
        stride = -(-len(candidates) // n_default)
        return candidates[::-1][::stride][::-1] if skip_zero else candidates[::stride]
    half_step = 0.5 * np.min(np.diff(samples)) if len(samples) > 1 else 0.0
    tolerance = max(half_step, 1e-9) * (1.0 + 1e-9)
    indices = []
    units = str(coordinate.attrs.get("units", ""))
    for value in require_series(wanted, f"{coordinate.name} to draw", units):
        index = int(np.argmin(np.abs(samples - value)))
        if not abs(samples[index] - value) <= tolerance:
            raise BadInputError(_between_samples(coordinate, samples, value))
        if index not in indices:
            indices.append(index)
    return np.asarray(indices)


def unconverged(sweep: xr.Dataset) -> xr.DataArray:
    """True where a sample has no result (status not 0); all False without a status."""
    if "status" in sweep:
        return sweep["status"] != 0
    return xr.zeros_like(sweep["moment"], dtype=bool)


def subject(dataset: xr.Dataset) -> str:
    """What a dataset is about, as in ``IH20 hexagon``, from its scalar coordinates."""
    words = []
    for name in ("family", "pattern"):
        if name in dataset.variables and dataset[name].ndim == 0:
            word = str(dataset[name].item())
            if word and word not in words:
                words.append(word)
    return " ".join(words)


def _between_samples(coordinate: xr.DataArray, samples: np.ndarray, value: float) -> str:
    units = unit_text(str(coordinate.attrs.get("units", "")))
    listed = ", ".join(f"{sample:g}" for sample in samples[:12])
    if len(samples) > 12:
        listed += f", … {samples[-1]:g} ({len(samples)} in all)"
    return (
        f"The dataset has no sample at {coordinate.name} {value:g} {units}; choose among {listed}."
    )
