"""Poses of rigid scales against independent formulas, and their derivatives against differences."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from flexscale.embedding.rigid_motion import (
    N_VARIABLES,
    N_WORK,
    place_pair,
    relative_pose,
    turn_functions,
)
from flexscale.mechanics.jets import jet_size
from tests.derivatives import directional_difference, relative_error
from tests.mechanics.test_jets import hessian_of

WAY = np.array([7.0, 3.0])
LIFTS = np.array([1.3, 2.1])
ARM = np.array([3.0, 1.0, 0.2])
TENSOR = np.array([[0.8, 0.3], [0.3, -0.5]])


def jets_at(x: np.ndarray, order: int = 2) -> np.ndarray:
    """(30, jet): poses of both scales, then how one lies against the other."""
    size = jet_size(N_VARIABLES)
    poses, work, relative = np.zeros((24, size)), np.zeros((N_WORK, size)), np.zeros((6, size))
    place_pair(x[:6], x[6:12], LIFTS, WAY, TENSOR, x[12:15], x[15], work, poses, N_VARIABLES, order)
    other = ARM - [*WAY, 0.0]
    relative_pose(poses, ARM, other, work, relative, N_VARIABLES, order)
    return np.concatenate([poses, relative])


def expected(x: np.ndarray) -> np.ndarray:
    """The same values by scipy's exponential map and rotations."""

    def rotation(c: np.ndarray) -> np.ndarray:
        size = np.linalg.norm(c)
        return Rotation.from_rotvec(2.0 * np.arctan(size) * c / size).as_matrix()

    stretch = np.array([[x[12], x[14]], [x[14], x[13]]])
    moved = WAY + stretch @ WAY
    turn = np.cross([*(x[15] * TENSOR @ moved), 0.0], [0.0, 0.0, 1.0])
    twist = np.zeros((4, 4))
    twist[:3, :3] = np.cross(np.eye(3), -turn).T
    twist[:2, 3] = moved
    motion = expm(twist)
    first, second = rotation(x[3:6]), motion[:3, :3] @ rotation(x[9:12])
    here = x[:3] + np.array([0.0, 0.0, x[15] * LIFTS[0]])
    there = motion[:3, 3] + motion[:3, :3] @ (x[6:9] + np.array([0.0, 0.0, x[15] * LIFTS[1]]))
    between = Rotation.from_matrix(first.T @ second).as_rotvec()
    angle = np.linalg.norm(between)
    middle = first @ Rotation.from_rotvec(0.5 * between).as_matrix()
    arrow = there + second @ (ARM - [*WAY, 0.0]) - here - first @ ARM
    axis = 2.0 * np.sin(0.5 * angle) * between / angle
    return np.concatenate([here, first.ravel(), there, second.ravel(), middle.T @ arrow, axis])


@pytest.mark.parametrize("size", [0.03, 0.3])
def test_poses_are_those_of_the_exponential_map(size: float) -> None:
    x = size * np.random.default_rng(0).normal(size=N_VARIABLES)
    assert np.abs(jets_at(x)[:, 0] - expected(x)).max() < 1e-13


@pytest.mark.parametrize("size", [1e-3, 0.03, 0.3])
def test_derivatives_are_exact(size: float) -> None:
    generator = np.random.default_rng(1)
    x, way = size * generator.normal(size=N_VARIABLES), generator.normal(size=N_VARIABLES)
    jets = jets_at(x)
    slope = directional_difference(lambda s: jets_at(x + s * way, 0)[:, 0], 1e-3)
    assert relative_error(jets[:, 1 : 1 + N_VARIABLES] @ way, slope) < 1e-9
    bend = directional_difference(lambda s: jets_at(x + s * way, 1)[:, 1 : 1 + N_VARIABLES], 1e-3)
    product = [hessian_of(jet, N_VARIABLES) @ way for jet in jets]
    assert relative_error(np.array(product), bend) < 1e-8


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
        poses, work = np.empty((24, 1)), np.empty((N_WORK, 1))
        place_pair(
            np.zeros(6), np.zeros(6), np.zeros(2), way, np.outer(normal, normal),
            np.array([0.01, -0.02, 0.005]), 0.02, work, poses, N_VARIABLES, 0,
        )  # fmt: skip
        motion = np.eye(4)
        motion[:3, 3], motion[:3, :3] = poses[12:15, 0], poses[15:, 0].reshape(3, 3)
        motions.append(motion)
    assert np.abs(motions[0] @ motions[1] - motions[2]).max() < 1e-13
