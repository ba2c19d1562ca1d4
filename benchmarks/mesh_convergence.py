"""Energy and moment before and in contact against every knob of the mesh and of contact.

    python benchmarks/mesh_convergence.py [--patterns NAME …] [--only-report]

Squares, hexagons, chevrons and arrowheads, both sides, softest and stiffest direction of the flat
sheet, at 0.002 /mm (before contact), 0.015 and 0.025 /mm. One knob at a time is turned to twice and
half the size, the others stay at their default; at the end all of them together. What is done is
kept in results/reference/benchmarks/mesh_convergence.json and not done again; tables (.md) and a
figure (.png) are made from it.

From the values at the three sizes follow the observed rate p = log2(d1 / d2) of the differences d1,
d2, where both have one sign, and for p > 0.8 the Richardson limit; the error of the default is its
distance from there, else from the finest.
"""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import flexscale as fs
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import Line, follow_line
from flexscale.solve.newton import SolverOptions

PATTERNS = ("square", "hexagon", "chevron", "arrowhead")
CURVATURES = (0.002, 0.006, 0.009, 0.012, 0.015, 0.02, 0.025)
SHOWN = (0.002, 0.015, 0.025)
STORE = Path(__file__).parents[1] / "results" / "reference" / "benchmarks" / "mesh_convergence.json"

M, C, S = fs.MeshOptions(), fs.ContactOptions(), fs.ScaleOptions()
Options = tuple[fs.MeshOptions, fs.ContactOptions, fs.ScaleOptions]
#: Knob -> options with elements twice as large, and half as large, in that respect.
KNOBS: dict[str, tuple[Options, Options]] = {
    "across": tuple(
        (replace(M, across=n, across_grading=g), C, S) for n, g in ((2, 2.56), (8, 1.265))
    ),
    "along": tuple((replace(M, along=h), C, S) for h in (1.6, 0.4)),
    "corner": tuple(
        (replace(M, corner=h, growth=g), C, S) for h, g in ((0.25, 4.0), (0.0625, 1.414))
    ),
    "scale layers": tuple(
        (replace(M, scale_layers=n, layer_growth=g), C, S) for n, g in ((3, 2.66), (9, 1.386))
    ),
    "scale base": (
        (replace(M, scale_corner=1.8, scale_rim=0.4, scale_size=6.8, scale_strips=2), C, S),
        (replace(M, scale_corner=0.45, scale_rim=0.1, scale_size=1.7, scale_strips=5), C, S),
    ),
    "modes": tuple((M, C, fs.ScaleOptions(cutoff=c)) for c in (1e-2, 2.5e-3)),
    "d_hat": tuple((M, replace(C, activation=d), S) for d in (0.01, 0.0025)),
    "all": ((M.finer(0.5), C, S), (M.finer(2.0), replace(C, activation=0.0025), S)),
}

Store = dict[str, dict]


def cases(pattern: str) -> list[tuple[str, Options]]:
    """Names and options of all runs of one pattern, the default first."""
    found = [(f"{pattern}: default", (M, C, S))]
    for knob, levels in KNOBS.items():
        for which, options in zip(("coarse", "fine"), levels, strict=True):
            found.append((f"{pattern}: {knob} {which}", options))
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
    mesh, contact, scales = options
    problem = CellProblem.from_pattern(pattern, mesh, contact=contact, scales=scales)
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
    """Observed rate and Richardson limit of values at three sizes; without a rate nan, the last."""
    first, second = values[0] - values[1], values[1] - values[2]
    if first * second > 0.0 and abs(first) > abs(second):
        rate = float(np.log2(first / second))
        # A slower rate is no rate yet: its limit would be a guess far beyond the values.
        end = values[2] - second / (first / second - 1.0) if rate > 0.8 else values[2]
        return rate, end
    return float("nan"), values[-1]


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
                panel.plot((2.0, 1.0, 0.5), errors, style, color=color, marker=".", linewidth=0.8)
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
