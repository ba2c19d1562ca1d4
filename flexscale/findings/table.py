"""All findings, and how they are written down."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from flexscale.findings import at_rest, in_contact, turning
from flexscale.findings.pattern_data import PatternData, collect
from flexscale.findings.verdict import Finding

if TYPE_CHECKING:
    from flexscale.datasets.registry import Registry

#: In the order of the paper's section.
FINDINGS: tuple[Callable[[Sequence[PatternData]], Finding], ...] = (
    in_contact.closing_stiffens,
    turning.quasi_isotropic_turns_tetragonal,
    at_rest.three_fold_is_isotropic,
    turning.three_fold_grows_lobes,
    turning.lobes_depend_on_curvature,
    at_rest.four_fold_is_tetragonal,
    turning.four_fold_axes_turn,
    at_rest.reflections_are_orthotropic,
    turning.soft_and_stiff_change_places,
    in_contact.closing_meets,
    in_contact.opening_can_stiffen,
    in_contact.only_concave_scales_stiffen_opening,
    at_rest.double_curvature_is_resisted,
)


def all_findings(registry: Registry, native: str = "shell") -> list[Finding]:
    """Every finding on all patterns of a registry that have a sweep, a tangent and a cell.

    Parameters
    ----------
    native : the native model whose datasets are judged.

    Raises
    ------
    MissingDataError : there are none, or several datasets of a kind for one pattern.
    """
    patterns = collect(registry, native)
    return [finding(patterns) for finding in FINDINGS]


def findings_text(findings: Sequence[Finding], *, evidence: bool = True) -> str:
    """Findings to be read in a terminal: verdict, statement, criterion, numbers by pattern."""
    lines = []
    for item in findings:
        kind = "of all" if item.of_all else "of at least one"
        lines.append(f"{item.verdict.upper()}  {item.key} ({item.count} patterns)")
        lines += _wrapped(f"paper: {item.paper_says}")
        lines += _wrapped(f"asked, {kind}: {item.criterion}")
        if why := item.to_dict()["why"]:
            lines += _wrapped(f"why: {why}")
        if evidence:
            lines += [
                f"    {'yes' if fact.holds else 'no':<4}{fact.pattern:<12}{fact.numbers}"
                for fact in item.evidence
            ]
        lines.append("")
    return "\n".join(lines)


def _wrapped(text: str) -> list[str]:
    return textwrap.wrap(text, 98, initial_indent="  ", subsequent_indent="    ")
