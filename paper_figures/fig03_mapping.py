"""Figure 3 of the paper: from curvilinear space to the world, before and after optimization."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from flexscale.plotting.figure_scripts import Need
from flexscale.plotting.mapping import mapping, scale_strain

NEEDS = {
    "shape": Need(
        "shape",
        "flexscale run workflows/paper_shapes.yaml",
        {"family": "IH20", "pattern": "hexagon"},
        "shell",
    )
}
CAPTION = (
    "A flat cell of the paper's shell mapped to the world has curved scales (top); coordinates "
    "that minimize the energy in the world give straight ones (bottom; after Fig. 3 of the paper)."
)
PAPER_SAYS = (
    "A planar initial state leads to curved scales and high elastic energy in world space; "
    "curvilinear coordinates are optimized such as to minimize the energy when mapped to world "
    "space."
)
SAMPLE = 0


def draw(inputs: Mapping[str, xr.Dataset]) -> Figure:
    """The figure; `inputs` are datasets by the names of NEEDS."""
    return mapping(inputs["shape"], SAMPLE)


def findings(inputs: Mapping[str, xr.Dataset]) -> list[str]:
    """Strain of the scales in both states."""
    planar, optimized = scale_strain(inputs["shape"], SAMPLE)
    return [
        f"Mapped from the plane, scales are strained by {100 * planar:.2g} % (root mean square); "
        f"in equilibrium by {100 * optimized:.2g} %, with {(planar / optimized) ** 2:.3g} times "
        "less energy by that measure."
    ]
