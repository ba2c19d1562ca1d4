"""A printable sheet: two solids of one pattern, and what is to be known of them."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

import manifold3d as m3
import numpy as np
import shapely

from flexscale import checks
from flexscale.checks import checked
from flexscale.fabricate.grooves import groove_rings
from flexscale.fabricate.hinges import hinge_axes, hinge_bases, hinge_profile
from flexscale.fabricate.layout import Layout
from flexscale.fabricate.options import Grooves, Printer
from flexscale.fabricate.plan import Plan, build_plan
from flexscale.fabricate.shapes import Disc, Rectangle, Shape
from flexscale.fabricate.solids import Solid, bar, grooved, keyed, prism, solid_of
from flexscale.patterns import Pattern
from flexscale.short_repr import ShortRepr

_ROOT = 0.5  # of the height above a groove: how far its rib is sunk into the body it belongs to


@dataclass(frozen=True, eq=False, repr=False)
class PrintableSheet(ShortRepr):
    """Scales and substrate in place for a printer with two materials; the bed is z = 0.

    Attributes
    ----------
    pattern, shape, layout, grooves, printer : what it was made of.
    plan : outlines seen from above.
    hinge_grooves : grooves under the hinge bars.
    substrate, scales : the solids. Hinge bars belong to the scales: they are one material.
    """

    pattern: Pattern
    shape: Shape
    layout: Layout
    grooves: Grooves
    printer: Printer
    plan: Plan
    hinge_grooves: tuple[shapely.Polygon, ...]
    substrate: Solid
    scales: Solid

    @property
    def solids(self) -> tuple[Solid, Solid]:
        """Substrate and scales."""
        return self.substrate, self.scales

    @cached_property
    def areas(self) -> dict[str, float]:
        """Areas in plan, mm²: of the sheet, of the scales, and of the grooves."""
        grooves = [*self.hinge_grooves, *(g for scale in self.plan.scales for g in scale.grooves)]
        return {
            "sheet": float(self.plan.sheet.area),
            "scales": float(sum(scale.outline.area for scale in self.plan.scales)),
            "grooves": float(sum(groove.area for groove in grooves)),
        }

    @cached_property
    def smallest_wall(self) -> float:
        """Of all scales, mm."""
        return self.plan.smallest_wall(self.printer.wall)

    def expected_volumes(self) -> dict[str, float]:
        """What the solids must measure, mm³: areas times heights, by solid."""
        in_grooves = self.areas["grooves"] * self.grooves.depth
        bars = 0.0
        if isinstance(self.shape, Rectangle) and self.shape.n_hinges:
            profile = hinge_profile(self.shape)
            bars = self.shape.n_hinges * float(profile.area) * self.shape.width
        height, thickness = self.pattern.scale_height, self.pattern.substrate_thickness
        return {
            "substrate": self.areas["sheet"] * thickness - in_grooves,
            "scales": self.areas["scales"] * height + in_grooves + bars,
        }

    def to_config(self) -> dict[str, Any]:
        """All that the solids depend on besides the pattern, in plain data (mm, degree)."""
        return {
            "shape": self.shape.to_config(),
            "layout": asdict(self.layout) | {"center": list(self.layout.center)},
            "grooves": asdict(self.grooves),
            "printer": asdict(self.printer),
        }


@checked(
    pattern=checks.PATTERN,
    shape=checks.instance("flexscale.fabricate.shapes:Shape", "take a Rectangle or a Disc"),
    layout=checks.options("flexscale.fabricate.layout:Layout"),
    grooves=checks.options("flexscale.fabricate.options:Grooves"),
    printer=checks.options("flexscale.fabricate.options:Printer"),
)
def printable_sheet(
    pattern: Pattern,
    shape: Shape | None = None,
    *,
    layout: Layout | None = None,
    grooves: Grooves | None = None,
    printer: Printer | None = None,
) -> PrintableSheet:
    """Solids of a pattern, cut out as a rectangle or a disc.

    Parameters
    ----------
    shape : `Rectangle` or `Disc`; a rectangle of 100 x 50 mm with hinges if not given.
    layout, grooves, printer : see the classes; their defaults are the paper's where it has any.

    Raises
    ------
    FabricationError : the printer cannot make it, or the shape holds no whole scale.
    """
    shape, layout = shape or Rectangle(), layout or Layout()
    grooves, printer = grooves or Grooves(), printer or Printer()
    plan = build_plan(pattern, shape, layout, grooves, printer)
    top = pattern.substrate_thickness
    floor = top - grooves.depth
    root = top + _ROOT * pattern.scale_height
    bodies = _scale_bodies(plan, (floor, top, root, top + pattern.scale_height))
    under_bars: list[shapely.Polygon] = []
    if isinstance(shape, Rectangle) and shape.n_hinges:
        profile, half_width = hinge_profile(shape), 0.5 * shape.width
        axes, root = hinge_axes(shape, pattern.gap, top), top + _ROOT * shape.barrel_wall
        bases = hinge_bases(shape, pattern.gap)
        for (x, _), base in zip(axes, bases, strict=True):
            rings = groove_rings(base, grooves)
            bodies.append(keyed(bar(profile, x, top, half_width), rings, floor, root))
            under_bars += rings
    every = [*under_bars, *(groove for scale in plan.scales for groove in scale.grooves)]
    substrate = solid_of("substrate", [grooved(plan.sheet, top, every, floor)])
    scales = solid_of("scales", bodies)
    return PrintableSheet(
        pattern, shape, layout, grooves, printer, plan, tuple(under_bars), substrate, scales
    )


def _scale_bodies(plan: Plan, heights: tuple[float, float, float, float]) -> list[m3.Manifold]:
    """Solids of all scales. Whole ones on one tile are copies of the first of them.

    Parameters
    ----------
    heights : of the grooves' bottom, of the base, to which ribs reach up, and of the top, mm.
    """
    floor, base, root, top = heights
    first: dict[int, m3.Manifold] = {}
    bodies = []
    for scale in plan.scales:
        if scale.shift is not None and scale.tile in first:
            bodies.append(first[scale.tile].translate((*scale.shift, 0.0)))
            continue
        bodies.append(keyed(prism(scale.outline, base, top), scale.grooves, floor, root))
        if scale.shift is not None:
            first[scale.tile] = bodies[-1]
    return bodies


def sheet_figures(sheet: PrintableSheet) -> dict[str, Any]:
    """Figures of a sheet in plain data: counts, lengths in mm, areas in mm², volumes in mm³, g.

    The mass is that of solid parts; infill makes the scales lighter.
    """
    pattern, plan, printer = sheet.pattern, sheet.plan, sheet.printer
    volumes = {solid.name: solid.volume for solid in sheet.solids}
    densities = {"substrate": printer.substrate_density, "scales": printer.scale_density}
    masses = {name: 1e-3 * volume * densities[name] for name, volume in volumes.items()}
    bounds = np.array([solid.bounds for solid in sheet.solids])
    size = bounds[:, 1].max(axis=0) - bounds[:, 0].min(axis=0)
    return {
        "scales": len(plan.scales),
        "whole_scales": plan.n_whole,
        "cut_scales": len(plan.scales) - plan.n_whole,
        "scales_without_grooves": sum(not scale.grooves for scale in plan.scales),
        "pieces_removed": plan.n_removed,
        "scales_left_out": plan.n_left_out,
        "areas_mm2": dict(sheet.areas),
        "volumes_mm3": {**volumes, "grooves": sheet.areas["grooves"] * sheet.grooves.depth},
        "masses_g": {**masses, "total": sum(masses.values())},
        "print_size_mm": [float(extent) for extent in size],
        "layers": round(float(size[2]) / printer.layer_height),
        "gap_mm": pattern.gap,
        "scale_height_mm": pattern.scale_height,
        "substrate_thickness_mm": pattern.substrate_thickness,
        "smallest_wall_of_scales_mm": sheet.smallest_wall,
        "triangles": {solid.name: len(solid.faces) for solid in sheet.solids},
        **_fixture(sheet),
    }


def _fixture(sheet: PrintableSheet) -> dict[str, Any]:
    """What is to be known for the machine that tests the sheet."""
    if isinstance(sheet.shape, Disc):
        return {"hub_hole_mm": sheet.shape.hub}
    axes = hinge_axes(sheet.shape, sheet.pattern.gap, sheet.pattern.substrate_thickness)
    if not len(axes):
        return {}
    return {
        "hinge_axes_distance_mm": float(axes[1, 0] - axes[0, 0]),
        "hinge_axes_height_mm": float(axes[0, 1]),
        "hinge_hole_mm": sheet.shape.hole,
    }
