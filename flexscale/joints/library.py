"""Laws of joints: those that ship with the package, those kept on this machine, and any other."""

from __future__ import annotations

import logging

import shapely

from flexscale.checks import PATTERN, checked, instance, length, optional
from flexscale.errors import PatternError
from flexscale.joints.compute import Progress, SolvedJoint, compute_joint
from flexscale.joints.key import JointGroove, JointKey, joint_key
from flexscale.joints.storage import keep_joint, load_joint
from flexscale.mechanics.joint_law import JointLaw
from flexscale.patterns.joint_lines import find_joints, joint_gaps
from flexscale.patterns.pattern import Pattern

log = logging.getLogger(__name__)

_SAME_GAP = 1e-6  # relative: keys of joints hold as many digits


@checked(
    pattern=PATTERN,
    gap=optional(length()),
    groove=instance("flexscale.joints.key:JointGroove", "give a JointGroove"),
)
def joint_law(
    pattern: Pattern,
    *,
    gap: float | None = None,
    groove: JointGroove | None = None,
    progress: Progress | None = None,
) -> JointLaw:
    """The law of a pattern's joints: in no time if it was solved before, else in a minute or two.

    Parameters
    ----------
    pattern : its gap, thickness, scale height and materials count.
    gap : mm, of those that joints of the pattern have; may be left out where there is one.
    groove : of the sheet under every scale; None for a plain base.
    progress : called with how many of how many ways of states are done, while it is computed.

    Raises
    ------
    PatternError : sizes for which no joint can be computed, or a gap that no joint has.
    """
    key = pattern_key(pattern, groove, gap)
    return solved_joint(key, progress).law(
        pattern.substrate_thickness, pattern.substrate_material.young_modulus
    )


def joint_laws(pattern: Pattern) -> tuple[JointLaw, ...]:
    """Laws of a pattern's joints, one for each gap, the narrowest first; see `joint_law`."""
    return tuple(joint_law(pattern, gap=gap) for gap in joint_gaps(pattern))


def pattern_key(
    pattern: Pattern, groove: JointGroove | None = None, gap: float | None = None
) -> JointKey:
    """Key of a pattern's joints, whose scales deform in their rims unless their material is rigid.

    Parameters
    ----------
    gap : mm, of the joint; may be left out where there is one.

    Raises
    ------
    PatternError : sizes for which no joint can be computed, or a gap that no joint has.
    """
    chosen = _chosen_gap(pattern, gap)
    return joint_key(
        chosen,
        pattern.substrate_thickness,
        pattern.scale_height,
        pattern.substrate_material,
        None if pattern.scale_material.is_rigid else pattern.scale_material,
        groove,
        half_width(pattern, chosen),
    )


def _chosen_gap(pattern: Pattern, gap: float | None) -> float:
    """The gap asked for, or the only one, mm."""
    known = joint_gaps(pattern)
    for one in known:
        if gap is None and len(known) == 1:
            return one
        if gap is not None and abs(gap - one) <= _SAME_GAP * one:
            return one
    told = ", ".join(f"{one:g}" for one in known)
    wrong = "" if gap is None else f", none of {gap:g} mm"
    raise PatternError(
        f"Joints of pattern {pattern.name!r} have gaps of {told} mm{wrong}: say which with gap=…"
    )


def half_width(pattern: Pattern, gap: float) -> float:
    """Half width [mm] of the narrowest scale that has a joint of a gap, mm: the radius of the
    largest circle in its outline."""
    outlines = pattern.outlines()
    if len(set(pattern.gaps)) > 1:
        pairs = [(j.first, j.second) for j in find_joints(pattern) if j.gaps[0] == gap]
        outlines = tuple(outlines[number] for number in sorted({n for pair in pairs for n in pair}))
    return min(
        float(shapely.maximum_inscribed_circle(shapely.Polygon(outline)).length)
        for outline in outlines
    )


def solved_joint(key: JointKey, progress: Progress | None = None) -> SolvedJoint:
    """A joint that is shipped or kept, or else is computed and kept."""
    found = load_joint(key)
    if found is None:
        log.info("The joint with a gap of %g thicknesses is computed, once.", key.gap)
        found = compute_joint(key, progress or _log_progress)
        keep_joint(found)
    return found


def _log_progress(done: int, total: int) -> None:
    if done % 10 == 0 or done == total:
        log.info("Joint: %d of %d ways of states are solved.", done, total)
