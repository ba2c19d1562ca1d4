"""Kind `sheet`: a sheet of a macro model between end strips."""

from __future__ import annotations

from flexscale.datasets.sheet_variables import BENT, check_sheet_samples, response, steepest, strips
from flexscale.datasets.variables import Schema

SHEET = Schema(
    "sheet",
    1,
    "Rectangular sheet of a macro model, bent between two end strips",
    coordinates=strips(("curvature",), ()),
    variables=(*response(BENT), steepest(BENT)),
    check=check_sheet_samples,
)
