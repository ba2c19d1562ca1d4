"""Were all samples of a set of sweeps reached, and how hard was it?

    python benchmarks/never_stuck.py --results DIR [--output FILE]

DIR is where `flexscale run workflows/named_patterns.yaml --results DIR` has put its datasets. Of
every pattern: samples solved (those that symmetry fills in are not counted), converged ones, ones
in contact, the smallest distance that scales keep, saddles left on the way, iterations before and
in contact, and the mesh error at rest that the dataset carries. Then every sample that was not
reached, with its status; how gradually contact sets in (`datasets.onset`); and the samples at which
the way back from the next curvature met another equilibrium.
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from report import datasets_and_output, report

from flexscale.datasets.onset import contact_onset
from flexscale.status import SolveStatus

FAR = 0.03  # mm-1; other sweeps in the folder go less far, the quickstart's for instance
SAME = 1e-5  # relative difference in energy up to which two equilibria are one
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
    """Rows with where contact sets in and over which range, per side that touches."""
    found, part = [], solved_part(sweep)
    onset = contact_onset(part)
    for side in part["side"].values:
        line = onset.sel(side=side)
        texts = []
        for direction in line["direction"].values:
            at = line.sel(direction=direction)
            if np.isnan(at["free_until"]):
                continue
            begin, end = (float(at[k]) for k in ("onset_begin", "onset_end"))
            where = f"{direction:g}°: after {float(at['free_until']):g}"
            if np.isfinite(begin):
                sudden = at["onset_spread"] <= at["onset_resolution"]
                where += f", {begin:.4f}–{end:.4f}{' (sudden)' if sudden else ''}"
            texts.append(where)
        if texts:
            found.append(f"| {name} | {side} | {'; '.join(texts)} |")
    return found


def branches(name: str, sweep: xr.Dataset) -> list[str]:
    """Rows with samples at which bending back met another equilibrium than bending on."""
    found, part = [], solved_part(sweep)
    if "moment_returning" not in part:
        return found
    energy = part["energy_density_returning"] / part["energy_density"] - 1.0
    moment = part["moment_returning"] / part["moment"] - 1.0
    checked = int(np.isfinite(energy).sum())
    other = np.abs(energy) > SAME
    for side in part["side"].values:
        for direction in part["direction"].values:
            at = {"side": side, "direction": direction}
            texts = [
                f"{kappa:g}: {100.0 * float(energy.sel(at).sel(curvature=kappa)):+.2f} / "
                f"{100.0 * float(moment.sel(at).sel(curvature=kappa)):+.1f} %"
                for kappa in part["curvature"].values[other.sel(at).values]
            ]
            if texts:
                found.append(f"| {name} | {side} | {direction:g}° | {'; '.join(texts)} |")
    found.append(f"| {name} | both | | {int(other.sum())} of {checked} checked |")
    return found


def main() -> None:
    """All sweeps of a results folder."""
    registry, output = datasets_and_output(__doc__ or "")
    found = [registry.load(entry) for entry in registry.find(kind="sweep")]
    found = [sweep for sweep in found if sweep["curvature"].max() >= FAR]
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
    rows += ["", "## How suddenly contact sets in", "", "Directions with the last sample free of "]
    rows[-1] += "contact, and the range over which the slope rises from 10 to 90 % [mm-1]."
    rows += ["", "| pattern | side | onset |", "|---|---|---|"]
    rows += [line for name, sweep in sweeps.items() for line in gradual(name, sweep)]
    rows += ["", "## Where there is more than one branch", ""]
    rows += ["Energy / moment on the way back, relative to the way on, at curvatures [mm-1].", ""]
    rows += ["| pattern | side | direction | way back |", "|---|---|---|---|"]
    rows += [line for name, sweep in sweeps.items() for line in branches(name, sweep)]
    report(rows, output)


if __name__ == "__main__":
    main()
