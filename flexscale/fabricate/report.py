"""Figures of a sheet as lines for people."""

from __future__ import annotations

from flexscale.fabricate.sheet import PrintableSheet, sheet_figures


def report_lines(sheet: PrintableSheet) -> list[str]:
    """One figure a line, name and value with its unit."""
    figures, grooves, printer = sheet_figures(sheet), sheet.grooves, sheet.printer
    areas, volumes, masses = (figures[key] for key in ("areas_mm2", "volumes_mm3", "masses_g"))
    x, y, z = figures["print_size_mm"]
    rows = {
        "print size": f"{x:.4g} x {y:.4g} x {z:.4g} mm, {figures['layers']} layers",
        "scales": f"{figures['whole_scales']} whole, {figures['cut_scales']} cut; "
        f"{figures['pieces_removed']} pieces and {figures['scales_left_out']} scales left out",
        "area": f"{areas['scales']:.1f} of {areas['sheet']:.1f} mm² under scales",
        "gap": f"{figures['gap_mm']:g} mm",
        "smallest wall": f"{figures['smallest_wall_of_scales_mm']:.3g} mm of a scale",
        "grooves": "none"
        if grooves.depth == 0.0
        else f"{grooves.width:g} mm wide, {grooves.depth:g} mm deep, every {grooves.pitch:g} mm; "
        f"{figures['scales_without_grooves']} scales too small for any",
        "volume": f"{volumes['scales']:.1f} mm³ of scales, of which {volumes['grooves']:.1f} in "
        f"grooves; {volumes['substrate']:.1f} mm³ of substrate",
        "mass if solid": f"{masses['scales']:.1f} g of scales at {printer.scale_density:g} g/cm³, "
        f"{masses['substrate']:.1f} g of substrate at {printer.substrate_density:g} g/cm³",
    }
    if "hinge_axes_distance_mm" in figures:
        rows["hinges"] = (
            f"axes {figures['hinge_axes_distance_mm']:.2f} mm apart, "
            f"{figures['hinge_axes_height_mm']:.2f} mm above the bed, "
            f"holes of {figures['hinge_hole_mm']:g} mm"
        )
    width = max(map(len, rows))
    return [f"{name:<{width}}  {text}" for name, text in rows.items()]
