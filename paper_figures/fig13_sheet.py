"""Figure 13 of the paper: a large sheet, native against macro."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from flexscale.plotting.figure_scripts import Need
from flexscale.plotting.sheets import compared_sheets

_WHERE = {"family": "IH64", "pattern": "chevron"}

NEEDS = {
    kind: Need(kind, "flexscale run workflows/printed.yaml", _WHERE, "joints")
    for kind in ("sheet", "native_sheet")
}
CAPTION = (
    "A sheet of 100 mm × 50 mm with chevrons, bent between end strips along 0°: energy density of "
    "scales on joints (native) and of the macro model fitted to their cells (after Fig. 13 of the "
    "paper)."
)
PAPER_SAYS = (
    "The macro model closely tracks the energy of the native model for low curvatures and slightly "
    "overestimates it for larger ones; 14.1 s against 659.8 s on 24 cores."
)
SIDE = "closing"


def draw(inputs: Mapping[str, xr.Dataset]) -> Figure:
    """Energy density against curvature; `inputs` are datasets by the names of NEEDS."""
    return compared_sheets(inputs["native_sheet"], inputs["sheet"], SIDE)


def findings(inputs: Mapping[str, xr.Dataset]) -> list[str]:
    """The macro model's energy over the native one's, sample by sample."""
    native = inputs["native_sheet"]["energy_density"].sel(side=SIDE)
    macro = inputs["sheet"]["energy_density"].sel(side=SIDE)
    both, other = xr.align(native, macro, join="inner")
    kept = np.isfinite(both) & np.isfinite(other) & (both["curvature"] > 0.0)
    ratios = (other / both)[kept]
    pairs = zip(ratios["curvature"].values, ratios.values, strict=True)
    shown = ", ".join(f"{ratio:.3g} at {kappa:g} mm-1" for kappa, ratio in pairs)
    facts = inputs["native_sheet"]
    return [
        f"Macro over native energy: {shown}.",
        f"The native sheet has {int(facts['n_scales'])} scales on joints and "
        f"{int(facts['n_unknowns']):,} unknowns.",
    ]
