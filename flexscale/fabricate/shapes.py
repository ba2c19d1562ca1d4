"""Shapes of a printed sheet: a rectangle for the linear stage, a disc for the mandrel."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import shapely

from flexscale.arrays import FloatArray
from flexscale.checks import checked, length, number, optional
from flexscale.errors import FabricationError
from flexscale.fabricate.options import ROUNDING, Printer
from flexscale.fabricate.walls import on_grid
from flexscale.units import LENGTHS

CHORD = 0.005  # mm, largest distance between a circle and the polygon that is printed for it


@checked(
    length=length("sheet length"),
    width=length("sheet width"),
    pin=optional(length("hinge pin")),
    clearance=number("mm", 0.0, LENGTHS[1], name="pin clearance"),
    barrel_wall=length(),
)
@dataclass(frozen=True)
class Rectangle:
    """Rectangle with a hinge barrel along either short side, or without hinges.

    The scaled part is `length` long; substrate and barrels continue beyond it.

    Attributes
    ----------
    length, width : mm, along x and y.
    pin : mm, diameter of the hinge pins; None for no hinges.
    clearance : mm, how much wider than the pin its hole is, in diameter.
    barrel_wall : mm, around the hole.
    """

    length: float = 100.0
    width: float = 50.0
    pin: float | None = 3.0
    clearance: float = 0.2
    barrel_wall: float = 1.2

    @property
    def name(self) -> str:
        """For files and headings."""
        return f"rectangle-{self.length:g}x{self.width:g}"

    @property
    def n_hinges(self) -> int:
        """Number of hinge barrels."""
        return 0 if self.pin is None else 2

    @property
    def hole(self) -> float:
        """Diameter of the hole for a pin, mm."""
        return (self.pin or 0.0) + self.clearance

    @property
    def barrel_radius(self) -> float:
        """Outer radius of a barrel, mm."""
        return 0.5 * self.hole + self.barrel_wall

    def scaled_region(self) -> shapely.Polygon:
        """Where scales are, mm."""
        return _box(0.5 * self.length, 0.5 * self.width)

    def sheet_region(self, gap: float) -> shapely.Polygon:
        """The substrate, mm; a barrel stands as far from the scales as these from each other."""
        beyond = gap + 2.0 * self.barrel_radius if self.n_hinges else 0.0
        return _box(0.5 * self.length + beyond, 0.5 * self.width)

    def check(self, printer: Printer) -> None:
        """Refuse a barrel with a wall thinner than the printer's."""
        if self.n_hinges and self.barrel_wall < printer.wall - ROUNDING:
            raise FabricationError(
                f"The wall of the hinge barrels is {self.barrel_wall:g} mm, below the smallest "
                f"wall of {printer.wall:g} mm: give a barrel wall of {printer.wall:g} mm or more."
            )

    def to_config(self) -> dict[str, Any]:
        """The sizes in plain numbers, mm."""
        return {"shape": "rectangle", **asdict(self)}


@checked(radius=length("disc radius"), hub=optional(length("hub hole")))
@dataclass(frozen=True)
class Disc:
    """Disc with a hole in the middle for the mandrel.

    Attributes
    ----------
    radius : mm.
    hub : mm, diameter of the hole; None for no hole.
    """

    radius: float = 100.0
    hub: float | None = 8.0

    n_hinges = 0

    def __post_init__(self) -> None:
        if self.hub is not None and self.hub >= 2.0 * self.radius:
            raise FabricationError(
                f"The hub hole of {self.hub:g} mm diameter takes up the whole disc of "
                f"{self.radius:g} mm radius: give one below {2.0 * self.radius:g} mm."
            )

    @property
    def name(self) -> str:
        """For files and headings."""
        return f"disc-{self.radius:g}"

    def scaled_region(self) -> shapely.Polygon:
        """Where scales are, mm: the sheet's region."""
        outside = shapely.Polygon(circle_points(self.radius, outside=False))
        if self.hub is None:
            return on_grid(outside)
        hole = shapely.Polygon(circle_points(0.5 * self.hub, outside=True))
        return on_grid(shapely.difference(outside, hole))

    def sheet_region(self, gap: float) -> shapely.Polygon:
        """The substrate, mm; `gap` does not matter here."""
        return self.scaled_region()

    def check(self, printer: Printer) -> None:
        """Refuse a ring narrower than the printer's smallest wall."""
        ring = self.radius - 0.5 * (self.hub or 0.0)
        if ring < printer.wall - ROUNDING:
            hole = f" with a hub hole of {self.hub:g} mm diameter" if self.hub else ""
            raise FabricationError(
                f"A disc of {self.radius:g} mm radius{hole} leaves a ring of {ring:g} mm, below "
                f"the smallest wall of {printer.wall:g} mm: give a "
                f"{'smaller hole' if self.hub else 'larger radius'}."
            )

    def to_config(self) -> dict[str, Any]:
        """The sizes in plain numbers, mm."""
        return {"shape": "disc", **asdict(self)}


Shape = Rectangle | Disc


def circle_points(radius: float, *, outside: bool) -> FloatArray:
    """Corners (n, 2) of a polygon around a circle, or in it, within `CHORD`, mm.

    Outside for holes, so that a pin fits. The number of corners is a multiple of four.
    """
    half_angle = np.arccos(max(1.0 - CHORD / radius, 0.0))
    n = 4 * max(6, int(np.ceil(np.pi / half_angle / 4.0)))
    angles = 2.0 * np.pi * np.arange(n) / n
    reach = radius / np.cos(np.pi / n) if outside else radius
    return reach * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def _box(half_length: float, half_width: float) -> shapely.Polygon:
    return on_grid(shapely.box(-half_length, -half_width, half_length, half_width))
