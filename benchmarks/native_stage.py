"""Strips on the stage: the native model against the macro model, by shortening and side (Fig. 11).

    python benchmarks/native_stage.py --results DIR [--output FILE]

Strips of scales are the native_rig datasets of DIR, made by `flexscale run
workflows/native_rigs.yaml`; macro models are fits of DIR, and gap models fitted to its sweeps. All
strips have the same hinges, sizes and shortenings. Native strips are meshed half as finely as the
cells that the models are of, which makes them stiffer: "cell of this mesh" is what that does to the
cell's stiffness along the strip. A strip that is a few cells wide has few rows of scales whose
neighbors are on both sides, which macro models cannot know. Strips curl across, so that they bend
in two directions at a time, of which the fit knows one. Times are of one core, all of them taken in
one run: macro strips from flat to the last shortening, and an iteration of Newton's method on the
native strip (energy, gradient, Hessian, factorization, solution), times the iterations that the
dataset counts. At last, squares by mesh. A picture of each strip, native_stage_PATTERN.png, goes
beside the page.
"""

from __future__ import annotations

import json
import time
from functools import cache
from pathlib import Path

import numpy as np
import xarray as xr
from report import datasets_and_output, heading, report, table

import flexscale as fs
from flexscale.datasets.registry import Registry
from flexscale.finite.native_stage import NativeStage
from flexscale.finite.stage_line import follow_shortenings
from flexscale.patterns.clipped import clip_pattern
from flexscale.plotting.rigs import compared_stages
from flexscale.sheets.stage import StageRig
from flexscale.solve.solver_options import SolverOptions

REPEATS = 3
SQUARES = {"opening": (0.1,), "closing": (0.05, 0.2)}  # shortenings, mm
SQUARES_LENGTH, SQUARES_WIDTH = 30.0, 10.0  # mm


def mesh_convergence() -> list[str]:
    """Forces on a strip of squares by mesh, before contact and in it."""
    pattern = fs.named_pattern("square")
    tiles = clip_pattern(pattern, SQUARES_LENGTH, SQUARES_WIDTH, glued=False)
    rows = []
    for factor in (0.5, 1.0):
        start = time.perf_counter()
        stage = NativeStage(
            pattern, tiles, native=fs.NativeModel("shell", mesh=fs.MeshOptions().finer(factor))
        )
        forces, pairs = [], []
        for side, shortenings in SQUARES.items():
            samples = list(follow_shortenings(stage, shortenings, side, SolverOptions()))
            forces += [sample.get("force", np.nan) for sample in samples]
            pairs += [sample.get("contact_pairs", 0) for sample in samples]
        seconds = time.perf_counter() - start
        shown = [f"{f:.4f}{'*' if n else ''}" for f, n in zip(forces, pairs, strict=True)]
        rows.append([f"{factor:g}", f"{len(stage.active):,}", *shown, f"{seconds:.0f}"])
    head = [f"{side}, {value:g} mm" for side, values in SQUARES.items() for value in values]
    return [
        f"## Squares, {SQUARES_LENGTH:g} x {SQUARES_WIDTH:g} mm: force [N] by mesh", "",
        "\"1\" is the default mesh; * with scales in contact.", "",
        *table(["finer by", "unknowns", *head, "s"], rows),
    ]  # fmt: skip


def iteration_seconds(stage: NativeStage) -> float:
    """Seconds of one iteration of Newton's method, at a small shortening."""
    z = stage.arc(stage.bend_rate(), 1e-4 * stage.tiles.length, 1.0)
    carried = stage.carried(1e-4 * stage.tiles.length, stage.hard)
    start = time.perf_counter()
    for _ in range(REPEATS):
        state = carried.evaluate(z)
        carried.system.factorize(carried.hessian_values(state))
        carried.system.solve(-state.gradient)
    return (time.perf_counter() - start) / REPEATS


def cell_ratios(pattern: fs.Pattern, mesh: fs.MeshOptions, direction: float) -> tuple[float, float]:
    """Bending stiffness of the cell along a direction [degree], of a mesh over that of the default
    one: held flat across, and free to curl."""
    cosine, sine = np.cos(np.radians(direction)), np.sin(np.radians(direction))
    along = np.array([cosine**2, sine**2, 2.0 * cosine * sine])
    flat, free = [], []
    for options in (mesh, None):
        tangent = fs.tangent_stiffness(pattern, model=fs.NativeModel("shell", mesh=options))
        flat.append(float(tangent.stiffness(direction)))
        free.append(1.0 / float(along @ np.linalg.solve(tangent.matrix, along)))
    return flat[0] / flat[1], free[0] / free[1]


@cache
def costs_of(
    config: str, sizes: tuple[float, float, float]
) -> tuple[int, float, float, float, float]:
    """Unknowns of a native strip, seconds to set it up and of an iteration, and what its mesh does
    to the cell (`cell_ratios`); from a dataset's configuration, length, width and direction."""
    settings = json.loads(config)
    pattern = fs.Pattern.from_config(settings["pattern"])
    mesh = fs.MeshOptions(**settings["mesh"])
    start = time.perf_counter()
    stage = NativeStage(
        pattern,
        clip_pattern(pattern, *sizes, glued=False),
        native=fs.NativeModel("shell", mesh=mesh),
    )
    built = time.perf_counter() - start
    ratios = cell_ratios(pattern, mesh, sizes[2])
    return len(stage.active), built, iteration_seconds(stage), *ratios


def picture(native: xr.Dataset, forces: dict[str, list[np.ndarray]], path: Path) -> None:
    """Force against shortening by all models; macro forces (n_shortenings,) [N] a side."""
    tests = {}
    for name, found in forces.items():
        macro = native[["stage_force", "stage_status", "stage_direction"]].copy(deep=True)
        macro["stage_force"].values = np.array(found)
        macro["stage_status"].values = np.where(np.isfinite(found), 0, 1).astype(np.int8)
        tests[name] = macro
    compared_stages(native, tests).savefig(path, dpi=150)


def against_macro(registry: Registry, native: xr.Dataset, folder: Path | None) -> list[str]:
    """Macro over native force of the same strip; the picture goes to the folder."""
    name = str(native["pattern"].values)
    start = time.perf_counter()
    gaps = fs.gap_model(fs.named_pattern(name), registry.one(kind="sweep", pattern=name))
    made = time.perf_counter() - start
    models = {
        "fit": fs.MacroModel.from_dataset(registry.one(kind="fit", pattern=name)),
        "gap model": gaps,
    }
    length, width, direction = (
        float(native[f"stage_{size}"]) for size in ("length", "width", "direction")
    )
    shortenings = native["shortening"].values
    rigs = {
        key: StageRig(model.sheet_law(), length=length, width=width, direction=direction)
        for key, model in models.items()
    }
    n_macro = len(rigs["fit"].problem(float(shortenings[-1])).active)
    rows = []
    times: dict[str, list[float]] = {key: [] for key in rigs}
    forces: dict[str, list[np.ndarray]] = {key: [] for key in rigs}
    for side in native["side"].values:
        tests = {}
        for key, rig in rigs.items():
            start = time.perf_counter()
            tests[key] = rig.test(shortenings, str(side))
            times[key].append(time.perf_counter() - start)
            forces[key].append(tests[key].force)
        one = native.sel(side=side)
        for k, shortening in enumerate(shortenings):
            force, energy = (float(one[f"stage_{n}"][k]) for n in ("force", "energy"))
            rows.append([
                str(side), f"{shortening:g}", f"{force:.4f}",
                *(f"{test.force[k]:.4f}" for test in tests.values()),
                *(f"{test.force[k] / force:.3f}" for test in tests.values()),
                *(f"{test.energy[k] / energy:.3f}" for test in tests.values()),
                f"{float(one['stage_deflection'][k]):.2f}",
                *(f"{test.deflection[k]:.2f}" for test in tests.values()),
                f"{int(one['stage_contact_pairs'][k])}", f"{float(one['stage_min_gap'][k]):.4f}",
                f"{int(one['stage_newton_iterations'][k])}",
            ])  # fmt: skip
    if folder is not None:
        picture(native, forces, folder / f"native_stage_{name}.png")
    sizes = (length, width, direction)
    n_native, built, each, flat, free = costs_of(native.attrs["flexscale_config"], sizes)
    counted = native["stage_newton_iterations"].sum("shortening").values
    head = [
        "side", "shortening [mm]", "native [N]", "fit [N]", "gap model [N]", "fit/native",
        "gap model/native", "energy, fit/native", "gap model/native", "deflection, native [mm]",
        "fit [mm]", "gap model [mm]", "contact pairs", "smallest gap [mm]", "iterations",
    ]  # fmt: skip
    costs = [
        [
            str(side),
            f"{int(n)}",
            f"{built + each * n:.0f}",
            *(f"{t[k]:.1f}" for t in times.values()),
        ]
        for k, (side, n) in enumerate(zip(native["side"].values, counted, strict=True))
    ]
    return [
        f"## {name}: {length:g} x {width:g} mm, along {direction:g}°", "",
        f"{int(native['n_scales'])} scales, pieces included. Unknowns: {n_native:,} "
        f"native, {n_macro:,} macro. Cell of this mesh over the default's: {flat:.3f} where it is "
        f"held flat across, {free:.3f} where it is free to curl.", "",
        *table(head, rows),
        f"The native strip is set up in {built:.0f} s; an iteration takes {each:.2f} s. The gap "
        f"model is made in {made:.0f} s, beside the sweep.", "",
        *table(["side", "native iterations", "native [s]", "fit [s]", "gap model [s]"], costs),
    ]  # fmt: skip


def main() -> None:
    """All native strips there are."""
    registry, output = datasets_and_output(__doc__ or "")
    rows = heading("Native strips on the stage", __doc__ or "")
    folder = output.parent if output else None
    for entry in registry.find(kind="native_rig"):
        rows += against_macro(registry, registry.load(entry), folder)
    rows += mesh_convergence()
    report(rows, output)


if __name__ == "__main__":
    main()
