"""What the paper says of its patterns, held against both native models, side by side.

    python benchmarks/findings.py [--results DIR] [--output FILE]

The shell is the paper's model, with directions every 15 degree; joints are what prints do, every 2
degree. Verdicts are those of `flexscale data findings --native shell` and `--native joints`; below
are the patterns on which the two differ, with the numbers of both.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from report import heading, report, table

import flexscale as fs
from flexscale.findings.table import all_findings
from flexscale.findings.verdict import Finding
from flexscale.steps.paper import paper_datasets

MODELS = ("joints", "shell")


def verdicts(found: dict[str, list[Finding]]) -> list[str]:
    """One row a finding."""
    rows = []
    for both in zip(*found.values(), strict=True):
        counts = [f"{item.verdict} ({item.count})" for item in both]
        rows.append([both[0].key.replace("_", " "), both[0].paper_says, *counts])
    return table(["finding", "the paper says", *MODELS], rows)


def differences(found: dict[str, list[Finding]]) -> list[str]:
    """Numbers of the patterns that hold in one model and not in the other."""
    lines = []
    for joints, shell in zip(*found.values(), strict=True):
        of_shell = {fact.pattern: fact for fact in shell.evidence}
        unlike = [
            (fact, of_shell[fact.pattern])
            for fact in joints.evidence
            if fact.pattern in of_shell and fact.holds != of_shell[fact.pattern].holds
        ]
        if unlike:
            rows = [[a.pattern, a.numbers, b.numbers] for a, b in unlike]
            lines += [f"### {joints.key.replace('_', ' ')}", "", f"Asked: {joints.criterion}", ""]
            lines += table(["pattern", *MODELS], rows)
    return lines


def main() -> None:
    """Print the tables, and write them if asked."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--results", type=Path, default=Path("results"))
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    arguments = parser.parse_args()
    registry = paper_datasets(fs.open_registry(arguments.results))
    found = {model: all_findings(registry, model) for model in MODELS}
    rows = heading("Findings by both native models", __doc__ or "")
    rows += verdicts(found)
    rows += ["## Where the models differ", "", *differences(found)]
    report(rows, arguments.output)


if __name__ == "__main__":
    main()
