"""Figure 14 of the paper: sheets with the pattern turned on them, against the periodic cell."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from flexscale.plotting.figure_scripts import Need
from flexscale.plotting.turned_sheets import TurnedColumn, sheet_errors, turned_sheets

_PRINTED = "flexscale run workflows/printed_turned_sheets.yaml"
_SHELL = "flexscale run workflows/turned_sheets.yaml"
PATTERNS = {"chevron": "IH64", "arrowhead": "IH69", "hexagon": "IH20", "threefold": "IH07"}


def _needs(pattern: str, family: str) -> dict[str, Need]:
    where = {"family": family, "pattern": pattern}
    return {
        f"{pattern}_turned_sheet": Need("turned_sheet", _PRINTED, where, "joints"),
        f"{pattern}_sweep": Need("sweep", _PRINTED, where, "joints"),
        f"{pattern}_scales": Need("native_turned_sheet", _PRINTED, where, "joints", optional=True),
        f"{pattern}_shell": Need("turned_sheet", _SHELL, where, "shell", optional=True),
        f"{pattern}_shell_sweep": Need("sweep", _SHELL, where, "shell", optional=True),
    }


NEEDS = {
    name: need
    for pattern, family in PATTERNS.items()
    for name, need in _needs(pattern, family).items()
}
CAPTION = (
    "Sheets between end strips, bent to 0.02 /mm with the pattern turned on them, against the "
    "periodic cell in that direction, closing: energy density and its error. Of scales on joints: "
    "the cell, sheets of scales where they are computed, and macro sheets by the energy on the "
    "tangent of the flat cell and by the paper's; thin, the paper's shell: its cell (above), and "
    "its macro sheets over it (below; after Fig. 14 of the paper)."
)
PAPER_SAYS = (
    "The two simulations agree very well despite the difference in boundary conditions, at a "
    "curvature of 0.02 mm-1."
)
SIDE = "closing"


def draw(inputs: Mapping[str, xr.Dataset]) -> Figure:
    """One column a pattern; `inputs` are datasets by the names of NEEDS."""
    return turned_sheets([_column(inputs, pattern) for pattern in PATTERNS])


def _column(inputs: Mapping[str, xr.Dataset], pattern: str) -> TurnedColumn:
    turned, sweep = inputs[f"{pattern}_turned_sheet"], inputs[f"{pattern}_sweep"]
    shell = [
        inputs[name] for name in (f"{pattern}_shell", f"{pattern}_shell_sweep") if name in inputs
    ]
    thin = (shell[0], shell[1]) if len(shell) == 2 else None
    return TurnedColumn(turned, sweep, SIDE, inputs.get(f"{pattern}_scales"), thin)


def findings(inputs: Mapping[str, xr.Dataset]) -> list[str]:
    """Errors of sheets of joints, and of the model without free sides, over all directions."""
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
            if f"{name}_scales" in inputs:
                lines += _of_scales(name, str(side), inputs)
    return lines


def _of_scales(name: str, side: str, inputs: Mapping[str, xr.Dataset]) -> list[str]:
    """Errors of sheets of scales against the cell, and of macro sheets against them."""
    scales = inputs[f"{name}_scales"]
    if side not in scales["side"].values:
        return []
    over_cell = 100.0 * sheet_errors(scales, inputs[f"{name}_sweep"]).sel(side=side)
    density = inputs[f"{name}_turned_sheet"]["energy_density"].sel(side=side)
    over = 100.0 * (density / scales["energy_density"].sel(side=side) - 1.0)
    macro = [f"{one} {_spread(over.sel(variant=one))}" for one in over["variant"].values]
    return [
        f"{name}, {side}, sheets of scales: {_spread(over_cell)} from the cell"
        f"{_lost(over_cell)}; macro sheets from these: {', '.join(macro)}."
    ]


def _spread(errors: xr.DataArray) -> str:
    """Median of the size of errors (%) over directions, and their range."""
    known = errors.values[np.isfinite(errors.values)]
    return f"{np.median(np.abs(known)):.2g} % ({known.min():+.2g} to {known.max():+.2g} %)"


def _lost(errors: xr.DataArray) -> str:
    """What did not converge."""
    lost = int(np.isnan(errors.values).sum())
    return f", {lost} of {errors.size} sheets not converged" if lost else ""
