"""Energy and moment before and in contact against every knob of the mesh and of contact.

    python benchmarks/mesh_convergence.py [--patterns NAME …] [--only-report]

Squares, hexagons, chevrons and arrowheads, both sides, softest and stiffest direction of the flat
sheet, at 0.002 /mm (before contact), 0.015 and 0.025 /mm. One knob at a time is turned to twice and
two thirds of the size, the others stay at their default; and all of them together. What is done is
kept in results/reference/benchmarks/mesh_convergence.json and not done again; tables (.md) and a
figure (.png) are made from it. Tiles with sharp corners (chevrons, arrowheads) are not meshed in
strips: there `across` bounds the elements near the scales' tips.

From the values at the three sizes follow the observed rate p of v0 + c h^p, where the differences
have one sign, and for p > 0.8 the Richardson limit v0; the error of the default is its distance
from there, else from the finest.
"""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import scipy.optimize

import flexscale as fs
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import follow_line
from flexscale.solve.solver_options import SolverOptions

PATTERNS = ("square", "hexagon", "chevron", "arrowhead")
CURVATURES = (0.002, 0.006, 0.009, 0.012, 0.015, 0.02, 0.025)
SHOWN = (0.002, 0.015, 0.025)
STORE = Path(__file__).parents[1] / "results" / "reference" / "benchmarks" / "mesh_convergence.json"

#: Sizes of elements on the three levels, over the default's.
SIZES = (2.0, 1.0, 1.0 / 1.5)
M, C = fs.MeshOptions(), fs.ContactOptions()
LEVELS = (M.finer(0.5), M, M.finer(1.5))
Options = tuple[fs.MeshOptions, fs.ContactOptions]
#: Knob -> the mesh options that it turns.
KNOBS: dict[str, tuple[str, ...]] = {
    "all": tuple(M.to_config()),
    "across": ("across", "across_grading"),
    "along": ("along",),
    "corner": ("corner", "growth"),
    "scale layers": ("scale_layers", "layer_growth"),
    "scale base": ("scale_corner", "scale_rim", "scale_size", "scale_strips", "scale_growth"),
    "d_hat": (),
}


def options_of(knob: str, level: int) -> Options:
    """Mesh and contact with one knob turned to a level, the others at their default."""
    turned = {name: getattr(LEVELS[level], name) for name in KNOBS[knob]}
    contact = C
    if knob in ("d_hat", "all"):
        contact = replace(C, activation=C.activation * SIZES[level])
    return replace(M, **turned), contact


Store = dict[str, dict]


def cases(pattern: str) -> list[tuple[str, Options]]:
    """Names and options of all runs of one pattern, the default first."""
    found = [(f"{pattern}: default", (M, C))]
    for knob in KNOBS:
        for which, level in (("coarse", 0), ("fine", 2)):
            found.append((f"{pattern}: {knob} {which}", options_of(knob, level)))
    return found


def lines_of(pattern: fs.Pattern) -> list[Line]:
    """Both sides of the softest and the stiffest direction."""
    tangent = fs.tangent_stiffness(pattern)
    directions = [round(angle, 1) % 180.0 for angle in (tangent.softest, tangent.stiffest)]
    if tangent.stiffness(directions[1]) < 1.001 * tangent.stiffness(directions[0]):
        directions = [0.0, 30.0]  # isotropic: any two
    return [Line(side, d, CURVATURES) for side in ("closing", "opening") for d in directions]


def run(name: str, pattern: fs.Pattern, options: Options) -> dict:
    """Energies and moments of all lines on one mesh."""
    start = time.perf_counter()
    mesh, contact = options
    problem = CellProblem.from_pattern(pattern, fs.NativeModel("shell", contact=contact, mesh=mesh))
    found: dict = {"unknowns": len(problem.active)}
    for line in lines_of(pattern):
        for sample in follow_line(problem, line, SolverOptions()):
            if sample["curvature"] in SHOWN:
                key = f"{line.side} {line.direction:g}° {sample['curvature']:g}"
                numbers = [sample.get(n) for n in ("energy_density", "moment", "contact_pairs")]
                found[key] = [*numbers, sample["status"]]
    found["seconds"] = round(time.perf_counter() - start, 1)
    print(f"{name}: {found['unknowns']} unknowns, {found['seconds']:.0f} s", flush=True)
    return found


def limit(values: list[float]) -> tuple[float, float]:
    """Observed rate and Richardson limit of values at three sizes; without a rate nan, the last.

    With v = v0 + c h^p the ratio of the differences is (h1^p - h2^p) / (h2^p - h3^p).
    """
    first, second = values[0] - values[1], values[1] - values[2]
    ratio = first / second if second else 0.0

    def excess(p: float) -> float:
        powers = np.power(SIZES, p)
        return float((powers[0] - powers[1]) / (powers[1] - powers[2]) - ratio)

    if not excess(0.05) < 0.0 < excess(12.0):
        return float("nan"), values[-1]
    rate = float(scipy.optimize.brentq(excess, 0.05, 12.0))
    # A slower rate is no rate yet: its limit would be a guess far beyond the values.
    if rate < 0.8:
        return rate, values[-1]
    share = SIZES[2] ** rate / (1.0 - SIZES[2] ** rate)
    return rate, values[-1] - share * second


def levels_of(store: Store, pattern: str, knob: str, sample: str, which: int) -> list | None:
    """Energy (0) or moment (1) on the coarse, default and fine level; None if not all are there."""
    names = [f"{pattern}: {knob} coarse", f"{pattern}: default", f"{pattern}: {knob} fine"]
    if not all(name in store for name in names):
        return None
    values = [store[name][sample][which] for name in names]
    return None if None in values else values


def tables(store: Store) -> list[str]:
    """Markdown tables, one per pattern."""
    rows = ["# Convergence with mesh and contact", "", (__doc__ or "").split("\n\n")[2], ""]
    for pattern in PATTERNS:
        base = store.get(f"{pattern}: default")
        if base is None:
            continue
        knobs = [k for k in KNOBS if f"{pattern}: {k} fine" in store]
        samples = [key for key in base if key not in ("unknowns", "seconds")]
        for which, name in ((1, "Moments, N"), (0, "Energy densities, N/mm")):
            rows += [
                f"## {pattern}: {name}",
                "",
                "Error of the default against the knob's limit.",
                "",
            ]
            rows.append("| sample | default | " + " | ".join(f"{k} (rate)" for k in knobs) + " |")
            rows.append("|---" * (len(knobs) + 2) + "|")
            for sample in samples:
                cells = [sample, _value(base[sample], which)]
                cells += [_error(levels_of(store, pattern, k, sample, which)) for k in knobs]
                rows.append("| " + " | ".join(cells) + " |")
            rows.append("")
        rows += ["", "| run | unknowns | s |", "|---|---|---|"]
        rows += [
            f"| {name.split(': ')[1]} | {entry['unknowns']} | {entry['seconds']} |"
            for name, entry in store.items()
            if name.startswith(f"{pattern}: ")
        ]
        rows.append("")
    return rows


def _value(entry: list, which: int) -> str:
    touching = " (in contact)" if entry[2] else ""
    return "not converged" if entry[3] else f"{entry[which]:.4g}{touching}"


def _error(values: list[float] | None) -> str:
    if values is None:
        return "-"
    rate, end = limit(values)
    shown = "" if np.isnan(rate) else f" ({rate:.1f})"
    return f"{100.0 * (values[1] / end - 1.0):+.2f} %{shown}"


def draw(store: Store, path: Path) -> None:
    """Error of the moment against each knob, one panel per knob, one curve per sample."""
    done = [p for p in PATTERNS if f"{p}: default" in store]
    figure, axes = plt.subplots(
        len(done), len(KNOBS), figsize=(2.1 * len(KNOBS), 2.1 * len(done)), squeeze=False,
        sharey=True, layout="constrained",
    )  # fmt: skip
    for row, pattern in zip(axes, done, strict=True):
        for panel, knob in zip(row, KNOBS, strict=True):
            base = store[f"{pattern}: default"]
            for sample in (key for key in base if key not in ("unknowns", "seconds")):
                values = levels_of(store, pattern, knob, sample, 1)
                if values is None:
                    continue
                errors = 100.0 * (np.array(values) / limit(values)[1] - 1.0)
                style = "-" if sample.startswith("closing") else "--"
                color = {"0.002": "C0", "0.015": "C1", "0.025": "C3"}[sample.split()[-1]]
                panel.plot(SIZES, errors, style, color=color, marker=".", linewidth=0.8)
            panel.set_title(f"{pattern}: {knob}", fontsize=8)
            panel.set_xscale("log", base=2)
            panel.grid(alpha=0.3)
            panel.set_ylim(-12.0, 12.0)
        row[0].set_ylabel("error of the moment [%]")
    for panel in axes[-1]:
        panel.set_xlabel("size, of the default")
    figure.suptitle(
        "κ = 0.002 blue, 0.015 orange, 0.025 red [mm⁻¹]; closing full, opening dashed", fontsize=8
    )
    figure.savefig(path, dpi=110)


def main() -> None:
    """Run what is missing, then write tables and figure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--patterns", nargs="+", default=PATTERNS, choices=PATTERNS)
    parser.add_argument("--only-report", action="store_true", help="run nothing")
    arguments = parser.parse_args()
    store: Store = json.loads(STORE.read_text()) if STORE.exists() else {}
    for name in arguments.patterns if not arguments.only_report else ():
        pattern = fs.named_pattern(name)
        for case, options in cases(name):
            if case not in store:
                store[case] = run(case, pattern, options)
                STORE.write_text(json.dumps(store, indent=1) + "\n")
    STORE.with_suffix(".md").write_text("\n".join(tables(store)) + "\n")
    draw(store, STORE.with_suffix(".png"))


if __name__ == "__main__":
    main()
