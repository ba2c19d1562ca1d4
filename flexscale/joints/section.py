"""The cross-section of a joint as a solid: generalized plane problem, all in thicknesses and E.

All three components of the displacement depend on (n, z) alone, so that the section carries plane
strain and, by the slide s, antiplane shear, at any size of either. Lengths are in thicknesses of
the sheet and stresses in its Young's modulus: energies per length of joint come in E t^2.

The energy W(q) is the least over all nodes that no pose holds. By the envelope theorem its slope is
the reactions' work, g_h . dx_h/dq, and its second derivatives follow from the Schur complement of
the held nodes: with V the rates of all nodes, K V = 0 on the free ones,

    d2W = V_h^T (K V)_h + g_h . d2x_h/dq2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.joints.pose import place, place_bends, place_rates
from flexscale.joints.section_mesh import SectionMesh
from flexscale.mechanics.energy import block_pairs
from flexscale.mechanics.neo_hookean import NeoHookeanElements
from flexscale.patterns.material import NeoHookean
from flexscale.solve.linear import build_factorization
from flexscale.solve.unconstrained import UnconstrainedSystem

_K = 10  # vectors of an element: nine nodes, and the one along the joint


@dataclass(frozen=True)
class State:
    """Energy and gradient of a section at places of its nodes.

    Attributes
    ----------
    y : (n_nodes + 1, 3) places, and the unit vector along the joint.
    energy : E t^2.
    full_gradient : (3 n_nodes,) by all places, E t.
    gradient : its part at free nodes.
    """

    y: FloatArray
    energy: float
    full_gradient: FloatArray
    gradient: FloatArray


class Section:
    """Energy of a meshed section, whose held nodes are at a pose.

    Parameters
    ----------
    mesh : the section.
    poisson_ratio : of the sheet.
    scales : material of elastic scales, its modulus in those of the sheet; None if rigid.
    slides : whether nodes move along the joint too, or stay in the plane of the section.

    Attributes
    ----------
    active : unknowns, among the 3 n_nodes components of all places.
    system : linear systems over them.
    """

    def __init__(
        self,
        mesh: SectionMesh,
        poisson_ratio: float,
        scales: NeoHookean | None = None,
        slides: bool = False,
    ) -> None:
        self.mesh = mesh
        sheet = NeoHookean(1.0, poisson_ratio)
        parts = [(sheet, ~mesh.of_scales)] + ([(scales, mesh.of_scales)] if scales else [])
        self.energies = [_energy(mesh, chosen, material) for material, chosen in parts]
        n = len(mesh.points)
        held = np.zeros(n, dtype=bool)
        held[mesh.held_a] = held[mesh.held_b] = True
        free = np.repeat(~held[:, None], 3, axis=1)
        free[:, 1] &= slides
        self.active = np.flatnonzero(free)
        self._build_pattern(3 * n)
        self.system = UnconstrainedSystem(
            build_factorization(self._free.indptr, self._free.indices), self._free.indptr[:-1]
        )

    def _build_pattern(self, n: int) -> None:
        first, second = block_pairs(_K)
        nodes = np.concatenate([energy.vectors for energy in self.energies])
        rows = 3 * nodes[:, first, None, None] + np.arange(3)[:, None] + np.zeros((3, 3), int)
        columns = 3 * nodes[:, second, None, None] + np.arange(3) + np.zeros((3, 3), int)
        twice = (nodes[:, first] != nodes[:, second])[:, :, None, None] & np.ones((3, 3), bool)
        self._matrix = _Slots(rows, columns, twice, np.arange(n))
        self._free = _Slots(rows, columns, twice, self.active, upper=True)

    def rest(self) -> FloatArray:
        """(3 n_nodes,) places at rest."""
        places = np.zeros((len(self.mesh.points), 3))
        places[:, [0, 2]] = self.mesh.points
        return places.ravel()

    def put(self, z: FloatArray, pose: FloatArray) -> FloatArray:
        """Places (3 n_nodes,) with the held nodes moved to a pose."""
        places = z.reshape(-1, 3).copy()
        for held, side in ((self.mesh.held_a, -1.0), (self.mesh.held_b, 1.0)):
            places[held] = place(self.mesh.points[held], side, pose)
        return places.ravel()

    def evaluate(self, z: FloatArray) -> State:
        """Energy and gradient at places (3 n_nodes,) of which the held ones are at a pose."""
        y = np.concatenate([z.reshape(-1, 3), [[0.0, 1.0, 0.0]]])
        energy = float(sum(part.energy_parts(y)[0] for part in self.energies))
        gradient = np.zeros_like(y)
        if np.isfinite(energy):
            for part in self.energies:
                part.add_gradient(y, gradient)
        full = gradient[:-1].ravel()
        return State(y, energy, full, full[self.active])

    def hessian_values(self, state: State) -> FloatArray:
        """Upper-triangle values over the free unknowns."""
        return self._free.values(self._blocks(state))

    def _blocks(self, state: State) -> FloatArray:
        return np.concatenate([part.hessian_blocks(state.y) for part in self.energies])

    def multiply(self, values: FloatArray, vector: FloatArray) -> FloatArray:
        """Product of the Hessian, given by its upper triangle, with a vector over the unknowns."""
        upper = self._free.matrix_of(values)
        return upper @ vector + sp.triu(upper, 1).T @ vector

    def response(self, state: State, pose: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Forces dW/dq (4,), tangent d2W/dq2 (4, 4), and rates (3 n_nodes, 4) of all nodes.

        The state is an equilibrium under the pose.
        """
        blocks = self._blocks(state)
        matrix = self._matrix.matrix(blocks)
        rates, bends = self._held_rates(pose)
        held = rates != 0.0
        self.system.factorize(self._free.values(blocks))
        rates[self.active] = -self.system.solve_block((matrix @ rates)[self.active])
        forces = np.where(held, rates, 0.0).T @ state.full_gradient
        tangent = rates.T @ (matrix @ rates)
        tangent[3, 3] += bends @ state.full_gradient
        return forces, 0.5 * (tangent + tangent.T), rates

    def _held_rates(self, pose: FloatArray) -> tuple[FloatArray, FloatArray]:
        n = len(self.mesh.points)
        rates, bends = np.zeros((n, 3, 4)), np.zeros((n, 3))
        for held, side in ((self.mesh.held_a, -1.0), (self.mesh.held_b, 1.0)):
            rates[held] = place_rates(self.mesh.points[held], side, pose)
            bends[held] = place_bends(self.mesh.points[held], side, pose)
        return rates.reshape(-1, 4), bends.ravel()


class _Slots:
    """Where entries of element blocks go in a sparse matrix over some unknowns.

    Parameters
    ----------
    rows, columns : (n_elements, n_pairs, 3, 3) unknowns of the entries of blocks i <= j.
    twice : same shape, whether an entry also stands on the other side of the diagonal.
    unknowns : (n,) those of the matrix, increasing.
    upper : whether the upper triangle alone is wanted.
    """

    def __init__(
        self,
        rows: IntArray,
        columns: IntArray,
        twice: BoolArray,
        unknowns: IntArray,
        upper: bool = False,
    ) -> None:
        self.n = n = len(unknowns)
        place = np.full(max(rows.max(), columns.max()) + 1, -1)
        place[unknowns] = np.arange(n)
        i, j, twice = place[rows.ravel()], place[columns.ravel()], twice.ravel()
        source = np.flatnonzero(np.minimum(i, j) >= 0)
        mirrored = source[twice[source]]
        self._source = np.concatenate([source, mirrored])
        i, j = np.concatenate([i[source], j[mirrored]]), np.concatenate([j[source], i[mirrored]])
        if upper:
            above = i <= j
            self._source, i, j = self._source[above], i[above], j[above]
        entries, self._slots = np.unique(i * n + j, return_inverse=True)
        self.indptr = np.searchsorted(entries, n * np.arange(n + 1))
        self.indices = entries % n

    def values(self, blocks: FloatArray) -> FloatArray:
        """Values on the pattern of element blocks (n_elements, n_pairs, 3, 3)."""
        found = blocks.ravel()[self._source]
        summed = np.bincount(self._slots, weights=found, minlength=len(self.indices))
        return summed.astype(np.float64, copy=False)

    def matrix(self, blocks: FloatArray) -> sp.csr_array:
        """The matrix of element blocks."""
        return self.matrix_of(self.values(blocks))

    def matrix_of(self, values: FloatArray) -> sp.csr_array:
        """The matrix with these values on the pattern."""
        return sp.csr_array((values, self.indices, self.indptr), shape=(self.n, self.n))


def _energy(mesh: SectionMesh, chosen: BoolArray, material: NeoHookean) -> NeoHookeanElements:
    """Elements of one material; their tenth vector gives F its column along the joint, e_m."""
    elements = mesh.elements[chosen]
    vectors = np.column_stack([elements, np.full(len(elements), len(mesh.points))])
    gradients, weights = _shape_gradients(mesh.points[elements])
    return NeoHookeanElements(
        gradients, weights, vectors, material.shear_modulus, material.lame_lambda
    )


def _shape_gradients(corners: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Gradients (n, 9, 10, 3) and weights (n, 9) at 3 x 3 Gauss points of rectangles (n, 9, 2)."""
    at, gauss = np.polynomial.legendre.leggauss(3)
    shape = np.stack([0.5 * at * (at - 1.0), 1.0 - at**2, 0.5 * at * (at + 1.0)], axis=1)
    slope = np.stack([at - 0.5, -2.0 * at, at + 0.5], axis=1)
    # Node 3 j + i is the i-th across and the j-th up; point 3 k + l so too.
    stretch_n, stretch_z = corners[:, :3, 0] @ slope.T, corners[:, ::3, 1] @ slope.T
    gradients = np.zeros((len(corners), 9, _K, 3))
    gradients[:, :, :9, 0] = np.einsum("lj,ki,ek->elkji", shape, slope, 1.0 / stretch_n).reshape(
        -1, 9, 9
    )
    gradients[:, :, :9, 2] = np.einsum("lj,ki,el->elkji", slope, shape, 1.0 / stretch_z).reshape(
        -1, 9, 9
    )
    gradients[:, :, 9, 1] = 1.0
    weights = np.einsum("el,l,ek,k->elk", stretch_z, gauss, stretch_n, gauss)
    return gradients, weights.reshape(-1, 9)
