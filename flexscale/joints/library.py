"""Laws of joints: those that ship with the package, those kept on this machine, and any other."""

from __future__ import annotations

import logging

import shapely

from flexscale.checks import PATTERN, checked, instance
from flexscale.joints.compute import Progress, SolvedJoint, compute_joint
from flexscale.joints.key import JointGroove, JointKey, joint_key
from flexscale.joints.storage import keep_joint, load_joint
from flexscale.mechanics.joint_law import JointLaw
from flexscale.patterns.pattern import Pattern

log = logging.getLogger(__name__)


@checked(
    pattern=PATTERN,
    groove=instance("flexscale.joints.key:JointGroove", "give a JointGroove"),
)
def joint_law(
    pattern: Pattern,
    *,
    groove: JointGroove | None = None,
    progress: Progress | None = None,
) -> JointLaw:
    """The law of a pattern's joints: in no time if it was solved before, else in a minute or two.

    Parameters
    ----------
    pattern : its gap, thickness, scale height and materials count.
    groove : of the sheet under every scale; None for a plain base.
    progress : called with how many of how many ways of states are done, while it is computed.

    Raises
    ------
    PatternError : sizes for which no joint can be computed.
    """
    key = pattern_key(pattern, groove)
    return solved_joint(key, progress).law(
        pattern.substrate_thickness, pattern.substrate_material.young_modulus
    )


def pattern_key(pattern: Pattern, groove: JointGroove | None = None) -> JointKey:
    """Key of a pattern's joints, whose scales deform in their rims unless their material is rigid.

    Raises
    ------
    PatternError : sizes for which no joint can be computed.
    """
    return joint_key(
        pattern.gap,
        pattern.substrate_thickness,
        pattern.scale_height,
        pattern.substrate_material,
        None if pattern.scale_material.is_rigid else pattern.scale_material,
        groove,
        half_width(pattern),
    )


def half_width(pattern: Pattern) -> float:
    """Half width [mm] of the narrowest scale: the radius of the largest circle in its outline."""
    return min(
        float(shapely.maximum_inscribed_circle(shapely.Polygon(outline)).length)
        for outline in pattern.outlines()
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
