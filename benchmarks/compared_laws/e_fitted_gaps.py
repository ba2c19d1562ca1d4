"""Gaps fitted to tensors, without the correction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import flexscale as fs
from compared_laws import LawData

NAME = "fitted gaps"
WHAT = "gaps with turns, fitted to the tensor sweep"


def make(data: LawData) -> fs.TensorModel:
    """The tensor model without its correction."""
    model = fs.tensor_model(data.tensor_sweep, fs.gap_model(data.pattern))
    return replace(model, correction=np.zeros_like(model.correction))
