"""Figure 4 of the paper: parameters of the fit against direction, and the law in one direction."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from flexscale.plotting.figure_scripts import Need
from flexscale.plotting.fits import fit

_COMMAND = "flexscale run workflows/printed.yaml"
_PATTERN = {"family": "IH20", "pattern": "hexagon"}

NEEDS = {kind: Need(kind, _COMMAND, _PATTERN, "joints") for kind in ("fit", "sweep")}
CAPTION = (
    "The macro model fitted to scales on joints: stiffness before and after contact and contact "
    "curvature against direction, with their circular harmonics, and energy and moment in the "
    "direction of first contact, beside those of the cells (after Fig. 4 of the paper)."
)
PAPER_SAYS = (
    "Circular harmonics of a(θ), b(θ) and the contact curvature κ₀(θ) fit the parameters of single "
    "directions; the piecewise quadratic energy fits the native samples. a(θ) varies less with "
    "direction than the others."
)


def draw(inputs: Mapping[str, xr.Dataset]) -> Figure:
    """The figure; `inputs` are datasets by the names of NEEDS."""
    return fit(inputs["fit"], inputs["sweep"])


def findings(inputs: Mapping[str, xr.Dataset]) -> list[str]:
    """How far harmonics are from single directions, and the law from samples, when closing."""
    model = inputs["fit"].sel(side="closing")
    sentences = []
    for name in ("a", "b", "kappa_0"):
        one, smooth = (
            model[kind].sel(parameter=name).values for kind in ("directional_value", "fitted_value")
        )
        units = str(model["parameter_units"].sel(parameter=name).values)
        off = 100.0 * np.nanmax(np.abs(smooth / one - 1.0))
        sentences.append(
            f"{name}, closing: {np.nanmin(one):.4g} to {np.nanmax(one):.4g} {units}; harmonics are "
            f"at most {off:.2g} % off."
        )
    error = model["overall_moment_error"].sel(assessment="law", statistic="median")
    sentences.append(
        f"Moments of the law, in single directions: {100 * float(error):.2g} % off (median)."
    )
    return sentences
