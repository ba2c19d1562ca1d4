"""How a pattern lies on a sheet."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely
from numpy.typing import NDArray

from flexscale.errors import FabricationError
from flexscale.fabricate.walls import GRID
from flexscale.patterns import Pattern
from flexscale.units import require_finite

FloatArray = NDArray[np.float64]
Border = Literal["cut", "whole"]


@dataclass(frozen=True)
class Layout:
    """How the pattern lies on the sheet, and what happens at the border.

    Attributes
    ----------
    direction : degree, direction of the pattern that lies along x, the length of a rectangle.
    center : (2,) mm, point of the pattern that lies in the middle of the sheet.
    border : "cut" scales at the border, or keep only those that are "whole".
    smallest_area : mm², cut pieces below this are left out; 5 % of a tile if not given.
    """

    direction: float = 0.0
    center: tuple[float, float] = (0.0, 0.0)
    border: Border = "cut"
    smallest_area: float | None = None

    def __post_init__(self) -> None:
        require_finite(self.direction, "direction", "degree")
        for value in self.center:
            require_finite(value, "center", "mm")
        if self.smallest_area is not None:
            area = require_finite(self.smallest_area, "smallest area", "mm²")
            if area < 0.0:
                raise FabricationError(f"The smallest area is {area:g} mm²: give 0 or more.")
        if self.border not in ("cut", "whole"):
            raise FabricationError(f"The border is {self.border!r}: choose 'cut' or 'whole'.")

    def place(self, points: FloatArray) -> FloatArray:
        """Points (n, 2) of the pattern in coordinates of the sheet, mm."""
        turn = np.deg2rad(self.direction)
        cosine, sine = np.cos(turn), np.sin(turn)
        return np.asarray((points - np.array(self.center)) @ [[cosine, -sine], [sine, cosine]])


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
