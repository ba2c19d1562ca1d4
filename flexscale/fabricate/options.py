"""What a printer can do, and the grooves that key scales into the sheet."""

from __future__ import annotations

from dataclasses import dataclass

from flexscale.checks import Check, checked, length, number
from flexscale.errors import FabricationError
from flexscale.patterns import Pattern
from flexscale.units import LENGTHS


def _density(name: str) -> Check:
    return number("g/cm³", 1e-3, 100.0, above=0.0, name=name)


ROUNDING = 1e-9  # mm: sizes are compared as they were typed


@checked(
    layer_height=length(),
    nozzle=length(),
    smallest_wall=length(),
    scale_density=_density("density of the scales"),
    substrate_density=_density("density of the substrate"),
)
@dataclass(frozen=True)
class Printer:
    """Limits of the printer, and densities of what it prints.

    Attributes
    ----------
    layer_height : mm; heights and depths are whole numbers of layers.
    nozzle : mm, its diameter: no gap, wall or groove is narrower.
    smallest_wall : mm, at least the nozzle, which it is if not given.
    scale_density, substrate_density : g cm⁻³, of the makers' data sheets of PETG and NinjaFlex.
    """

    layer_height: float = 0.1
    nozzle: float = 0.4
    smallest_wall: float | None = None
    scale_density: float = 1.27
    substrate_density: float = 1.19

    def __post_init__(self) -> None:
        if self.smallest_wall is None:
            object.__setattr__(self, "smallest_wall", self.nozzle)
        wall = self.wall
        if wall < self.nozzle - ROUNDING:
            raise FabricationError(
                f"The smallest wall is {wall:g} mm, narrower than the nozzle of {self.nozzle:g} mm:"
                f" give at least {self.nozzle:g} mm."
            )

    @property
    def wall(self) -> float:
        """The smallest wall, mm."""
        return self.nozzle if self.smallest_wall is None else self.smallest_wall

    def n_layers(self, height: float, what: str) -> int:
        """How many layers a height (mm) takes.

        Raises
        ------
        FabricationError : not a whole number; `what` names the height.
        """
        n = round(height / self.layer_height)
        if n < 1 or abs(n * self.layer_height - height) > 1e-6:
            below = max(1, int(height / self.layer_height)) * self.layer_height
            raise FabricationError(
                f"The {what} is {height:g} mm, no whole number of {self.layer_height:g} mm layers: "
                f"a printer would round it. Choose {below:g} or {below + self.layer_height:g} mm, "
                "or another layer height."
            )
        return n


@checked(
    width=length("groove width"),
    pitch=length("groove pitch"),
    depth=number("mm", 0.0, LENGTHS[1], name="groove depth"),
    margin=number("mm", -LENGTHS[1], LENGTHS[1], name="groove margin"),
)
@dataclass(frozen=True)
class Grooves:
    """Rings sunk into the substrate under every scale, parallel to its outline and filled by it.

    Attributes
    ----------
    width : mm, of a groove.
    pitch : mm, from one ring to the next; what lies between them is substrate.
    depth : mm, below the top of the substrate; 0 for a plain base.
    margin : mm, from a scale's outline to its first groove; pitch - width if not given.
    """

    width: float = 0.8
    pitch: float = 1.6
    depth: float = 0.2
    margin: float | None = None

    def __post_init__(self) -> None:
        if self.margin is None:
            object.__setattr__(self, "margin", self.pitch - self.width)

    @property
    def spacing(self) -> float:
        """Substrate between two rings, mm."""
        return self.pitch - self.width

    @property
    def first(self) -> float:
        """From the outline to the first ring, mm."""
        return self.spacing if self.margin is None else self.margin


def check_printable(pattern: Pattern, grooves: Grooves, printer: Printer) -> None:
    """Refuse what the printer cannot make of a pattern, whatever the shape of the sheet.

    Raises
    ------
    FabricationError : the gap or a groove is narrower than the nozzle, a groove leaves no layer of
        the substrate, or a height is no whole number of layers.
    """
    nozzle = printer.nozzle
    if pattern.gap < nozzle - ROUNDING:
        raise FabricationError(
            f"The gap of pattern {pattern.name!r} is {pattern.gap:g} mm, narrower than the nozzle "
            f"of {nozzle:g} mm: neighboring scales would fuse. Widen the gap to {nozzle:g} mm or "
            "more, or use a finer nozzle."
        )
    thickness = pattern.substrate_thickness
    printer.n_layers(thickness, "substrate thickness")
    printer.n_layers(pattern.scale_height, "scale height")
    if grooves.depth == 0.0:
        return
    if grooves.depth > thickness - printer.layer_height + ROUNDING:
        raise FabricationError(
            f"The grooves are {grooves.depth:g} mm deep, but the substrate is {thickness:g} mm "
            f"thick and one layer of {printer.layer_height:g} mm must stay below them: "
            f"{_shallower(thickness - printer.layer_height)}"
        )
    printer.n_layers(grooves.depth, "groove depth")
    widths = {
        "are": ("width", grooves.width),
        "leave walls of substrate that are": ("pitch or a smaller width", grooves.spacing),
        "begin behind a margin that is": ("margin", grooves.first),
    }
    for what, (remedy, value) in widths.items():
        if value < printer.wall - ROUNDING:
            raise FabricationError(
                f"The grooves {what} {value:g} mm wide, narrower than the smallest wall of "
                f"{printer.wall:g} mm: give a larger {remedy}."
            )


def _shallower(deepest: float) -> str:
    if deepest < ROUNDING:
        return "give a groove depth of 0, or a thicker substrate."
    return f"give a depth of {deepest:g} mm at most."
