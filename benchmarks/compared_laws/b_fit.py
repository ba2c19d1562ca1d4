"""The default fit."""

from __future__ import annotations

import flexscale as fs
from compared_laws import LawData

NAME = "fit"
WHAT = "the same on the tangent of the flat cell, relative errors"


def make(data: LawData) -> fs.MacroModel:
    """Fitted to single curvatures."""
    return fs.fit(data.sweep, data.tangent)
