"""The tensor model."""

from __future__ import annotations

import flexscale as fs
from compared_laws import LawData

NAME = "tensor model"
WHAT = "the same, times a smooth correction"


def make(data: LawData) -> fs.TensorModel:
    """Fitted to the tensor sweep."""
    return fs.tensor_model(data.tensor_sweep, fs.gap_model(data.pattern))
