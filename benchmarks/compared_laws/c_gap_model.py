"""Gaps of the flat cell."""

from __future__ import annotations

import flexscale as fs
from compared_laws import LawData

NAME = "gap model"
WHAT = "stiffness and gaps of the flat cell on joints, no sweep"


def make(data: LawData) -> fs.GapModel:
    """From the pattern alone."""
    return fs.gap_model(data.pattern)
