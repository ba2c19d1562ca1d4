"""What a preview of a printable sheet shows."""

from __future__ import annotations

import numpy as np
import shapely

from flexscale.arrays import FloatArray
from flexscale.fabricate.hinges import hinge_bases
from flexscale.fabricate.plan import PlannedScale
from flexscale.fabricate.shapes import Disc, Rectangle
from flexscale.fabricate.sheet import PrintableSheet, sheet_figures
from flexscale.fabricate.solids import prism, section, solid_of
from flexscale.fabricate.walls import GRID, rings_of
from flexscale.plotting.printable import PrintableBody, PrintablePicture
from flexscale.plotting.style import SCALE_COLOR, SUBSTRATE_COLOR

_SECTION_LENGTH = 32.0  # mm, at most: enough to see layers


def sheet_picture(sheet: PrintableSheet, remark: str) -> PrintablePicture:
    """Contents of the preview; `remark` says where the outlines come from."""
    plan, shape = sheet.plan, sheet.shape
    left, right = _window(sheet)
    y = _section_height(sheet, 0.5 * (left + right))
    bars = hinge_bases(shape, sheet.pattern.gap) if isinstance(shape, Rectangle) else []
    grooves = [*sheet.hinge_grooves, *(groove for scale in plan.scales for groove in scale.grooves)]
    return PrintablePicture(
        headings=_headings(sheet),
        remarks=(remark,),
        sheet=_turned(plan.sheet),
        bars=[_turned(bar)[0] for bar in bars],
        whole=[_turned(scale.outline) for scale in plan.scales if scale.whole],
        cut=[_turned(scale.outline) for scale in plan.scales if not scale.whole],
        grooves=[_turned(groove) for groove in grooves],
        bodies=_visible(sheet),
        section_y=y,
        section=(section(sheet.substrate, y), section(sheet.scales, y)),
        window=(left, right),
    )


def _turned(area: shapely.Polygon) -> list[FloatArray]:
    """Outlines (n_i, 2) of a polygon, mm: the outer one turns left, holes turn right."""
    return rings_of(shapely.orient_polygons(area))


def _headings(sheet: PrintableSheet) -> tuple[str, str]:
    figures, pattern, shape = sheet_figures(sheet), sheet.pattern, sheet.shape
    size = (
        f"disc of {shape.radius:g} mm radius"
        if isinstance(shape, Disc)
        else f"rectangle of {shape.length:g} × {shape.width:g} mm"
    )
    masses = figures["masses_g"]
    return (
        f"{pattern.name} ({pattern.family}): {size}, direction {sheet.layout.direction:g}° along x",
        f"{figures['whole_scales']} whole and {figures['cut_scales']} cut scales; "
        f"{masses['scales']:.1f} g of scales and {masses['substrate']:.1f} g of substrate if solid",
    )


def _window(sheet: PrintableSheet) -> tuple[float, float]:
    """The right end of a rectangle, with its hinge, or from the hub of a disc outward."""
    low, _, high, _ = sheet.plan.sheet.bounds
    if isinstance(sheet.shape, Disc):
        return -1.0, min(_SECTION_LENGTH, high) + 1.0
    return max(low, high - _SECTION_LENGTH) - 1.0, high + 1.0


def _section_height(sheet: PrintableSheet, x: float) -> float:
    """y of the middle of a whole scale with grooves, the nearest to (x, 0)."""

    def rank(scale: PlannedScale) -> tuple[bool, bool, float]:
        middle = scale.outline.centroid
        return not scale.whole, not scale.grooves, float(np.hypot(middle.x - x, middle.y))

    y = float(min(sheet.plan.scales, key=rank).outline.centroid.y)
    return 0.0 if abs(y) < GRID else y


def _visible(sheet: PrintableSheet) -> tuple[PrintableBody, PrintableBody]:
    """Bodies without what the other one hides: ribs, and the grooves they fill."""
    top = sheet.pattern.substrate_thickness
    plain = solid_of("substrate", [prism(sheet.plan.sheet, 0.0, top)])
    heights = sheet.scales.vertices[sheet.scales.faces][..., 2]
    ribs = heights.min(axis=1) < top - 1e-4
    return (
        PrintableBody(plain.vertices, plain.faces, _rgb(SUBSTRATE_COLOR)),
        PrintableBody(sheet.scales.vertices, sheet.scales.faces[~ribs], _rgb(SCALE_COLOR)),
    )


def _rgb(color: str) -> tuple[float, float, float]:
    red, green, blue = (int(color[k : k + 2], 16) / 255.0 for k in (1, 3, 5))
    return red, green, blue
