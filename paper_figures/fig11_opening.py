"""Figure 11 of the paper: stiffening when opening."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from flexscale.findings.measures import stiffening
from flexscale.plotting.both_sides import both_sides
from flexscale.plotting.figure_scripts import Need

_WHERE = {"family": "IH69", "pattern": "arrowhead"}

NEEDS = {
    kind: Need(kind, "flexscale run workflows/printed.yaml", _WHERE, "joints")
    for kind in ("sweep", "shape")
}
CAPTION = (
    "Scales on joints that interlock when the sheet opens: moment against curvature in two "
    "directions, and the bent cells (after Fig. 11c of the paper; its linear stage is in datasets "
    "of kind native_rig, of scales on joints, and rig, of macro models)."
)
PAPER_SAYS = (
    "Opening curvatures can likewise lead to contact and stiffening, with non-convex, interlocking "
    "scales. It is highly direction-dependent and only occurs for non-convex scale shapes."
)
DIRECTION = 90.0


def draw(inputs: Mapping[str, xr.Dataset]) -> Figure:
    """The figure; `inputs` are datasets by the names of NEEDS."""
    return both_sides(inputs["sweep"], inputs["shape"], (0.0, DIRECTION), "opening")


def findings(inputs: Mapping[str, xr.Dataset]) -> list[str]:
    """In which directions opening stiffens, and how much in that of the figure."""
    lines = stiffening(inputs["sweep"], "opening")
    touching = sum(item.touches for item in lines)
    stiffer = [item for item in lines if item.gain > 1.0]
    (shown,) = (item for item in lines if item.direction == DIRECTION)
    listed = ", ".join(f"{item.direction:g}° (x{item.gain:.2g})" for item in stiffer) or "none"
    return [
        f"Opening, scales touch in {touching} of {len(lines)} directions; the slope grows by "
        f"contact in: {listed}.",
        f"At {DIRECTION:g}° it grows to {shown.gain:.3g} times that just before contact.",
        "Whether only non-convex scales do so is told by flexscale data findings.",
    ]
