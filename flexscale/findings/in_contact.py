"""Findings on what contact between scales does, closing and opening."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexscale.findings.measures import Stiffening, stiffening
from flexscale.findings.pattern_data import PatternData, convexity
from flexscale.findings.verdict import Evidence, Finding

SIGNIFICANT = 1.5  # slope in contact over the slope just before it
CONVEX = 0.999  # scales that fill more of their hull count as convex


def closing_meets(patterns: Sequence[PatternData]) -> Finding:
    """Closing brings scales into contact in every direction."""
    evidence = []
    for item in patterns:
        lines = stiffening(item.sweep, "closing")
        touching = sum(line.touches for line in lines)
        reach = float(item.sweep["curvature"].max())
        numbers = f"in {touching} of {len(lines)} directions up to {reach:g} mm-1"
        evidence.append(Evidence(item.name, touching == len(lines), numbers))
    return Finding(
        "closing meets",
        "Closing curvatures always induce contact.",
        "closing, all directions: scales touch up to the largest curvature",
        tuple(evidence),
    )


def closing_stiffens(patterns: Sequence[PatternData]) -> Finding:
    """The slope of the moment grows in contact, in every direction."""
    evidence = []
    for item in patterns:
        lines = [line for line in stiffening(item.sweep, "closing") if np.isfinite(line.gain)]
        if not lines:
            evidence.append(Evidence(item.name, False, "no contact seen"))
            continue
        least = min(lines, key=lambda line: line.gain)
        rest = min(lines, key=lambda line: line.rest_gain)
        numbers = (
            f"at least x{least.gain:.3g} ({least.direction:g}°); over the slope at rest "
            f"x{rest.rest_gain:.3g} ({rest.direction:g}°)"
        )
        evidence.append(Evidence(item.name, least.gain >= SIGNIFICANT, numbers))
    return Finding(
        "closing stiffens",
        "For all patterns, bending stiffness increases significantly in the contact regime.",
        f"closing, all directions that touch: the largest slope of the moment in contact is at "
        f"least {SIGNIFICANT:g} times that just before contact",
        tuple(evidence),
    )


def only_concave_scales_stiffen_opening(patterns: Sequence[PatternData]) -> Finding:
    """Where opening stiffens a sheet, its scales are non-convex."""
    evidence = []
    for item in patterns:
        share = convexity(item.cell)
        lines = stiffening(item.sweep, "opening")
        stiffer = [line for line in lines if line.gain >= SIGNIFICANT]
        shape = "convex" if share > CONVEX else f"non-convex ({share:.2f} of the hull)"
        evidence.append(
            Evidence(
                item.name,
                not stiffer or share <= CONVEX,
                f"{shape}; {_opened(lines, stiffer)}",
            )
        )
    return Finding(
        "only non-convex opening",
        "Contact-induced stiffening when opening only occurs for non-convex scale shapes.",
        f"opening: a pattern whose slope grows by contact to {SIGNIFICANT:g} times in any "
        "direction has non-convex scales",
        tuple(evidence),
        why="The four pentagons of a cell do not tilt alike: while the sheet opens, neighbors come "
        "together across some of their edges and open the more across the others. Convex scales "
        "can meet that way.",
    )


def opening_can_stiffen(patterns: Sequence[PatternData]) -> Finding:
    """Some pattern interlocks when it opens, in some directions and not in others."""
    evidence = []
    for item in patterns:
        lines = stiffening(item.sweep, "opening")
        stiffer = [line for line in lines if line.gain >= SIGNIFICANT]
        holds = 0 < len(stiffer) < len(lines)
        evidence.append(Evidence(item.name, holds, _opened(lines, stiffer)))
    return Finding(
        "opening can stiffen",
        "Opening curvatures can likewise lead to contact and stiffening, which is highly "
        "direction-dependent (Fig. 11).",
        f"a pattern, opening: the slope grows by contact to {SIGNIFICANT:g} times in some "
        "directions, not in all",
        tuple(evidence),
        of_all=False,
    )


def _opened(lines: Sequence[Stiffening], stiffer: Sequence[Stiffening]) -> str:
    touching = sum(line.touches for line in lines)
    if not touching:
        return "no contact when opening"
    text = f"opening, contact in {touching} of {len(lines)} directions"
    if not stiffer:
        return f"{text}, none stiffens"
    most = max(stiffer, key=lambda line: line.gain)
    return f"{text}, {len(stiffer)} stiffen, up to x{most.gain:.3g} ({most.direction:g}°)"
