"""Synthetic sweeps of a known two-regime law, for the tests of the fit."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import xarray as xr

from flexscale.datasets.fit_values import two_regime_energy, two_regime_moment
from flexscale.datasets.kinds.sweep import build_sweep_dataset
from flexscale.homogenize.tangent import TangentStiffness
from flexscale.macro.fit import fit
from flexscale.macro.model import MacroModel
from flexscale.macro.uniaxial import Weighting

Function = Callable[[np.ndarray], np.ndarray]
DIRECTIONS = np.arange(0.0, 180.0, 15.0)
CURVATURES = np.linspace(0.0, 0.02, 11)


def a_of(directions: np.ndarray) -> np.ndarray:
    angle = np.deg2rad(directions)
    return 60.0 + 20.0 * np.cos(2.0 * angle) + 8.0 * np.sin(4.0 * angle)


def b_of(directions: np.ndarray) -> np.ndarray:
    angle = np.deg2rad(directions)
    return 400.0 + 90.0 * np.cos(4.0 * angle) - 40.0 * np.sin(6.0 * angle)


def kappa_0_of(directions: np.ndarray) -> np.ndarray:
    angle = np.deg2rad(directions)
    return 0.0102 + 0.0015 * np.cos(6.0 * angle) + 0.0008 * np.sin(2.0 * angle)


def tangent() -> TangentStiffness:
    """A flat cell whose stiffness is `a_of`, with strong coupling and some in-plane stiffness."""
    # a's five numbers fix C but for the share of C_xyxy in what C_xxyy and C_xyxy make together.
    matrix = np.array([[80.0, -20.0, 8.0], [-20.0, 40.0, -8.0], [8.0, -8.0, 40.0]])
    return TangentStiffness(matrix, np.diag([300.0, 250.0, 60.0]) + 30.0)


def fit_law(sweep: xr.Dataset, weighting: Weighting = "relative") -> MacroModel:
    """Fit of all parameters, a among them, to a sweep that says nothing of its cell."""
    return fit(sweep, variant="paper", weighting=weighting)


def no_contact(directions: np.ndarray) -> np.ndarray:
    return np.full(np.shape(directions), np.nan)


def law_sweep(
    *,
    directions: np.ndarray = DIRECTIONS,
    curvatures: np.ndarray = CURVATURES,
    closing: Function = kappa_0_of,
    opening: Function | None = no_contact,
    before: Function = a_of,
    beyond: Function = b_of,
    noise: float = 0.0,
    touches: bool = False,
    softening: float = 0.0,
    config: Mapping[str, Any] | None = None,
) -> xr.Dataset:
    """Sweep of a and b (a_of, b_of if not given) and onsets by side.

    closing, opening : nan for no contact; opening None leaves it out. noise : relative, on energy
    and moment. touches : store contact pairs beyond the onset. config : what the sweep says of its
    making, too little to make its cell if not given.
    """
    onsets = {"closing": closing} | ({"opening": opening} if opening else {})
    table = np.stack([onset(directions) for onset in onsets.values()])[..., None]
    a, b = before(directions)[:, None], beyond(directions)[:, None]
    shape = (len(onsets), len(directions), len(curvatures))
    scatter = 1.0 + noise * np.random.default_rng(5).standard_normal((2, *shape))
    energy = two_regime_energy(curvatures, a, b, table, softening) * scatter[0]
    arrays = {
        "energy_density": energy,
        "energy_density_membrane": 0.0 * energy,
        "energy_density_bending": energy,
        "energy_density_scales": 0.0 * energy,
        "moment": two_regime_moment(curvatures, a, b, table, softening) * scatter[1],
        "stretch": np.ones((*shape, 3)),
        "newton_iterations": np.full(shape, 3),
        "negative_eigenvalues": np.zeros(shape, dtype=int),
        "residual_norm": np.zeros(shape),
        "mean_offset": np.zeros(shape),
        "status": np.zeros(shape, dtype=int),
    }
    if touches:
        arrays["contact_pairs"] = np.where(curvatures > np.nan_to_num(table, nan=1.0), 7, 0)
        arrays["min_gap"] = np.full(shape, 0.1)
    return build_sweep_dataset(
        list(onsets),
        directions,
        curvatures,
        arrays,
        scalars={"family": "IH20", "pattern": "hexagon", "gap": 0.4, "tile_area": 100.0},
        config={"pattern": {"gap": 0.4}} if config is None else config,
    )


def without(sweep: xr.Dataset, *, side: int, direction: int, curvature: int) -> xr.Dataset:
    """Copy in which one sample did not converge."""
    copy = sweep.copy(deep=True)
    for variable in copy.data_vars.values():
        if variable.dims[:3] == ("side", "direction", "curvature") and variable.dtype.kind == "f":
            variable.values[side, direction, curvature] = np.nan
    copy["status"].values[side, direction, curvature] = 1
    return copy
