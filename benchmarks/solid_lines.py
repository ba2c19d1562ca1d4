"""Lines through contact by the solid cell: what joints are held against.

    python benchmarks/solid_lines.py [--log FILE] [--output FILE]

Rigid scales, to both sides, to 0.02 /mm. The log keeps one line of JSON for each sample; lines that
it has are not followed again. The mesh is coarse, and stiffer than its limit by some 4 % at rest:
each line begins with the stiffness at rest of the same mesh, to be compared with the limit of
`solid_tangents.py`.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from report import heading, report, table

import flexscale as fs
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import follow_line
from flexscale.homogenize.tangent import solve_tangent

#: Patterns and their directions, degree.
LINES = {"square": (0.0, 45.0), "hexagon": (0.0, 30.0), "chevron": (0.0, 90.0),
         "arrowhead": (0.0, 90.0)}  # fmt: skip
CURVATURES = (0.002, 0.004, 0.006, 0.008, 0.009, 0.01, 0.011, 0.012, 0.014, 0.016, 0.018, 0.02)
MODEL = fs.NativeModel(
    "solid",
    mesh=fs.MeshOptions(along=2.4, corner=0.3),
    scales=fs.ScaleOptions("rigid"),
    solid=fs.SolidOptions(edge=0.06, growth=2.0),
)
LOG = Path("results/local/solid_lines.jsonl")
KEPT = ("curvature", "status", "newton_iterations", "energy_density", "moment", "min_gap",
        "contact_force", "negative_eigenvalues")  # fmt: skip


def follow(name: str, direction: float, side: str) -> None:
    """Print one line of JSON for each sample."""
    pattern, start = fs.named_pattern(name), time.perf_counter()
    rest = solve_tangent(CellProblem.from_pattern(pattern, MODEL.without_contact))
    problem = CellProblem.from_pattern(pattern, MODEL)
    for sample in follow_line(problem, Line(side, direction, CURVATURES), MODEL.solver):
        line = {"pattern": name, "direction": direction, "side": side}
        line |= {key: float(sample[key]) for key in KEPT if key in sample}
        line |= {
            "stretch": list(map(float, sample.get("stretch", ()))),
            "stiffness_at_rest": rest.stiffness(direction),
            "n_unknowns": len(problem.active),
            "seconds": round(time.perf_counter() - start, 1),
            "peak_memory_gb": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6, 2),
        }
        print(json.dumps(line), flush=True)


def read(log: Path) -> list[dict[str, Any]]:
    return [json.loads(text) for text in log.read_text().splitlines()] if log.exists() else []


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--log", type=Path, default=LOG, help="file of the samples")
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    parser.add_argument("--one", help="follow this line alone and print its samples")
    options = parser.parse_args()
    if options.one:
        follow(*json.loads(options.one))
        return
    options.log.parent.mkdir(parents=True, exist_ok=True)
    for side in ("closing", "opening"):
        for name, direction in ((n, d) for n, given in LINES.items() for d in given):
            job = (name, direction, side)
            done = [
                s for s in read(options.log) if (s["pattern"], s["direction"], s["side"]) == job
            ]
            if done and done[-1]["curvature"] == CURVATURES[-1]:
                continue
            command = [sys.executable, __file__, "--one", json.dumps(job)]
            with options.log.open("a") as file:
                if subprocess.run(command, stdout=file, check=False).returncode:
                    print(f"{job} failed", file=sys.stderr, flush=True)
    head = ["pattern", "direction", "side", "curvature", "energy density", "moment", "status"]
    rows = [
        [s["pattern"], f"{s['direction']:g}", s["side"], f"{s['curvature']:g}",
         f"{s.get('energy_density', float('nan')):.5g}", f"{s.get('moment', float('nan')):.5g}",
         f"{s['status']:g}"]
        for s in read(options.log)
    ]  # fmt: skip
    title = "Lines through contact by the solid cell"
    report([*heading(title, __doc__), *table(head, rows)], options.output)


if __name__ == "__main__":
    main()
