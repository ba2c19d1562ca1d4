"""Kind `native_turned_sheet`: sheets of scales, with the pattern turned on them."""

from __future__ import annotations

from flexscale.datasets.sheet_variables import (
    TURNED,
    check_turned,
    count,
    number,
    response,
    strips,
)
from flexscale.datasets.variables import Schema

NATIVE_TURNED_SHEET = Schema(
    "native_turned_sheet",
    1,
    "Rectangular sheets of scales between end strips, with the pattern turned on them",
    coordinates=strips((), ("direction",)),
    variables=(
        *response(TURNED),
        number("min_gap", TURNED, "mm", "smallest distance between scales"),
        count("contact_pairs", TURNED, "active contact pairs"),
        count("outside_range", TURNED, "stations of joints beyond the range of their law"),
        count("n_scales", ("direction",), "scales, cut ones included"),
        count("n_unknowns", ("direction",), "unknowns of the model"),
    ),
    check=check_turned,
)
