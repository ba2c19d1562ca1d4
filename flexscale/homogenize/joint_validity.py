"""Where joints are no good model of a pattern: what its scales must be for lines to be joints."""

from __future__ import annotations

import numpy as np
import shapely

from flexscale.patterns.junctions import turning_angles
from flexscale.patterns.pattern import Pattern

NARROW = 4.0  # thicknesses of the sheet: widths that a scale should have, necks included
SHARP = 30.0  # degree: tips that comparisons with solids do not cover
HARD = 70.0  # times the sheet's modulus: scales of PETG on TPU, softer ones were not compared
GAPS = (0.5, 4.0)  # thicknesses of the sheet, between which sections were compared with strips


def doubts(pattern: Pattern) -> tuple[str, ...]:
    """Sentences on what of a pattern lies beyond what joints were compared with solids for."""
    found = []
    outlines = [shapely.Polygon(outline) for outline in pattern.outlines()]
    need = NARROW * pattern.substrate_thickness
    if any(_falls_apart(outline, 0.5 * need) for outline in outlines):
        found.append(
            f"scales or their necks are narrower than {need:g} mm, {NARROW:g} thicknesses of the "
            "sheet: the sheet below them gives way more than joints tell"
        )
    sharpest = min(_sharpest_tip(tile) for tile in pattern.tiles)
    if sharpest < SHARP:
        found.append(
            f"scales have tips of {sharpest:.0f} degree: the ends of joints there are known for "
            f"tips down to {SHARP:g} degree"
        )
    stiffer = pattern.scale_material.young_modulus / pattern.substrate_material.young_modulus
    if stiffer < HARD:
        found.append(
            f"scales are {stiffer:.3g} times as stiff as the sheet: joints take them as rigid but "
            f"for their rims, which was compared with solids from {HARD:g} times on"
        )
    for gap in (min(pattern.gaps), max(pattern.gaps)):
        if not GAPS[0] <= gap / pattern.substrate_thickness <= GAPS[1]:
            found.append(
                f"a gap of {gap:g} mm is {gap / pattern.substrate_thickness:.3g} thicknesses of "
                f"the sheet wide: joints were checked from {GAPS[0]:g} to {GAPS[1]:g}"
            )
            break
    return tuple(found)


def _falls_apart(outline: shapely.Polygon, inset: float) -> bool:
    """Whether a scale vanishes, or falls into pieces, when it is made narrower all around."""
    left = outline.buffer(-inset)
    return left.is_empty or left.geom_type != "Polygon"


def _sharpest_tip(tile: np.ndarray) -> float:
    """Smallest angle of a tile at its corners, degree."""
    return float(np.degrees((np.pi - turning_angles(tile)).min()))
