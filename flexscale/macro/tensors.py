"""Curvature tensors as sheet laws take them, and uniaxial bending as tensors."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from flexscale.arrays import FloatArray
from flexscale.errors import UnitRangeError, shown
from flexscale.mechanics.extrapolation import warn_beyond
from flexscale.mechanics.sheet_law import SheetLaw
from flexscale.sides import side_sign
from flexscale.units import LENGTHS, require_array


def evaluate_tensors(curvature: ArrayLike, law: SheetLaw) -> tuple[FloatArray, FloatArray]:
    """Energies (...) [N mm-1] and moments (..., 2, 2) [N] of curvature tensors (..., 2, 2) in mm-1,
    without strain.

    Raises
    ------
    UnitRangeError : not symmetric 2 by 2 matrices of finite numbers.
    """
    tensors = require_tensors(curvature)
    states = np.zeros((tensors.size // 4, 6))
    states[:, 3:] = tensors.reshape(-1, 4)[:, [0, 1, 3]]
    energies = law.energies(states)
    # The derivative by b12 counts both off-diagonals.
    moments = law.gradients(states)[:, [3, 4, 4, 5]] * [1.0, 0.5, 0.5, 1.0]
    return energies.reshape(tensors.shape[:-2]), moments.reshape(tensors.shape)


def warn_beyond_tensors(curvature: ArrayLike, limit: float) -> None:
    """One warning if a principal curvature of tensors (..., 2, 2) is beyond `limit`, in mm-1.

    Raises
    ------
    UnitRangeError : not symmetric 2 by 2 matrices of finite numbers.
    """
    principal = np.abs(np.linalg.eigvalsh(require_tensors(curvature)))
    warn_beyond("Curvature tensors are asked for up", principal, limit)


def require_tensors(curvature: ArrayLike) -> FloatArray:
    """Curvature tensors (..., 2, 2) in mm-1, checked.

    Raises
    ------
    UnitRangeError : not symmetric 2 by 2 matrices of finite numbers.
    """
    tensors = require_array(curvature, "curvature tensors", "mm-1")
    _require_moderate(tensors)
    if tensors.shape[-2:] != (2, 2):
        raise UnitRangeError(
            "A curvature tensor is a symmetric 2 by 2 matrix of finite numbers in mm-1, not "
            f"{shown(curvature)}."
        )
    off = np.abs(tensors[..., 0, 1] - tensors[..., 1, 0])
    if tensors.size and np.any(
        off > 1e-9 * np.abs(tensors).max(axis=(-2, -1))
    ):  # more than rounding
        raise UnitRangeError(f"Curvature tensors are symmetric, but {shown(curvature)} is not.")
    return tensors


def uniaxial_tensors(curvature: ArrayLike, direction: ArrayLike, side: str) -> FloatArray:
    """(..., 2, 2) mm-1 of bending by curvatures (mm-1, >= 0) in directions (degree), broadcast.

    Raises
    ------
    UnitRangeError, UnknownNameError : numbers out of range, no such side.
    """
    sign = side_sign(side)
    kappa = sign * require_curvatures(curvature)
    n = unit_vectors(direction)
    require_same_shape(kappa, n[..., 0])
    return np.asarray(kappa)[..., None, None] * n[..., :, None] * n[..., None, :]


def unit_vectors(direction: ArrayLike) -> FloatArray:
    """(..., 2) of directions in degree."""
    angle = np.radians(require_directions(direction))
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def require_directions(direction: ArrayLike) -> FloatArray:
    """Directions in degree, checked.

    Raises
    ------
    UnitRangeError : not finite.
    """
    return require_array(direction, "directions", "degree")


def require_curvatures(curvature: ArrayLike) -> FloatArray:
    """Magnitudes of curvatures in mm-1, checked.

    Raises
    ------
    UnitRangeError : negative or not finite.
    """
    values = require_array(curvature, "curvatures", "mm-1")
    if (values < 0.0).any():
        raise UnitRangeError(
            f"Curvatures are not negative, in mm-1, but {shown(curvature)} are: the side says to "
            "which side the sheet is bent."
        )
    _require_moderate(values)
    return values


def require_same_shape(curvature: FloatArray, direction: FloatArray) -> None:
    """Refuse arrays of curvatures and directions that do not broadcast against each other."""
    try:
        np.broadcast_shapes(curvature.shape, direction.shape)
    except ValueError:
        raise UnitRangeError(
            f"Curvatures of shape {curvature.shape} and directions of shape {direction.shape} do "
            "not go together: give one of them, as many of both, or columns and rows."
        ) from None


def _require_moderate(curvatures: FloatArray) -> None:
    largest = float(np.abs(curvatures).max(initial=0.0))
    if largest > 1.0 / LENGTHS[0]:
        raise UnitRangeError(
            f"A curvature of {largest:.6g} mm-1 has a radius below {LENGTHS[0]:g} mm, to which no "
            "sheet can be bent."
        )
