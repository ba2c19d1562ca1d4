"""Sheets of 100 x 50 mm by the macro model, against native cells and native sheets (Figs. 13, 14).

    python benchmarks/large_sheet.py --results DIR [--output FILE]

Datasets are those of DIR. First the native sheets there are, sample by sample: the macro model's
energy over theirs, with both energies of a curvature tensor, with a quarter and four times the
resistance to double curvature, and of the gap model. Native sheets are meshed half as finely as the
cells that the model is fitted to, which makes them stiffer: the row "cell of this mesh" is what
that does to the cell. Strips of the native sheet turn with the arc, as cells do; macro sheets keep
their turn, since the law has the work of the moment on that slide in it already. Then macro sheets
with the pattern turned on them, over the native cell in that direction: what free sides and the fit
do. Times are of one core.
"""

from __future__ import annotations

import dataclasses
import json
import time

import numpy as np
import xarray as xr
from report import datasets_and_output, heading, report

import flexscale as fs
from flexscale.datasets.registry import Registry
from flexscale.finite.free_strip import FreeStrip
from flexscale.finite.native_sheet import NativeSheet
from flexscale.homogenize.line import Line, follow_line
from flexscale.solve.solver_options import SolverOptions

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


def macro_energies(
    model: fs.MacroModel | fs.GapModel, native: xr.Dataset
) -> tuple[list[float], float]:
    """Energy densities of the macro sheet at the native samples, and seconds for all of them."""
    start = time.perf_counter()
    sizes = {name: float(native[name]) for name in ("length", "width", "direction")}
    found = [
        fs.simulate_sheet(model, curvature=float(k), **sizes).energy_density
        for k in native["curvature"].values[1:]
    ]
    return found, time.perf_counter() - start


def sides_and_strips(native: xr.Dataset, cell: float) -> list[str]:
    """What free sides do to a sheet, and what its end strips do.

    Sheets of the native one's length and width, and of half of either, are compared with strips
    without ends, which the sides cut at the same places.

    cell : energy density of the periodic cell on the same mesh at the first curvature, N/mm.
    """
    pattern = fs.named_pattern(str(native["pattern"].values))
    mesh, direction = _mesh_of(native), float(native["direction"])
    curvature = float(native["curvature"][1])
    line = Line(SIDE, 0.0, (0.0, curvature))
    rows = []
    for x, y in ((1.0, 1.0), (0.5, 1.0), (1.0, 0.5)):
        length, width = x * float(native["length"]), y * float(native["width"])
        sheet = NativeSheet(
            pattern, length, width, direction, native=fs.NativeModel("shell", mesh=mesh)
        )
        strip = FreeStrip(
            pattern,
            width,
            direction,
            center=sheet.tiles.center,
            native=fs.NativeModel("shell", mesh=mesh),
        )
        held, free = (
            [*follow_line(problem, line, SolverOptions())][-1]["energy_density"]
            for problem in (sheet, strip)
        )
        rows.append(
            f"| {length:g} x {width:g} | {held / cell:.3f} | {free / cell:.3f} | "
            f"{held / free:.3f} | {(held / free - 1.0) * length:.2f} |"
        )
    return [
        "",
        f"Free sides and end strips, at {curvature:g} /mm, where nothing touches: energies of "
        "sheets over the cell on the same mesh, and over strips without ends that the sides cut at "
        "the same places.", "",
        "| sheet, mm | sheet / cell | strip / cell: sides | sheet / strip: ends | (that - 1) x "
        "length, mm |",
        "|" + "---|" * 5, *rows,
    ]  # fmt: skip


def against_native(registry: Registry, entry) -> list[str]:
    """Macro over native energy of the same sheet."""
    native, run = registry.load(entry), registry.record(entry)["run"]
    pattern = str(native["pattern"].values)
    sweep = registry.one(kind="sweep", pattern=pattern)
    tangent = registry.one(kind="tangent", pattern=pattern)
    energies = native["energy_density"].sel(side=SIDE).values[1:]
    usual = fs.fit(sweep, tangent)
    models: dict[str, fs.MacroModel | fs.GapModel] = {
        "tangent (default)": usual,
        "paper": fs.fit(sweep, tangent, variant="paper"),
        "w_biaxial / 4": dataclasses.replace(usual, w_biaxial=0.25 * usual.w_biaxial),
        "w_biaxial x 4": dataclasses.replace(usual, w_biaxial=4.0 * usual.w_biaxial),
        "gap model": fs.gap_model(fs.named_pattern(pattern), sweep),
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
        f"| native [N/mm] | {shown} | {run['cpu_seconds']:.0f} |",
    ]  # fmt: skip
    for name, model in models.items():
        found, seconds = macro_energies(model, native)
        cells = [f"{v:.3f}" for v in np.array(found) / energies]
        rows.append(f"| {name} | {' | '.join(cells)} | {seconds:.1f} |")
    law = [float(usual.energy(k, float(native["direction"]), SIDE)) for k in kappa]
    rows.append(f"| law alone | {' | '.join(f'{v:.3f}' for v in np.array(law) / energies)} | |")
    cells = [
        fs.sweep(
            fs.named_pattern(pattern),
            [float(native["direction"])],
            [0.0, *map(float, kappa)],
            sides=[SIDE],
            workers=1,
            model=fs.NativeModel("shell", mesh=mesh),
        )["energy_density"].values.ravel()[1:]
        for mesh in (_mesh_of(native), fs.MeshOptions())
    ]
    rows.append(
        f"| cell of this mesh, over the default's | "
        f"{' | '.join(f'{v:.3f}' for v in cells[0] / cells[1])} | |"
    )
    slides = native["slide"].sel(side=SIDE).values[1:]
    rows.append(f"| slide, native [mm] | {' | '.join(f'{v:.2f}' for v in slides)} | |")
    rows += sides_and_strips(native, float(cells[0][0]))
    return [*rows, ""]


def main() -> None:
    """All native sheets, then all turned ones."""
    registry, output = datasets_and_output(__doc__ or "")
    rows = heading("Large sheets", __doc__ or "")
    for entry in registry.find(kind="native_sheet"):
        rows += against_native(registry, entry)
    for entry in registry.find(kind="turned_sheet"):
        rows += turned_sheets(registry, registry.load(entry))
    report(rows, output)


if __name__ == "__main__":
    main()
