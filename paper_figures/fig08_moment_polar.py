"""Figure 8 of the paper: bending moment in every direction, for growing curvature, part 2.

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
PATTERNS = {"chevron": "IH64", "arrowhead": "IH69", "fish_scale": "IH68", "threefold": "IH07"}

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
    "Native-scale simulations, part 2: bending moment against bending direction when the scales "
    "close, for growing curvature, of chevrons, arrowheads, fish scales and a three-fold tile "
    "(after Fig. 8 of the paper). Rigid scales on joints every 2°; thin, the paper's shell "
    "every 15°."
)
PAPER_SAYS = (
    "(e, f) are orthotropic for small curvatures; for (f), minimum and maximum stiffness switch "
    "directions; (g) goes from quasi-isotropic to tetragonal; (h) is three-fold and isotropic for "
    "small curvatures, with peaks at 30° for larger ones."
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
