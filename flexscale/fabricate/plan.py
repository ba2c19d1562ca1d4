"""Plan of a sheet: the simulated outlines laid out, cut at the border, and their grooves.

All walls of the printed scales are vertical, so cutting a scale at the border is cutting its
outline. That is done exactly up to a grid of 2⁻¹⁵ mm (0.03 µm), on which all corners of a plan lie.
"""

from __future__ import annotations

from dataclasses import dataclass

import shapely

from flexscale.arrays import FloatArray
from flexscale.errors import FabricationError
from flexscale.fabricate.grooves import groove_rings
from flexscale.fabricate.layout import Layout, lay_out, moved, no_whole_scale
from flexscale.fabricate.options import Grooves, Printer, check_printable
from flexscale.fabricate.shapes import Shape
from flexscale.fabricate.walls import is_printable, smallest_wall, without_thin_parts
from flexscale.patterns import Pattern
from flexscale.short_repr import ShortRepr

LARGEST = 500.0  # mm from the middle: beyond, 32-bit numbers do not hold the grid


@dataclass(frozen=True, eq=False, repr=False)
class PlannedScale(ShortRepr):
    """One scale, or a piece of one.

    Attributes
    ----------
    outline : of base and top, mm.
    grooves : under its base.
    tile : which tile of the pattern's cell it stands on.
    shift : (2,) mm, of a whole scale: from the first one on this tile to this one; they are equal
        to the last bit, as shifts lie on the grid. None of a piece.
    """

    outline: shapely.Polygon
    grooves: tuple[shapely.Polygon, ...]
    tile: int
    shift: tuple[float, float] | None

    @property
    def whole(self) -> bool:
        """Whether its outline is the simulated one."""
        return self.shift is not None


@dataclass(frozen=True, eq=False, repr=False)
class Plan(ShortRepr):
    """All that is printed, seen from above, in mm, the middle of the sheet at the origin.

    Attributes
    ----------
    sheet : outline of the substrate.
    scales : whole ones and pieces.
    n_removed : pieces left out because they were too small or too thin.
    n_left_out : scales left out because they crossed the border.
    """

    sheet: shapely.Polygon
    scales: tuple[PlannedScale, ...]
    n_removed: int
    n_left_out: int

    @property
    def n_whole(self) -> int:
        """Number of whole scales."""
        return sum(scale.whole for scale in self.scales)

    def smallest_wall(self, start: float) -> float:
        """Of all scales, mm, sought from `start` mm."""
        wholes = {scale.tile: scale.outline for scale in self.scales if scale.whole}
        pieces = [scale.outline for scale in self.scales if not scale.whole]
        return smallest_wall([*wholes.values(), *pieces], start)


def build_plan(
    pattern: Pattern, shape: Shape, layout: Layout, grooves: Grooves, printer: Printer
) -> Plan:
    """Lay the pattern out on a shape.

    Raises
    ------
    FabricationError : the printer cannot make the pattern, or no scale lies wholly in the shape.
    """
    check_printable(pattern, grooves, printer)
    shape.check(printer)
    _check_scales(pattern, printer)
    region = shape.scaled_region()
    _check_size(region)
    least = layout.least_area(pattern)
    scales: list[PlannedScale] = []
    n_removed = n_left_out = 0
    for copies in lay_out(pattern, layout, region):
        scales += _whole_scales(copies.home, copies.tile, copies.inside, grooves)
        if layout.border == "whole":
            n_left_out += len(copies.crossing)
            continue
        for part in copies.pieces(region):
            kept = without_thin_parts(part, printer.wall) if part.area >= least else None
            if kept is None or kept.area < least:
                n_removed += 1
            else:
                rings = tuple(groove_rings(kept, grooves))
                scales.append(PlannedScale(kept, rings, copies.tile, None))
    plan = Plan(shape.sheet_region(pattern.gap), tuple(scales), n_removed, n_left_out)
    if plan.n_whole == 0:
        raise no_whole_scale(pattern, layout, region, shape.name)
    return plan


def _check_size(region: shapely.Polygon) -> None:
    reach = max(map(abs, region.bounds))
    if reach > LARGEST:
        raise FabricationError(
            f"The sheet reaches {reach:g} mm from its middle, but files for printers hold at most "
            f"{LARGEST:g} mm to less than 0.1 µm: give a smaller size."
        )


def _whole_scales(
    home: shapely.Polygon, tile: int, shifts: FloatArray, grooves: Grooves
) -> list[PlannedScale]:
    """Copies of the scale on one tile."""
    if not len(shifts):
        return []
    rings = groove_rings(home, grooves)
    return [
        PlannedScale(
            moved(home, shift),
            tuple(moved(ring, shift) for ring in rings),
            tile,
            (float(shift[0] - shifts[0, 0]), float(shift[1] - shifts[0, 1])),
        )
        for shift in shifts
    ]


def _check_scales(pattern: Pattern, printer: Printer) -> None:
    for number, prototile in enumerate(pattern.prototiles):
        outline = shapely.Polygon(prototile.outline)
        if not is_printable(outline, printer.wall):
            thinnest = smallest_wall([outline], printer.wall)
            raise FabricationError(
                f"Scale {number} of pattern {pattern.name!r} has a wall, a fin or a needle "
                f"of {thinnest:.3g} mm, below the smallest wall of {printer.wall:g} mm: give a "
                f"larger tile area than {pattern.tile_area:g} mm², a gap below {pattern.gap:g} mm, "
                "or a rounder tile."
            )
