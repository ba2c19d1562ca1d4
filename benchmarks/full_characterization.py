"""The named patterns in full: samples, iterations, processor time and memory of each sweep.

    python benchmarks/full_characterization.py --results DIR [--output FILE]

DIR is where `flexscale run workflows/full_characterization.yaml --results DIR` has put its sweeps:
every 2° over 180°, to both sides, 12 curvatures up to 0.025 mm-1. Directions that symmetry makes
equivalent are solved once. Processor time is that of the sweep, of all its processes; on two cores
that have nothing else to do a sweep takes half of it. "*": it went on after a stop, and this is of
the rest. Mesh errors are those that the datasets
carry: of the stiffness at rest, from elements twice as large.
"""

from __future__ import annotations

import numpy as np
from never_stuck import solved_part
from report import datasets_and_output, heading, report, table

from flexscale.status import SolveStatus

MANY = 90  # directions of a full characterization
GOALS = {"hexagon": 5.0}  # minutes on two cores
GOAL = 30.0


def main() -> None:
    """All full sweeps of a results folder."""
    registry, output = datasets_and_output(__doc__ or "")
    rows, total = [], 0.0
    for entry in registry.find(kind="sweep"):
        sweep = registry.load(entry)
        if sweep.sizes["direction"] < MANY:
            continue
        part, run = solved_part(sweep), registry.record(entry)["run"]
        done = part["status"].values == SolveStatus.converged
        touching = done & (part["contact_pairs"].values > 0)
        iterations = part["newton_iterations"].values
        name, minutes = str(sweep["pattern"].values), run["cpu_seconds"] / 60.0
        total += minutes
        rows.append([
            name, str(int(sweep["status"].size)), str(done.size), str(int(done.sum())),
            str(int(touching.sum())), f"{iterations[done & ~touching].mean():.1f}",
            f"{iterations[touching].mean():.1f}", str(int(np.max(iterations))),
            f"{minutes:.1f}{'*' if run.get('resumed') else ''}",
            f"{0.5 * minutes:.1f}", f"{GOALS.get(name, GOAL):g}", f"{run['peak_memory_mib']:,.0f}",
            f"{100.0 * sweep.attrs['mesh_error_at_rest']:.1f}",
        ])  # fmt: skip
    rows.sort(key=lambda row: float(row[9]))
    head = [
        "pattern", "samples", "solved", "converged", "in contact", "iterations before contact",
        "in contact", "most", "processor, min", "half of it", "goal", "memory, MiB",
        "mesh error, %",
    ]  # fmt: skip
    lines = heading("Named patterns in full", __doc__ or "") + table(head, rows)
    report([*lines, f"In all {total:.0f} minutes of one core."], output)


if __name__ == "__main__":
    main()
