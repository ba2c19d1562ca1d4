"""Poses of rigid scales against independent formulas, and their derivatives against differences."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from flexscale.embedding.middle_pose import N_POSE, N_WORK, middle_pose, turn_jets
from flexscale.embedding.relative_pose import add_pose_bends, pose_slopes, relative_pose
from flexscale.embedding.rigid_motion import (
    N_MOTION,
    N_VARIABLES,
    neighbor_motion,
    rotation_of,
    turn_functions,
)
from flexscale.mechanics.jets import jet_length
from tests.derivatives import directional_difference, relative_error
from tests.mechanics.test_jets import hessian_of

WAY = np.array([7.0, 3.0])
LIFTS = np.array([[0.02, 1.3], [0.05, 2.1]])  # mm at the base, and by kappa, of two anchors
ARM = np.array([3.0, 1.0, 0.2])
TENSOR = np.array([[0.8, 0.3], [0.3, -0.5]])
BASE = np.array([[0.01, -0.02], [-0.02, 0.03]])


def pose_at(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, tuple]:
    """Pose (4, 3), J (6, 16), and what second derivatives follow from."""
    size = jet_length(N_MOTION, 2)
    motion, work = np.empty((12, size)), np.zeros((12, 3, 3))
    neighbor_motion(WAY, LIFTS, BASE, TENSOR, x[12:15], x[15], np.empty((10, size)), motion, 2)
    turns, slopes, bends = np.empty((2, 3, 3)), np.empty((2, 3, 3, 3)), np.empty((2, 3, 3, 3, 3))
    for side, first in enumerate((3, 9)):
        rotation_of(x[first : first + 3], turns[side], slopes[side], bends[side], 2)
    pose, jacobian = np.empty((4, 3)), np.empty((6, N_VARIABLES))
    relative_pose(x[:3], x[6:9], motion, turns, pose, work)
    pose_slopes(x[6:9], motion, turns, slopes, pose, N_MOTION, work, jacobian)
    return pose, jacobian, work, (x[6:9], motion, turns, slopes, bends, pose, N_MOTION, work)


def bends_at(x: np.ndarray, gradient: np.ndarray) -> np.ndarray:
    """(16, 16) second derivatives of g . t + <N, G>."""
    out = np.zeros((N_VARIABLES, N_VARIABLES))
    add_pose_bends(gradient, *pose_at(x)[3], out)
    return np.triu(out) + np.triu(out, 1).T


def rotation(c: np.ndarray) -> np.ndarray:
    size = np.linalg.norm(c)
    return Rotation.from_rotvec(2.0 * np.arctan(size) * c / size).as_matrix()


def expected(x: np.ndarray) -> np.ndarray:
    """t and G by scipy's exponential map and rotations, (4, 3)."""
    stretch = np.array([[x[12], x[14]], [x[14], x[13]]])
    moved = WAY + stretch @ WAY
    turn = np.cross([*((BASE + x[15] * TENSOR) @ moved), 0.0], [0.0, 0.0, 1.0])
    twist = np.zeros((4, 4))
    twist[:3, :3] = np.cross(np.eye(3), -turn).T
    twist[:2, 3] = moved
    motion = expm(twist)
    first, second = rotation(x[3:6]), motion[:3, :3] @ rotation(x[9:12])
    here = x[:3] + np.array([0.0, 0.0, LIFTS[0] @ [1.0, x[15]]])
    there = motion[:3, 3] + motion[:3, :3] @ (
        x[6:9] + np.array([0.0, 0.0, LIFTS[1] @ [1.0, x[15]]])
    )
    return np.array([first.T @ (there - here), *(first.T @ second)])


def middle_jets(pose: np.ndarray, order: int = 2) -> np.ndarray:
    """(6, jet) arrow and turn midway."""
    size = jet_length(N_POSE, order)
    turn, work, out = np.empty((9, size)), np.empty((N_WORK, size)), np.empty((6, size))
    turn_jets(pose, turn, order)
    middle_pose(pose, turn, ARM, ARM - [*WAY, 0.0], work, out, order)
    return out


def changed(pose: np.ndarray, change: np.ndarray) -> np.ndarray:
    """t + tau and G exp[alpha]."""
    turn = pose[1:] @ Rotation.from_rotvec(change[3:]).as_matrix()
    return np.array([pose[0] + change[:3], *turn])


@pytest.mark.parametrize("size", [0.03, 0.3])
def test_poses_are_those_of_the_exponential_map(size: float) -> None:
    x = size * np.random.default_rng(0).normal(size=N_VARIABLES)
    assert np.abs(pose_at(x)[0] - expected(x)).max() < 1e-13


@pytest.mark.parametrize("size", [1e-3, 0.03, 0.3])
def test_slopes_of_poses_are_exact(size: float) -> None:
    generator = np.random.default_rng(1)
    x, way = size * generator.normal(size=N_VARIABLES), generator.normal(size=N_VARIABLES)
    pose, jacobian, _, _ = pose_at(x)
    slope = directional_difference(lambda s: pose_at(x + s * way)[0], 1e-3)
    tau, alpha = np.split(jacobian @ way, 2)
    assert relative_error(tau, slope[0]) < 1e-9
    assert relative_error(pose[1:] @ np.cross(np.eye(3), -alpha).T, slope[1:]) < 1e-9


@pytest.mark.parametrize("size", [1e-3, 0.03, 0.3])
def test_second_derivatives_of_poses_are_exact(size: float) -> None:
    """Of g . t + <N, G> with N = G_0 [m] / 2 held."""
    generator = np.random.default_rng(2)
    x, way = size * generator.normal(size=N_VARIABLES), generator.normal(size=N_VARIABLES)
    gradient = generator.normal(size=6)
    skew = 0.5 * pose_at(x)[0][1:] @ np.cross(np.eye(3), -gradient[3:]).T

    def slope(s: float) -> np.ndarray:
        pose, jacobian, _, _ = pose_at(x + s * way)
        turns = [pose[1:] @ np.cross(np.eye(3), -alpha).T for alpha in jacobian[3:].T]
        return gradient[:3] @ jacobian[:3] + np.array([np.sum(skew * turn) for turn in turns])

    assert relative_error(bends_at(x, gradient) @ way, directional_difference(slope, 1e-3)) < 1e-8


@pytest.mark.parametrize("size", [0.03, 0.3])
def test_the_middle_pose_is_that_of_half_the_turn(size: float) -> None:
    x = size * np.random.default_rng(3).normal(size=N_VARIABLES)
    pose = expected(x)
    between = Rotation.from_matrix(pose[1:]).as_rotvec()
    angle = np.linalg.norm(between)
    middle = Rotation.from_rotvec(0.5 * between).as_matrix()
    arrow = pose[0] + pose[1:] @ (ARM - [*WAY, 0.0]) - ARM
    axis = 2.0 * np.sin(0.5 * angle) * between / angle
    assert np.abs(middle_jets(pose)[:, 0] - [*(middle.T @ arrow), *axis]).max() < 1e-13


@pytest.mark.parametrize("size", [1e-3, 0.03, 0.3])
def test_derivatives_of_the_middle_pose_are_exact(size: float) -> None:
    generator = np.random.default_rng(4)
    pose, way = expected(size * generator.normal(size=N_VARIABLES)), generator.normal(size=N_POSE)
    jets = middle_jets(pose)
    assert np.array_equal(middle_jets(pose, 1), jets[:, : 1 + N_POSE])
    slope = directional_difference(lambda s: middle_jets(changed(pose, s * way), 0)[:, 0], 1e-3)
    assert relative_error(jets[:, 1 : 1 + N_POSE] @ way, slope) < 1e-9
    # Along one way exp[alpha] is a group: the second derivative is that of the values.
    step = 1e-3
    values = [middle_jets(changed(pose, k * step * way), 0)[:, 0] for k in range(-3, 4)]
    weights = np.array([2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0]) / 180.0 / step**2
    twice = np.array([way @ hessian_of(jet, N_POSE) @ way for jet in jets])
    assert np.abs(twice - weights @ values).max() < 1e-6 * max(np.abs(twice).max(), 1.0)


def test_functions_of_a_turn_do_not_jump_where_the_series_ends() -> None:
    below, above = np.empty((3, 3)), np.empty((3, 3))
    turn_functions(1.0 - 1e-12, below)
    turn_functions(1.0 + 1e-12, above)
    assert np.abs(above / below - 1.0).max() < 1e-9


def test_a_cylinder_does_not_care_over_which_scales_one_goes() -> None:
    """Motions of one curvature commute: two ways one after the other are their sum."""
    normal = np.array([np.cos(0.3), np.sin(0.3)])
    motions = []
    for way in (np.array([7.0, 3.0]), np.array([-2.0, 9.0]), np.array([5.0, 12.0])):
        out = np.empty((12, 1))
        neighbor_motion(
            way, np.zeros((2, 2)), np.zeros((2, 2)), np.outer(normal, normal),
            np.array([0.01, -0.02, 0.005]), 0.02, np.empty((10, 1)), out, 0,
        )  # fmt: skip
        motion = np.eye(4)
        motion[:3, 3], motion[:3, :3] = out[:3, 0], out[3:, 0].reshape(3, 3)
        motions.append(motion)
    assert np.abs(motions[0] @ motions[1] - motions[2]).max() < 1e-13
