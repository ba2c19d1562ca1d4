"""Moment errors of the fit, with the paper's choices and with ours, for every sweep in a folder.

    python benchmarks/fit_errors.py --results DIR [--output FILE]

The sweeps come from `flexscale run workflows/named_patterns.yaml --results DIR`, or any other. Each
is fitted three times: as the paper does (a, b and κ0 of every direction, absolute errors), with
relative errors instead, and by default (a of the flat cell and one softening; b and κ0 with
relative errors). Errors are |fit − native| / |native| of the moment with the harmonics, over all
directions and both sides: median / 95th percentile, in %. "low": up to 0.004 mm-1, where no scales
touch; "high": from 0.01 mm-1 on; "held out": all curvatures, in directions that the fit was not
given. "mesh" is the element size in scales, 3.4 mm by default. The
second table has the numbers of the default fit: its softening, in-plane stiffnesses in N/mm, and
w_biaxial; then the time of one evaluation of its law, with and without Hessian.
"""

from __future__ import annotations

import json
import time
from typing import Any

import numpy as np
from numba import njit
from report import datasets_and_output, report, table

import flexscale as fs
from flexscale.datasets.variables import ASSESSMENTS, STATISTICS
from flexscale.macro.tensor_law import law

LOW, HIGH = 0.004, 0.01  # mm-1
CHOICES: dict[str, dict[str, Any]] = {
    "paper": {"variant": "paper", "weighting": "absolute"},
    "relative": {"variant": "paper", "weighting": "relative"},
    "default": {},
}
ERRORS = ["pattern", "mesh, mm", "fit", "low", "high", "high, closing", "high, opening", "held out"]
NUMBERS = ["pattern", "variables", "s, mm/N", "A_xxxx", "A_yyyy", "A_xxyy", "A_xyxy", "w, N mm3"]


def relative_errors(model: fs.MacroModel, sweep: Any) -> np.ndarray:
    """(sides, directions, curvatures) without curvature 0; nan where not converged."""
    curvatures, directions = sweep["curvature"].values[1:], sweep["direction"].values[:, None]
    found = []
    for side in model.sides:
        native = sweep["moment"].sel(side=side).transpose("direction", "curvature").values[:, 1:]
        found.append(np.abs(model.moment(curvatures, directions, side) / native - 1.0))
    return np.stack(found)


def percent(values: np.ndarray) -> str:
    """Median / 95th percentile, in %."""
    known = values[np.isfinite(values)]
    if not known.size:
        return "–"
    return " / ".join(f"{100.0 * item:.3g}" for item in np.percentile(known, [50.0, 95.0]))


def held_out(model: fs.MacroModel) -> str:
    """Both sides' statistics in directions held out; the worse of the sides."""
    errors = model.errors.overall_moment_error[ASSESSMENTS.index("held_out_direction")]
    worst = np.nanmax(errors, axis=0) if np.isfinite(errors).any() else errors[0]
    shown = [worst[STATISTICS.index(name)] for name in ("median", "percentile_95")]
    return " / ".join(f"{100.0 * item:.3g}" for item in shown)


def measure(sweep: Any) -> tuple[list[list[str]], list[str]]:
    """Rows of both tables for one sweep."""
    pattern = str(sweep["pattern"].values)
    mesh = f"{json.loads(sweep.attrs['flexscale_config'])['mesh']['scale_size']:g}"
    curvatures = sweep["curvature"].values[1:]
    low, high = curvatures <= LOW, curvatures >= HIGH
    rows = []
    for name, choice in CHOICES.items():
        model = fs.fit(sweep, **choice)
        errors = relative_errors(model, sweep)
        parts = [errors[..., low], errors[..., high], *errors[..., high]]
        shown = [percent(part) for part in parts]
        rows.append([pattern, mesh, name, *shown, held_out(model)])
    numbers = [model.polar.softening, *(model.in_plane[i, j] for i, j in PLACES), model.w_biaxial]
    return rows, [pattern, str(model.n_parameters), *(f"{number:.4g}" for number in numbers)]


PLACES = ((0, 0), (1, 1), (0, 1), (2, 2))


def law_time(parameters: np.ndarray, *, hessian: bool) -> float:
    """Microseconds of one evaluation of energy derivatives beyond contact, on one core."""
    e, b, grad = np.zeros(3), np.array([0.02, 0.003, -0.005]), np.empty(6)
    hess = np.empty((6, 6) if hessian else (0, 0))
    _repeat(10, e, b, parameters, grad, hess)
    start = time.perf_counter()
    _repeat(100_000, e, b, parameters, grad, hess)
    return 10.0 * (time.perf_counter() - start)


@njit
def _repeat(count, e, b, parameters, grad, hess):
    for _ in range(count):
        law(e, b, parameters, grad, hess)


def main() -> None:
    """Print the tables, and write them if asked."""
    registry, output = datasets_and_output(__doc__ or "")
    errors: list[list[str]] = []
    numbers: list[list[str]] = []
    for entry in registry.find(kind="sweep"):
        rows, row = measure(registry.load(entry))
        for line in rows:
            print(" ".join(line), flush=True)
        errors += rows
        numbers.append(row)
    parameters = fs.fit(registry.load(next(iter(registry.find(kind="sweep"))))).law_parameters()
    times = [law_time(parameters, hessian=hessian) for hessian in (False, True)]
    cost = f"Law: {times[0]:.1f} µs with gradient, {times[1]:.1f} µs with Hessian as well."
    report([*table(ERRORS, errors), "", *table(NUMBERS, numbers), "", cost], output)


if __name__ == "__main__":
    main()
