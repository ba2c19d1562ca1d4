"""The macro model of the flat cell and its gaps: against native sweeps, and against free strips.

    python benchmarks/gap_models.py --results DIR [--output FILE]

A gap model is made of a pattern's flat cell alone; "fitted" has two softenings from the sweep of
the pattern in DIR (`flexscale run workflows/named_patterns.yaml --results DIR`), "fit" is the
default fit with its 14 numbers a side. Errors are of native moments, all directions, both sides
and all curvatures above 0: root mean square of the logarithm, and the worst. Onsets are the least
of all sampled directions; native ones are between the last curvature free of contact and the first
one in contact. "meet": directions and sides in which native scales meet; "outside": those whose
onset by the model is not between these two samples, and by how much at most.

Then strips without ends, with free sides, of the scales themselves, on a mesh half as fine as the
default: what they do as they grow wider, what free sides take in contact beside what they take of
macro sheets (turned_sheet datasets of DIR), and contact in a strip that curls across, by the native
model, by the gap model of the same mesh, and by the fit, both of a sheet whose curvature across is
free. A picture of the latter, gap_models.png, goes beside the page.
"""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from report import datasets_and_output, heading, report, table
from scipy.optimize import minimize_scalar

import flexscale as fs
from flexscale.datasets.registry import Registry
from flexscale.finite.free_strip import FreeStrip
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import Line, follow_line
from flexscale.macro.gap_model import model_of_cell
from flexscale.plotting.style import (
    COLUMN_WIDTH,
    MACRO_COLOR,
    NATIVE_COLOR,
    SCALE_COLOR,
    flexscale_style,
    new_figure,
)
from flexscale.solve.solver_options import SolverOptions

COARSE = fs.MeshOptions().finer(0.5)
SMALL = 0.001  # mm-1
WIDTHS = (2, 4, 8)  # lattice vectors
NARROW = 31.0  # mm, two rows of arrowheads
CURVATURES = (0.0, 0.0025, 0.005, 0.0075, 0.01, 0.0125)  # mm-1
CURLS = (-0.03, 0.03)  # mm-1, within which the curvature across is sought


def log_errors(ratios: np.ndarray) -> str:
    """Root mean square / worst of ratios, in %."""
    off = np.abs(np.log(ratios[np.isfinite(ratios)]))
    return f"{100 * np.sqrt(np.mean(off**2)):.1f} / {100 * off.max():.0f}"


def fit_ratios(fit: fs.MacroModel, sweep: xr.Dataset, side: str) -> np.ndarray:
    """Moments of the fit over native ones of a side, (n,); nan where these did not converge."""
    one = sweep.sel(side=side).isel(curvature=slice(1, None))
    native = one["moment"].transpose("direction", "curvature").values
    found = fit.moment(one["curvature"].values, one["direction"].values[:, None], side)
    return np.ravel(found / native)


def native_onset(sweep: xr.Dataset, side: str) -> str:
    """Between which curvatures [mm-1] scales meet first, in any direction."""
    kappa = sweep["curvature"].values
    touches = (sweep["contact_pairs"].sel(side=side).values > 0).any(axis=0)
    if not touches.any():
        return "–"
    first = int(np.argmax(touches))
    return f"{kappa[first - 1]:g}–{kappa[first]:g}"


def model_onset(model: fs.GapModel, sweep: xr.Dataset, side: str) -> str:
    """Least onset [mm-1] in the sweep's directions."""
    least = float(np.min(model.onset(sweep["direction"].values, side)))
    return f"{least:.4f}" if least < float(sweep["curvature"].max()) else "–"


def onset_errors(model: fs.GapModel, sweep: xr.Dataset) -> np.ndarray:
    """Of each direction and side in which native scales meet, by what share the model's onset lies
    outside the two samples between which they do: below 0 if early, 0 between them."""
    kappa, found = sweep["curvature"].values, []
    for side in sweep["side"].values:
        touches = sweep["contact_pairs"].sel(side=side).transpose("direction", "curvature") > 0
        onsets = model.onset(sweep["direction"].values, str(side))
        for touching, onset in zip(touches.values, onsets, strict=True):
            if touching.any():
                first = int(np.argmax(touching))
                between = np.clip(onset, kappa[first - 1], kappa[first])
                found.append(onset / between - 1.0)
    return np.array(found)


def against_sweeps(registry: Registry) -> list[str]:
    """Every pattern that has a sweep."""
    rows = []
    for entry in registry.find(kind="sweep"):
        sweep = registry.load(entry)
        name = str(sweep["pattern"].values)
        pattern = fs.named_pattern(name)
        start = time.perf_counter()
        problem = CellProblem.from_pattern(pattern)
        built = time.perf_counter() - start
        start = time.perf_counter()
        rough = model_of_cell(problem)
        seconds = time.perf_counter() - start
        fitted = rough.fitted(sweep)
        fit = fs.MacroModel.from_dataset(registry.one(kind="fit", pattern=name))
        moments = [model.errors(sweep)[1] + 1.0 for model in (rough, fitted)]
        by_fit = np.concatenate([fit_ratios(fit, sweep, side) for side in fit.sides])
        off = onset_errors(rough, sweep)
        rows.append([
            name, str(len(rough.contact)), f"{built:.1f}", f"{seconds:.1f}",
            *(
                text
                for side in ("closing", "opening")
                for text in (native_onset(sweep, side), model_onset(rough, sweep, side))
            ),
            str(len(off)), str(np.count_nonzero(off)), f"{100 * off.min():.0f}",
            f"{100 * off.max():.0f}", f"{fitted.softening:.2f}", f"{fitted.contact_softening:.2f}",
            *map(log_errors, moments), log_errors(by_fit),
        ])  # fmt: skip
    head = [
        "pattern", "gaps", "cell, s", "gaps, s", "closing: native onset", "model",
        "opening: native", "model", "meet", "outside", "early, %", "late, %",
        "s, mm/N", "s_c, mm/N", "no sweep, %", "fitted, %", "fit, %",
    ]  # fmt: skip
    return ["## Against native sweeps", "", *table(head, rows)]


def wider_strips(name: str, direction: float) -> list[str]:
    """Energy of strips over that of the cell that is held straight across, as they grow wider."""
    pattern = fs.named_pattern(name)
    line = Line("closing", direction, (0.0, SMALL))
    cell = CellProblem.from_pattern(pattern, fs.NativeModel("shell", mesh=COARSE))
    *_, straight = follow_line(cell, line, SolverOptions())
    tangent = fs.tangent_stiffness(pattern, model=fs.NativeModel("shell", mesh=COARSE))
    c, s = np.cos(np.radians(direction)), np.sin(np.radians(direction))
    along = np.array([c * c, s * s, 2.0 * c * s])
    free = 1.0 / float(along @ np.linalg.solve(tangent.matrix, along))
    rows = []
    for count in WIDTHS:
        width = count * float(np.linalg.norm(pattern.lattice[1]))
        strip = FreeStrip(pattern, width, direction, native=fs.NativeModel("shell", mesh=COARSE))
        *_, sample = follow_line(strip, Line("closing", 0.0, (0.0, SMALL)), SolverOptions())
        ratio = sample["energy_density"] / straight["energy_density"]
        curl = strip.curl(sample["state"]) / SMALL
        rows.append([f"{width:.1f}", f"{ratio:.4f}", f"{curl:.3f}"])
    bent_free = free / float(tangent.stiffness(direction))
    return [
        f"### {name}, along {direction:g}°", "",
        f"Free to curl, the flat cell has {bent_free:.3f} of the energy that it has held straight "
        "across.", "",
        *table(["width, mm", "strip / cell", "curl / curvature"], rows),
    ]  # fmt: skip


def sides_in_contact(registry: Registry) -> list[str]:
    """What free sides take of the energy of hexagons in contact, by the native model and by both
    energies of the fit."""
    pattern = fs.named_pattern("hexagon")
    turned = registry.one(kind="turned_sheet", pattern="hexagon").sel(side="closing")
    kappa, width = float(turned["curvature"]), float(turned["width"])
    curvatures = (*(k for k in CURVATURES if k < kappa), 0.015, kappa)
    cell = CellProblem.from_pattern(pattern, fs.NativeModel("shell", mesh=COARSE))
    rows = []
    for direction in (0.0, 30.0):
        *_, straight = follow_line(cell, Line("closing", direction, curvatures), SolverOptions())
        strip = FreeStrip(pattern, width, direction, native=fs.NativeModel("shell", mesh=COARSE))
        *_, sample = follow_line(strip, Line("closing", 0.0, curvatures), SolverOptions())
        sheets = turned.sel(direction=direction)
        shares = [
            float(one["energy_density"] / one["law_energy_density"])
            for one in (sheets.sel(variant=variant) for variant in ("tangent", "paper"))
        ]
        native = sample["energy_density"] / straight["energy_density"]
        rows.append([f"{direction:g}", f"{native:.3f}", *(f"{share:.3f}" for share in shares)])
    return [
        f"## Free sides in contact: hexagons, {width:g} mm wide, closing at {kappa:g} /mm", "",
        "Energy with free sides over that held straight across: of a native strip without ends "
        "over the cell, and of macro sheets between end strips over their law.", "",
        *table(["direction, °", "native", "tangent energy", "paper's energy"], rows),
    ]  # fmt: skip


def curled(model: fs.GapModel | fs.MacroModel, kappa: float) -> tuple[float, float]:
    """Energy density [N/mm] and curvature across [mm-1] of a sheet that is free to curl."""

    def energy(curl: float) -> float:
        return float(model.tensor_energy(np.diag([kappa, curl])))

    # A grid first: the law has kinks, and a softening one need not be convex.
    grid = np.linspace(*CURLS, 121)
    best = int(np.argmin([energy(curl) for curl in grid]))
    bounds = grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)]
    found = minimize_scalar(energy, bounds=bounds, method="bounded", options={"xatol": 1e-8})
    return float(found.fun), float(found.x)


def contact_in_a_saddle(registry: Registry, folder: Path | None) -> list[str]:
    """A narrow strip of arrowheads by three models, closing and opening."""
    pattern = fs.named_pattern("arrowhead")
    gaps = fs.gap_model(
        pattern,
        registry.one(kind="sweep", pattern="arrowhead"),
        model=fs.NativeModel("shell", mesh=COARSE),
    )
    fit = fs.MacroModel.from_dataset(registry.one(kind="fit", pattern="arrowhead"))
    rows, curves = [], []
    for side, sign in (("closing", 1.0), ("opening", -1.0)):
        strip = FreeStrip(pattern, NARROW, native=fs.NativeModel("shell", mesh=COARSE))
        for sample in follow_line(strip, Line(side, 0.0, CURVATURES), SolverOptions()):
            kappa = sample["curvature"]
            if kappa == 0.0 or "state" not in sample:
                continue
            native, curl = sample["energy_density"], strip.curl(sample["state"])
            by_gaps, by_fit = curled(gaps, sign * kappa), curled(fit, sign * kappa)
            curves.append((sign * kappa, native, by_gaps[0], by_fit[0]))
            rows.append([
                side, f"{kappa:g}", f"{native:.5f}", f"{by_gaps[0] / native:.3f}",
                f"{by_fit[0] / native:.3f}", f"{curl:.4f}", f"{by_gaps[1]:.4f}",
                f"{by_fit[1]:.4f}", str(sample["contact_pairs"]),
            ])  # fmt: skip
    if folder is not None:
        picture(np.array(sorted(curves)), folder / "gap_models.png")
    head = [
        "side", "curvature, /mm", "native, N/mm", "gap model / native", "fit / native",
        "curl, native, /mm", "gap model", "fit", "contact pairs",
    ]  # fmt: skip
    single, both = gaps.onset(0.0), gaps.tensor_onset(np.diag([1.0, curled(gaps, 1e-4)[1] / 1e-4]))
    return [
        f"## Contact in a saddle: a strip of arrowheads, {NARROW:g} mm wide, along 0°", "",
        f"Held straight across, scales of the flat cell meet at {float(single):.4f} mm-1 (closing);"
        f" free to curl, at {float(both):.4f} mm-1.", "",
        *table(head, rows),
    ]  # fmt: skip


def picture(curves: ArrayLike, path: Path) -> None:
    """Energy density over signed curvature by the three models; curves (n, 4)."""
    kappa, native, gaps, fit = np.transpose(curves)
    with flexscale_style():
        drawn = new_figure(COLUMN_WIDTH, 0.8 * COLUMN_WIDTH)
        axes = drawn.subplots()
        axes.plot(kappa, native, "o-", color=NATIVE_COLOR, label="native strip")
        axes.plot(kappa, gaps, "s--", color=SCALE_COLOR, label="gap model")
        axes.plot(kappa, fit, "^:", color=MACRO_COLOR, label="fit to single directions")
        axes.set_yscale("log")
        axes.set_xlabel("curvature along the strip [mm$^{-1}$], closing > 0")
        axes.set_ylabel("energy density [N mm$^{-1}$]")
        axes.legend()
        drawn.savefig(path, dpi=200)


def main() -> None:
    """All of it."""
    registry, output = datasets_and_output(__doc__ or "")
    rows = heading("Gap models", __doc__ or "")
    rows += against_sweeps(registry)
    rows += ["## Strips with free sides, before contact", ""]
    rows += wider_strips("chevron", 0.0) + wider_strips("arrowhead", 0.0)
    rows += sides_in_contact(registry)
    rows += contact_in_a_saddle(registry, output.parent if output else None)
    report(rows, output)


if __name__ == "__main__":
    main()
