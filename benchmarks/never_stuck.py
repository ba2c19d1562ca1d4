"""Were all samples of a set of sweeps reached, and how hard was it?

    python benchmarks/never_stuck.py --results DIR [--output FILE]

DIR is where `flexscale run workflows/named_patterns.yaml --results DIR` has put its datasets. Of
every pattern: samples solved (those that symmetry fills in are not counted), converged ones, ones
in contact, the smallest distance that scales keep, saddles left on the way, iterations before and
in contact, and the mesh error at rest that the dataset carries. Then every sample that was not
reached, with its status. Contact that forms gradually is told by the direction's moments: the share
of the moment at the largest curvature's slope that the first sample in contact has already.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import xarray as xr
from report import report

import flexscale as fs
from flexscale.status import SolveStatus

HEAD = (
    "| pattern | solved | converged | % | in contact | smallest distance, mm | saddles left "
    "| iterations before / in contact | mesh error at rest |"
)


def solved_part(sweep: xr.Dataset) -> xr.Dataset:
    """Directions that were solved themselves."""
    own = sweep["symmetry_source"] == sweep["direction"]
    own = own.all([name for name in own.dims if name != "direction"])
    return sweep.isel(direction=np.flatnonzero(own.values))


def row(name: str, sweep: xr.Dataset) -> str:
    """Table row of a pattern."""
    part = solved_part(sweep)
    status = part["status"].values
    done = status == SolveStatus.converged
    touching = done & (part["contact_pairs"].values > 0)
    iterations = part["newton_iterations"].values
    before = iterations[done & ~touching]
    cells = [
        name,
        str(status.size),
        str(int(done.sum())),
        f"{100.0 * done.mean():.1f}",
        str(int(touching.sum())),
        f"{np.nanmin(part['min_gap'].values):.2g}",
        str(int(part["saddles_left"].values[done].sum())),
        f"{before.mean():.1f} / {iterations[touching].mean():.1f}" if touching.any() else "-",
        f"{100.0 * sweep.attrs['mesh_error_at_rest']:.1f} %",
    ]
    return f"| {' | '.join(cells)} |"


def missing(name: str, sweep: xr.Dataset) -> list[str]:
    """Lines with the samples that were not reached."""
    part, found = solved_part(sweep), []
    for side in part["side"].values:
        for direction in part["direction"].values:
            line = part.sel(side=side, direction=direction)
            failed = np.flatnonzero(line["status"].values != SolveStatus.converged)
            if len(failed):
                first = SolveStatus(int(line["status"].values[failed[0]])).name
                kappa = line["curvature"].values[failed[0]]
                found.append(
                    f"- {name}, {side}, {direction:g}°: {first} at {kappa:g} /mm, "
                    f"{len(failed)} samples missing"
                )
    return found


def gradual(name: str, sweep: xr.Dataset) -> list[str]:
    """Rows with how suddenly contact sets in, per side and direction that touches.

    Of the slopes of the moment before contact, in the first interval that ends in contact, and in
    the last one: 0 % is no change at first, 100 % is the final slope at once.
    """
    found, part = [], solved_part(sweep)
    for side in part["side"].values:
        shares = []
        for direction in part["direction"].values:
            line = part.sel(side=side, direction=direction)
            kappa, moment = line["curvature"].values, line["moment"].values
            touching = np.flatnonzero(line["contact_pairs"].values > 0)
            if len(touching) < 3 or touching[0] < 2 or not np.isfinite(moment).all():
                continue
            slopes, k = np.diff(moment) / np.diff(kappa), touching[0]
            last = slopes[-1]
            share = (slopes[k] - slopes[k - 2]) / (last - slopes[k - 2])
            shares.append(f"{direction:g}°: {100.0 * share:.0f} %")
        if shares:
            found.append(f"| {name} | {side} | {', '.join(shares)} |")
    return found


def main() -> None:
    """All sweeps of a results folder."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--results", type=Path, required=True, help="folder of the datasets")
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    arguments = parser.parse_args()
    registry = fs.open_registry(arguments.results)
    found = [registry.load(entry) for entry in registry.find(kind="sweep")]
    sweeps = {str(sweep["pattern"].item()): sweep for sweep in found}
    rows = ["# Samples reached", "", (__doc__ or "").split("\n\n")[2], "", HEAD]
    rows.append("|" + "---|" * 9)
    rows += [row(name, sweep) for name, sweep in sweeps.items()]
    total = sum(solved_part(s)["status"].size for s in sweeps.values())
    reached = sum(
        int((solved_part(s)["status"].values == SolveStatus.converged).sum())
        for s in sweeps.values()
    )
    rows += ["", f"In all {reached} of {total}: {100.0 * reached / total:.2f} %.", ""]
    rows += ["## Not reached", ""]
    rows += [line for name, sweep in sweeps.items() for line in missing(name, sweep)] or ["None."]
    rows += ["", "## How suddenly contact sets in", "", "| pattern | side | share of the slope |"]
    rows.append("|---|---|---|")
    rows += [line for name, sweep in sweeps.items() for line in gradual(name, sweep)]
    report(rows, arguments.output)


if __name__ == "__main__":
    main()
