"""Stored datasets computed again from their recipes: does the same come out, to the last bit?

    python benchmarks/recompute.py --results DIR [--output FILE]

On the machine that made a dataset, with the same code and libraries and one thread, its content has
the same digest. Code that is newer rounds sums otherwise, or changes numbers: the largest
difference of a variable over its largest value says which. Where two stable states lie close
together, rounding may decide which one is met: hexagons that close along 0° have two at 0.02 and
0.025 /mm, less than 0.1 % apart in energy and moment. What is left of zero, and counts of
iterations and contact pairs, are not listed.
"""

from __future__ import annotations

import os

from report import datasets_and_output, heading, report

from flexscale.processes import single_threaded

single_threaded(os.environ)  # as jobs run; before numpy is imported

from flexscale.steps.recompute import ROUNDING, recompute  # noqa: E402

#: Kind -> patterns; sweeps take minutes.
CHOSEN = {
    "cell": ("square", "hexagon", "arrowhead"),
    "tangent": ("square", "hexagon", "arrowhead"),
    "fit": ("square", "hexagon", "arrowhead"),
    "sheet": ("square", "hexagon", "arrowhead"),
    "turned_sheet": ("threefold", "arrowhead"),
    "sweep": ("hexagon",),
}


def main() -> None:
    """One row a dataset."""
    registry, output = datasets_and_output(__doc__ or "")
    rows = heading("Datasets computed again", __doc__ or "")
    rows += ["| dataset | pattern | made by | digest | largest difference | s |", "|---" * 6 + "|"]
    for kind, patterns in CHOSEN.items():
        for pattern in patterns:
            for entry in registry.find(kind=kind, pattern=pattern):
                found = recompute(entry, registry)
                listed = {k: v for k, v in found.differences.items() if k not in ROUNDING}
                worst = max(listed, key=lambda name: listed[name], default="")
                cells = [
                    entry.id,
                    pattern,
                    str(entry.row["commit"])[:7],
                    "same" if found.same else "other",
                    f"{worst} {listed[worst]:.1e}" if worst else "",
                    f"{found.seconds:.0f}",
                ]
                rows.append(f"| {' | '.join(cells)} |")
    report(rows, output)


if __name__ == "__main__":
    main()
