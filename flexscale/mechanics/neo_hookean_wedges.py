"""Compressible Neo-Hookean wedges of 18 nodes: a substrate that is a solid.

A triangle of quadratic functions times a line of quadratic functions; the law and its derivatives
are those of the tets. Full quadrature: six points of a triangle (degree 4) times three of a line
(degree 5) integrate the energy of small strains exactly. Quadratic strains follow a nearly constant
volume well: a strip of Poisson's ratio 0.48 bends without locking (`tests/physics/test_solid.py`).
"""

from __future__ import annotations

import numpy as np

from flexscale.arrays import FloatArray, IntArray
from flexscale.mechanics.neo_hookean import NeoHookeanElements
from flexscale.simplices import TRIANGLE_EDGES

N_NODES = 18
# Degree 4 on a triangle: two orbits of three points (Dunavant 1985), as shares of their corner.
_ORBITS = ((0.108103018168070, 0.223381589678011), (0.816847572980459, 0.109951743655322))
_LINE_POINTS, _LINE_WEIGHTS = np.polynomial.legendre.leggauss(3)


def _triangle_rule() -> tuple[FloatArray, FloatArray]:
    """Barycentric coordinates (6, 3) and weights (6,), which add up to 1."""
    points = [np.roll([own, 0.5 * (1.0 - own), 0.5 * (1.0 - own)], k)
              for own, _ in _ORBITS for k in range(3)]  # fmt: skip
    return np.array(points), np.repeat([weight for _, weight in _ORBITS], 3)


def _triangle_shapes(shares: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Values (n, 6) at barycentric coordinates (n, 3), and derivatives (n, 6, 3) by these."""
    start, end = np.transpose(TRIANGLE_EDGES)
    values = np.concatenate(
        [shares * (2.0 * shares - 1.0), 4.0 * shares[:, start] * shares[:, end]], axis=1
    )
    slopes = np.zeros((len(shares), 6, 3))
    for k in range(3):
        slopes[:, k, k] = 4.0 * shares[:, k] - 1.0
        slopes[:, 3 + k, start[k]] = 4.0 * shares[:, end[k]]
        slopes[:, 3 + k, end[k]] = 4.0 * shares[:, start[k]]
    return values, slopes


def _line_shapes(places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Values (n, 3) of the functions of the nodes -1, 0, 1 at places in [-1, 1], and slopes."""
    s = places
    values = np.stack([0.5 * s * (s - 1.0), 1.0 - s * s, 0.5 * s * (s + 1.0)], axis=1)
    return values, np.stack([s - 0.5, -2.0 * s, s + 0.5], axis=1)


def wedge_shape_gradients(
    corners: FloatArray, upper: FloatArray, lower: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Rest gradients (n, 18, 18, 3) and weights (n, 18) at the quadrature points of wedges.

    Parameters
    ----------
    corners : (n, 3, 2) of their triangles, counterclockwise, mm.
    upper, lower : (n,) heights of their faces, mm.
    """
    shares, area_weights = _triangle_rule()
    flat, slopes = _triangle_shapes(shares)
    across, across_slopes = _line_shapes(_LINE_POINTS)
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    double = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    barycentric = np.stack([-opposite[..., 1], opposite[..., 0]], axis=-1) / double[:, None, None]
    in_plane = np.einsum("qak,nkc->nqac", slopes, barycentric)
    # The first level of nodes is the upper face: heights fall with the line's coordinate.
    per_height = -2.0 / (upper - lower)
    n, n_flat, n_line = len(corners), len(shares), len(_LINE_POINTS)
    gradients = np.empty((n, n_flat, n_line, 3, 6, 3))
    gradients[..., :2] = np.einsum("nqac,pl->nqplac", in_plane, across)
    gradients[..., 2] = np.einsum("n,qa,pl->nqpla", per_height, flat, across_slopes)
    volumes = 0.5 * double * (upper - lower)
    weights = np.einsum("n,q,p->nqp", volumes, area_weights, 0.5 * _LINE_WEIGHTS)
    return gradients.reshape(n, -1, N_NODES, 3), np.ascontiguousarray(weights.reshape(n, -1))


class NeoHookeanWedges(NeoHookeanElements):
    """Elastic energy of a solid substrate, on prisms with straight edges.

    Parameters
    ----------
    corners : (n, 3, 2) rest coordinates of the triangles, counterclockwise, mm.
    upper, lower : (n,) rest heights of the two faces, mm.
    vectors : (n, 18) rows of the world vectors `y` with the nodes' positions: the upper face's
        corners, the middles of its `TRIANGLE_EDGES`, the same halfway down, and of the lower face.
    shear_modulus, lame_lambda : MPa.
    """

    part_names: tuple[str, ...] = ("solid",)

    def __init__(
        self,
        corners: FloatArray,
        upper: FloatArray,
        lower: FloatArray,
        vectors: IntArray,
        shear_modulus: float,
        lame_lambda: float,
    ) -> None:
        gradients, weights = wedge_shape_gradients(corners, upper, lower)
        super().__init__(gradients, weights, vectors, shear_modulus, lame_lambda)
