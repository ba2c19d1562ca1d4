"""From a joint's key to its law: linear stiffness, states over the range of poses, fit."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.errors import FlexScaleError
from flexscale.joints.key import JointKey
from flexscale.joints.law_fit import Samples, fit_errors, fit_terms, with_stiffness
from flexscale.joints.sampling import PoseRange, fitted_ends, guarding_ends, held_out_ends, way
from flexscale.joints.section import Section
from flexscale.joints.section_mesh import Grading, SectionShape, build_section_mesh
from flexscale.joints.states import follow, rest_state
from flexscale.mechanics.joint_law import JointLaw
from flexscale.patterns.material import NeoHookean

log = logging.getLogger(__name__)

#: Of states at any pose: stiffnesses at rest 0.3 to 0.6 % above the limit.
SAMPLED = Grading(0.02, 1.8, 0.4)
#: Of the linear joint: the error falls with the smallest element, so that twice the finer less the
#: coarser is the limit to 0.05 %.
LINEAR = (Grading(0.01, 1.5, 0.25), Grading(0.005, 1.5, 0.25))
_LEAST_SHARE = 0.8  # of states that must be reached

Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class SolvedJoint:
    """A law without units, and what it was made of.

    Attributes
    ----------
    key : what it depends on.
    exponents, coefficients : (n_terms, 4) and (n_terms,), see `JointLaw`.
    errors : (5,) of energy and forces over the states held out, in their root mean squares.
    mesh_errors : (5,) by which stiffnesses uu, ww, ss, phi phi and u phi of the mesh with which
        states were solved exceed the linear joint's, relative.
    poses, energies, forces : (n, 4), (n,) and (n, 4) of all states within the range.
    held_out : (n,) whether a state was left out of the fit.
    n_missing : states that were not reached.
    """

    key: JointKey
    exponents: IntArray
    coefficients: FloatArray
    errors: FloatArray
    mesh_errors: FloatArray
    poses: FloatArray
    energies: FloatArray
    forces: FloatArray
    held_out: BoolArray
    n_missing: int

    def law(self, thickness: float, modulus: float) -> JointLaw:
        """The law of a sheet of a thickness [mm] and a Young's modulus [MPa]."""
        poses = PoseRange(self.key.gap, self.key.height)
        lengths = thickness * np.array([1.0, 1.0, 1.0, 1.0 / thickness])
        return JointLaw(
            exponents=self.exponents,
            coefficients=self.coefficients,
            thickness=thickness,
            modulus=modulus,
            bounds=poses.bounds * lengths[:, None],
            band=tuple(  # type: ignore[arg-type]
                thickness * size for size in (poses.slope, poses.below, poses.above, poses.before)
            ),
            errors=self.errors,
        )


def build_section(key: JointKey, grading: Grading, *, slides: bool = False) -> Section:
    """Section of a joint, meshed; `slides` lets its points move along the joint too."""
    rigid = key.modulus_ratio is None
    shape = SectionShape(
        key.gap, key.depth, None if rigid else key.height, key.grooves, key.groove_depth
    )
    scales = None
    if key.modulus_ratio is not None and key.scale_poisson_ratio is not None:
        scales = NeoHookean(key.modulus_ratio, key.scale_poisson_ratio)
    mesh = build_section_mesh(shape, grading)
    return Section(mesh, key.poisson_ratio, scales, slides=slides)


def linear_stiffness(key: JointKey, gradings: tuple[Grading, Grading] = LINEAR) -> FloatArray:
    """(4, 4) stiffness at rest in E t^2, extrapolated from two meshes of which one is twice as
    fine at the bond's edges as the other."""
    coarse, fine = (
        rest_state(build_section(key, grading, slides=True)).tangent for grading in gradings
    )
    # Mirror images tell which entries vanish; the solver leaves 1e-13.
    kept = np.eye(4, dtype=bool)
    kept[0, 3] = kept[3, 0] = True
    return np.where(kept, 2.0 * fine - coarse, 0.0)


def compute_joint(key: JointKey, progress: Progress | None = None) -> SolvedJoint:
    """Sample and fit a joint; `progress` is told how many of how many ways are done."""
    poses = PoseRange(key.gap, key.height)
    stiffness = linear_stiffness(key)
    section = build_section(key, SAMPLED)
    rest = rest_state(section)
    meshed = rest.tangent.copy()
    meshed[2, 2] = stiffness[2, 2]  # the slide is exact, and not sampled
    sets = [fitted_ends(poses), held_out_ends(poses), guarding_ends(poses)]
    n_ways = sum(map(len, sets))
    states, n_done, n_missing = [], 0, 0
    for ends in sets:
        found = []
        for end in ends:
            wanted = way(end)
            reached = list(follow(section, rest, wanted))
            n_missing += len(wanted) - len(reached)
            found += reached
            n_done += 1
            if progress is not None:
                progress(n_done, n_ways)
        states.append(Samples.of(found))
    fitted, held, guards = states
    _check_reached(key, fitted, held, n_missing)
    exponents, coefficients = fit_terms(fitted, guards, meshed)
    sizes = [(0, 0), (1, 1), (2, 2), (3, 3), (0, 3)]
    kept = _kept(fitted.poses, held.poses)
    everywhere = np.concatenate([kept, np.concatenate([way(end) for end in sets[2]])])
    return SolvedJoint(
        key,
        exponents,
        with_stiffness(exponents, coefficients, stiffness, everywhere),
        fit_errors(exponents, coefficients, held),
        np.array([meshed[size] / stiffness[size] - 1.0 for size in sizes]),
        kept,
        _kept(fitted.energies, held.energies),
        _kept(fitted.forces, held.forces),
        np.arange(len(fitted.poses) + len(held.poses)) >= len(fitted.poses),
        n_missing,
    )


def _kept(*arrays: FloatArray) -> FloatArray:
    """States as files keep them, in single precision: a joint is the same, computed or loaded."""
    return np.concatenate(arrays).astype(np.float32).astype(np.float64)


def _check_reached(key: JointKey, fitted: Samples, held: Samples, n_missing: int) -> None:
    n = len(fitted.poses) + len(held.poses)
    if n_missing:
        log.info("%d states of the joint %s were not reached.", n_missing, key)
    if n < _LEAST_SHARE * (n + n_missing):
        raise FlexScaleError(
            f"Only {n} of {n + n_missing} states of the joint were reached, with a gap of "
            f"{key.gap:g} thicknesses: no law can be fitted to them; choose another gap."
        )
