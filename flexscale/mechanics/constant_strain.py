"""Neo-Hookean membrane of constant-strain triangles, plane stress: the paper's in-plane element.

On a triangle with rest gradients N_a of its three shape functions the deformation gradient F = sum
x_a (x) N_a (3 x 2) is constant, and the first form is a = F^T F. The energy per rest volume is the
one of `shell_law`, mu/2 (tr a - 2) + m(L) with L = ln sqrt(det a). With the dual basis D = F a^-1,
the unit normal n and d_a = D N_a, from dL = D : dF and dD = n (x) n dF a^-1 - D dF^T D,

    f_a   = mu F N_a + m' d_a
    K_ab  = mu (N_a . N_b) I + m'' d_a (x) d_b + m' [(d_a . d_b) n (x) n - d_b (x) d_a].
"""

from __future__ import annotations

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray, IntArray
from flexscale.mechanics.shell_law import membrane_energy, thickness_stretch_squared


@njit(cache=True)
def deform(y, triangle, gradients, f, strain):
    """Fill F (3, 2) and a - I as (11, 12, 22); returns det a - 1."""
    for r in range(3):
        for c in range(2):
            f[r, c] = 0.0
            for a in range(3):
                f[r, c] += y[triangle[a], r] * gradients[a, c]
    strain[0] = f[0, 0] ** 2 + f[1, 0] ** 2 + f[2, 0] ** 2 - 1.0
    strain[1] = f[0, 0] * f[0, 1] + f[1, 0] * f[1, 1] + f[2, 0] * f[2, 1]
    strain[2] = f[0, 1] ** 2 + f[1, 1] ** 2 + f[2, 1] ** 2 - 1.0
    return strain[0] + strain[2] + strain[0] * strain[2] - strain[1] * strain[1]


@njit(cache=True)
def _energy(y, triangles, gradients, areas, law):
    mu, lam, thickness = law
    f, e = np.empty((3, 2)), np.empty(3)
    total = 0.0
    for t in range(len(triangles)):
        if not deform(y, triangles[t], gradients[t], f, e) > -1.0:
            return np.inf
        total += areas[t] * thickness * membrane_energy(e[0], e[1], e[2], mu, lam)
    return total


@njit(cache=True)
def _dual_vectors(f, e, det_minus_one, gradients, d):
    """Fill d (3, 3), rows d_a = F a^-1 N_a."""
    det = 1.0 + det_minus_one
    for a in range(3):
        c0 = ((1.0 + e[2]) * gradients[a, 0] - e[1] * gradients[a, 1]) / det
        c1 = ((1.0 + e[0]) * gradients[a, 1] - e[1] * gradients[a, 0]) / det
        for r in range(3):
            d[a, r] = f[r, 0] * c0 + f[r, 1] * c1


@njit(cache=True)
def _gradient(y, triangles, gradients, areas, law, out):
    mu, lam, thickness = law
    f, e, d = np.empty((3, 2)), np.empty(3), np.empty((3, 3))
    for t in range(len(triangles)):
        n = gradients[t]
        det_minus_one = deform(y, triangles[t], n, f, e)
        _dual_vectors(f, e, det_minus_one, n, d)
        log_area = 0.5 * np.log1p(det_minus_one)
        slope = -mu * (1.0 + thickness_stretch_squared(log_area, mu, lam))  # m'
        w = areas[t] * thickness
        for a in range(3):
            for r in range(3):
                pulled = mu * (f[r, 0] * n[a, 0] + f[r, 1] * n[a, 1]) + slope * d[a, r]
                out[triangles[t, a], r] += w * pulled


@njit(cache=True)
def _hessian(y, triangles, gradients, areas, law, out):
    mu, lam, thickness = law
    f, e, d, normal = np.empty((3, 2)), np.empty(3), np.empty((3, 3)), np.empty(3)
    for t in range(len(triangles)):
        n = gradients[t]
        det_minus_one = deform(y, triangles[t], n, f, e)
        _dual_vectors(f, e, det_minus_one, n, d)
        stretch = 1.0 + thickness_stretch_squared(0.5 * np.log1p(det_minus_one), mu, lam)
        slope, curve = -mu * stretch, mu * lam / (mu + 0.5 * lam / stretch)  # m', m''
        area = np.sqrt(1.0 + det_minus_one)
        normal[0] = (f[1, 0] * f[2, 1] - f[2, 0] * f[1, 1]) / area
        normal[1] = (f[2, 0] * f[0, 1] - f[0, 0] * f[2, 1]) / area
        normal[2] = (f[0, 0] * f[1, 1] - f[1, 0] * f[0, 1]) / area
        w = areas[t] * thickness
        pair = 0
        for a in range(3):
            for b in range(a, 3):
                dot = n[a, 0] * n[b, 0] + n[a, 1] * n[b, 1]
                dual_dot = d[a, 0] * d[b, 0] + d[a, 1] * d[b, 1] + d[a, 2] * d[b, 2]
                for r in range(3):
                    for c in range(3):
                        out[t, pair, r, c] = w * (
                            curve * d[a, r] * d[b, c]
                            + slope * (dual_dot * normal[r] * normal[c] - d[b, r] * d[a, c])
                        )
                    out[t, pair, r, r] += w * mu * dot
                pair += 1


def triangle_gradients(corners: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rest gradients (n, 3, 2) of the shape functions [mm-1] and areas (n,) of triangles (n, 3, 2).

    The corners run counterclockwise.
    """
    opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    double = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    gradients = np.stack([-opposite[..., 1], opposite[..., 0]], axis=-1) / double[:, None, None]
    return np.ascontiguousarray(gradients), 0.5 * double


class ConstantStrainTriangles:
    """Membrane energy of a sheet that is flat at rest.

    Parameters
    ----------
    corners : (n, 3, 2) rest coordinates of the triangles, mm.
    vectors : (n, 3) rows of `y`: positions of their vertices.
    shear_modulus, lame_lambda : MPa.
    thickness : mm.
    """

    part_names: tuple[str, ...] = ("membrane",)

    def __init__(
        self,
        corners: FloatArray,
        vectors: IntArray,
        *,
        shear_modulus: float,
        lame_lambda: float,
        thickness: float,
    ) -> None:
        self.gradients, self.areas = triangle_gradients(corners)
        self.vectors = np.ascontiguousarray(vectors, dtype=np.int64)
        self.law = (shear_modulus, lame_lambda, thickness)

    def _arguments(self, y: FloatArray) -> tuple:
        return (y, self.vectors, self.gradients, self.areas, self.law)

    def energy_parts(self, y: FloatArray) -> FloatArray:
        """(1,) N mm; infinite where a triangle has no area."""
        return np.array([_energy(*self._arguments(y))])

    def add_gradient(self, y: FloatArray, gradient: FloatArray) -> None:
        """Add dE/dy [N] to `gradient (n_y, 3)`."""
        _gradient(*self._arguments(y), gradient)

    def hessian_blocks(self, y: FloatArray) -> FloatArray:
        """(n, 6, 3, 3) N/mm."""
        out = np.empty((len(self.vectors), 6, 3, 3))
        _hessian(*self._arguments(y), out)
        return out
