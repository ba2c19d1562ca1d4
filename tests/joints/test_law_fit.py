"""A law is fitted to states: exact where they are of a polynomial, its linear part given."""

from __future__ import annotations

import numpy as np

from flexscale.joints.law_fit import Samples, evaluate_terms, fit_errors, fit_terms, with_stiffness
from flexscale.joints.sampling import (
    LARGEST_TURN,
    PoseRange,
    fitted_ends,
    guarding_ends,
    held_out_ends,
    way,
)
from flexscale.mechanics.joint_law import JointLaw

POSES = PoseRange(1.0, 10.0)
STIFFNESS = np.diag([0.44, 0.12, 0.18, 0.07])
STIFFNESS[0, 3] = STIFFNESS[3, 0] = -0.07
TERMS = np.array(
    [
        *[(2, 0, 0, 0), (1, 0, 0, 1), (0, 0, 0, 2), (0, 2, 0, 0), (0, 0, 2, 0)],
        *[(3, 0, 0, 0), (1, 2, 0, 1), (0, 4, 0, 2), (2, 0, 0, 3)],
    ],
    dtype=np.int64,
)
VALUES = np.array([0.22, -0.07, 0.035, 0.06, 0.09, -0.02, 0.03, 0.01, 0.02])


def samples(ends: np.ndarray) -> Samples:
    poses = np.concatenate([way(end) for end in ends])
    law = JointLaw(TERMS, VALUES, 1.0, 1.0, np.array([[-9.0, 9.0]] * 4))
    return Samples(poses, *law.evaluate(poses))


def test_states_of_a_polynomial_give_it_back() -> None:
    fitted = samples(fitted_ends(POSES))
    exponents, coefficients = fit_terms(fitted, samples(guarding_ends(POSES)), STIFFNESS)
    errors = fit_errors(exponents, coefficients, samples(held_out_ends(POSES)))
    assert errors.max() < 1e-8
    for row, value in zip(TERMS, VALUES, strict=True):
        found = coefficients[(exponents == row).all(axis=1)]
        assert np.allclose(found, value, atol=1e-8)


def test_the_quadratic_part_is_the_one_given_whatever_states_say() -> None:
    other = STIFFNESS * 1.1
    fitted, guards = samples(fitted_ends(POSES)), samples(guarding_ends(POSES))
    for exponents, coefficients in (
        fit_terms(fitted, guards, other),
        (TERMS, with_stiffness(TERMS, VALUES, other, fitted.poses)),
    ):
        law = JointLaw(exponents, coefficients, 1.0, 1.0, POSES.bounds)
        assert np.allclose(law.stiffness, other, rtol=1e-12)


def test_errors_are_root_mean_squares_over_those_of_the_states() -> None:
    states = samples(held_out_ends(POSES))
    errors = fit_errors(TERMS, 1.01 * VALUES, states)
    assert np.allclose(errors[[0, 1, 2, 4]], 0.01, rtol=1e-9)
    assert errors[3] == 0.0  # no state slides
    energies, forces = evaluate_terms(TERMS, VALUES, states.poses)
    assert np.allclose(energies, states.energies)
    assert np.allclose(forces, states.forces)


def test_sampled_poses_are_in_the_range_and_reach_its_ends() -> None:
    for gap in (0.5, 1.0, 2.5):
        poses = PoseRange(gap, 10.0)
        law = JointLaw(
            TERMS, VALUES, 1.0, 1.0, poses.bounds + np.array([-1e-9, 1e-9]),
            (poses.slope, poses.below + 1e-9, poses.above + 1e-9, poses.before),
        )  # fmt: skip
        ends = np.concatenate([fitted_ends(poses), held_out_ends(poses)])
        assert law.inside(ends).all()
        assert np.allclose(ends[:, 0].min(), poses.bounds[0, 0])
        assert np.allclose(ends[:, 0].max(), poses.bounds[0, 1])
        touching = [poses.slope * LARGEST_TURN - gap, 0.0, 0.0, LARGEST_TURN]
        assert law.inside(np.array(touching)).all()
        if gap <= 1.0:  # wide gaps have no corner far from all that is met
            assert not law.inside(guarding_ends(poses)).any()


def test_another_stiffness_changes_far_states_little() -> None:
    fitted, guards = samples(fitted_ends(POSES)), samples(guarding_ends(POSES))
    exponents, coefficients = fit_terms(fitted, guards, STIFFNESS)
    poses = np.concatenate([fitted.poses, guards.poses])
    changed = with_stiffness(exponents, coefficients, 1.01 * STIFFNESS, poses)
    near, far = np.array([0.01, 0.01, 0.0, 0.003]), np.array([2.675, 0.0, 0.0, 0.35])
    for pose, share, within in ((near, 0.01, 2e-4), (far, 0.0, 4e-3)):
        before, _ = evaluate_terms(exponents, coefficients, pose[None])
        after, _ = evaluate_terms(exponents, changed, pose[None])
        assert abs(after[0] / before[0] - 1.0 - share) < within
