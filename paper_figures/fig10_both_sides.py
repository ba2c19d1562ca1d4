"""Figure 10 of the paper: asymmetric bending resistance."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from flexscale.findings.measures import stiffening
from flexscale.plotting.both_sides import both_sides
from flexscale.plotting.figure_scripts import Need

_WHERE = {"family": "IH20", "pattern": "hexagon"}

NEEDS = {
    kind: Need(kind, "flexscale run workflows/printed.yaml", _WHERE, "joints")
    for kind in ("sweep", "shape")
}
CAPTION = (
    "Asymmetric bending resistance of scales on joints: moment against curvature, closing and "
    "opening, and the bent cells (after Fig. 10c of the paper; its linear stage is in datasets of "
    "kind native_rig, of scales on joints, and rig, of macro models)."
)
PAPER_SAYS = (
    "Stiffness for opening curvatures is very low and stays roughly constant beyond the initial "
    "range. Closing coincides with opening at first; once scales make contact it stiffens "
    "significantly: bi-phasic."
)
DIRECTION = 90.0


def draw(inputs: Mapping[str, xr.Dataset]) -> Figure:
    """The figure; `inputs` are datasets by the names of NEEDS."""
    return both_sides(inputs["sweep"], inputs["shape"], DIRECTION)


def findings(inputs: Mapping[str, xr.Dataset]) -> list[str]:
    """Before contact both sides, then each side's slope."""
    sweep = inputs["sweep"]
    line = sweep.sel(direction=DIRECTION)
    touching = (line["contact_pairs"].sel(side="closing") > 0).values
    free = line.isel(curvature=~touching & (sweep["curvature"].values > 0.0))
    ratio = (free["moment"].sel(side="closing") / free["moment"].sel(side="opening")).values
    slopes = line["moment"].differentiate("curvature").sel(side="opening").values
    (closing,) = (item for item in stiffening(sweep, "closing") if item.direction == DIRECTION)
    return [
        f"At {DIRECTION:g}°, up to the last sample free of contact "
        f"({float(free['curvature'].max()):g} mm-1), closing moments are {ratio.min():.3g} to "
        f"{ratio.max():.3g} times opening ones.",
        f"In contact the slope grows to {closing.gain:.3g} times that just before.",
        f"Opening, the slope falls from {slopes[0]:.3g} N mm to {slopes[-1]:.2g} N mm at "
        f"{float(sweep['curvature'].max()):g} mm-1.",
    ]
