"""Curvature tensors as sheet laws take them, and uniaxial bending as tensors."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from flexscale.datasets.fit_values import FloatArray
from flexscale.datasets.variables import SIDES
from flexscale.errors import UnitRangeError, UnknownNameError, suggest
from flexscale.macro.extrapolation import warn_beyond
from flexscale.mechanics.sheet_law import SheetLaw


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
    tensors = np.asarray(curvature, dtype=float)
    if tensors.shape[-2:] != (2, 2) or not np.isfinite(tensors).all():
        raise UnitRangeError(
            "A curvature tensor is a symmetric 2 by 2 matrix of finite numbers in mm-1, not "
            f"{curvature!r}."
        )
    off = np.abs(tensors[..., 0, 1] - tensors[..., 1, 0])
    if np.any(off > 1e-9 * np.abs(tensors).max(axis=(-2, -1))):  # more than rounding
        raise UnitRangeError(f"Curvature tensors are symmetric, but {curvature!r} is not.")
    return tensors


def uniaxial_tensors(curvature: ArrayLike, direction: ArrayLike, side: str) -> FloatArray:
    """(..., 2, 2) mm-1 of bending by curvatures (mm-1, >= 0) in directions (degree), broadcast.

    Raises
    ------
    UnitRangeError, UnknownNameError : numbers out of range, no such side.
    """
    if side not in SIDES:
        raise UnknownNameError(f"There is no side {side!r}. {suggest(side, SIDES)}")
    kappa = require_curvatures(curvature) * (1.0 if side == "closing" else -1.0)
    n = unit_vectors(direction)
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
    values = np.asarray(direction, dtype=float)
    if not np.isfinite(values).all():
        raise UnitRangeError(f"Directions must be finite, in degree, not {direction!r}.")
    return values


def require_curvatures(curvature: ArrayLike) -> FloatArray:
    """Magnitudes of curvatures in mm-1, checked.

    Raises
    ------
    UnitRangeError : negative or not finite.
    """
    values = np.asarray(curvature, dtype=float)
    if not (np.isfinite(values) & (values >= 0.0)).all():
        raise UnitRangeError(
            f"Curvatures must be finite and not negative, in mm-1, not {curvature!r}; "
            "the side says to which side the sheet is bent."
        )
    return values
