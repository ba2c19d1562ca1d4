"""The two-regime law of one bending direction, and its fit by variable projection [Eq. 10].

With c = b − a the law reads m = a κ + c (κ − κ0)₊ and E = ½ a κ² + ½ c (κ − κ0)₊². For given
κ0 both are linear in (a, c), so only κ0 is searched for; a is shared by the two sides, since both
meet at κ = 0. For each κ0 of a side, elimination of c leaves a quadratic in a, three numbers; those
of two sides add up, so that a search over all pairs of κ0 costs one broadcast sum.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexscale.arrays import FloatArray
from flexscale.datasets.fit_values import two_regime_energy, two_regime_moment
from flexscale.datasets.variables import Weighting

#: Without measured contact: least ratio b / a, and least gain in n ln(rss) beyond the two
#: variables' ln(n) each (six is strong evidence), for a kink to count as contact.
LEAST_STIFFENING = 1.1
LEAST_EVIDENCE = 6.0
#: Candidates for κ0 between two samples, and rounds of refinement (each divides by 10).
_PER_INTERVAL = 8
_ROUNDS = 7
#: Relative residuals below this are rounding: the sums of squares cancel to its square.
_ROUNDING = 1e-8
#: κ0 stays this share of an interval away from the last sample, or b would be unbounded.
_MARGIN = 0.05


@dataclass(frozen=True)
class UniaxialLaw:
    """Bending response in one direction, or, with arrays, in several.

    Attributes
    ----------
    a : N mm, stiffness before contact.
    b : N mm, stiffness after contact; nan without contact.
    kappa_0 : mm-1, contact curvature; nan means none: contact was not seen.
    softening : mm N-1, see `two_regime_moment`.
    """

    a: float | FloatArray
    b: float | FloatArray
    kappa_0: float | FloatArray
    softening: float = 0.0

    @property
    def has_contact(self) -> bool | np.ndarray:
        """Whether there is contact within the sampled curvatures."""
        present = ~np.isnan(self.kappa_0)
        return bool(present) if np.ndim(present) == 0 else np.asarray(present)

    def moment(self, curvature: ArrayLike) -> FloatArray:
        """Moment per width [N] at curvatures [mm-1], non-negative."""
        return two_regime_moment(curvature, self.a, self.b, self.kappa_0, self.softening)

    def energy(self, curvature: ArrayLike) -> FloatArray:
        """Energy per area [N mm-1] at curvatures [mm-1], non-negative."""
        return two_regime_energy(curvature, self.a, self.b, self.kappa_0, self.softening)


@dataclass(frozen=True)
class Line:
    """Converged samples of one side in one direction.

    Attributes
    ----------
    curvature, energy, moment : (n,) mm-1, N mm-1, N; curvatures positive and increasing.
    free_until : mm-1, scales do not touch up to here, inf if they never do; None where contact was
        not measured, so that the curve alone decides.
    """

    curvature: FloatArray
    energy: FloatArray
    moment: FloatArray
    free_until: float | None = None

    def weights(self, weighting: Weighting) -> FloatArray:
        """(2 n,) factors of the residuals of energy and moment.

        "relative" divides each by the sample's own value: over a sweep the energy grows by five
        orders of magnitude, and contact by three, so that absolute errors see the last samples
        only and leave a and κ0 to chance. "absolute" divides by the line's largest value.
        # PAPER: absolute error of the energy alone. WE: also the moment, in units of its largest.
        # WHY: both are known exactly, and the moment shows the onset where the energy barely does.
        """
        parts = []
        for values in (np.abs(self.energy), np.abs(self.moment)):
            largest = values.max()
            scale = np.maximum(values, 1e-12 * largest) if weighting == "relative" else largest
            parts.append(np.ones(len(values)) / (scale if largest > 0.0 else 1.0))
        return np.concatenate(parts)


@dataclass(frozen=True)
class _Fit:
    """Outcome of a search: shared a, per side the added stiffness c and κ0 (inf for none)."""

    a: float
    added: tuple[float, ...]
    onsets: tuple[float, ...]
    rss: float


class _WeightedLine:
    """A line's weighted data vector, with what elimination of c leaves for each κ0."""

    def __init__(self, line: Line, weighting: Weighting, known: UniaxialLaw | None) -> None:
        self.kappa = line.curvature
        self.free_until = line.free_until or 0.0
        self.weights = line.weights(weighting)
        self.data = np.concatenate([line.energy, line.moment]) * self.weights
        before = known or UniaxialLaw(
            1.0, np.nan, np.nan
        )  # the a-th part of what is before contact
        columns = [before.energy(self.kappa), before.moment(self.kappa)]
        self.a_column = np.concatenate(columns) / before.a * self.weights

    def c_columns(self, onsets: FloatArray) -> FloatArray:
        beyond = np.maximum(self.kappa - onsets[:, None], 0.0)
        return np.hstack([beyond**2 / 2.0, beyond]) * self.weights

    def candidates(self) -> FloatArray:
        """Candidates for κ0: where scales may begin to touch, to just before the last sample."""
        steps = np.diff(self.kappa, prepend=0.0)
        shares = (np.arange(_PER_INTERVAL) + 0.5) / _PER_INTERVAL
        grid = (self.kappa - steps)[:, None] + steps[:, None] * shares
        return self.within(grid.ravel())

    def within(self, onsets: FloatArray) -> FloatArray:
        """Onsets moved to where κ0 may be."""
        latest = self.latest()
        return np.clip(onsets, min(self.free_until, latest), latest)

    def latest(self) -> float:
        before = self.kappa[-2] if len(self.kappa) > 1 else 0.0
        return float(self.kappa[-1] - _MARGIN * (self.kappa[-1] - before))

    def reduced(self, onsets: FloatArray) -> FloatArray:
        """(5, m): quadratic in a after elimination of c, then c at a = 0 and its decrease by a."""
        columns = self.c_columns(onsets)
        square = np.sum(columns**2, axis=1)
        square[square == 0.0] = 1.0
        with_a, with_data = columns @ self.a_column, columns @ self.data
        return np.stack(
            [
                self.a_column @ self.a_column - with_a**2 / square,
                self.a_column @ self.data - with_a * with_data / square,
                self.data @ self.data - with_data**2 / square,
                with_data / square,
                with_a / square,
            ]
        )


def fit_uniaxial(
    lines: Mapping[str, Line],
    weighting: Weighting = "relative",
    contact_sides: Sequence[str] | None = None,
    known: UniaxialLaw | None = None,
) -> dict[str, UniaxialLaw]:
    """Laws of the sides of one direction, with one a.

    Parameters
    ----------
    lines : samples by side; at least two samples each.
    weighting : see `Line.weights`.
    contact_sides : sides known to meet contact; decided here if not given. Where contact was
        measured, a side has κ0 if scales touch and stiffen it; elsewhere if a kink with
        b >= LEAST_STIFFENING a explains the curve far better than a straight line.
    known : response without contact (a and softening), where known already; else a is fitted.
    """
    weighted = {side: _WeightedLine(line, weighting, known) for side, line in lines.items()}
    a = None if known is None else float(known.a)
    if contact_sides is not None:
        best = _search(weighted, set(contact_sides), a)
    else:
        allowed = {side for side, line in lines.items() if line.free_until != np.inf}
        best = _search(weighted, allowed, a)
        for side in sorted(allowed):
            without = _search(weighted, allowed - {side}, a)
            if not _is_contact(lines[side], best, without, list(lines).index(side)):
                allowed, best = allowed - {side}, without
    laws = {}
    for side, added, onset in zip(lines, best.added, best.onsets, strict=True):
        contact = np.isfinite(onset)
        b, kappa_0 = (best.a + added, onset) if contact else (np.nan, np.nan)
        softening = 0.0 if known is None else known.softening
        laws[side] = UniaxialLaw(best.a, float(b), float(kappa_0), softening)
    return laws


def _is_contact(line: Line, best: _Fit, without: _Fit, position: int) -> bool:
    if not np.isfinite(best.onsets[position]):
        return False
    if line.free_until is not None:
        return True
    count = 2 * len(line.curvature)
    rounding = count * _ROUNDING**2
    gain = count * np.log((without.rss + rounding) / (best.rss + rounding))
    stiff = best.a + best.added[position] >= LEAST_STIFFENING * best.a
    return bool(stiff and gain > 2.0 * np.log(count) + LEAST_EVIDENCE)


def _search(lines: Mapping[str, _WeightedLine], contact_sides: set[str], a: float | None) -> _Fit:
    """Best laws with c >= 0, and c = 0 for the sides not in `contact_sides`; `a` if known."""
    none = np.array([np.inf])
    grids = [
        np.concatenate([line.candidates(), none]) if side in contact_sides else none
        for side, line in lines.items()
    ]
    best = _best_of(lines, grids, a)
    widths = [np.diff(line.kappa, prepend=0.0).max() / _PER_INTERVAL for line in lines.values()]
    for _ in range(_ROUNDS):
        grids = []
        for line, onset, width in zip(lines.values(), best.onsets, widths, strict=True):
            near = line.within(onset + np.linspace(-width, width, 21))
            grids.append(np.append(near, onset) if np.isfinite(onset) else none)
        best = min(best, _best_of(lines, grids, a), key=lambda fit: fit.rss)
        widths = [width / 10.0 for width in widths]
    return best


def _best_of(
    lines: Mapping[str, _WeightedLine], grids: Sequence[FloatArray], known_a: float | None
) -> _Fit:
    """Best combination of one κ0 per side; combinations with a <= 0 or c < 0 do not count."""
    reduced = []
    for position, (line, grid) in enumerate(zip(lines.values(), grids, strict=True)):
        shape = [5] + [1] * len(grids)
        shape[position + 1] = len(grid)
        reduced.append(line.reduced(grid).reshape(shape))
    zero = np.zeros([1] * len(grids))
    alpha, beta, gamma = (sum((part[row] for part in reduced), start=zero) for row in range(3))
    if known_a is None:
        whole = sum(line.a_column @ line.a_column for line in lines.values())
        known = alpha > 1e-12 * whole
        a = beta / np.where(known, alpha, 1.0)
        fine = known & (a > 0.0)
    else:
        a = np.full(alpha.shape, known_a)
        fine = np.full(alpha.shape, True)
    for part in reduced:
        fine = fine & (part[3] - a * part[4] >= 0.0)
    rss = np.where(fine, gamma - 2.0 * beta * a + alpha * a**2, np.inf)
    where = np.unravel_index(int(np.argmin(rss)), rss.shape)
    onsets = tuple(float(grid[index]) for grid, index in zip(grids, where, strict=True))
    best = float(a[where])
    added = tuple(
        float(part[3].ravel()[index] - best * part[4].ravel()[index])
        for part, index in zip(reduced, where, strict=True)
    )
    return _Fit(best, added, onsets, max(float(rss[where]), 0.0))
