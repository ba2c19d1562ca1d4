"""Kernels of linear triangles with per-triangle shape operators and any sheet law.

On a triangle the first form a is that of constant strain and the second form is the shape operator
of `edge_angles`: from the turns phi_i of the edges' normals against the face's,

    b = sum c_i B_i,   c_i = 2 tan(phi_i / 2),   B_i = l_i / A nu_i (x) nu_i,

and the energy is A psi(a - I, b), hence

    dE  = A (psi_e . de + sum g_i dphi_i),   g_i = (psi_b . B_i) c'_i
    d2E = A [(de, db) psi'' (de, db) + psi_e . d2e + sum (psi_b . B_i) c''_i dphi_i^2 + g_i d2phi_i]

with db = sum B_i c'_i dphi_i, c' = 1 + c^2/4 and c'' = c c'/2. On a free edge phi = xi, so nothing
holds its normal: its couple vanishes at equilibrium.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from flexscale.mechanics.constant_strain import deform
from flexscale.mechanics.dihedral import add_angle_gradient, add_angle_hessian, edge_frame
from flexscale.mechanics.edge_angles import local_nodes


@njit(cache=True)
def _turns(y, rows, shares, signs, frames, sizes, c):
    """Fill frames and sizes of the three edges, and c; False if the triangle is degenerate.

    Other than in the native sheet, an edge that shares no dihedral angle may still turn by xi.
    """
    for i in range(3):
        turn = 0.0
        if shares[i] != 0.0:
            p, q = y[rows[i]], y[rows[(i + 1) % 3]]
            a, b = y[rows[(i + 2) % 3]], y[rows[3 + i]]
            turn = shares[i] * edge_frame(p, q, a, b, frames[i], sizes[i])
        if len(rows) == 9:
            turn += signs[i] * y[rows[6 + i], 0]
        if not abs(turn) < np.pi:
            return False
        c[i] = 2.0 * np.tan(0.5 * turn)
    return True


@njit(cache=True)
def triangle_states(y, vectors, gradients, shapes, shares, signs, out):
    frames, sizes, c, f = np.empty((3, 5, 3)), np.empty((3, 5)), np.empty(3), np.empty((3, 2))
    for t in range(len(vectors)):
        if not deform(y, vectors[t], gradients[t], f, out[t]) > -1.0:
            return False
        if not _turns(y, vectors[t], shares[t], signs[t], frames, sizes, c):
            return False
        for k in range(3):
            out[t, 3 + k] = 0.0
            for i in range(3):
                out[t, 3 + k] += c[i] * shapes[t, i, k]
    return True


@njit(cache=True)
def _strain_rates(f, gradients, d):
    """Fill d (3, 3, 3): de_k / dx_a of the three corners."""
    for a in range(3):
        for r in range(3):
            d[0, a, r] = 2.0 * gradients[a, 0] * f[r, 0]
            d[1, a, r] = gradients[a, 0] * f[r, 1] + gradients[a, 1] * f[r, 0]
            d[2, a, r] = 2.0 * gradients[a, 1] * f[r, 1]


@njit(cache=True)
def triangle_gradient(y, vectors, gradients, shapes, shares, signs, areas, grads, out):
    frames, sizes, c, f = np.empty((3, 5, 3)), np.empty((3, 5)), np.empty(3), np.empty((3, 2))
    e, d, local = np.empty(3), np.empty((3, 3, 3)), np.empty((6, 3))
    for t in range(len(vectors)):
        deform(y, vectors[t], gradients[t], f, e)
        _turns(y, vectors[t], shares[t], signs[t], frames, sizes, c)
        _strain_rates(f, gradients[t], d)
        local[:] = 0.0
        for k in range(3):
            for a in range(3):
                for r in range(3):
                    local[a, r] += areas[t] * grads[t, k] * d[k, a, r]
        for i in range(3):
            g = 0.0
            for k in range(3):
                g += areas[t] * grads[t, 3 + k] * shapes[t, i, k]
            g *= 1.0 + 0.25 * c[i] * c[i]
            if shares[t, i] != 0.0:
                add_angle_gradient(frames[i], sizes[i], g * shares[t, i], local_nodes(i), local)
            if vectors.shape[1] == 9:
                out[vectors[t, 6 + i], 0] += g * signs[t, i]
        for k in range(6):
            for r in range(3):
                out[vectors[t, k], r] += local[k, r]


@njit(cache=True)
def _add_stretch_terms(gradients, grad, full):
    """Add psi_e . d2e, the same in all three directions of space."""
    for a in range(3):
        for b in range(3):
            u, v = gradients[a], gradients[b]
            s = 2.0 * grad[0] * u[0] * v[0] + 2.0 * grad[2] * u[1] * v[1]
            s += grad[1] * (u[0] * v[1] + u[1] * v[0])
            for r in range(3):
                full[a, b, r, r] += s


@njit(cache=True)
def _add_turn_terms(i, share, sign, shape, c, grad, frame, sizes, slope, rates, full):
    """Add those of edge i: to `rates` db, to `full` the terms with second derivatives of c_i."""
    couple, rate, n = 0.0, 1.0 + 0.25 * c * c, len(slope)
    for k in range(3):
        couple += grad[3 + k] * shape[k]
    slope[:] = 0.0
    if share != 0.0:
        nodes = local_nodes(i)
        add_angle_gradient(frame, sizes, share, nodes, slope)
        add_angle_hessian(frame, sizes, couple * rate * share, nodes, full)
    if n == 9:
        slope[6 + i, 0] = sign
    _add_square(slope, 0.5 * couple * c * rate, full)
    for k in range(3):
        for x in range(n):
            for r in range(3):
                rates[3 + k, x, r] += shape[k] * rate * slope[x, r]


@njit(cache=True)
def triangle_hessian(y, vectors, gradients, shapes, shares, signs, areas, grads, hessians, out):
    n = vectors.shape[1]
    frames, sizes, c, f = np.empty((3, 5, 3)), np.empty((3, 5)), np.empty(3), np.empty((3, 2))
    e, d = np.empty(3), np.empty((3, 3, 3))
    rates, halves = np.empty((6, n, 3)), np.empty((6, n, 3))
    slope, full = np.empty((n, 3)), np.empty((n, n, 3, 3))
    for t in range(len(vectors)):
        deform(y, vectors[t], gradients[t], f, e)
        _turns(y, vectors[t], shares[t], signs[t], frames, sizes, c)
        _strain_rates(f, gradients[t], d)
        full[:] = 0.0
        rates[:] = 0.0
        rates[:3, :3] = d
        _add_stretch_terms(gradients[t], grads[t], full)
        for i in range(3):
            _add_turn_terms(
                i, shares[t, i], signs[t, i], shapes[t, i], c[i], grads[t],
                frames[i], sizes[i], slope, rates, full,
            )  # fmt: skip
        for s in range(6):
            for x in range(n):
                for r in range(3):
                    halves[s, x, r] = 0.0
                    for q in range(6):
                        halves[s, x, r] += hessians[t, s, q] * rates[q, x, r]
        _store(areas[t], full, rates, halves, out[t])


@njit(cache=True)
def _store(area, full, rates, halves, out):
    """Fill the blocks of an element with A (full + rates^T halves)."""
    pair, n = 0, full.shape[0]
    for x in range(n):
        for z in range(x, n):
            for r in range(3):
                for k in range(3):
                    total = full[x, z, r, k]
                    for s in range(6):
                        total += rates[s, x, r] * halves[s, z, k]
                    out[pair, r, k] = area * total
            pair += 1


@njit(cache=True)
def _add_square(slope, factor, full):
    for x in range(len(slope)):
        for z in range(len(slope)):
            for r in range(3):
                for k in range(3):
                    full[x, z, r, k] += factor * slope[x, r] * slope[z, k]
