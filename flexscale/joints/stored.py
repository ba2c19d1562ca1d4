"""The law of a joint that is stored as a dataset."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexscale.mechanics.joint_law import JointLaw

if TYPE_CHECKING:
    import xarray as xr


def law_of_dataset(joint: xr.Dataset) -> JointLaw:
    """Law of a dataset of kind joint, for the sheet that it is labelled with."""
    thickness = float(joint["substrate_thickness"])
    bounds = np.column_stack([joint["lowest"].values, joint["highest"].values])
    bounds[:3] *= thickness
    names = ("touching_slope", "below_touching", "above_touching", "before_touching")
    slope, below, above, before = (thickness * float(joint[name]) for name in names)
    errors = np.concatenate([[float(joint["energy_error"])], joint["force_error"].values])
    return JointLaw(
        exponents=joint["exponents"].transpose("term", "pose").values.astype(np.int64),
        coefficients=joint["coefficients"].values,
        thickness=thickness,
        modulus=float(joint["substrate_young_modulus"]),
        bounds=bounds,
        band=(slope, below, above, before),
        errors=errors,
    )
