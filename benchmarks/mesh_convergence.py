"""Energy and moment before and in contact against every knob of the mesh and of contact.

    python benchmarks/mesh_convergence.py [--patterns NAME …] [--only-report]

Squares, hexagons, chevrons and arrowheads, both sides, softest and stiffest direction of the flat
sheet, at 0.002 /mm (before contact), 0.015 and 0.025 /mm. One knob at a time is refined, the others
stay at their default; at the end all of them are finer together. What is done is kept in
results/reference/benchmarks/mesh_convergence.json and not done again; tables (.md) and a figure
(.png) are made from it.

A knob is refined twice, by the same factor r. From the values at its three levels follow the
observed rate p = log(d1 / d2) / log r of the differences d1, d2, where both have one sign, and for
p > 0.8 the Richardson limit; the error of the default is its distance from there, else from the
finest.
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

M, C = fs.MeshOptions(), fs.ContactOptions()
#: Knob -> refinement factor, and the levels beyond the default.
KNOBS: dict[str, tuple[float, list[tuple[fs.MeshOptions, fs.ContactOptions]]]] = {
    "across": (2.0, [(replace(M, across=4), C), (replace(M, across=8), C)]),
    "along": (2.0, [(replace(M, along=0.4), C), (replace(M, along=0.2), C)]),
    "corner": (2.0, [(replace(M, corner=0.125), C), (replace(M, corner=0.0625), C)]),
    "scale layers": (
        2.0,
        [
            (replace(M, scale_layers=6, layer_growth=3.0**0.5), C),
            (replace(M, scale_layers=12, layer_growth=3.0**0.25), C),
        ],
    ),
    "scale base": (
        2.0,
        [
            (replace(M, scale_corner=0.45, scale_rim=0.225, scale_size=1.7, scale_strips=2), C),
        ],
    ),
    "d_hat": (2.0, [(M, replace(C, activation=0.0025)), (M, replace(C, activation=0.00125))]),
    "all": (2.0, [(M.finer(2.0), replace(C, activation=0.0025))]),
}

Store = dict[str, dict]


def cases(pattern: str) -> list[tuple[str, fs.MeshOptions, fs.ContactOptions]]:
    """Names and options of all runs of one pattern, the default first."""
    found = [(f"{pattern}: default", M, C)]
    for knob, (_, levels) in KNOBS.items():
        found += [(f"{pattern}: {knob} {k}", *level) for k, level in enumerate(levels, start=1)]
    return found


def lines_of(pattern: fs.Pattern) -> list[Line]:
    """Both sides of the softest and the stiffest direction."""
    tangent = fs.tangent_stiffness(pattern)
    directions = [round(angle, 1) % 180.0 for angle in (tangent.softest, tangent.stiffest)]
    if tangent.stiffness(directions[1]) < 1.001 * tangent.stiffness(directions[0]):
        directions = [0.0, 30.0]  # isotropic: any two
    return [Line(side, d, CURVATURES) for side in ("closing", "opening") for d in directions]


def run(name: str, pattern: fs.Pattern, mesh: fs.MeshOptions, contact: fs.ContactOptions) -> dict:
    """Energies and moments of all lines on one mesh."""
    start = time.perf_counter()
    problem = CellProblem.from_pattern(pattern, mesh, contact=contact)
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


def limit(values: list[float], factor: float) -> tuple[float, float]:
    """Observed rate and Richardson limit of values at up to three levels; nan without a rate."""
    if len(values) == 3:
        first, second = values[0] - values[1], values[1] - values[2]
        if first * second > 0.0 and abs(first) > abs(second):
            rate = float(np.log(first / second) / np.log(factor))
            # A slower rate is no rate yet: its limit would be a guess far beyond the values.
            end = values[2] - second / (first / second - 1.0) if rate > 0.8 else values[2]
            return rate, end
    return float("nan"), values[-1]


def tables(store: Store) -> list[str]:
    """Markdown tables, one per pattern."""
    rows = ["# Convergence with mesh and contact", "", (__doc__ or "").split("\n\n")[2], ""]
    for pattern in PATTERNS:
        base = store.get(f"{pattern}: default")
        if base is None:
            continue
        rows += [f"## {pattern}", "", "Moments; error of the default against the knob's limit.", ""]
        knobs = [k for k in KNOBS if f"{pattern}: {k} 1" in store]
        rows.append("| sample | M, N | " + " | ".join(f"{k}: error (rate)" for k in knobs) + " |")
        rows.append("|---" * (len(knobs) + 2) + "|")
        for sample in (key for key in base if key not in ("unknowns", "seconds")):
            cells = [sample, _moment(base[sample])]
            for knob in knobs:
                factor, levels = KNOBS[knob]
                names = [f"{pattern}: {knob} {k}" for k in range(1, len(levels) + 1)]
                found = [store[n][sample][1] for n in names if n in store]
                cells.append(_error([base[sample][1], *found], factor))
            rows.append("| " + " | ".join(cells) + " |")
        rows += ["", "| run | unknowns | s |", "|---|---|---|"]
        rows += [
            f"| {name.split(': ')[1]} | {entry['unknowns']} | {entry['seconds']} |"
            for name, entry in store.items()
            if name.startswith(f"{pattern}: ")
        ]
        rows.append("")
    return rows


def _moment(entry: list) -> str:
    touching = " (in contact)" if entry[2] else ""
    return "not converged" if entry[3] else f"{entry[1]:.4g}{touching}"


def _error(values: list[float | None], factor: float) -> str:
    if None in values:
        return "not converged"
    numbers = [float(value) for value in values if value is not None]
    rate, end = limit(numbers, factor)
    shown = "" if np.isnan(rate) else f" ({rate:.1f})"
    return f"{100.0 * (numbers[0] / end - 1.0):+.2f} %{shown}"


def draw(store: Store, path: Path) -> None:
    """Error of the moment against each knob, one panel per knob, one curve per sample."""
    done = [p for p in PATTERNS if f"{p}: default" in store]
    figure, axes = plt.subplots(
        len(done), len(KNOBS), figsize=(2.1 * len(KNOBS), 2.1 * len(done)), squeeze=False,
        sharey=True, layout="constrained",
    )  # fmt: skip
    for row, pattern in zip(axes, done, strict=True):
        for panel, (knob, (factor, levels)) in zip(row, KNOBS.items(), strict=True):
            names = [f"{pattern}: default"]
            names += [f"{pattern}: {knob} {k}" for k in range(1, len(levels) + 1)]
            entries = [store[n] for n in names if n in store]
            for sample in (key for key in entries[0] if key not in ("unknowns", "seconds")):
                values = [entry[sample][1] for entry in entries]
                if len(values) < 2 or None in values:
                    continue
                errors = 100.0 * (np.array(values) / limit(values, factor)[1] - 1.0)
                size = factor ** -np.arange(len(values))
                style = "-" if sample.startswith("closing") else "--"
                color = {"0.002": "C0", "0.015": "C1", "0.025": "C3"}[sample.split()[-1]]
                panel.plot(size, errors, style, color=color, marker=".", linewidth=0.8)
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
        for case, mesh, contact in cases(name):
            if case not in store:
                store[case] = run(case, pattern, mesh, contact)
                STORE.write_text(json.dumps(store, indent=1) + "\n")
    STORE.with_suffix(".md").write_text("\n".join(tables(store)) + "\n")
    draw(store, STORE.with_suffix(".png"))


if __name__ == "__main__":
    main()
