"""Figure 9 of the paper: force around the mandrel, simulated where the paper measured it."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from flexscale.plotting.figure_scripts import Need
from flexscale.plotting.rigs import mandrels

PATTERNS = {
    "hexagon": "IH20",
    "square": "IH76",
    "pinwheel4": "IH62",
    "chevron": "IH64",
    "arrowhead": "IH69",
    "threefold": "IH07",
}

NEEDS = {
    pattern: Need("rig", "flexscale run workflows/paper.yaml", {"family": f, "pattern": pattern})
    for pattern, f in PATTERNS.items()
}
CAPTION = (
    "Discs of 100 mm radius on the mandrel, pushed by 15 mm: force against the angle, closing, of "
    "the macro model (after Figs. 6 and 9 of the paper, which measured it on prints)."
)
PAPER_SAYS = (
    "Measured forces are in good qualitative agreement with the moments simulated behind contact; "
    "those of the three-fold pattern are not symmetric under half a turn, since the mandrel holds "
    "all scales next to the center."
)
SIDE = "closing"


def draw(inputs: Mapping[str, xr.Dataset]) -> Figure:
    """One panel a pattern; `inputs` are datasets by the names of NEEDS."""
    return mandrels([inputs[pattern] for pattern in PATTERNS], SIDE)


def findings(inputs: Mapping[str, xr.Dataset]) -> list[str]:
    """How forces vary around the disc, and where they are largest."""
    lines = []
    for pattern in PATTERNS:
        force = inputs[pattern]["mandrel_force"].sel(side=SIDE)
        half = force.where(force["angle"] < 180.0, drop=True)
        ratio = float(half.max() / half.min())
        at = float(half["angle"][int(half.values.argmax())])
        lines.append(
            f"{pattern}: {float(half.min()):.3g} to {float(half.max()):.3g} N, ratio {ratio:.3g}, "
            f"largest at {at:g}°."
        )
    return lines
