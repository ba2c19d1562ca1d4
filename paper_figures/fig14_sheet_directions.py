"""Figure 14 of the paper: sheets with the pattern turned on them, against the periodic cell."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from flexscale.plotting.figure_scripts import Need
from flexscale.plotting.turned_sheets import sheet_errors, turned_sheets

_COMMAND = "flexscale run workflows/turned_sheets.yaml"
PATTERNS = {"chevron": "IH64", "arrowhead": "IH69", "hexagon": "IH20", "threefold": "IH07"}

NEEDS = {
    f"{pattern}_{kind}": Need(kind, _COMMAND, {"family": family, "pattern": pattern}, "shell")
    for pattern, family in PATTERNS.items()
    for kind in ("turned_sheet", "sweep")
}
CAPTION = (
    "Macro sheets between end strips, bent to 0.02 /mm with the pattern turned on them, against "
    "the periodic native cell in that direction: energy density and its error, closing, by the "
    "energy on the tangent of the flat cell and by the paper's (after Fig. 14 of the paper)."
)
PAPER_SAYS = (
    "The two simulations agree very well despite the difference in boundary conditions, at a "
    "curvature of 0.02 mm-1."
)
SIDE = "closing"


def draw(inputs: Mapping[str, xr.Dataset]) -> Figure:
    """One column a pattern; `inputs` are datasets by the names of NEEDS."""
    return turned_sheets(
        [(inputs[f"{name}_turned_sheet"], inputs[f"{name}_sweep"], SIDE) for name in PATTERNS]
    )


def findings(inputs: Mapping[str, xr.Dataset]) -> list[str]:
    """Errors of sheets, and of the model without free sides, over all directions."""
    errors, laws = {}, {}
    for name in PATTERNS:
        turned, sweep = inputs[f"{name}_turned_sheet"], inputs[f"{name}_sweep"]
        errors[name] = 100.0 * sheet_errors(turned, sweep)
        laws[name] = 100.0 * sheet_errors(turned, sweep, "law_energy_density")
    shown = np.concatenate([item.sel(side=SIDE, variant="paper") for item in errors.values()])
    coupled = np.concatenate([item.sel(side=SIDE, variant="tangent") for item in errors.values()])
    lines = [
        f"{SIDE.capitalize()}, sheets with the paper's energy are {np.nanmin(shown):+.2g} to "
        f"{np.nanmax(shown):+.2g} % from the cell, those with the energy on the tangent "
        f"{np.nanmin(coupled):+.2g} to {np.nanmax(coupled):+.2g} %: only this one couples the "
        "principal curvatures, so that free sides give way, which periodic cells cannot."
    ]
    for name in PATTERNS:
        for side in errors[name]["side"].values:
            parts = [
                f"{variant} {_spread(errors[name].sel(side=side, variant=variant))}, without free "
                f"sides {_spread(laws[name].sel(side=side, variant=variant))}"
                + _lost(errors[name].sel(side=side, variant=variant))
                for variant in errors[name]["variant"].values
            ]
            lines.append(f"{name}, {side}, median error (range): {'; '.join(parts)}.")
    return lines


def _spread(errors: xr.DataArray) -> str:
    """Median of the size of errors (%) over directions, and their range."""
    known = errors.values[np.isfinite(errors.values)]
    return f"{np.median(np.abs(known)):.2g} % ({known.min():+.2g} to {known.max():+.2g} %)"


def _lost(errors: xr.DataArray) -> str:
    """What did not converge."""
    lost = int(np.isnan(errors.values).sum())
    return f", {lost} of {errors.size} sheets not converged" if lost else ""
