"""Datasets of whole sheets, from plain arrays: sheets between strips, and testing devices."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from flexscale.datasets.build import build_dataset
from flexscale.datasets.identity import Recipe


def build_sheet_dataset(
    sides: Sequence[str],
    curvatures: ArrayLike,
    arrays: Mapping[str, ArrayLike],
    *,
    length: float,
    width: float,
    direction: float,
    scalars: Mapping[str, float | str],
    config: Mapping[str, Any],
    recipe: Recipe | None = None,
    kind: str = "sheet",
) -> xr.Dataset:
    """Dataset of kind sheet, or native_sheet.

    Parameters
    ----------
    sides : of "closing", "opening".
    curvatures : (n,) mm-1, non-negative, increasing.
    arrays : (n_sides, n) variables by the names of the schema, and numbers; real values become nan
        wherever `status` is not 0.
    length, width : mm.
    direction : degree, of the length in the pattern's coordinates.
    scalars, config, recipe : as in `build_sweep_dataset`.
    """
    values = {
        **arrays,
        **_sided(sides, curvatures),
        "length": length,
        "width": width,
        "direction": direction,
    }
    return build_dataset(kind, values, scalars=scalars, config=config, recipe=recipe)


def build_turned_sheet_dataset(
    variants: Sequence[str],
    sides: Sequence[str],
    directions: ArrayLike,
    arrays: Mapping[str, ArrayLike],
    *,
    curvature: float,
    length: float,
    width: float,
    scalars: Mapping[str, float | str],
    config: Mapping[str, Any],
    recipe: Recipe | None = None,
) -> xr.Dataset:
    """Dataset of kind turned_sheet.

    Parameters
    ----------
    variants : energies of a curvature tensor, of `variables.VARIANTS`.
    sides : of "closing", "opening".
    directions : (n,) degree, increasing, of the lengths in the pattern's coordinates.
    arrays : (n_variants, n_sides, n) variables by the names of the schema; real values become nan
        wherever `status` is not 0.
    curvature : mm-1, positive.
    length, width : mm.
    scalars, config, recipe : as in `build_sweep_dataset`.
    """
    values = {
        **arrays,
        **_sided(sides, curvature),
        "variant": list(variants),
        "direction": np.asarray(directions, dtype=float),
        "length": length,
        "width": width,
    }
    return build_dataset("turned_sheet", values, scalars=scalars, config=config, recipe=recipe)


def _sided(sides: Sequence[str], curvature: ArrayLike) -> dict[str, Any]:
    """Sides and curvatures (mm-1, one or several), and what follows from them."""
    kappa = np.asarray(curvature, dtype=float)
    signs = np.array([1 if side == "closing" else -1 for side in sides], dtype=np.int8)
    return {
        "side": list(sides),
        "curvature": kappa,
        "side_sign": signs,
        "signed_curvature": np.multiply.outer(signs, kappa),
    }


def build_rig_dataset(
    sides: Sequence[str],
    devices: Mapping[str, Mapping[str, ArrayLike]],
    *,
    scalars: Mapping[str, float | str],
    config: Mapping[str, Any],
    recipe: Recipe | None = None,
    kind: str = "rig",
    numbers: Mapping[str, int] | None = None,
) -> xr.Dataset:
    """Dataset of kind rig, or native_rig.

    Parameters
    ----------
    sides : of "closing", "opening".
    devices : of "mandrel" and "stage" one or both; each with its axis ("angle" in degree, or
        "shortening" in mm, increasing), and its sizes and variables by the names of the schema
        without the device's. Variables are (n_sides, n_axis).
    numbers : of no device, by the names of the schema.
    scalars, config, recipe : as in `build_sweep_dataset`.
    """
    values: dict[str, Any] = {"side": list(sides), **(numbers or {})}
    for device, arrays in devices.items():
        for name, value in arrays.items():
            own = name in ("angle", "shortening")
            values[name if own else f"{device}_{name}"] = value
    return build_dataset(kind, values, scalars=scalars, config=config, recipe=recipe)
