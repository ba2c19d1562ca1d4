"""The macro model of the flat cell and its gaps: against native sweeps.

    python benchmarks/gap_models.py --results DIR [--output FILE]

A gap model is made of a pattern's flat cell alone; "fitted" has two softenings from the sweep of
the pattern in DIR (`flexscale run workflows/named_patterns.yaml --results DIR`), "fit" is the
default fit with its 14 numbers a side. Errors are of native moments, all directions, both sides
and all curvatures above 0: root mean square of the logarithm, and the worst. Onsets are the least
of all sampled directions; native ones are between the last curvature free of contact and the first
one in contact. "meet": directions and sides in which native scales meet; "outside": those whose
onset by the model is not between these two samples, and by how much at most.

Strips without ends, with free sides, are no longer compared: they were sheets of the shell, which
has none any more.
"""

from __future__ import annotations

import time

import numpy as np
import xarray as xr
from report import datasets_and_output, heading, report, table

import flexscale as fs
from flexscale.datasets.registry import Registry
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.macro.gap_model import model_of_cell


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


def main() -> None:
    """All of it."""
    registry, output = datasets_and_output(__doc__ or "")
    rows = heading("Gap models", __doc__ or "")
    rows += against_sweeps(registry)
    report(rows, output)


if __name__ == "__main__":
    main()
