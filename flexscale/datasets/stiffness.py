"""Stiffness matrices of a flat cell: what several kinds hold of them, and whether they can be."""

from __future__ import annotations

import numpy as np

from flexscale.datasets.variables import Variable
from flexscale.errors import SchemaError

VOIGT = (
    Variable("component", ("component",), "text", "", "curvature or strain xx, yy, 2xy"),
    Variable(
        "other_component", ("other_component",), "text", "", "curvature or strain xx, yy, 2xy"
    ),
)
BENDING = "stiffness C: energy density 1/2 k C k with k = (kxx, kyy, 2 kxy)"
IN_PLANE = "in-plane stiffness A: energy density 1/2 E A E with E = (Exx, Eyy, 2 Exy)"


def matrix(name: str, units: str, long_name: str) -> Variable:
    return Variable(name, ("component", "other_component"), "float64", units, long_name)


def directional_stiffness(matrix: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """(n,) N mm: k C k for unit curvature in each direction (degree), k = (c², s², 2 c s)."""
    cosine, sine = np.cos(np.deg2rad(directions)), np.sin(np.deg2rad(directions))
    bending = np.stack([cosine**2, sine**2, 2.0 * cosine * sine])
    return np.einsum("in,ij,jn->n", bending, matrix, bending)


def check_stiffness(matrix: np.ndarray, name: str) -> None:
    """SchemaError unless a matrix is one of a stiffness."""
    if matrix.shape != (3, 3) or not np.isfinite(matrix).all():
        raise SchemaError(f"The stiffness {name} must be 3 by 3 and finite.")
    if np.abs(matrix - matrix.T).max() > 1e-6 * np.abs(matrix).max():
        raise SchemaError(f"The stiffness {name} must be symmetric.")
