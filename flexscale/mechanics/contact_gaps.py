"""Distances between scales as linear functions of positions, as far as they are small."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from flexscale.arrays import FloatArray, IntArray


@dataclass(frozen=True)
class LinearGaps:
    """Signed distances of pairs of primitives along the normals they have somewhere.

    Attributes
    ----------
    shares : (n, n_vertices) of the surface's vertices in the arrow between nearest points.
    normals : (n, 3) along which distances are measured.
    distances : (n,) there, mm.
    bodies : (n,) number of the pair of scales that each is between.
    """

    shares: sp.csr_array
    normals: FloatArray
    distances: FloatArray
    bodies: IntArray

    def __len__(self) -> int:
        return len(self.distances)

    def at(self, positions: FloatArray) -> FloatArray:
        """(n,) distances at other positions (n_vertices, 3), mm; negative where scales overlap."""
        return np.einsum("nc,nc->n", self.normals, self.shares @ positions)

    def forces(self, entry: int) -> FloatArray:
        """(n_vertices, 3) derivative of one distance."""
        row = self.shares[[entry]]
        out = np.zeros((self.shares.shape[1], 3))
        out[row.indices] = row.data[:, None] * self.normals[entry]
        return out

    def take(self, entries: IntArray) -> LinearGaps:
        """Some of them."""
        return LinearGaps(
            sp.csr_array(self.shares[entries]),
            self.normals[entries],
            self.distances[entries],
            self.bodies[entries],
        )

    def joined(self, others: LinearGaps) -> LinearGaps:
        """These, then the others."""
        return LinearGaps(
            sp.csr_array(sp.vstack([self.shares, others.shares])),
            np.concatenate([self.normals, others.normals]),
            np.concatenate([self.distances, others.distances]),
            np.concatenate([self.bodies, others.bodies]),
        )
