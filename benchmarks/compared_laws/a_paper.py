"""The paper's law."""

from __future__ import annotations

import flexscale as fs
from compared_laws import LawData

NAME = "paper"
WHAT = "two regimes a direction, 19 numbers a side, determinant penalty (Eqs. 10 to 13)"


def make(data: LawData) -> fs.MacroModel:
    """Fitted to single curvatures."""
    return fs.fit(data.sweep, data.tangent, variant="paper", weighting="absolute")
