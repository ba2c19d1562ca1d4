"""Kind `native_sheet`: a sheet of scales between end strips."""

from __future__ import annotations

from flexscale.datasets.sheet_variables import (
    BENT,
    SIZES,
    check_sheet_samples,
    count,
    number,
    response,
    strips,
)
from flexscale.datasets.variables import Schema

NATIVE_SHEET = Schema(
    "native_sheet",
    2,
    "Sheet of whole and cut scales, bent between two end strips",
    coordinates=strips(("curvature",), ()),
    variables=(
        *response(BENT),
        number("min_gap", BENT, "mm", "smallest distance between scales"),
        count("contact_pairs", BENT, "active contact pairs"),
        count("outside_range", BENT, "stations of joints beyond the range of their law"),
        *SIZES,
    ),
    check=check_sheet_samples,
)
