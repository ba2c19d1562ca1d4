"""A fit in a few lines of text."""

from __future__ import annotations

import numpy as np

from flexscale.datasets.fit_values import FloatArray
from flexscale.datasets.schema import ASSESSMENTS
from flexscale.macro.assessment import FitErrors
from flexscale.macro.polar import DirectionalLaws, PolarLaw


def describe_laws(laws: DirectionalLaws, polar: PolarLaw) -> list[str]:
    """Ranges of the parameters over the sampled directions, one line for a and one per side."""
    lines = [f"  a        {_span(laws.a)} N mm in {len(laws.directions)} directions"]
    for index, side in enumerate(polar.sides):
        law = laws.law(index)
        seen = int(np.count_nonzero(law.has_contact))
        quantity = polar.onset_quantity[index]
        if quantity == "none":
            unused = polar.b[index].n_parameters + polar.onset[index].n_parameters
            lines.append(
                f"  {side:<8} no contact up to {polar.largest_curvature:g} mm-1; "
                f"its {unused} variables are 0"
            )
        else:
            lines.append(
                f"  {side:<8} b {_span(law.b)} N mm   kappa_0 {_span(law.kappa_0)} mm-1   "
                f"contact in {seen} of {int(laws.sampled[index].sum())} directions, "
                f"{quantity} interpolated"
            )
    return lines


def describe_errors(errors: FitErrors, sides: tuple[str, ...]) -> list[str]:
    """Relative moment errors over all directions, one line per assessment."""
    lines = ["  moment error [%], median / 95 % of the samples / worst"]
    for index, name in enumerate(ASSESSMENTS):
        shown = [
            f"{side} " + " / ".join(map(_percent, errors.overall_moment_error[index, position]))
            for position, side in enumerate(sides)
        ]
        lines.append(f"    {name.replace('_', ' '):<20} {'   '.join(shown)}")
    return lines


def _span(values: float | FloatArray) -> str:
    low, high = np.nanmin(values), np.nanmax(values)
    return f"{low:.4g}" if np.isclose(low, high, rtol=1e-3) else f"{low:.4g} … {high:.4g}"


def _percent(value: float) -> str:
    if np.isnan(value):
        return "-"
    return f"{100.0 * value:.1f}" if value < 0.1 else f"{100.0 * value:.0f}"
