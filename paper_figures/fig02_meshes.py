"""Figure 2 of the paper: meshes of scales and substrate, and how they conform."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from flexscale.plotting.figure_scripts import Need
from flexscale.plotting.meshes import conformity, meshes

NEEDS = {
    "cell": Need(
        "cell",
        "flexscale run workflows/named_patterns.yaml",
        {"family": "IH69", "pattern": "arrowhead"},
    )
}
CAPTION = (
    "Scale (left) and substrate meshes (middle) of one cell, and a detail where scales meet: the "
    "substrate conforms to the edges of the scales (right; after Fig. 2 of the paper)."
)
PAPER_SAYS = (
    "Scale and substrate meshes are generated from isohedral tilings. The substrate is meshed such "
    "as to conform to the boundaries of the scale mesh."
)


def draw(inputs: Mapping[str, xr.Dataset]) -> Figure:
    """The figure; `inputs` are datasets by the names of NEEDS."""
    return meshes(inputs["cell"])


def findings(inputs: Mapping[str, xr.Dataset]) -> list[str]:
    """Sizes of the meshes, and how far they are from conforming."""
    cell = inputs["cell"]
    return [
        f"{int(cell['n_scales'])} scales of {cell.sizes['tet']} tetrahedra, on "
        f"{cell.sizes['triangle']} triangles of substrate.",
        f"Vertices on the edges of the scales' bases are at most {conformity(cell):.1g} mm from a "
        "vertex of the substrate.",
    ]
