"""Meshes have the symmetry of their pattern: nodes, triangles and tets go onto one another."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.mesh import MeshOptions, build_mesh
from tests.patterns.pattern_shapes import SHAPES
from tests.property.mesh_symmetry import assert_symmetric, point_group

# name -> center of a point group of the pattern, from the first corner of its first tile if this
# was given, its rotations, whether it has mirrors along x
GROUPS = {
    "square": ((0.0, 0.0), 4, True),
    "hexagon": ((0.0, 0.0), 6, True),
    "brick": ((5.0, 2.5), 2, True),
    "parallelogram": ((6.5, 4.0), 2, False),
    "pinwheel 4": ((-5.0, 5.0), 4, False),
    "pinwheel 6": ((-5.0, 5.0 / np.sqrt(3.0)), 6, False),
    "triangles": ((10.0, 8.0), 2, True),
    "wide and narrow": ((15.0, 2.5), 2, True),
    "nearly aligned": ((5.0, 5.0), 2, False),
}
OPTIONS = {
    "default": MeshOptions(),
    "fine": MeshOptions(
        across=4,
        along=0.5,
        scale_size=1.2,
        across_grading=1.5,
        scale_rim=0.1,
        scale_strips=3,
        scale_growth=1.5,
    ),
}


@pytest.mark.parametrize("options", list(OPTIONS))
@pytest.mark.parametrize("name", list(GROUPS))
def test_point_group(name: str, options: str) -> None:
    center, order, mirrors = GROUPS[name]
    mesh = build_mesh(SHAPES[name][0], OPTIONS[options])
    for isometry in point_group(np.array(center), order, mirrors):
        assert_symmetric(mesh, isometry)


def test_mirror_of_arrowheads() -> None:
    mesh = build_mesh(SHAPES["arrowhead"][0])
    upright = point_group(np.array([5.0, 0.0]), 2, True)[3]  # x -> 10 - x
    assert np.allclose(upright.linear, np.diag([-1.0, 1.0]))
    assert_symmetric(mesh, upright)


def test_diagonal_mirror_of_corners_and_squares() -> None:
    mesh = build_mesh(SHAPES["corner and square"][0])
    diagonal = point_group(np.zeros(2), 4, True)[5]  # exchanges x and y
    assert np.allclose(diagonal.linear, [[0.0, 1.0], [1.0, 0.0]])
    assert_symmetric(mesh, diagonal)


def test_a_symmetry_that_the_pattern_lacks_is_noticed() -> None:
    mesh = build_mesh(SHAPES["pinwheel 4"][0])
    with pytest.raises(AssertionError):
        assert_symmetric(mesh, point_group(np.zeros(2), 4, True)[4])
