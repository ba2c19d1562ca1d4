"""Gaps of the flat cell, softened."""

from __future__ import annotations

import flexscale as fs
from compared_laws import LawData

NAME = "softened gaps"
WHAT = "the same with two softenings fitted to single curvatures"


def make(data: LawData) -> fs.GapModel:
    """Two numbers are fitted."""
    return fs.gap_model(data.pattern, data.sweep)
