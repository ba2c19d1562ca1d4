"""How a pattern lies on a sheet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely

from flexscale.arrays import FloatArray
from flexscale.checks import ANGLE, checked, choice, number, point
from flexscale.errors import FabricationError
from flexscale.fabricate.walls import GRID
from flexscale.patterns import Pattern

Border = Literal["cut", "whole"]

MOST_SCALES = 20000  # of a sheet: each takes about a millisecond and up to 0.1 MB
SLIVER = 0.05  # of a tile: pieces smaller than this are left out if nothing else is said


@checked(
    direction=ANGLE,
    center=point("mm"),
    border=choice("border", ("cut", "whole")),
    smallest_area=number("mm²", 0.0, 1e8),
)
@dataclass(frozen=True)
class Layout:
    """How the pattern lies on the sheet, and what happens at the border.

    Attributes
    ----------
    direction : degree, direction of the pattern that lies along x, the length of a rectangle.
    center : (2,) mm, point of the pattern that lies in the middle of the sheet; of polygons that
        were given, seen from the first corner of the first tile.
    border : "cut" scales at the border, or keep only those that are "whole".
    smallest_area : mm², cut pieces below this are left out; 5 % of a tile if not given.
    """

    direction: float = 0.0
    center: tuple[float, float] = (0.0, 0.0)
    border: Border = "cut"
    smallest_area: float | None = None

    def place(self, points: FloatArray) -> FloatArray:
        """Points (n, 2) of the pattern in coordinates of the sheet, mm."""
        turn = np.deg2rad(self.direction)
        cosine, sine = np.cos(turn), np.sin(turn)
        return np.asarray((points - np.array(self.center)) @ [[cosine, -sine], [sine, cosine]])

    def least_area(self, pattern: Pattern) -> float:
        """Area of the smallest pieces that are kept, mm²."""
        return SLIVER * pattern.tile_area if self.smallest_area is None else self.smallest_area


@dataclass(frozen=True, eq=False)
class TileCopies:
    """The scales on all copies of one tile of the pattern's cell that a region meets.

    Attributes
    ----------
    tile : which tile.
    home : outline of the scale on it, in coordinates of the sheet, mm.
    inside, crossing : (n, 2) shifts of the scales that lie in the region, and across its border.
    """

    tile: int
    home: shapely.Polygon
    inside: FloatArray
    crossing: FloatArray

    def pieces(self, region: shapely.Polygon) -> Iterator[shapely.Polygon]:
        """What the region's border leaves of the scales across it, slivers included."""
        for shift in self.crossing:
            cut = shapely.intersection(moved(self.home, shift), region, grid_size=GRID)
            yield from shapely.get_parts(cut)


def lay_out(pattern: Pattern, layout: Layout, region: shapely.Polygon) -> Iterator[TileCopies]:
    """The pattern's scales over a region, tile by tile.

    Raises
    ------
    FabricationError : there are more than `MOST_SCALES`.
    """
    expected = region.area / pattern.tile_area
    if expected > MOST_SCALES:
        raise FabricationError(
            f"The sheet would hold about {expected:.0f} scales on tiles of {pattern.tile_area:g} "
            f"mm², more than {MOST_SCALES}: give a smaller size or a larger tile area."
        )
    lattice = lattice_on_sheet(pattern, layout)
    for tile, outline in enumerate(pattern.outlines()):
        home = shapely.set_precision(shapely.Polygon(layout.place(outline)), GRID)
        yield TileCopies(tile, home, *shifts_onto(home, lattice, region))


def no_whole_scale(
    pattern: Pattern, layout: Layout, region: shapely.Polygon, name: str
) -> FabricationError:
    """The error about a region, called `name`, that no scale lies wholly in."""
    sizes = [np.ptp(layout.place(outline), axis=0) for outline in pattern.outlines()]
    width, height = min(sizes, key=lambda size: float(size.prod()))
    low, high = np.reshape(region.bounds, (2, 2))
    return FabricationError(
        f"The {name} mm holds no whole scale of pattern {pattern.name!r}: the sheet measures "
        f"{high[0] - low[0]:g} x {high[1] - low[1]:g} mm, a scale {width:.3g} x {height:.3g} mm. "
        "Give a larger sheet, or another point of the pattern as its center."
    )


def lattice_on_sheet(pattern: Pattern, layout: Layout) -> FloatArray:
    """(2, 2) rows t1, t2 in coordinates of the sheet, mm."""
    return layout.place(pattern.lattice) - layout.place(np.zeros((1, 2)))


def shifts_onto(
    home: shapely.Polygon, lattice: FloatArray, region: shapely.Polygon
) -> tuple[FloatArray, FloatArray]:
    """Shifts (n, 2), lattice vectors to the grid, of a scale into a region, and across its border.

    Scales that only touch the border from outside are in neither.
    """
    low, high = np.reshape(region.bounds, (2, 2))
    least, most = low - home.bounds[2:], high - home.bounds[:2]
    corners = np.array([(x, y) for x in (least[0], most[0]) for y in (least[1], most[1])])
    steps = corners @ np.linalg.inv(lattice)
    first = np.floor(steps.min(axis=0)).astype(int)
    last = np.ceil(steps.max(axis=0)).astype(int)
    steps = np.mgrid[first[0] : last[0] + 1, first[1] : last[1] + 1].reshape(2, -1).T
    shifts = GRID * np.rint(steps @ lattice / GRID)
    shifts = shifts[np.all((shifts >= least) & (shifts <= most), axis=1)]
    shapely.prepare(region)
    copies = np.array([moved(home, shift) for shift in shifts], dtype=object)
    inside = shapely.covered_by(copies, region)
    crossing = shapely.relate_pattern(copies, region, "T********") & ~inside
    return shifts[inside], shifts[crossing]


def moved(area: shapely.Polygon, shift: FloatArray) -> shapely.Polygon:
    """An area shifted by (2,) mm."""
    return shapely.transform(area, lambda points: points + shift)
