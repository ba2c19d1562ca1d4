"""The mesh of a joint's section: it fills the section, is finest at the bond, and holds scales."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.joints.section_mesh import Grading, SectionMesh, SectionShape, build_section_mesh

GRADING = Grading(0.05, 2.0, 0.5)
GROOVE = {"grooves": ((2.0, 4.0),), "groove_depth": 0.5}


def areas(mesh: SectionMesh) -> np.ndarray:
    sides = mesh.points[mesh.elements[:, 8]] - mesh.points[mesh.elements[:, 0]]
    assert (sides > 0.0).all()
    return np.prod(sides, axis=1)


@pytest.mark.parametrize(
    ("shape", "sheet", "scales"),
    [
        (SectionShape(1.0, 4.0), 9.0, 0.0),
        (SectionShape(1.0, 4.0, 10.0), 9.0, 80.0),
        (SectionShape(0.5, 6.0, **GROOVE), 12.5 - 2.0, 0.0),
        (SectionShape(0.5, 6.0, 3.0, **GROOVE), 12.5 - 2.0, 36.0 + 2.0),
    ],
)
def test_elements_fill_sheet_and_scales(shape: SectionShape, sheet: float, scales: float) -> None:
    mesh = build_section_mesh(shape, GRADING)
    found = areas(mesh)
    assert found[~mesh.of_scales].sum() == pytest.approx(sheet, rel=1e-12)
    assert found[mesh.of_scales].sum() == pytest.approx(scales, rel=1e-12)
    assert np.array_equal(np.unique(mesh.elements), np.arange(len(mesh.points)))


def test_nodes_of_an_element_are_three_rows_of_three() -> None:
    mesh = build_section_mesh(SectionShape(1.0, 4.0), GRADING)
    nodes = mesh.points[mesh.elements].reshape(-1, 3, 3, 2)
    assert np.allclose(nodes[:, 1], 0.5 * (nodes[:, 0] + nodes[:, 2]))
    assert np.allclose(nodes[:, :, 1], 0.5 * (nodes[:, :, 0] + nodes[:, :, 2]))
    assert (nodes[:, :, 2, 0] > nodes[:, :, 0, 0]).all()
    assert (nodes[:, 2, :, 1] > nodes[:, 0, :, 1]).all()


def test_the_smallest_elements_are_at_the_edges_of_the_bond() -> None:
    mesh = build_section_mesh(SectionShape(1.0, 4.0), GRADING)
    smallest = mesh.elements[np.argmin(areas(mesh))]
    assert np.abs(np.abs(mesh.points[smallest]) - [0.5, 0.0]).max() < 2.0 * GRADING.smallest
    sides = mesh.points[mesh.elements[:, 8]] - mesh.points[mesh.elements[:, 0]]
    assert sides.max() <= GRADING.largest * (1.0 + 1e-9)


def test_sections_are_their_own_mirror_images() -> None:
    mesh = build_section_mesh(SectionShape(1.0, 6.0, 10.0, **GROOVE), GRADING)
    mirrored = mesh.points * [-1.0, 1.0]
    order, other = np.lexsort(mesh.points.T.round(9)), np.lexsort(mirrored.T.round(9))
    assert np.allclose(mesh.points[order], mirrored[other], atol=1e-12)


def test_rigid_scales_hold_what_they_touch() -> None:
    mesh = build_section_mesh(SectionShape(1.0, 6.0, **GROOVE), GRADING)
    held = mesh.points[mesh.held_b]
    assert (held[:, 0] >= 0.5).all()
    walls = held[held[:, 1] < 0.0]
    assert walls[:, 1].min() == -0.5
    assert (walls[:, 0].min(), walls[:, 0].max()) == (2.5, 4.5)
    assert len(mesh.held_a) == len(mesh.held_b)


def test_elastic_scales_are_held_at_the_far_side() -> None:
    mesh = build_section_mesh(SectionShape(1.0, 4.0, 10.0), GRADING)
    assert (mesh.points[mesh.held_a, 0] == -4.5).all()
    assert mesh.points[mesh.held_b, 1].max() == 10.0
