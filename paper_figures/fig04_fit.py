"""Figure 4 of the paper: parameters of the fit against direction, and the law in one direction."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from flexscale.plotting.figures import Need
from flexscale.plotting.fits import fit

_COMMAND = "flexscale run workflows/quickstart.yaml"
_PATTERN = {"family": "IH20", "pattern": "hexagon"}

NEEDS = {kind: Need(kind, _COMMAND, _PATTERN) for kind in ("fit", "sweep")}
CAPTION = (
    "Stiffness before and after contact and contact curvature against direction, with their "
    "circular harmonics, and energy and moment in the direction of first contact (after Fig. 4 of "
    "the paper)."
)


def draw(inputs: Mapping[str, xr.Dataset]) -> Figure:
    """The figure; `inputs` are datasets by the names of NEEDS."""
    return fit(inputs["fit"], inputs["sweep"])
