"""The bending law of a model at many curvature tensors, and what its data reach."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.macro.model import MacroModel
from flexscale.mechanics.sheet_law import SheetLaw
from flexscale.sides import SIDES

if TYPE_CHECKING:
    from flexscale.macro.bending_model import BendingModel

_ROUNDING = 1e-9  # relative; curvatures that are typed and those that are computed may differ so
#: What every file of a law says, in its own kind of comment.
CONVENTIONS = (
    "W is the bending energy per area of the flat sheet in N/mm, without strain of its middle "
    "surface",
    "k_xx, k_yy, k_xy are entries of the curvature tensor in 1/mm, k_xy the entry itself, not the "
    "engineering twist 2 k_xy; k > 0 closes: concave towards the scales",
    "x and y are the pattern's axes",
)


def bending_law(model: MacroModel | BendingModel) -> SheetLaw:
    """The law of a model, whether or not its in-plane stiffness is known; without strain."""
    if isinstance(model, MacroModel) and model.in_plane is None:
        return replace(model, in_plane=np.zeros((3, 3))).sheet_law()
    return model.sheet_law()


def evaluate_bending(law: SheetLaw, curvatures: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Energies (n,) [N/mm] and gradients (n, 3) [N] at (n, 3) of (k_xx, k_yy, k_xy) [mm-1]."""
    states = np.zeros((len(curvatures), 6))
    states[:, 3:] = curvatures[:, [0, 2, 1]]
    return law.energies(states), law.gradients(states)[:, [3, 5, 4]]


def bend_all_ways(curvatures: FloatArray, directions: FloatArray) -> FloatArray:
    """(n, 3) single curvatures [mm-1, closing > 0] in directions [radian], both (n,)."""
    c, s = np.cos(directions), np.sin(directions)
    return np.stack([c * c, s * s, c * s], axis=-1) * curvatures[..., None]


def sampled_sides(model: MacroModel | BendingModel) -> tuple[str, ...]:
    """Sides to which the data of the law bend the sheet."""
    return model.sides if isinstance(model, MacroModel) else SIDES


def principal_bounds(model: MacroModel | BendingModel) -> tuple[float, float]:
    """Least and largest principal curvature [mm-1] in the data of the law."""
    sides, largest = sampled_sides(model), float(model.largest_curvature)
    return (-largest if "opening" in sides else 0.0), (largest if "closing" in sides else 0.0)


def is_within_data(model: MacroModel | BendingModel, curvatures: FloatArray) -> np.ndarray:
    """(n,) bool: whether (n, 3) tensors are within the data: both principal curvatures, or the root
    of the sum of their squares where the data are of tensors."""
    low, high = principal_bounds(model)
    slack = _ROUNDING * max(high, -low)
    mean = 0.5 * (curvatures[:, 0] + curvatures[:, 1])
    radius = np.hypot(0.5 * (curvatures[:, 0] - curvatures[:, 1]), curvatures[:, 2])
    if _is_of_tensors(model):
        return np.asarray(np.sqrt(2.0 * (mean**2 + radius**2)) <= high + slack)
    return np.asarray((mean - radius >= low - slack) & (mean + radius <= high + slack))


def data_sentence(model: MacroModel | BendingModel) -> str:
    """Up to where the law has data, for the comments of a file."""
    low, high = principal_bounds(model)
    fitted = f"principal curvatures from {low:g} to {high:g} 1/mm"
    if _is_of_tensors(model):
        fitted = (
            f"curvature tensors whose entries have a root of the sum of squares of {high:g} 1/mm"
        )
    return f"the law was fitted to {fitted}: what lies beyond is extrapolated"


def _is_of_tensors(model: MacroModel | BendingModel) -> bool:
    from flexscale.macro.tensor_model import TensorModel

    return isinstance(model, TensorModel)
