"""From a plan to closed surfaces, by exact booleans on solids (manifold3d).

Both solids are made of the same polygons, so their common faces coincide, to the width of the grid
on which these lie: no gap between the two materials and no overlap.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import manifold3d as m3
import numpy as np
import shapely
from numpy.typing import NDArray

from flexscale.arrays import FloatArray
from flexscale.errors import FabricationError
from flexscale.fabricate.walls import GRID, rings_of
from flexscale.short_repr import ShortRepr

_NEEDLE = 1e-6  # height of a triangle over its length: ten times what 32-bit numbers resolve
_PASSES = 5  # needles beside each other need more than one
_REACH = 1.0  # mm, how far the tool that cuts grooves stands out above the substrate


@dataclass(frozen=True, eq=False, repr=False)
class Solid(ShortRepr):
    """Closed surface of one material, to be printed.

    Attributes
    ----------
    name : "substrate" or "scales".
    vertices : (n, 3) mm, exactly as 32-bit numbers hold them, as an STL file needs.
    faces : (m, 3) corners, counterclockwise seen from outside.
    """

    name: str
    vertices: NDArray[np.float32]
    faces: NDArray[np.int64]

    @property
    def volume(self) -> float:
        """Volume of the triangles, mm³."""
        a, b, c = np.moveaxis(self.vertices[self.faces].astype(float), 1, 0)
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)

    @property
    def bounds(self) -> FloatArray:
        """(2, 3) lowest and highest coordinates, mm."""
        return np.array([self.vertices.min(axis=0), self.vertices.max(axis=0)], dtype=float)


def prism(area: shapely.Polygon, bottom: float, top: float) -> m3.Manifold:
    """Solid over an area, between two heights, mm."""
    section = m3.CrossSection(rings_of(area), m3.FillRule.EvenOdd)
    body = m3.Manifold.extrude(section, 1.0)
    # Heights are set rather than scaled, so that solids that meet have the very same ones.
    return body.warp_batch(lambda points: _with_heights(points, bottom, top))


def _with_heights(points: FloatArray, bottom: float, top: float) -> FloatArray:
    moved = points.copy()
    moved[:, 2] = np.where(points[:, 2] < 0.5, bottom, top)
    return moved


def bar(profile: shapely.Polygon, axis_x: float, base: float, half_width: float) -> m3.Manifold:
    """Solid whose section by y = const is a profile (x, z), mm.

    Parameters
    ----------
    profile : as `hinges.hinge_profile` gives it.
    axis_x, base : where its origin goes, mm.
    half_width : of the bar, along y, mm.
    """
    lying = prism(profile, -half_width, half_width)
    to_standing = np.array([[1.0, 0.0, 0.0, axis_x], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, base]])
    return lying.transform(to_standing)


def keyed(
    body: m3.Manifold, grooves: Sequence[shapely.Polygon], floor: float, into: float
) -> m3.Manifold:
    """A body with ribs under it that fill its grooves.

    Parameters
    ----------
    floor : mm, height of the grooves' bottom.
    into : mm, a height inside the body, to which the ribs reach.
    """
    if not grooves:
        return body
    return m3.Manifold.batch_boolean(
        [body, *(prism(groove, floor, into) for groove in grooves)], m3.OpType.Add
    )


def grooved(
    sheet: shapely.Polygon, thickness: float, grooves: list[shapely.Polygon], floor: float
) -> m3.Manifold:
    """The substrate, with grooves down to a height `floor`, mm."""
    body = prism(sheet, 0.0, thickness)
    if not grooves:
        return body
    tools = [prism(groove, floor, thickness + _REACH) for groove in grooves]
    return body - m3.Manifold.compose(tools)


def solid_of(name: str, bodies: list[m3.Manifold]) -> Solid:
    """Closed surface of bodies that do not touch each other.

    Raises
    ------
    FabricationError : the booleans found no solid.
    """
    whole = m3.Manifold.compose(bodies)
    if whole.status() != m3.Error.NoError or whole.is_empty():
        raise FabricationError(
            f"The {name} of this sheet are no solid ({whole.status().name}): change the sizes a "
            "little, or report the pattern and the options."
        )
    mesh = whole.to_mesh64()
    vertices = np.array(mesh.vert_properties)[:, :3]
    # The library rounds decimal places of what it extrudes: back to the grid all plans lie on.
    vertices[:, :2] = GRID * np.rint(vertices[:, :2] / GRID)
    faces = without_needles(vertices, np.array(mesh.tri_verts).astype(np.int64))
    return Solid(name, vertices.astype(np.float32), faces)


def without_needles(vertices: FloatArray, faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """Faces (m, 3) of the same surface, without triangles whose corners lie on one line.

    Programs that compute with 32-bit numbers find no normal for these. The triangle beyond the
    longest side is split at the corner that lies on this side, which is where the needle goes.
    One that this would make into another needle stays.
    """
    faces = faces.copy()
    for _ in range(_PASSES):
        sides = np.roll(vertices[faces], -1, axis=1) - vertices[faces]
        lengths = np.linalg.norm(sides, axis=2)
        areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
        needles = np.flatnonzero(areas < _NEEDLE * lengths.max(axis=1) ** 2)
        if not len(needles):
            break
        changed: set[int] = set()
        for needle in needles:
            if needle in changed:
                continue
            a, b, c = np.roll(faces[needle], -int(lengths[needle].argmax()))
            other, side = np.argwhere((faces == b) & (np.roll(faces, -1, axis=1) == a))[0]
            d = faces[other, side - 1]
            new = np.array([(a, d, c), (d, b, c)])
            if other not in changed and _is_fatter(vertices, new, faces[other]):
                faces[needle], faces[other] = new
                changed |= {int(needle), int(other)}
    return faces


def _is_fatter(vertices: FloatArray, new: NDArray[np.int64], old: NDArray[np.int64]) -> bool:
    """Whether new triangles (2, 3) face where an old one (3,) does, and are no needles."""
    corners = vertices[np.vstack([new, old[None]])]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    facing = normals[:2] @ normals[2]
    return bool((facing > _NEEDLE * lengths[:2] ** 2 * np.linalg.norm(normals[2])).all())


def section(solid: Solid, y: float) -> list[FloatArray]:
    """Outlines (n_i, 2) of the cut of a solid by the plane at y (mm): x and z; holes clockwise."""
    mesh = m3.Mesh64(solid.vertices.astype(float), solid.faces.astype(np.uint64))
    lying = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0]])
    cut = m3.Manifold(mesh).transform(lying).slice(-y)
    return [np.asarray(polygon) for polygon in cut.to_polygons()]
