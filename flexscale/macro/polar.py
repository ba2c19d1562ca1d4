"""Parameters in every direction: per-direction laws, and harmonics through them [Eq. 11]."""

from __future__ import annotations

import logging
from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.datasets.fit_values import onset_curvature
from flexscale.datasets.variables import Weighting
from flexscale.errors import BadInputError
from flexscale.macro.flat_response import FlatResponse
from flexscale.macro.harmonics import FLOOR_SHARE, Harmonics, fit_harmonics
from flexscale.macro.samples import ORDER_A, ORDER_B, ORDER_KAPPA_0, Samples, well_spread
from flexscale.macro.uniaxial import UniaxialLaw, fit_uniaxial

log = logging.getLogger(__name__)

#: Energies of a curvature tensor, by name; see `tensor_law`.

#: Samples beyond the onset that b needs: with one, b and κ0 trade off against each other.
LEAST_BEYOND = 2
#: Where contact is missing in part of the circle, a few directions must determine all harmonics:
#: weight of a pull toward no contact there, and of damping of the higher harmonics of b.
_PULL = 0.1
_SMOOTHING = 0.03


@dataclass(frozen=True)
class DirectionalLaws:
    """Laws in the sampled directions: (s) sides, (d) directions.

    Attributes
    ----------
    directions : (d,) degree.
    a : (d,) N mm, shared by the sides; nan where a direction has too few samples.
    b, kappa_0 : (s, d) N mm, mm-1; nan without contact.
    n_before, n_beyond : (s, d) number of samples up to and beyond the onset, or all and 0.
    softening : mm N-1, of all directions.
    """

    directions: FloatArray
    a: FloatArray
    b: FloatArray
    kappa_0: FloatArray
    n_before: np.ndarray
    n_beyond: np.ndarray
    softening: float = 0.0

    @property
    def sampled(self) -> np.ndarray:
        """(s, d) bool, whether there are samples."""
        return np.asarray(self.n_before + self.n_beyond > 0)

    def law(self, side: int) -> UniaxialLaw:
        """Laws of a side (by index) in all sampled directions, (d,) each."""
        a = np.where(self.sampled[side], self.a, np.nan)
        return UniaxialLaw(a, self.b[side], self.kappa_0[side], self.softening)


@dataclass(frozen=True)
class PolarLaw:
    """Harmonics of a, and per side of b and of κ0 or its inverse.

    Attributes
    ----------
    sides : names.
    a : N mm.
    b : one per side, N mm; all 0 without contact.
    onset : one per side, of what `onset_quantity` says: "kappa_0" [mm-1], as in the paper, where
        contact occurs in every direction; "1/kappa_0" [mm] where it is missing in part of the
        circle (0 or less means no contact); "none" where there is no contact at all.
    largest_curvature : mm-1, of the samples; contact beyond it was not seen.
    softening : mm N-1, of all directions, see `two_regime_moment`.
    """

    sides: tuple[str, ...]
    a: Harmonics
    b: tuple[Harmonics, ...]
    onset: tuple[Harmonics, ...]
    onset_quantity: tuple[str, ...]
    largest_curvature: float
    softening: float = 0.0

    def law(self, directions: FloatArray, side: int, *, within: bool = True) -> UniaxialLaw:
        """Laws of a side (by index) in any directions (degree).

        `within`: contact beyond the sampled curvatures counts as none. Without it the law goes on
        as the harmonics do, which keeps energies continuous in the direction at any curvature.
        """
        largest = self.largest_curvature if within else np.inf
        kappa_0 = onset_curvature(self.onset_quantity[side], self.onset[side](directions), largest)
        b = np.where(np.isnan(kappa_0), np.nan, self.b[side](directions))
        return UniaxialLaw(self.a(directions), b, kappa_0, self.softening)


def fit_directions(
    samples: Samples,
    weighting: Weighting,
    flat: FlatResponse | None = None,
    contact: np.ndarray | None = None,
) -> DirectionalLaws:
    """Law of every direction with enough samples.

    `flat`: response without contact, where known already. `contact` (s, d) bool: which lines meet
    contact, where known already; else decided here.
    """
    shape = (len(samples.sides), len(samples.directions))
    a, b, kappa_0 = np.full(shape[1], np.nan), np.full(shape, np.nan), np.full(shape, np.nan)
    n_before, n_beyond = np.zeros(shape, dtype=np.int32), np.zeros(shape, dtype=np.int32)
    for d in range(shape[1]):
        lines = samples.lines(d)
        known = None
        if contact is not None:
            known = [side for side, yes in zip(samples.sides, contact[:, d], strict=True) if yes]
        before = None if flat is None else flat.law(samples.directions[d])
        laws = fit_uniaxial(lines, weighting, known, before) if lines else {}
        for side, law in laws.items():
            s = samples.sides.index(side)
            a[d], b[s, d], kappa_0[s, d] = law.a, law.b, law.kappa_0
            beyond = lines[side].curvature > law.kappa_0
            n_beyond[s, d] = np.count_nonzero(beyond)
            n_before[s, d] = np.count_nonzero(~beyond)
    softening = 0.0 if flat is None else flat.softening
    return DirectionalLaws(samples.directions, a, b, kappa_0, n_before, n_beyond, softening)


def require_visible_onset(laws: DirectionalLaws, samples: Samples) -> None:
    """Refuse a sweep whose samples do not bracket the onset.

    Where one side does and the other has only begun to touch, the log says so: the model then has
    no contact on that side.

    Raises
    ------
    BadInputError : with the numbers.
    """
    for s, side in enumerate(samples.sides):
        late = np.flatnonzero(laws.sampled[s] & (laws.n_before[s] == 0))
        if late.size:
            d = int(late[0])
            first = samples.curvatures[samples.used[s, d]][0]
            raise BadInputError(
                f"The sweep is too coarse to see the onset of contact: {side} at "
                f"{laws.directions[d]:g} degree, scales already touch at its first curvature "
                f"besides 0, {first:g} mm-1 (onset near {laws.kappa_0[s, d]:.3g} mm-1): add "
                "curvatures before it."
            )
    seen = [bool(np.isfinite(onsets).any()) for onsets in laws.kappa_0]
    resolved = [bool((beyond >= LEAST_BEYOND).any()) for beyond in laws.n_beyond]
    for s in range(len(samples.sides)):
        if not seen[s] or resolved[s]:
            continue
        last = samples.curvatures[-2:]
        problem = (
            f"The sweep is too coarse to see the onset of contact: {samples.sides[s]}, in no "
            f"direction are there {LEAST_BEYOND} samples beyond it (the last curvatures are "
            f"{last[0]:g} and {last[1]:g} mm-1, the onset is near "
            f"{np.nanmin(laws.kappa_0[s]):.3g} mm-1): add curvatures between or beyond."
        )
        if not any(resolved):
            raise BadInputError(problem)
        log.warning("%s The model has no contact on this side.", problem)


def fit_polar(
    laws: DirectionalLaws,
    samples: Samples,
    weighting: Weighting,
    flat: FlatResponse | None = None,
    chosen: np.ndarray | None = None,
) -> PolarLaw | None:
    """Harmonics through the laws of the chosen directions, (d,) bool; all if not given.

    `flat`: response without contact, where known already; else harmonics are fitted to a. None
    where these directions do not determine the harmonics. Residuals are relative to the values with
    relative weighting: along a strip of hinges a sheet may be a hundred times softer than across,
    and these soft directions are those it bends in.
    """
    chosen = np.ones(len(laws.directions), dtype=bool) if chosen is None else chosen
    known = chosen & np.isfinite(laws.a)
    if not well_spread(laws.directions[known], ORDER_B):
        return None
    if flat is None:
        a = _positive(laws.directions[known], laws.a[known], ORDER_A, weighting)
    else:
        a = flat.stiffness
    largest = float(samples.curvatures[-1])
    fitted = [_fit_contact(laws, s, known, largest, weighting) for s in range(len(samples.sides))]
    b, onset, quantity = zip(*fitted, strict=True)
    return PolarLaw(samples.sides, a, b, onset, quantity, largest, laws.softening)


def _fit_contact(
    laws: DirectionalLaws, side: int, known: np.ndarray, largest: float, weighting: Weighting
) -> tuple[Harmonics, Harmonics, str]:
    """Harmonics of b and of the onset of one side, and what quantity the latter are of."""
    with_contact = known & np.isfinite(laws.kappa_0[side])
    resolved = with_contact & (laws.n_beyond[side] >= LEAST_BEYOND)
    if not resolved.any():
        return _zero(ORDER_B), _zero(ORDER_KAPPA_0), "none"
    everywhere = bool(resolved.sum() == known.sum())
    b = _positive(
        laws.directions[resolved],
        laws.b[side][resolved],
        ORDER_B,
        weighting,
        smoothing=0.0 if everywhere else _SMOOTHING,
    )
    free = known & laws.sampled[side] & ~with_contact
    at, kappa_0 = laws.directions[with_contact], laws.kappa_0[side][with_contact]
    if not free.any() and well_spread(at, ORDER_KAPPA_0):
        return b, _positive(at, kappa_0, ORDER_KAPPA_0, weighting), "kappa_0"
    onset = _inverse_onset(at, kappa_0, laws.directions[free], largest, weighting)
    return b, onset, "1/kappa_0"


def _zero(order: int) -> Harmonics:
    return Harmonics(np.zeros(order + 1), np.zeros(order + 1))


def _positive(
    directions: FloatArray,
    values: FloatArray,
    order: int,
    weighting: Weighting,
    *,
    smoothing: float = 0.0,
) -> Harmonics:
    return fit_harmonics(
        directions,
        values,
        order,
        weights=1.0 / values if weighting == "relative" else None,
        floor=FLOOR_SHARE * float(values.min()),
        smoothing=smoothing,
    )


def _inverse_onset(
    directions: FloatArray,
    kappa_0: FloatArray,
    free: FloatArray,
    largest: float,
    weighting: Weighting,
) -> Harmonics:
    """Harmonics of 1/κ0 where contact is missing in some directions.

    What is known in the free directions is an inequality: no contact up to the largest curvature,
    1/κ0 <= 1/largest. Setting 1/κ0 = 0 there would make it jump; so it is a weak pull only.
    """
    values = np.concatenate([1.0 / kappa_0, np.zeros(len(free))])
    weights = np.full(len(kappa_0), largest)
    if weighting == "relative":
        weights = kappa_0
    return fit_harmonics(
        np.concatenate([directions, free]),
        values,
        ORDER_KAPPA_0,
        weights=np.concatenate([weights, np.full(len(free), _PULL * largest)]),
        ceilings=(free, np.full(len(free), 1.0 / largest)),
        smoothing=1e-6,
    )
