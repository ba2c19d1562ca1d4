"""Figure 9 of the paper: force around the mandrel, simulated where the paper measured it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
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

_KINDS = {
    "native_rig": ("flexscale run workflows/printed_rigs.yaml", "joints"),
    "rig": ("flexscale run workflows/paper.yaml", "shell"),
}

NEEDS = {
    f"{pattern}_{kind}": Need(kind, command, {"family": family, "pattern": pattern}, native)
    for pattern, family in PATTERNS.items()
    for kind, (command, native) in _KINDS.items()
}
CAPTION = (
    "Discs of 100 mm radius on the mandrel, pushed by 15 mm: force against the angle, closing, of "
    "scales on joints every 5° and, thin, of the macro model fitted to the shell (after Figs. 6 "
    "and 9 of the paper, which measured it on prints)."
)
PAPER_SAYS = (
    "Measured forces are in good qualitative agreement with the moments simulated behind contact; "
    "those of the three-fold pattern are not symmetric under half a turn, since the mandrel holds "
    "all scales next to the center."
)
SIDE = "closing"


def draw(inputs: Mapping[str, xr.Dataset]) -> Figure:
    """One panel a pattern; `inputs` are datasets by the names of NEEDS."""
    both = [(inputs[f"{p}_native_rig"], inputs[f"{p}_rig"]) for p in PATTERNS]
    return mandrels(both, SIDE)


def findings(inputs: Mapping[str, xr.Dataset]) -> list[str]:
    """How forces vary around the disc, and where they are largest."""
    lines = []
    for pattern in PATTERNS:
        for kind, what in (("native_rig", "scales on joints"), ("rig", "macro model of the shell")):
            force = inputs[f"{pattern}_{kind}"]["mandrel_force"].sel(side=SIDE)
            ratio = float(force.max() / force.min())
            at = float(force["angle"][int(np.nanargmax(force.values))])
            turned = force.values / np.roll(force.values, len(force) // 2) - 1.0
            lines.append(
                f"{pattern}, {what}: {float(force.min()):.3g} to {float(force.max()):.3g} N, ratio "
                f"{ratio:.3g}, largest at {at:g}°; half a turn changes it by up to "
                f"{100.0 * np.nanmax(np.abs(turned)):.2g} %."
            )
    return lines
