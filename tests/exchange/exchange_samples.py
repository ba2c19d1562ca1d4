"""Models and curvatures for the tests of files that are exported."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexscale.exchange.bending import bending_law
from flexscale.macro.gap_model import GapModel
from flexscale.macro.model import MacroModel
from tests.macro.law_samples import BIAXIAL, IN_PLANE, TANGENT, polar_of

LABELS = {"family": "IH01", "pattern": "4.8.8", "substrate_thickness": 0.4}


def model_of(variant: str = "tangent", **changes: Any) -> MacroModel:
    """A model of random anisotropy; opening, its scales touch in a part of the circle only."""
    fields: dict[str, Any] = {
        "polar": polar_of(variant),
        "laws": None,
        "errors": None,
        "weighting": "relative",
        "variant": variant,
        "tangent": TANGENT,
        "in_plane": IN_PLANE,
        "w_biaxial": BIAXIAL,
        "labels": LABELS,
    }
    return MacroModel(**{**fields, **changes})


def random_curvatures(n: int = 4000, size: float = 0.02) -> np.ndarray:
    """(n, 3) of (k_xx, k_yy, k_xy) mm-1, a hundred times as large to as small as contact needs,
    and some that are flat, cylinders, or equal in both directions."""
    rng = np.random.default_rng(7)
    scale = size * 10.0 ** rng.uniform(-2.0, 0.5, n)
    k = scale[:, None] * rng.standard_normal((n, 3))
    special = size * np.array([[0, 0, 0], [1, 0, 0], [0, -1, 0], [1, 1, 0], [-1, -1, 0], [0, 0, 1]])
    return np.concatenate([special, k])


def derivatives_of(
    model: MacroModel | GapModel, k: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Energies (n,), gradients (n, 3), Hessians (n, 3, 3) by (k_xx, k_yy, k_xy), by our kernels."""
    states = np.zeros((len(k), 6))
    states[:, 3:] = k[:, [0, 2, 1]]
    law, order = bending_law(model), [3, 5, 4]
    gradients, hessians = law.derivatives(states)
    return law.energies(states), gradients[:, order], hessians[:, order][:, :, order]


def touching_share(model: MacroModel, k: np.ndarray) -> float:
    """Share of curvatures at which the law has contact: its energy is not that before contact."""
    free = MacroModel(
        **{**vars(model), "polar": vars(model)["polar"].__class__(
            **{**vars(model.polar), "onset_quantity": ("none",) * len(model.sides)}
        )}
    )  # fmt: skip
    return float(np.mean(derivatives_of(model, k)[0] != derivatives_of(free, k)[0]))
