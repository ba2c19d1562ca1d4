"""What the solver asks of an energy: values, forces and stiffness blocks on world vectors.

A *world vector* is a row of `y (n_y, 3)`: the position of a vertex image, or the image of one of
the substrate's parameter gradients. An energy is a list of elements, each a pure function of the
few world vectors it names.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from flexscale.arrays import FloatArray, IntArray


class Energy(Protocol):
    """A sum of element energies over world vectors.

    Attributes
    ----------
    vectors : (n_elements, k) rows of `y` that each element depends on.
    part_names : names of the parts that `energy_parts` returns, for the dataset.
    """

    vectors: IntArray
    part_names: tuple[str, ...]

    def energy_parts(self, y: FloatArray) -> FloatArray:
        """(n_parts,) N mm; any of them infinite where an element is inverted."""

    def add_gradient(self, y: FloatArray, gradient: FloatArray) -> None:
        """Add dE/dy to `gradient (n_y, 3)` [N, or N mm for gradient vectors]."""

    def hessian_blocks(self, y: FloatArray) -> FloatArray:
        """(n_elements, k (k + 1) / 2, 3, 3): blocks (i, j), i <= j row by row, of d2E/dy2."""


class PairEnergy(Protocol):
    """An energy whose pairs of world vectors change with the state."""

    def pair_blocks(self, y: FloatArray, project: bool = False) -> tuple[IntArray, FloatArray]:
        """Pairs (n, 2) of rows, a <= b, and blocks (n, 3, 3) of d2E/dy2 or its positive part."""

    def near_pairs(self, y: FloatArray) -> IntArray:
        """Pairs (n, 2) of rows, a <= b, that have blocks here or may have at states nearby."""


#: What of a Hessian is replaced by its positive part, for a search direction.
NOTHING, CONTACT, ALL = "nothing", "contact", "all"


def block_pairs(k: int) -> tuple[IntArray, IntArray]:
    """Local indices (i, j), i <= j row by row, of the blocks of a k-vector element."""
    i, j = np.triu_indices(k)
    return i.astype(np.int64), j.astype(np.int64)


def project_blocks(blocks: FloatArray, k: int) -> FloatArray:
    """Nearest positive semi-definite element Hessians (eigenvalues clipped at zero).

    Only for a search direction; tangents and inertia use the Hessian as it is.
    """
    i, j = block_pairs(k)
    n = len(blocks)
    full = np.zeros((n, k, 3, k, 3))
    full[:, i, :, j, :] = np.swapaxes(blocks, 0, 1)
    full[:, j, :, i, :] = np.swapaxes(np.swapaxes(blocks, 2, 3), 0, 1)
    values, modes = np.linalg.eigh(full.reshape(n, 3 * k, 3 * k))
    modes *= np.sqrt(np.maximum(values, 0.0))[:, None, :]
    projected = (modes @ np.swapaxes(modes, 1, 2)).reshape(n, k, 3, k, 3)
    return np.ascontiguousarray(np.swapaxes(projected[:, i, :, j, :], 0, 1))
