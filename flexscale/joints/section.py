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
from typing import Any

import numpy as np
import scipy.sparse as sp

from flexscale.arrays import FloatArray, IntArray
from flexscale.joints.pose import place, place_bends, place_rates
from flexscale.joints.section_mesh import SectionMesh
from flexscale.mechanics.energy import ALL, NOTHING, block_pairs, project_blocks
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
    """Energy of a meshed section under a pose: an `Objective` of Newton's method.

    Parameters
    ----------
    mesh : the section.
    poisson_ratio : of the sheet.
    scales : material of elastic scales, its modulus in those of the sheet; None if rigid.
    """

    energy_floor = 1e-16

    def __init__(
        self, mesh: SectionMesh, poisson_ratio: float, scales: NeoHookean | None = None
    ) -> None:
        self.mesh = mesh
        sheet = NeoHookean(1.0, poisson_ratio)
        parts = [(sheet, ~mesh.of_scales)] + ([(scales, mesh.of_scales)] if scales else [])
        self.energies = [_energy(mesh, chosen, material) for material, chosen in parts]
        n = len(mesh.points)
        held = np.zeros(n, dtype=bool)
        held[mesh.held_a] = held[mesh.held_b] = True
        self.held = np.concatenate([mesh.held_a, mesh.held_b])
        self.active = np.flatnonzero(np.repeat(~held, 3))
        self.shift_mode: FloatArray = np.zeros(len(self.active))
        self._build_pattern(3 * n)
        self.system = UnconstrainedSystem(
            build_factorization(self._upper.indptr, self._upper.indices),
            self._upper.indptr[:-1].astype(np.int64),
        )
        self.system.constraint = np.zeros(len(self.active))
        self.pose: FloatArray = np.zeros(4)

    def _build_pattern(self, n: int) -> None:
        first, second = block_pairs(_K)
        nodes = np.concatenate([energy.vectors for energy in self.energies])
        rows = 3 * nodes[:, first, None, None] + np.arange(3)[:, None] + np.zeros((3, 3), int)
        columns = 3 * nodes[:, second, None, None] + np.arange(3) + np.zeros((3, 3), int)
        twice = (nodes[:, first] != nodes[:, second])[:, :, None, None] & np.ones((3, 3), bool)
        inside = np.maximum(rows, columns) < n
        self._direct, self._mirrored = np.flatnonzero(inside), np.flatnonzero(inside & twice)
        rows, columns = rows.ravel(), columns.ravel()
        i = np.concatenate([rows[self._direct], columns[self._mirrored]])
        j = np.concatenate([columns[self._direct], rows[self._mirrored]])
        entries, self._slots = np.unique(i * n + j, return_inverse=True)
        indptr = np.searchsorted(entries, n * np.arange(n + 1))
        self._matrix = sp.csr_array((np.ones(len(entries)), entries % n, indptr), shape=(n, n))
        free = np.full(n, -1)
        free[self.active] = np.arange(len(self.active))
        i, j = free[entries // n], free[entries % n]
        self._upper_slots: IntArray = np.flatnonzero((i >= 0) & (j >= i))
        i, j = i[self._upper_slots], j[self._upper_slots]
        n_free = len(self.active)
        pointers = np.searchsorted(i, np.arange(n_free + 1))
        self._upper = sp.csr_array((np.ones(len(i)), j, pointers), shape=(n_free, n_free))

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

    def hessian_values(self, state: State, project: str = NOTHING) -> FloatArray:
        """Upper-triangle values over the free unknowns."""
        return self._all_values(state, project == ALL)[self._upper_slots]

    def _all_values(self, state: State, project: bool = False) -> FloatArray:
        blocks = np.concatenate([part.hessian_blocks(state.y) for part in self.energies])
        if project:
            blocks = project_blocks(blocks, _K)
        flat = blocks.ravel()
        mirrored = np.swapaxes(blocks, 2, 3).ravel()
        del mirrored
        values = np.concatenate([flat[self._direct], flat[self._mirrored]])
        return np.bincount(self._slots, weights=values, minlength=len(self._matrix.data))

    def free_share(self, evaluation: Any, trial: Any) -> float:
        """1: nothing stands in the way."""
        return 1.0

    def keep_apart(self, evaluation: Any, wanted: FloatArray) -> None:
        """None: nothing is kept apart."""
        return

    def response(self, state: State, pose: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Forces dW/dq (4,), tangent d2W/dq2 (4, 4), and rates (3 n_nodes, 4) of all nodes.

        The state is an equilibrium under the pose.
        """
        self._matrix.data = values = self._all_values(state)
        rates, bends = self._held_rates(pose)
        self.system.factorize(values[self._upper_slots])
        rates[self.active] = -self.system.solve_block((self._matrix @ rates)[self.active])
        forces = rates.T @ np.where(self._is_held(), state.full_gradient, 0.0)
        tangent = rates.T @ (self._matrix @ rates)
        tangent[3, 3] += bends @ state.full_gradient
        return forces, 0.5 * (tangent + tangent.T), rates

    def _is_held(self) -> Any:
        held = np.ones(len(self._matrix.indptr) - 1, dtype=bool)
        held[self.active] = False
        return held

    def _held_rates(self, pose: FloatArray) -> tuple[FloatArray, FloatArray]:
        n = len(self.mesh.points)
        rates, bends = np.zeros((n, 3, 4)), np.zeros((n, 3))
        for held, side in ((self.mesh.held_a, -1.0), (self.mesh.held_b, 1.0)):
            rates[held] = place_rates(self.mesh.points[held], side, pose)
            bends[held] = place_bends(self.mesh.points[held], side, pose)
        return rates.reshape(-1, 4), bends.ravel()


def _energy(mesh: SectionMesh, chosen: Any, material: NeoHookean) -> NeoHookeanElements:
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
    half = 0.5 * (corners[:, 8] - corners[:, 0])
    # Node 3 j + i is the i-th across and the j-th up; point 3 k + l so too.
    across = np.einsum("lj,ki->klji", shape, slope).reshape(9, 9)
    up = np.einsum("lj,ki->klji", slope, shape).reshape(9, 9)
    gradients = np.zeros((len(corners), 9, _K, 3))
    gradients[:, :, :9, 0] = across / half[:, 0, None, None]
    gradients[:, :, :9, 2] = up / half[:, 1, None, None]
    gradients[:, :, 9, 1] = 1.0
    weights = np.outer(np.prod(half, axis=1), np.outer(gauss, gauss))
    return gradients, weights
