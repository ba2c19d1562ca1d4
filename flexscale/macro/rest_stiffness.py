"""Stiffness of the flat cell that a sweep was made with: given, or computed from its recipe."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.datasets.given import read_config
from flexscale.datasets.kinds.tangent import TANGENT
from flexscale.errors import BadInputError, SchemaError
from flexscale.homogenize.native_model import NAME, NativeModel
from flexscale.macro.harmonics import Harmonics
from flexscale.macro.samples import Samples
from flexscale.units import require_array

if TYPE_CHECKING:
    import xarray as xr

    from flexscale.homogenize.tangent import TangentStiffness

log = logging.getLogger(__name__)

#: How far the first moments of a sweep may be from the tangent's, before both belong to different
#: cells; contact and large bends move them by a few percent.
_MOST_DEPARTURE = 1.3


def read_rest_stiffness(tangent: TangentStiffness | xr.Dataset) -> tuple[FloatArray, FloatArray]:
    """C (3, 3) N mm and in-plane A (3, 3) N mm-1, both checked.

    Raises
    ------
    SchemaError : a dataset of another kind.
    BadInputError : not finite, or not positive definite: the flat cell is not stable.
    """
    names = ("matrix", "in_plane")  # of a dataset as of a TangentStiffness
    missing = [name for name in names if not hasattr(tangent, name)]
    if missing:
        raise SchemaError(
            f"The tangent has no {', '.join(missing)}: give a dataset of kind "
            f"{TANGENT.name}, or what fs.tangent_stiffness returns."
        )
    found = [require_array(getattr(tangent, name), f"tangent {name}", "1") for name in names]
    for values, name in zip(found, names, strict=True):
        if values.shape != (3, 3):
            raise SchemaError(f"The {name} of the tangent has shape {values.shape}, not (3, 3).")
    for values, name, units in zip(found, ("bending", "in-plane"), ("N mm", "N mm-1"), strict=True):
        least = np.linalg.eigvalsh(values).min() if np.isfinite(values).all() else np.nan
        if not least > 0.0:
            raise BadInputError(
                f"The {name} stiffness of the flat cell is not positive (least eigenvalue "
                f"{least:.3g} {units}): compute it anew with fs.tangent_stiffness."
            )
    return found[0], found[1]


def tangent_of_sweep(sweep: xr.Dataset) -> TangentStiffness | None:
    """Stiffness of the flat cell of a sweep, in seconds; None where its recipe names no pattern, or
    joints that are not those of the pattern."""
    config = read_config(sweep)
    if not {"pattern", NAME} <= config.keys():
        return None
    # Meshing needs system libraries, which a fit that is given its tangent can do without.
    from flexscale.homogenize.tangent import tangent_stiffness
    from flexscale.patterns import Pattern

    log.info("fit computes the stiffness of the flat cell from the sweep's recipe")
    pattern = Pattern.from_config(config["pattern"])
    native = NativeModel.from_config(config)
    if native.name == "joints" and "joint_law" in config:
        from flexscale.joints.library import joint_laws
        from flexscale.mechanics.stacked_laws import digest_of

        if digest_of(joint_laws(pattern)) != config["joint_law"]:
            return None  # of a groove, or of the user's own law
    return tangent_stiffness(pattern, model=native)


def require_same_cell(stiffness: Harmonics, samples: Samples) -> None:
    """Refuse a tangent of another cell than the sweep's: their first moments disagree.

    Raises
    ------
    BadInputError : with the numbers.
    """
    expected = stiffness(samples.directions)[:, None] * samples.curvatures
    with np.errstate(invalid="ignore"):
        ratio = np.where(samples.used, samples.moment / expected, np.nan)
    sampled = samples.used.any(axis=2)
    first = np.take_along_axis(ratio, samples.used.argmax(axis=2)[..., None], axis=2)[..., 0]
    middle = float(np.median(first[sampled]))
    if not 1.0 / _MOST_DEPARTURE < middle < _MOST_DEPARTURE:
        raise BadInputError(
            f"At the first curvature the sweep's moments are {middle:.3g} times those of the "
            "tangent (median over directions): they belong to different patterns, meshes or "
            "materials. Give the tangent of the sweep's own cell, or leave it out."
        )
