"""Mesh of a joint's cross-section: the sheet under the rims of two scales, all in thicknesses.

Axes are n, across the joint from scale A to scale B, and z, up; the sheet lies between z = -1 and
z = 0, the gap's walls stand at n = -g/2 and n = +g/2. The mesh is a product of two series of lines,
graded geometrically towards the edges of the bond, (+-g/2, 0), where the stress has a singularity
r^(-1/2): with elements of nine nodes, the error of the energy falls with the smallest of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexscale.arrays import BoolArray, FloatArray, IntArray

_GROOVES = 8.0  # elements at the edges of grooves, in sizes of those at the bond's edges
Interval = tuple[float, float]


@dataclass(frozen=True)
class SectionShape:
    """Sizes of a cross-section, in thicknesses of the sheet.

    Attributes
    ----------
    gap : between the facing walls.
    depth : behind the walls, as far as the section reaches.
    height : of the scales above the sheet; None for rigid scales, of which no height is seen.
    grooves : behind the walls, from and to, that scales fill; none for a plain base.
    groove_depth : below the top of the sheet.
    """

    gap: float
    depth: float
    height: float | None = None
    grooves: tuple[Interval, ...] = ()
    groove_depth: float = 0.0


@dataclass(frozen=True)
class Grading:
    """How fine a mesh is, in thicknesses.

    Attributes
    ----------
    smallest : size of the elements at the bond's edges.
    growth : from one element to the next.
    largest : size of any element in the sheet.
    """

    smallest: float = 0.03
    growth: float = 2.0
    largest: float = 0.5


@dataclass(frozen=True)
class SectionMesh:
    """Nine-node quadrilaterals of a cross-section.

    Attributes
    ----------
    points : (n_nodes, 2) places (n, z).
    elements : (n_elements, 9) rows of `points`, three rows of three from below.
    of_scales : (n_elements,) whether an element is of a scale; none is if scales are rigid.
    held_a, held_b : nodes that move with scale A, and with scale B.
    """

    points: FloatArray
    elements: IntArray
    of_scales: BoolArray
    held_a: IntArray
    held_b: IntArray


def build_section_mesh(shape: SectionShape, grading: Grading) -> SectionMesh:
    """Mesh of a section: of the sheet alone under rigid scales, else with the scales' rims."""
    half, end = 0.5 * shape.gap, 0.5 * shape.gap + shape.depth
    fine, keyed = grading.smallest, _GROOVES * grading.smallest
    walls = [half + place for groove in shape.grooves for place in groove if place < shape.depth]
    outer = _graded([half, *walls, end], [fine, *[keyed] * len(walls), np.inf], grading)
    inner = _graded([0.0, half], [np.inf, fine], grading)
    positive = np.concatenate([inner, outer[1:]])
    across = np.concatenate([-positive[:0:-1], positive])
    floors = [-shape.groove_depth] if walls else []
    up = _graded([-1.0, *floors, 0.0], [np.inf, *[keyed] * len(floors), fine], grading)
    if shape.height is not None:
        coarse = Grading(3.0 * fine, 1.25 * grading.growth, np.inf)
        up = np.concatenate([up, _graded([0.0, shape.height], [3.0 * fine, np.inf], coarse)[1:]])
    return _product_mesh(shape, across, up)


def _product_mesh(shape: SectionShape, across: FloatArray, up: FloatArray) -> SectionMesh:
    n_up = len(up) - 1
    middle_n, middle_z = np.meshgrid(
        0.5 * (across[1:] + across[:-1]), 0.5 * (up[1:] + up[:-1]), indexing="ij"
    )
    behind = np.abs(middle_n) - 0.5 * shape.gap
    scale = (middle_z > 0.0) & (behind > 0.0)
    for start, stop in shape.grooves:
        scale |= (behind > start) & (behind < stop) & (middle_z > -shape.groove_depth)
    sheet = (middle_z < 0.0) & ~scale
    rigid = shape.height is None
    column, row = np.nonzero(sheet if rigid else sheet | scale)
    width = 2 * n_up + 1  # nodes of a line of the grid
    corner = 2 * column * width + 2 * row
    offsets = np.array([i * width + j for j in range(3) for i in range(3)])
    grid_elements = corner[:, None] + offsets
    used, elements = np.unique(grid_elements, return_inverse=True)
    lines_n, lines_z = _with_middles(across), _with_middles(up)
    points = np.stack([lines_n[used // width], lines_z[used % width]], axis=1)
    if rigid:
        column, row = np.nonzero(scale)
        bonded = np.isin(used, (2 * column * width + 2 * row)[:, None] + offsets)
        bonded |= (points[:, 1] == 0.0) & (np.abs(points[:, 0]) >= 0.5 * shape.gap)
    else:
        bonded = np.abs(points[:, 0]) == across[-1]
    return SectionMesh(
        points=points,
        elements=elements.reshape(-1, 9).astype(np.int64),
        of_scales=np.zeros(len(elements), dtype=bool) if rigid else scale[sheet | scale],
        held_a=np.flatnonzero(bonded & (points[:, 0] < 0.0)),
        held_b=np.flatnonzero(bonded & (points[:, 0] > 0.0)),
    )


def _with_middles(lines: FloatArray) -> FloatArray:
    out = np.empty(2 * len(lines) - 1)
    out[::2] = lines
    out[1::2] = 0.5 * (lines[1:] + lines[:-1])
    return out


def _graded(places: list[float], sizes: list[float], grading: Grading) -> FloatArray:
    """Lines through increasing places, which grow from the size of elements at each place."""
    lines = [places[0]]
    for start, stop, first, last in zip(
        places[:-1], places[1:], sizes[:-1], sizes[1:], strict=True
    ):
        steps, rest = [], stop - start
        ends = [first, last]
        while rest > 1e-9 * (stop - start):
            side = 0 if ends[0] <= ends[1] else 1
            size = min(ends[side], grading.largest)
            steps.append((side, size))
            ends[side] = size * grading.growth
            rest -= size
        lengths = np.array(
            [size for side, size in steps if side == 0]
            + [size for side, size in steps[::-1] if side == 1]
        )
        lines += list(start + (stop - start) * np.cumsum(lengths / lengths.sum()))
        lines[-1] = stop
    return np.array(lines)
