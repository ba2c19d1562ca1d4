"""Samples of a sweep as the fit needs them, and clear refusals where a sweep says too little."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.datasets.given import require_variables
from flexscale.errors import BadInputError
from flexscale.macro.harmonics import harmonic_matrix
from flexscale.macro.uniaxial import Line
from flexscale.sides import SIDES
from flexscale.status import SolveStatus

if TYPE_CHECKING:
    import xarray as xr

ORDER_A, ORDER_B, ORDER_KAPPA_0 = 2, 3, 3  # the paper's n
#: Curvatures besides 0: one before the onset and two beyond, for a, b and κ0.
LEAST_CURVATURES = 3
LEAST_DIRECTIONS = 2 * max(ORDER_B, ORDER_KAPPA_0) + 1
#: Evenly spread directions have condition √2; beyond this some harmonic is a guess.
_MOST_CONDITION = 20.0
_NEEDED = ("energy_density", "moment", "side", "direction", "curvature")


@dataclass(frozen=True)
class Samples:
    """Numbers of a sweep, (s) sides by (d) directions by (c) curvatures without curvature 0.

    Attributes
    ----------
    sides : names, "closing" first.
    directions, curvatures : (d,) degree; (c,) mm-1, positive and increasing.
    energy, moment : (s, d, c) N mm-1; N.
    used : (s, d, c) bool, samples that count: converged, in a line with enough of them.
    touches : (s, d, c) bool, whether scales touch; None where contact was not measured.
    sources : (d,) degree, the direction that was computed; others are copies by symmetry.
    n_ignored : number of samples ignored since they did not converge.
    """

    sides: tuple[str, ...]
    directions: FloatArray
    curvatures: FloatArray
    energy: FloatArray
    moment: FloatArray
    used: np.ndarray
    touches: np.ndarray | None
    sources: FloatArray
    n_ignored: int

    def lines(self, direction: int) -> dict[str, Line]:
        """Usable lines by side of the direction with this index."""
        lines = {}
        for index, side in enumerate(self.sides):
            used = self.used[index, direction]
            if used.any():
                curvature = self.curvatures[used]
                touches = None if self.touches is None else self.touches[index, direction][used]
                lines[side] = Line(
                    curvature,
                    self.energy[index, direction][used],
                    self.moment[index, direction][used],
                    None if touches is None else _free_until(curvature, touches),
                )
        return lines

    def without_curvature(self, index: int) -> Samples:
        """All but the samples at one curvature; lines left with too few are out as well."""
        used = self.used.copy()
        used[..., index] = False
        return replace(self, used=_enough(used))


def read_samples(sweep: xr.Dataset) -> Samples:
    """Samples of a dataset of kind sweep/1.

    Raises
    ------
    SchemaError : not a sweep.
    BadInputError : too few curvatures or directions, or directions too unevenly spread.
    """
    require_variables(sweep, _NEEDED, "A fit to a sweep", "sweep")
    sides = tuple(side for side in SIDES if side in sweep["side"].values)
    ordered = sweep.sel(side=list(sides)).sortby(["direction", "curvature"])
    ordered = ordered.transpose("side", "direction", "curvature", ...)
    curved = ordered.isel(curvature=ordered["curvature"].values > 0.0)
    curvatures = np.asarray(curved["curvature"].values, dtype=float)
    directions = np.asarray(curved["direction"].values, dtype=float)
    require_axes(directions, curvatures)
    energy, moment = (
        np.asarray(curved[name].values, dtype=float) for name in ("energy_density", "moment")
    )
    converged = np.isfinite(energy) & np.isfinite(moment)
    if "status" in curved:
        converged &= curved["status"].values == SolveStatus.converged
    used = _enough(converged)
    _require_directions(directions[used.any(axis=(0, 2))], directions.size)
    sources = directions
    if "symmetry_source" in curved:
        sources = np.asarray(curved["symmetry_source"].values[0], dtype=float)
    return Samples(
        sides,
        directions,
        curvatures,
        energy,
        moment,
        used,
        _touching(curved, converged),
        sources,
        int(np.count_nonzero(~converged)),
    )


def require_axes(directions: FloatArray, curvatures: FloatArray) -> None:
    """Refuse directions (degree) and curvatures (mm-1) that cannot determine a fit.

    Raises
    ------
    BadInputError : with the numbers.
    """
    _require_curvatures(curvatures[curvatures > 0.0])
    _require_directions(directions, len(directions))


def well_spread(directions: FloatArray, order: int) -> bool:
    """Whether harmonics of this order are determined by values in these directions."""
    if len(directions) < 2 * order + 1:
        return False
    return bool(np.linalg.cond(harmonic_matrix(directions, order)) < _MOST_CONDITION)


def _enough(used: np.ndarray) -> np.ndarray:
    return np.asarray(used & (used.sum(axis=-1, keepdims=True) >= LEAST_CURVATURES))


def _free_until(curvature: FloatArray, touches: np.ndarray) -> float:
    """Last curvature before scales touch first, 0 if they do at once; inf if they never do."""
    if not touches.any():
        return np.inf
    first = int(np.argmax(touches))
    return float(curvature[first - 1]) if first else 0.0


def _touching(sweep: xr.Dataset, converged: np.ndarray) -> np.ndarray | None:
    """(s, d, c) whether contact pairs are active; None when no sample has any, or none counted.

    Pairs nowhere in a sweep may mean that contact was not modeled: then the curves decide.
    """
    if "contact_pairs" not in sweep:
        return None
    touching = (sweep["contact_pairs"].values > 0) & converged
    return np.asarray(touching) if touching.any() else None


def _require_curvatures(curvatures: FloatArray) -> None:
    if len(curvatures) < LEAST_CURVATURES:
        listed = ", ".join(f"{value:g}" for value in curvatures) or "none"
        raise BadInputError(
            f"A fit needs at least {LEAST_CURVATURES} curvatures besides 0, one before contact and "
            f"two beyond, but the sweep has {len(curvatures)} ({listed} mm-1): add curvatures."
        )


def _require_directions(directions: FloatArray, n_sampled: int) -> None:
    if len(directions) < LEAST_DIRECTIONS:
        raise BadInputError(
            f"Harmonics of order {ORDER_B} have {LEAST_DIRECTIONS} numbers, but only "
            f"{len(directions)} of the sweep's {n_sampled} directions have {LEAST_CURVATURES} "
            f"converged samples besides curvature 0: sample at least {LEAST_DIRECTIONS} "
            "directions in [0, 180) degree."
        )
    if not well_spread(directions, ORDER_B):
        gaps = np.diff(directions, append=directions[0] + 180.0)
        widest = int(np.argmax(gaps))
        raise BadInputError(
            f"The sweep has no usable direction for {gaps[widest]:g} degree after "
            f"{directions[widest]:g} degree, too wide a gap for harmonics of order {ORDER_B}: "
            "spread the directions evenly over [0, 180) degree."
        )
