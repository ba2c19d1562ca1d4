"""Rigid prisms of scales: convex parts for contact, solid's moments, surfaces for pictures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray, IntArray
from flexscale.mechanics.hct import QUADRATURE_POINTS, QUADRATURE_WEIGHTS
from flexscale.mesh.prism_surface import triangles_of
from flexscale.synthesis.convex import convex_parts
from flexscale.synthesis.placement import Placement


@dataclass(frozen=True, eq=False)
class ConvexParts:
    """Convex prisms that fill the scales, in a common number of corners: the last one repeats.

    Attributes
    ----------
    owner : (p,) scale that a part belongs to.
    corners : (p, k, 2) counterclockwise, at rest, mm.
    normals : (p, k + 2, 3) outward, of the k sides (those of length 0 repeat one), top and base.
    edges : (p, k + 1, 3) unit directions: k sides, then upright.
    height : mm.
    """

    owner: IntArray
    corners: FloatArray
    normals: FloatArray
    edges: FloatArray
    height: float

    def vertices(self, placement: Placement) -> FloatArray:
        """(p, 2 k, 3) mm, base corners first."""
        n, k, _ = self.corners.shape
        rest = np.zeros((n, 2 * k, 3))
        rest[:, :k, :2] = rest[:, k:, :2] = self.corners
        rest[:, k:, 2] = self.height
        turned = rest @ placement.rotations[self.owner].transpose(0, 2, 1)
        return np.asarray(turned + placement.translations[self.owner][:, None])


def build_parts(outlines: list[FloatArray], height: float) -> ConvexParts:
    """Convex parts of prisms over outlines (m_i, 2), mm high."""
    parts = [(n, outline[p]) for n, outline in enumerate(outlines) for p in convex_parts(outline)]
    k = max(len(corners) for _, corners in parts)
    padded = np.array([np.vstack([c, np.repeat(c[-1:], k - len(c), axis=0)]) for _, c in parts])
    spans = np.roll(padded, -1, axis=1) - padded
    lengths = np.linalg.norm(spans, axis=2)
    # The first corners are never repeated, so that the first side has a length.
    spans = np.where(lengths[:, :, None] > 0.0, spans, spans[:, :1])
    spans /= np.linalg.norm(spans, axis=2, keepdims=True)
    n = len(parts)
    edges, normals = np.zeros((n, k + 1, 3)), np.zeros((n, k + 2, 3))
    edges[:, :k, :2], edges[:, k, 2] = spans, 1.0
    normals[:, :k, 0], normals[:, :k, 1] = spans[..., 1], -spans[..., 0]
    normals[:, k, 2], normals[:, k + 1, 2] = 1.0, -1.0
    return ConvexParts(np.array([owner for owner, _ in parts]), padded, normals, edges, height)


@dataclass(frozen=True, eq=False)
class Moments:
    """Of the solids at rest.

    Attributes
    ----------
    volumes : (n,) mm3.
    centers : (n, 3) centroids, mm.
    turning : (n, 3, 3) mm2: w.T @ turning @ w is the mean square displacement of a solid's points
        in a small turn w [rad] about its centroid.
    radii : (n,) mm, of the smallest sphere around the centroid that holds the solid.
    """

    volumes: FloatArray
    centers: FloatArray
    turning: FloatArray
    radii: FloatArray


def moments_of(outlines: list[FloatArray], height: float) -> Moments:
    """Moments of prisms over outlines (m_i, 2), mm high."""
    found = [_moments(outline, height) for outline in outlines]
    return Moments(*map(np.array, zip(*found, strict=True)))


def _moments(outline: FloatArray, height: float) -> tuple[float, FloatArray, FloatArray, float]:
    corners = outline[triangles_of(outline)]
    areas = 0.5 * np.linalg.det(corners[:, 1:] - corners[:, :1])
    points = np.einsum("qk,nkc->nqc", QUADRATURE_POINTS, corners).reshape(-1, 2)
    share = np.outer(areas / areas.sum(), QUADRATURE_WEIGHTS).ravel()
    center = share @ points
    second = np.zeros((3, 3))
    second[:2, :2] = (points - center).T @ ((points - center) * share[:, None])
    second[2, 2] = height**2 / 12.0
    turning = np.trace(second) * np.eye(3) - second
    reach = np.linalg.norm(outline - center, axis=1).max()
    radius = float(np.hypot(reach, 0.5 * height))
    return float(areas.sum() * height), np.append(center, 0.5 * height), turning, radius
