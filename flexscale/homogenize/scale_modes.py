"""The modes of a scale: the few elastic displacements by which a scale yields to its loads.

A scale of hard material strains little, but it yields where the sheet pulls on it, and that halves
the stiffness of some patterns. Its finite elements have many unknowns, of which few combinations
matter: those in which the scale is soft compared to what pulls on it. Let f_j be the unit loads on
the scale's points and vectors, each times the root of the stiffness k_j of what pulls there
(`scale_loads`), K the scale's stiffness, and C_ij = f_i . K^-1 f_j. An eigenvalue of C is the
compliance of the scale over the compliance of what pulls on it. The modes whose eigenvalue is above
a cutoff are kept.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.bodies import N_STRAINS, STRAIN_PAIRS, Body
from flexscale.embedding.cell import CellEmbedding
from flexscale.embedding.curvature_map import BODY_POINT
from flexscale.embedding.scale_nodes import PointNodes
from flexscale.homogenize.scale_loads import SheetSupport, components, unit_loads
from flexscale.mechanics.energy import block_pairs
from flexscale.mechanics.neo_hookean import NeoHookeanTets
from flexscale.mesh.periodic_mesh import PeriodicMesh
from flexscale.patterns import NeoHookean
from flexscale.solve.linear import build_factorization

_AT_ONCE = 64  # loads that are solved for together
_CONGRUENT = 1e-9  # of a scale's size: copies may differ by rounding
_SAME = 1e-5  # eigenvalues closer than this are a pair that symmetry makes: both or none are kept


def build_bodies(
    embedding: CellEmbedding,
    material: NeoHookean,
    support: SheetSupport,
    cutoff: float,
) -> list[Body]:
    """Bodies of all scales of a cell whose scales are points (`PointNodes`)."""
    nodes = embedding.nodes
    assert isinstance(nodes, PointNodes)
    loads = unit_loads(embedding, nodes, support)
    shares = embedding.vertex_shares()
    known: list[_Modes] = []
    return [
        _build_body(embedding, nodes, material, loads, shares, scale, cutoff, known)
        for scale in range(embedding.mesh.n_scales)
    ]


def build_rigid_bodies(embedding: CellEmbedding, material: NeoHookean, factor: float) -> list[Body]:
    """Bodies that strain evenly alone, `factor` times as stiff as their material."""
    nodes = embedding.nodes
    assert isinstance(nodes, PointNodes)
    none = sp.csr_array((3 * embedding.mesh.n_scale_vertices, 0))
    shares = embedding.vertex_shares()
    bodies = [
        _build_body(embedding, nodes, material, none, shares, scale, np.inf, [])
        for scale in range(embedding.mesh.n_scales)
    ]
    return [replace(body, stiffness=factor * body.stiffness) for body in bodies]


@dataclass(frozen=True)
class _Modes:
    """Modes of a scale: vertices' places (n, 3) from the anchor, loads, modes (n, 3, k), and the
    stiffness (6 + k, 6 + k) of strains and modes."""

    places: FloatArray
    n_loads: int
    modes: FloatArray
    stiffness: FloatArray

    def is_moved_to(self, places: FloatArray, n_loads: int) -> bool:
        """Whether a scale is the same one elsewhere, not turned, with the same numbering."""
        if places.shape != self.places.shape or n_loads != self.n_loads:
            return False
        return bool(np.abs(self.places - places).max() <= _CONGRUENT * np.abs(places).max())

    def turned_to(self, places: FloatArray, n_loads: int) -> FloatArray | None:
        """(3 n, k) modes of a congruent scale with the same numbering; None if it is none."""
        if places.shape != self.places.shape or n_loads != self.n_loads:
            return None
        turn = np.eye(3)
        turn[:2, :2] = np.linalg.lstsq(self.places[:, :2], places[:, :2], rcond=None)[0]
        if np.abs(self.places @ turn - places).max() > _CONGRUENT * np.abs(places).max():
            return None
        return np.asarray(np.einsum("nck,cd->ndk", self.modes, turn)).reshape(places.size, -1)


def _build_body(
    embedding: CellEmbedding,
    nodes: PointNodes,
    material: NeoHookean,
    loads: sp.csr_array,
    shares: FloatArray,
    scale: int,
    cutoff: float,
    known: list[_Modes],
) -> Body:
    """One scale; a new one, up to where it lies, is added to `known`. Congruent scales share their
    modes."""
    mesh = embedding.mesh
    vertices = np.unique(mesh.tets[mesh.tet_scale == scale])
    own = sp.csc_array(sp.csr_array(loads[components(vertices)]))
    own = own[:, np.flatnonzero(np.diff(own.indptr))]
    carried = np.flatnonzero(mesh.vertex_scale == scale)
    weight = shares[carried] / shares[carried].sum()
    anchor = weight @ mesh.positions[carried]
    places = mesh.scale_positions[vertices].copy()
    places[:, :2] -= anchor
    n_loads = own.shape[1]
    affine = np.isinf(cutoff)
    kind = next((found for found in known if found.is_moved_to(places, n_loads)), None)
    if kind is None or affine:
        copies = (found.turned_to(places, n_loads) for found in known)
        modes = next((found for found in copies if found is not None), None)
        stiffness = _stiffness(mesh, scale, vertices, material)
        if affine:
            modes = np.zeros((places.size, 0))
        if modes is None:
            modes = _modes(stiffness, own, places, cutoff)
        fields = np.concatenate([_strain_fields(places), modes], axis=1)
        product = _symmetric(fields.T @ (stiffness @ fields))
        kind = _Modes(places, n_loads, modes.reshape(*places.shape, -1), product)
        if not affine:
            known.append(kind)
    shapes, n = kind.modes, kind.modes.shape[2]
    mine = np.flatnonzero(nodes.scale == scale)
    on_nodes = nodes.weights[mine][:, vertices]
    bonds = embedding.bonds
    table = sp.csr_array(
        (bonds.values, bonds.scale_vertices, bonds.indptr),
        shape=(len(bonds.indptr) - 1, mesh.n_scale_vertices),
    )[embedding.vertex_bond[carried]][:, vertices]
    offsets = mesh.positions[carried] - anchor
    is_point = (nodes.kinds[mine] == BODY_POINT).astype(float)
    arms = nodes.rest[mine].copy()
    arms[:, :2] -= is_point[:, None] * anchor
    return Body(
        anchor=anchor,
        arms=arms,
        is_point=is_point,
        modes=(on_nodes @ shapes.reshape(len(vertices), 3 * n)).reshape(len(mine), 3, n),
        stiffness=kind.stiffness,
        second_moment=offsets.T @ (weight[:, None] * offsets),
        share=float(shares[carried].sum()),
        mean_modes=weight @ (table @ shapes[:, 2]),
        shapes=shapes,
        vertices=vertices,
        vertex_arms=places,
    )


def _symmetric(matrix: FloatArray) -> FloatArray:
    return 0.5 * (matrix + matrix.T)


def _stiffness(
    mesh: PeriodicMesh, scale: int, vertices: IntArray, material: NeoHookean
) -> sp.csr_array:
    """Stiffness (3 n, 3 n) of a scale's finite elements at rest, N/mm."""
    tets = np.searchsorted(vertices, mesh.tets[mesh.tet_scale == scale])
    rest = mesh.scale_positions[vertices]
    elements = NeoHookeanTets(rest, tets, tets, material.shear_modulus, material.lame_lambda)
    blocks = elements.hessian_blocks(rest)
    i, j = block_pairs(tets.shape[1])
    first, second = np.broadcast_arrays(
        3 * tets[:, i][..., None, None] + np.arange(3)[:, None],
        3 * tets[:, j][..., None, None] + np.arange(3),
    )
    first, second = np.broadcast_arrays(first, second)
    upper = sp.csr_array(
        (blocks.ravel(), (first.ravel(), second.ravel())), shape=(3 * len(vertices),) * 2
    )
    off = i != j
    lower = sp.csr_array(
        (blocks[:, off].ravel(), (second[:, off].ravel(), first[:, off].ravel())),
        shape=upper.shape,
    )
    return sp.csr_array(upper + lower)


def _strain_fields(places: FloatArray) -> FloatArray:
    """(3 n, 6) displacements of the unit strains of `bodies`."""
    fields = np.zeros((len(places), 3, N_STRAINS))
    for k, (a, b) in enumerate(STRAIN_PAIRS):
        fields[:, b, k] += 0.5 * places[:, a]
        fields[:, a, k] += 0.5 * places[:, b]
    return fields.reshape(-1, N_STRAINS)


def _modes(
    stiffness: sp.csr_array, loads: sp.csc_array, places: FloatArray, cutoff: float
) -> FloatArray:
    """(3 n, k) modes of unit energy without their affine parts, for loads (3 n, n_loads)."""
    n, n_loads = len(places), loads.shape[1]
    affine = np.zeros((n, 3, 12))
    for c in range(3):
        affine[:, c, c] = 1.0
        affine[:, c, 3 + 3 * c : 6 + 3 * c] = places
    basis = np.linalg.qr(affine.reshape(3 * n, 12))[0]
    respond = _Responses(stiffness, places)
    compliance = np.empty((n_loads, n_loads))
    # Responses to all loads at once would be most of the memory that a cell takes.
    for start in range(0, n_loads, _AT_ONCE):
        part = slice(start, start + _AT_ONCE)
        compliance[:, part] = loads.T @ respond(loads[:, part].toarray())
    values, vectors = np.linalg.eigh(_symmetric(compliance))
    values, vectors = values[::-1], vectors[:, ::-1]
    count = int(np.count_nonzero(values > cutoff))
    while 0 < count < len(values) and values[count] > (1.0 - _SAME) * values[count - 1]:
        count += 1
    modes = respond(loads @ (vectors[:, :count] / np.sqrt(values[:count])))
    return np.asarray(modes - basis @ (basis.T @ modes))


class _Responses:
    """Displacements of a free body under loads, both without their rigid parts."""

    def __init__(self, stiffness: sp.csr_array, places: FloatArray) -> None:
        n = len(places)
        turns = np.zeros((n, 3, 6))
        for c in range(3):
            axis = np.eye(3)[c]
            turns[:, c, c] = 1.0
            turns[:, :, 3 + c] = np.cross(axis, places)
        self._rigid = np.linalg.qr(turns.reshape(3 * n, 6))[0]
        # Balanced loads leave no force where six components are held.
        self._free = np.setdiff1d(np.arange(3 * n), _three_points(places))
        upper = sp.csr_array(sp.triu(stiffness[self._free][:, self._free]))
        upper.sort_indices()
        self._factorization = build_factorization(upper.indptr, upper.indices)
        self._factorization.factorize(upper.data)

    def __call__(self, loads: FloatArray) -> FloatArray:
        """(3 n, k) under loads (3 n, k), of which there may be none: rigid scales have no modes."""
        if loads.shape[1] == 0:
            return np.zeros_like(loads)
        balanced = loads - self._rigid @ (self._rigid.T @ loads)
        out = np.zeros_like(balanced)
        out[self._free] = self._factorization.solve(balanced[self._free], refine=False)
        return np.asarray(out - self._rigid @ (self._rigid.T @ out))


def _three_points(places: FloatArray) -> IntArray:
    """Six components that hold a body just so: three, two and one of three far vertices."""
    a = int(np.argmin(places @ [1.0, 0.3, 0.1]))
    b = int(np.argmax(np.linalg.norm(places - places[a], axis=1)))
    along = (places[b] - places[a]) / np.linalg.norm(places[b] - places[a])
    c = int(np.argmax(np.linalg.norm(np.cross(places - places[a], along), axis=1)))
    span = np.abs(along)
    main = int(np.argmax(span))
    others = [axis for axis in range(3) if axis != main]
    normal = np.abs(np.cross(along, places[c] - places[a]))
    last = int(np.argmax(normal))
    return np.array(
        [3 * a, 3 * a + 1, 3 * a + 2, 3 * b + others[0], 3 * b + others[1], 3 * c + last]
    )
