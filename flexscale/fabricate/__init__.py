"""Printable solids of a pattern: sheet, scales, grooves, hinges, and the files printers read."""

from flexscale.fabricate.layout import Layout
from flexscale.fabricate.options import Grooves, Printer
from flexscale.fabricate.shapes import Disc, Rectangle
from flexscale.fabricate.sheet import PrintableSheet, printable_sheet, sheet_figures

__all__ = [
    "Disc",
    "Grooves",
    "Layout",
    "PrintableSheet",
    "Printer",
    "Rectangle",
    "printable_sheet",
    "sheet_figures",
]
