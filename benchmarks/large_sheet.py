"""Sheets of 100 x 50 mm by the macro model, against native cells and native sheets (Figs. 13, 14).

    python benchmarks/large_sheet.py --results DIR [--output FILE]

Datasets are those of DIR. First the native sheets there are, sample by sample: the macro model's
energy over theirs, with both energies of a curvature tensor, and with a quarter and four times the
resistance to double curvature. Native sheets are meshed half as finely as the cells that the
model is fitted to, which makes them stiffer: the row "cell of this mesh" is what that does to the
cell. Strips of the native sheet turn with the arc, as cells do; macro sheets keep their turn, since
the law has the work of the moment on that slide in it already. Then macro sheets with the pattern
turned on them, over the native cell in that direction: what free sides and the fit do. Times are of
one core.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import time
from pathlib import Path

import numpy as np
import xarray as xr
from report import report

import flexscale as fs
from flexscale.datasets.registry import Registry

SIDE = "closing"


def turned_sheets(registry: Registry, turned: xr.Dataset) -> list[str]:
    """Macro sheet over native cell, by direction; law is the model without free sides."""
    pattern, curvature = str(turned["pattern"].values), float(turned["curvature"])
    sweep = registry.one(kind="sweep", pattern=pattern)
    cell = sweep["energy_density"].sel(side=SIDE, curvature=curvature)
    found = turned.sel(side=SIDE)
    rows, worst = [], {}
    for direction in turned["direction"].values:
        native = float(cell.sel(direction=direction))
        cells = [f"{direction:g}°", f"{native:.5f}"]
        for variant in ("tangent", "paper"):
            one = found.sel(variant=variant, direction=direction)
            ratios = [float(one[n]) / native for n in ("law_energy_density", "energy_density")]
            worst[variant] = max(worst.get(variant, 0.0), abs(ratios[1] - 1.0))
            cells += [f"{ratio:.3f}" for ratio in ratios]
        rows.append(f"| {' | '.join(cells)} |")
    head = "| direction | cell [N/mm] | law | sheet | law, paper | sheet, paper |"
    said = ", ".join(f"{v} {100 * w:.1f} %" for v, w in worst.items())
    return [
        f"## {pattern}: pattern turned on the sheet, {curvature:g} /mm, {SIDE}", "",
        "Energy density over the native cell's.", "", head, "|" + "---|" * 6, *rows, "",
        f"Largest error of a sheet: {said}.", "",
    ]  # fmt: skip


def _mesh_of(native: xr.Dataset) -> fs.MeshOptions:
    """Mesh options that a native sheet was made with."""
    return fs.MeshOptions(**json.loads(native.attrs["flexscale_config"])["mesh"])


def macro_energies(model: fs.MacroModel, native: xr.Dataset) -> tuple[list[float], float]:
    """Energy densities of the macro sheet at the native samples, and seconds for all of them."""
    start = time.perf_counter()
    sizes = {name: float(native[name]) for name in ("length", "width", "direction")}
    found = [
        fs.simulate_sheet(model, curvature=float(k), **sizes).energy_density
        for k in native["curvature"].values[1:]
    ]
    return found, time.perf_counter() - start


def smaller_sheets(native: xr.Dataset, energy: float, cell: float) -> list[str]:
    """What strips, free sides and cut scales do: also sheets half as long, and half as wide.

    energy : of the sheet at its first curvature, cell : of the cell on the same mesh, N/mm.
    """
    pattern = fs.named_pattern(str(native["pattern"].values))
    length, width, direction = (float(native[n]) for n in ("length", "width", "direction"))
    curvature = float(native["curvature"][1])
    halves = []
    for x, y in ((0.5 * length, width), (length, 0.5 * width)):
        sheet = fs.simulate_native_sheet(
            pattern, length=x, width=y, direction=direction, curvatures=[curvature], sides=[SIDE],
            mesh=_mesh_of(native),
        )  # fmt: skip
        halves.append(sheet["energy_density"].item())
    return [
        "",
        f"At {curvature:g} /mm, where nothing touches, the sheet's energy density is "
        f"{energy / cell:.3f} of that of the periodic cell on the same mesh; half as long "
        f"{halves[0] / cell:.3f}, half as wide {halves[1] / cell:.3f}.",
    ]


def against_native(registry: Registry, entry) -> list[str]:
    """Macro over native energy of the same sheet."""
    native, run = registry.load(entry), registry.record(entry)["run"]
    pattern = str(native["pattern"].values)
    sweep = registry.one(kind="sweep", pattern=pattern)
    tangent = registry.one(kind="tangent", pattern=pattern)
    energies = native["energy_density"].sel(side=SIDE).values[1:]
    usual = fs.fit(sweep, tangent)
    models = {
        "tangent (default)": usual,
        "paper": fs.fit(sweep, tangent, variant="paper"),
        "w_biaxial / 4": dataclasses.replace(usual, w_biaxial=0.25 * usual.w_biaxial),
        "w_biaxial x 4": dataclasses.replace(usual, w_biaxial=4.0 * usual.w_biaxial),
    }
    kappa = native["curvature"].values[1:]
    sizes = " x ".join(f"{float(native[name]):g}" for name in ("length", "width"))
    shown = " | ".join(f"{energy:.5f}" for energy in energies)
    rows = [
        f"## {pattern}: native sheet of {sizes} mm", "",
        f"{int(native['n_scales'])} scales, {int(native['n_unknowns']):,} unknowns. Energy density "
        "over the native sheet's.", "",
        f"| model | {' | '.join(f'{k:g} /mm' for k in kappa)} | s |",
        "|" + "---|" * (len(kappa) + 2),
        f"| native [N/mm] | {shown} | {run['wall_seconds']:.0f} |",
    ]  # fmt: skip
    for name, model in models.items():
        found, seconds = macro_energies(model, native)
        cells = [f"{v:.3f}" for v in np.array(found) / energies]
        rows.append(f"| {name} | {' | '.join(cells)} | {seconds:.1f} |")
    law = [float(usual.energy(k, float(native["direction"]), SIDE)) for k in kappa]
    rows.append(f"| law alone | {' | '.join(f'{v:.3f}' for v in np.array(law) / energies)} | |")
    cells = [
        fs.sweep(
            fs.named_pattern(pattern), [float(native["direction"])], [0.0, *map(float, kappa)],
            sides=[SIDE], mesh=mesh, workers=1,
        )["energy_density"].values.ravel()[1:]
        for mesh in (_mesh_of(native), None)
    ]  # fmt: skip
    rows.append(
        f"| cell of this mesh, over the default's | "
        f"{' | '.join(f'{v:.3f}' for v in cells[0] / cells[1])} | |"
    )
    slides = native["slide"].sel(side=SIDE).values[1:]
    rows.append(f"| slide, native [mm] | {' | '.join(f'{v:.2f}' for v in slides)} | |")
    rows += smaller_sheets(native, float(energies[0]), float(cells[0][0]))
    return [*rows, ""]


def main() -> None:
    """All native sheets, then all turned ones."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--results", type=Path, required=True, help="folder of the datasets")
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    arguments = parser.parse_args()
    registry = fs.open_registry(arguments.results)
    rows = ["# Large sheets", "", (__doc__ or "").split("\n\n")[2], ""]
    for entry in registry.find(kind="native_sheet"):
        rows += against_native(registry, entry)
    for entry in registry.find(kind="turned_sheet"):
        rows += turned_sheets(registry, registry.load(entry))
    report(rows, arguments.output)


if __name__ == "__main__":
    main()
