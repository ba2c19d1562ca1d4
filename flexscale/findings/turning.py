"""Findings on how directions of stiffness change with curvature, when scales close."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from flexscale.findings.measures import (
    LEAST_LOBE,
    contact_curvatures,
    harmonic_shares,
    largest_curvature,
    lobes,
    moments,
    smallest_curvature,
    spread,
)
from flexscale.findings.pattern_data import PatternData
from flexscale.findings.verdict import Evidence, Finding

SIDE = "closing"
QUASI = 0.1  # a moment that varies by less over all directions is called quasi-isotropic
SWITCHED = 0.05  # the ratio of two moments has to pass 1 by this much


def three_fold_grows_lobes(patterns: Sequence[PatternData]) -> Finding:
    """Patterns of period 60 degree get lobes in contact, at 60 or at 30 degree."""
    evidence = []
    for item in patterns:
        if item.symmetry.period != 60.0:
            continue
        direction = item.sweep["direction"].values.astype(float)
        half_step = 90.0 / len(direction)
        shown = [
            (curvature, moments(item.sweep, SIDE, curvature))
            for curvature in contact_curvatures(item.sweep, SIDE)
        ]
        if not shown:
            continue
        curvature, values = max(shown, key=lambda pair: spread(pair[1]))
        found = lobes(direction, values)
        # One of each lobe's copies: distance from the nearest multiple of 30 degree.
        fits = [abs((place + 15.0) % 30.0 - 15.0) <= half_step / 2 for place in found]
        numbers = f"{_lobed(found)} at {curvature:g} mm-1, spread {100 * spread(values):.0f} %"
        evidence.append(Evidence(item.name, bool(found) and all(fits), numbers))
    return Finding(
        "three-fold lobes",
        "Although initially isotropic, they show distinct stiffness peaks at 60° and 30° for "
        "larger curvatures (Figs. 7a, 8h).",
        f"three- and six-fold patterns, closing, where the moment varies most: lobes of more than "
        f"{100 * LEAST_LOBE:g} %, all at multiples of 30°",
        tuple(evidence),
    )


def lobes_depend_on_curvature(patterns: Sequence[PatternData]) -> Finding:
    """Number and place of the lobes change with curvature."""
    evidence = []
    for item in patterns:
        if item.symmetry.period != 60.0:
            continue
        direction = item.sweep["direction"].values.astype(float)
        by_curvature = {
            curvature: tuple(lobes(direction, moments(item.sweep, SIDE, curvature)))
            for curvature in contact_curvatures(item.sweep, SIDE)
        }
        if by_curvature:
            numbers = "; ".join(
                f"from {k:g} mm-1 {_lobed(found)}" for k, found in _changes(by_curvature)
            )
            evidence.append(Evidence(item.name, len(set(by_curvature.values())) > 1, numbers))
    return Finding(
        "lobes change",
        "Number and frequency of the lobes depend on both pattern and magnitude of curvature.",
        "three- and six-fold patterns, closing: lobes differ between curvatures in contact, as far "
        "as the sweep's steps of direction show them",
        tuple(evidence),
        why="Lobes on a mirror axis, as those of hexagons, can split but not move, and shifts by "
        "less than the sweep's steps of direction are not seen.",
    )


def four_fold_axes_turn(patterns: Sequence[PatternData]) -> Finding:
    """The stiffest direction of four-fold patterns turns by 45 degree."""
    evidence = []
    for item in patterns:
        if item.symmetry.period != 90.0:
            continue
        (k0, before), (k1, after) = _ends(item)
        turn = abs((after - before + 45.0) % 90.0 - 45.0)
        half_step = 90.0 / len(item.sweep["direction"])
        numbers = f"stiffest at {before:g}° at {k0:g} mm-1, {after:g}° at {k1:g}: {turn:g}°"
        evidence.append(Evidence(item.name, turn >= 45.0 - half_step, numbers))
    return Finding(
        "four-fold axes turn",
        "The principal axes of the four-fold pattern turn by 45° for larger curvatures (Fig. 7b).",
        "a four-fold pattern, closing: its stiffest directions at the smallest and the largest "
        "curvature are 45° apart",
        tuple(evidence),
        of_all=False,
    )


def soft_and_stiff_change_places(patterns: Sequence[PatternData]) -> Finding:
    """Along the two principal axes of a mirrored pattern, the stiffer becomes the softer."""
    evidence = []
    for item in patterns:
        if item.symmetry.period != 180.0 or not item.symmetry.mirrors:
            continue
        axis = item.symmetry.mirrors[0]
        ratios = []
        for curvature in (
            smallest_curvature(item.sweep, SIDE),
            largest_curvature(item.sweep, SIDE),
        ):
            line = item.sweep["moment"].sel(side=SIDE, curvature=curvature)
            along, across = (
                float(line.sel(direction=(axis + turn) % 180.0, method="nearest"))
                for turn in (0.0, 90.0)
            )
            ratios.append(along / across)
        low, high = sorted(ratios)
        numbers = f"moment at {axis:g}° over {axis + 90:g}°: {ratios[0]:.3g}, then {ratios[1]:.3g}"
        holds = low < 1.0 - SWITCHED and high > 1.0 + SWITCHED
        evidence.append(Evidence(item.name, holds, numbers))
    return Finding(
        "soft and stiff change places",
        "Minimum and maximum stiffness switch directions, while the principal directions remain "
        "(Fig. 8f).",
        "a pattern with reflections, closing: of its two principal axes the stiffer one at the "
        f"smallest curvature is the softer one at the largest, by {100 * SWITCHED:g} % each",
        tuple(evidence),
        of_all=False,
    )


def quasi_isotropic_turns_tetragonal(patterns: Sequence[PatternData]) -> Finding:
    """A nearly isotropic pattern gets four lobes around the circle."""
    evidence = []
    for item in patterns:
        first = spread(moments(item.sweep, SIDE, smallest_curvature(item.sweep, SIDE)))
        best, at = 0.0, np.nan
        tetragonal = False
        for curvature in contact_curvatures(item.sweep, SIDE):
            shares = harmonic_shares(moments(item.sweep, SIDE, curvature))
            others = float(np.delete(shares, 1).max())
            if shares[1] > best:
                best, at = float(shares[1]), curvature
            tetragonal = tetragonal or bool(shares[1] >= max(LEAST_LOBE, 2.0 * others))
        numbers = f"spread {100 * first:.3g} % at first, then cos 4θ up to {100 * best:.3g} %"
        numbers += f" at {at:g} mm-1" if best else ""
        evidence.append(Evidence(item.name, first <= QUASI and tetragonal, numbers))
    return Finding(
        "quasi-isotropic turns tetragonal",
        "There are transitions between symmetry classes, as from quasi-isotropic to tetragonal "
        "(Fig. 8g).",
        f"a pattern, closing: moments vary by at most {100 * QUASI:g} % at the smallest curvature, "
        f"and in contact cos 4θ exceeds {100 * LEAST_LOBE:g} % and twice any other harmonic",
        tuple(evidence),
        of_all=False,
        why="The paper does not give the tile of Fig. 8g. Patterns here that are nearly isotropic "
        "at rest have three- or six-fold symmetry: moments repeat after 60°, which rules cos 4θ "
        "out.",
    )


def _ends(item: PatternData) -> list[tuple[float, float]]:
    """(curvature, stiffest direction) at the smallest and at the largest curvature."""
    direction = item.sweep["direction"].values.astype(float)
    ends = smallest_curvature(item.sweep, SIDE), largest_curvature(item.sweep, SIDE)
    return [(k, float(direction[int(np.argmax(moments(item.sweep, SIDE, k)))])) for k in ends]


def _changes(
    by_curvature: Mapping[float, tuple[float, ...]],
) -> list[tuple[float, tuple[float, ...]]]:
    """Those that differ from the one before."""
    items = list(by_curvature.items())
    return [item for k, item in enumerate(items) if k == 0 or item[1] != items[k - 1][1]]


def _lobed(found: Sequence[float]) -> str:
    return f"lobes at {', '.join(f'{place:g}°' for place in found)}" if found else "no lobes"
