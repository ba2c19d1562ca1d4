"""Scales described by few modes: an affine motion, and displacements in its frame.

A point of a scale at the place r from its anchor goes to

    x = p + sum_a (r + U(r) q)_a g_a,

with p the anchor's position and g_1, g_2, g_3 the frame, which start as the unit vectors, and the
amplitudes q of the modes U. A vector of the base (an in-plane gradient) goes to the same sum
without p. Both are linear in (p, g) for given q and the other way around. With the strain of the
frame

    s = (e11, e22, e33, 2 e23, 2 e13, 2 e12, q),    e_ab = (g_a . g_b - d_ab) / 2,

the elastic energy is 1/2 s . K s, K the stiffness of the scale's finite elements in these fields:
rotations cost nothing, strains may be large in rotation but stay small in themselves (in a hard
scale they do: below 1 %).

p is given by curvilinear coordinates w and turns, as the g do, with the cylinder at the anchor. The
flat base under a bend lies off the cylinder by -kappa (r . n)^2 / 2, in the mean by -kappa n . J n
/ 2; p is lifted by as much: its w3 then is the mean normal displacement of the midsurface there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray

N_FRAME = 12  # unknowns of the anchor and the frame
N_STRAINS = 6
#: The frame's vectors in each strain component.
STRAIN_PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))


@dataclass(frozen=True)
class Body:
    """One scale.

    Attributes
    ----------
    anchor : (2,) rest place of p under the scale, mm.
    arms : (m, 3) r of the points, and unit vectors for vectors, mm or 1.
    is_point : (m,) 1 for points, 0 for vectors.
    modes : (m, 3, n) U of the points and vectors.
    stiffness : (6 + n, 6 + n) K, N mm.
    second_moment : (2, 2) mean of r r^T over the midsurface under the scale, mm2.
    share : share of the cell's midsurface that is the scale's.
    mean_modes : (n,) mean normal displacement of that midsurface in each mode.
    shapes : (n_scale_vertices of this scale, 3, n) modes at all its vertices, for pictures.
    vertices : (n_scale_vertices of this scale,) these vertices.
    vertex_arms : (n_scale_vertices of this scale, 3) their r, mm.
    """

    anchor: FloatArray
    arms: FloatArray
    is_point: FloatArray
    modes: FloatArray
    stiffness: FloatArray
    second_moment: FloatArray
    share: float
    mean_modes: FloatArray
    shapes: np.ndarray
    vertices: np.ndarray
    vertex_arms: FloatArray

    @property
    def n_points(self) -> int:
        """Number of points and vectors."""
        return len(self.arms)

    @property
    def n_unknowns(self) -> int:
        """12 of the frame, and the modes."""
        return N_FRAME + self.modes.shape[2]

    def strain(self, unknowns: FloatArray) -> FloatArray:
        """(6 + n,) s at unknowns (p, g_1, g_2, g_3, q)."""
        g = unknowns[3:N_FRAME].reshape(3, 3)
        metric = g @ g.T - np.eye(3)
        shares = (0.5, 0.5, 0.5, 1.0, 1.0, 1.0)
        strains = [c * metric[a, b] for c, (a, b) in zip(shares, STRAIN_PAIRS, strict=True)]
        return np.concatenate([strains, unknowns[N_FRAME:]])

    def energy(self, unknowns: FloatArray) -> float:
        """Elastic energy, N mm."""
        s = self.strain(unknowns)
        return 0.5 * float(s @ self.stiffness @ s)

    def _strain_rates(self, unknowns: FloatArray) -> FloatArray:
        """(6 + n, n_unknowns) ds/d(unknowns)."""
        g = unknowns[3:N_FRAME].reshape(3, 3)
        rates = np.zeros((len(self.stiffness), self.n_unknowns))
        for k, (a, b) in enumerate(STRAIN_PAIRS):
            rates[k, 3 + 3 * a : 6 + 3 * a] = g[b]
            rates[k, 3 + 3 * b : 6 + 3 * b] = g[a]
        rates[N_STRAINS:, N_FRAME:] = np.eye(len(rates) - N_STRAINS)
        return rates

    def gradient(self, unknowns: FloatArray) -> FloatArray:
        """(n_unknowns,) of the energy."""
        return self._strain_rates(unknowns).T @ (self.stiffness @ self.strain(unknowns))

    def hessian(self, unknowns: FloatArray, project: bool = False) -> FloatArray:
        """(n_unknowns, n_unknowns) of the energy, or of its part that is never negative."""
        rates = self._strain_rates(unknowns)
        hessian = rates.T @ self.stiffness @ rates
        if project:
            return hessian
        stress = self.stiffness[:N_STRAINS] @ self.strain(unknowns)
        for tension, (a, b) in zip(stress, STRAIN_PAIRS, strict=True):
            first, second = slice(3 + 3 * a, 6 + 3 * a), slice(3 + 3 * b, 6 + 3 * b)
            hessian[first, second] += tension * np.eye(3)
            if a != b:
                hessian[second, first] += tension * np.eye(3)
        return hessian

    def places(self, amplitudes: FloatArray) -> FloatArray:
        """(m, 3) r + U q."""
        return self.arms + self.modes @ amplitudes
