"""A fit in a few lines of text."""

from __future__ import annotations

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.datasets.variables import ASSESSMENTS
from flexscale.macro.assessment import FitErrors
from flexscale.macro.polar import DirectionalLaws, PolarLaw


def describe_laws(laws: DirectionalLaws, polar: PolarLaw) -> list[str]:
    """Ranges of the parameters over the sampled directions, one line for a and one per side."""
    lines = [f"  a        {_span(laws.a)} N mm in {len(laws.directions)} directions"]
    if laws.softening > 0.0:
        lines[0] += f", halved at an energy of {1.0 / laws.softening:.3g} N mm-1"
    for index, side in enumerate(polar.sides):
        law = laws.law(index)
        seen, sampled = int(np.count_nonzero(law.has_contact)), int(laws.sampled[index].sum())
        quantity = polar.onset_quantity[index]
        if quantity == "none":
            unused = polar.b[index].n_parameters + polar.onset[index].n_parameters
            what = f"no contact up to {polar.largest_curvature:g} mm-1"
            if seen:
                what = (
                    f"contact in {seen} of {sampled} directions, too late in the sweep to be fitted"
                )
            lines.append(f"  {side:<8} {what}; its {unused} variables are 0")
        else:
            lines.append(
                f"  {side:<8} b {_span(law.b)} N mm   kappa_0 {_span(law.kappa_0)} mm-1   "
                f"contact in {seen} of {sampled} directions, "
                f"{quantity} interpolated"
            )
    return lines


def describe_sheet(in_plane: FloatArray | None, w_biaxial: float) -> list[str]:
    """In-plane stiffness, if known, and resistance to double curvature."""
    if in_plane is None:
        return ["  in plane not known: no tangent was given"]
    names = ("xxxx", "yyyy", "xxyy", "xyxy", "xxxy", "yyxy")
    places = ((0, 0), (1, 1), (0, 1), (2, 2), (0, 2), (1, 2))
    floor = 1e-6 * np.abs(in_plane).max()  # below are roundings of what symmetry makes 0
    shown = [
        f"{name} {in_plane[place]:.4g}"
        for name, place in zip(names, places, strict=True)
        if abs(in_plane[place]) > floor
    ]
    return [f"  in plane {', '.join(shown)} N mm-1;  w_biaxial {w_biaxial:.4g} N mm3"]


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
