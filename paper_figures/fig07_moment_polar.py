"""Figure 7 of the paper: bending moment in every direction, for growing curvature, part 1.

The paper does not say which members of the tiling families its patterns are: ours have the
symmetry and kind of shape that it tells of.
"""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from flexscale.findings.sentences import variation_sentence
from flexscale.plotting.figure_scripts import Need
from flexscale.plotting.moment_grid import moment_grid

_SHELL = "flexscale run workflows/named_patterns.yaml"
_PRINTED = "flexscale run workflows/printed.yaml"
PATTERNS = {"hexagon": "IH20", "square": "IH76", "brick": "IH17", "rhombus": "IH74"}

NEEDS = {
    **{
        f"{pattern}_{kind}": Need(kind, _SHELL, {"family": family, "pattern": pattern}, "shell")
        for pattern, family in PATTERNS.items()
        for kind in ("cell", "sweep")
    },
    **{
        f"{pattern}_printed": Need(
            "sweep", _PRINTED, {"family": family, "pattern": pattern}, "joints"
        )
        for pattern, family in PATTERNS.items()
    },
}
CAPTION = (
    "Native-scale simulations, part 1: bending moment against bending direction when the scales "
    "close, for growing curvature, of hexagons, squares, bricks and rhombi (after Fig. 7 of the "
    "paper). Rigid scales on joints every 2°; thin, the paper's shell every 15°."
)
PAPER_SAYS = (
    "(a) is isotropic for small curvatures and gets lobes for larger ones; (b) is tetragonal, and "
    "its principal axes turn by 45°; (c, d) are orthotropic. All patterns stiffen significantly "
    "in the contact regime."
)
SIDE = "closing"


def draw(inputs: Mapping[str, xr.Dataset]) -> Figure:
    """Grid of panels, one row per pattern; `inputs` are datasets by the names of NEEDS."""
    return moment_grid(
        [(inputs[f"{p}_cell"], inputs[f"{p}_printed"], inputs[f"{p}_sweep"]) for p in PATTERNS],
        SIDE,
    )


def findings(inputs: Mapping[str, xr.Dataset]) -> list[str]:
    """How moments vary at the smallest and at the largest curvature."""
    models = {"joints": "printed", "shell": "sweep"}
    return [
        f"{model}, {variation_sentence(p, inputs[f'{p}_{kind}'], SIDE)}"
        for p in PATTERNS
        for model, kind in models.items()
    ]
