"""The loads that sheet and contact put on a scale, each times the root of a stiffness.

A strip of sheet of width g, thickness t and plate stiffness D, held at its other side, pulls at the
outline with E t / g per length and displacement in the plane, 12 D / g^3 across, and 4 D / g per
turn. A solid sheet pulls at the base. A neighbor that touches presses on the walls.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.cell import CellEmbedding
from flexscale.embedding.scale_nodes import PointNodes
from flexscale.embedding.solid_cell import SolidCell

_PULLED = 1.0  # thickness, from the outline inward, in which a solid sheet pulls at the base


@dataclass(frozen=True)
class SheetSupport:
    """What hangs on a scale: a strip of sheet all along its outline, and neighbors.

    Attributes
    ----------
    stretching, lifting : N/mm2 per length of the strip, for displacements in the plane and across.
    turning : N per length, for gradients.
    touching : N/mm2 per length of the outline, of a neighbor.
    bearing : N/mm3 per area of the base, of a solid sheet.
    """

    stretching: float
    lifting: float
    turning: float
    touching: float
    bearing: float

    @classmethod
    def of_strip(
        cls, young_modulus: float, thickness: float, bending_stiffness: float, gap: float
    ) -> SheetSupport:
        """The strip of sheet in the gap; moduli in MPa, lengths in mm, stiffness in N mm."""
        stretching = young_modulus * thickness / gap
        return cls(
            stretching,
            12.0 * bending_stiffness / gap**3,
            4.0 * bending_stiffness / gap,
            stretching,
            young_modulus / thickness,
        )


def unit_loads(embedding: CellEmbedding, nodes: PointNodes, support: SheetSupport) -> sp.csr_array:
    """(3 n_scale_vertices, n_loads) unit loads times the roots of their stiffnesses."""
    pulls = _base_pulls if isinstance(embedding, SolidCell) else _outline_pulls
    return sp.csr_array(sp.hstack([*pulls(embedding, nodes, support), _presses(nodes, support)]))


def _outline_pulls(
    embedding: CellEmbedding, nodes: PointNodes, support: SheetSupport
) -> list[sp.csr_array]:
    """Loads of the strip of sheet along the outline: forces, and couples about the outline."""
    mesh = embedding.mesh
    outline = np.flatnonzero(mesh.edge_scale >= 0)
    spans = embedding.edge_span[outline]
    lengths = np.linalg.norm(spans, axis=1)
    normals = np.stack([-spans[:, 1], spans[:, 0]], axis=1) / lengths[:, None]
    # An edge's length goes to the bonds of its ends and its middle by Simpson's rule.
    ends = embedding.vertex_bond[mesh.edges[outline]]
    middles = embedding.edge_bond[outline]
    bond = np.concatenate([ends[:, 0], ends[:, 1], middles])
    length = np.concatenate([lengths, lengths, 4.0 * lengths]) / 6.0
    normal = np.tile(normals, (3, 1))
    # Bonds with a position take forces, by their share of the outline; all take couples.
    share = np.bincount(bond, length, minlength=len(embedding.bonded))
    valued = np.flatnonzero(nodes.value_of >= 0)
    share *= lengths.sum() / share[valued].sum()
    forces = np.sqrt(share[valued])[:, None] * np.sqrt(
        [support.stretching, support.stretching, support.lifting]
    )
    parts = [_columns(nodes.weights[nodes.value_of[valued]], axis * np.eye(3)[k])
             for k, axis in enumerate(forces.T[:, :, None])]  # fmt: skip
    bond, normal, length = _merged(bond, normal, length)
    couples = np.sqrt(support.turning * length)
    turn = sp.diags_array(couples * normal[:, 0]) @ nodes.weights[nodes.gradient_of[bond, 0]]
    turn = turn + sp.diags_array(couples * normal[:, 1]) @ nodes.weights[nodes.gradient_of[bond, 1]]
    parts.append(_columns(turn, np.tile([0.0, 0.0, 1.0], (len(bond), 1))))
    return parts


def _presses(nodes: PointNodes, support: SheetSupport) -> sp.csr_array:
    """Loads of neighbors that touch the walls."""
    touched, outward, span = _merged(*nodes.wall_normals())
    presses = np.sqrt(support.touching * span)[:, None] * outward
    return _columns(nodes.weights[touched], presses)


def _base_pulls(
    embedding: CellEmbedding, nodes: PointNodes, support: SheetSupport
) -> list[sp.csr_array]:
    """Loads of a solid sheet, which pulls at the base by its shear, near the outline."""
    assert isinstance(embedding, SolidCell)
    mesh, layers = embedding.mesh, embedding.layers
    triangles = mesh.base_triangles
    shares = [1.0 / 3.0] * 3 if triangles.shape[1] == 3 else [1.0 / 12.0] * 3 + [0.25] * 3
    area = np.zeros(mesh.n_scale_vertices)
    np.add.at(area, triangles, mesh.base_areas()[:, None] * shares)
    rim = layers.plane[(layers.plane_scale >= 0) & ~layers.plane_inner]
    depth = cKDTree(rim).query(mesh.scale_positions[:, :2])[0]
    pulled = np.flatnonzero((area > 0.0) & (depth < _PULLED * -layers.heights[-1]))
    roots = np.sqrt(area[pulled] * support.bearing)
    at = sp.csr_array(
        (np.repeat(roots, 3), (components(pulled), np.arange(3 * len(pulled)))),
        shape=(3 * mesh.n_scale_vertices, 3 * len(pulled)),
    )
    return [at]


def _merged(
    places: IntArray, normals: FloatArray, lengths: FloatArray
) -> tuple[IntArray, FloatArray, FloatArray]:
    """One entry for all with the same place and normal, with the sum of their lengths."""
    keys = np.concatenate([places[:, None], np.round(normals * 1e6)], axis=1)
    _, first, number = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return places[first], normals[first], np.bincount(number.ravel(), lengths).astype(float)


def _columns(weights: sp.csr_array, directions: FloatArray) -> sp.csr_array:
    """(3 n_scale_vertices, n) loads in `directions (n, 3)`, spread by the rows of `weights`."""
    return sp.csr_array(
        sum(
            sp.kron((sp.diags_array(directions[:, c]) @ weights).T, np.eye(3)[:, [c]])
            for c in range(3)
        )
    )


def components(vertices: IntArray) -> IntArray:
    """(3 n,) rows of the vertices' coordinates in an array of all coordinates."""
    return (3 * vertices[:, None] + np.arange(3)).ravel()
