"""The cylinder of curvature kappa in direction alpha, regular at kappa = 0 [Eqs. 1, 2, 14, 15].

With n = (cos alpha, sin alpha), m = (-sin alpha, cos alpha), q1 = n . P, q2 = m . P, theta = kappa
q1, a point at in-plane coordinates P and height w3 goes to

    x = n (sin(theta)/kappa - w3 sin theta) + m q2 + e3 ((1 - cos theta)/kappa + w3 cos theta),

the paper's map moved by 1/kappa so that kappa -> 0 is the identity. kappa > 0 closes scales on the
+w3 side.

A lattice image of the cell is a rigid motion of it: P = w + (I + S) L for a lattice vector L, and
vectors (the substrate's parameter gradients g) turn with the cylinder by kappa n . (X + (I + S) L),
X a fixed anchor. Every such quantity depends on three home unknowns and, for L != 0, on S = (Sxx,
Syy, Sxy). Numbers (the substrate's edge angles) are the same in all images and under every bend.

Points and vectors of a body that is given in the world (a scale described by few modes) have their
world coordinates as home unknowns; their images are what that rigid motion makes of them. With q =
n . (I + S) L and R the rotation by kappa q,

    x -> R x + n sin(kappa q)/kappa + m (m . (I + S) L) + e3 (1 - cos(kappa q))/kappa.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray, IntArray

POSITION, GRADIENT, NUMBERS, BODY_POINT, BODY_VECTOR = range(5)


@dataclass(frozen=True)
class ImageVectors:
    """Positions of vertices, gradient vectors and numbers, in the home cell and its lattice images.

    Attributes
    ----------
    kinds : (n,) POSITION, GRADIENT, NUMBERS, BODY_POINT or BODY_VECTOR.
    nodes : (n,) first of the three home unknowns in z.
    shifts : (n, 2) lattice vector of the image, mm.
    anchors : (n, 2) rest coordinates that set the frame of a gradient vector, mm.
    """

    kinds: IntArray
    nodes: IntArray
    shifts: FloatArray
    anchors: FloatArray


@njit(cache=True)
def _trigonometric_quotients(t):
    """sin t / t, (1 - cos t)/t^2, (t cos t - sin t)/t^2, (t sin t - 1 + cos t)/t^2."""
    if abs(t) < 1e-2:
        t2 = t * t
        sinc = 1.0 - t2 / 6.0 * (1.0 - t2 / 20.0 * (1.0 - t2 / 42.0))
        versine = 0.5 - t2 / 24.0 * (1.0 - t2 / 30.0 * (1.0 - t2 / 56.0))
        d_sine = -t / 3.0 * (1.0 - t2 / 10.0 * (1.0 - t2 / 28.0))
        d_versine = 0.5 - t2 / 8.0 * (1.0 - t2 / 18.0 * (1.0 - t2 / 40.0))
        return sinc, versine, d_sine, d_versine
    sine, cosine = np.sin(t), np.cos(t)
    half = np.sin(0.5 * t)
    versine = 2.0 * half * half / (t * t)
    return sine / t, versine, (t * cosine - sine) / (t * t), sine / t - versine


@njit(cache=True)
def _stretch_rates(shift, out):
    """d(S L)/dS: out (2, 3) for S = (Sxx, Syy, Sxy)."""
    out[0, 0], out[0, 1], out[0, 2] = shift[0], 0.0, shift[1]
    out[1, 0], out[1, 1], out[1, 2] = 0.0, shift[1], shift[0]


@njit(cache=True)
def _home_point(z, node, shift, n_unknowns, point):
    """P = w + (I + S) L and w3."""
    s = n_unknowns - 3
    point[0] = z[node] + (1.0 + z[s]) * shift[0] + z[s + 2] * shift[1]
    point[1] = z[node + 1] + (1.0 + z[s + 1]) * shift[1] + z[s + 2] * shift[0]
    point[2] = z[node + 2]


@njit(cache=True)
def _frame_angle(z, anchor, shift, n_unknowns, n0, n1):
    """n . (X + (I + S) L)."""
    s = n_unknowns - 3
    p0 = anchor[0] + (1.0 + z[s]) * shift[0] + z[s + 2] * shift[1]
    p1 = anchor[1] + (1.0 + z[s + 1]) * shift[1] + z[s + 2] * shift[0]
    return n0 * p0 + n1 * p1


@njit(cache=True)
def _place_body_image(z, curvature, n0, n1, is_point, node, shift, rates, x, jacobian, kappa_rate):
    """Fill x (3,), jacobian (3, 6) and kappa_rate (3,) of one image of a body's vector."""
    s = len(z) - 3
    l0 = (1.0 + z[s]) * shift[0] + z[s + 2] * shift[1]
    l1 = (1.0 + z[s + 1]) * shift[1] + z[s + 2] * shift[0]
    q, across = n0 * l0 + n1 * l1, -n1 * l0 + n0 * l1
    theta = curvature * q
    sine, cosine = np.sin(theta), np.cos(theta)
    h0, h1, h2 = z[node], z[node + 1], z[node + 2]
    along, side = n0 * h0 + n1 * h1, -n1 * h0 + n0 * h1
    turned, lifted = cosine * along - sine * h2, sine * along + cosine * h2
    # Derivative by q, in n and e3, and by kappa at fixed q.
    d_turned, d_lifted = -curvature * lifted, curvature * turned
    k_turned, k_lifted = -q * lifted, q * turned
    if is_point:
        sinc, versine, d_sine, d_versine = _trigonometric_quotients(theta)
        turned += q * sinc
        lifted += curvature * q * q * versine
        side += across
        d_turned += cosine
        d_lifted += sine
        k_turned += q * q * d_sine
        k_lifted += q * q * d_versine
    x[0], x[1], x[2] = n0 * turned - n1 * side, n1 * turned + n0 * side, lifted
    kappa_rate[0], kappa_rate[1], kappa_rate[2] = n0 * k_turned, n1 * k_turned, k_lifted
    for c in range(2):
        nc = n0 if c == 0 else n1
        mc = -n1 if c == 0 else n0
        jacobian[0, c] = cosine * n0 * nc - n1 * mc
        jacobian[1, c] = cosine * n1 * nc + n0 * mc
        jacobian[2, c] = sine * nc
    jacobian[0, 2] = -sine * n0
    jacobian[1, 2] = -sine * n1
    jacobian[2, 2] = cosine
    for r in range(3):
        d_q = n0 * rates[0, r] + n1 * rates[1, r]
        d_across = -n1 * rates[0, r] + n0 * rates[1, r] if is_point else 0.0
        jacobian[0, 3 + r] = n0 * d_turned * d_q - n1 * d_across
        jacobian[1, 3 + r] = n1 * d_turned * d_q + n0 * d_across
        jacobian[2, 3 + r] = d_lifted * d_q


@njit(cache=True)
def place_images(z, curvature, direction, kinds, nodes, shifts, anchors, x, jacobian, kappa_rate):
    """Fill x (n, 3), jacobian (n, 3, 6) in (home, S), kappa_rate (n, 3) = dx/dkappa at fixed z."""
    n0, n1 = np.cos(direction), np.sin(direction)
    point, rates = np.empty(3), np.empty((2, 3))
    for k in range(len(kinds)):
        _stretch_rates(shifts[k], rates)
        if kinds[k] == POSITION:
            _home_point(z, nodes[k], shifts[k], len(z), point)
            q1 = n0 * point[0] + n1 * point[1]
            q2 = -n1 * point[0] + n0 * point[1]
            w3 = point[2]
            theta = curvature * q1
            sinc, versine, d_sine, d_versine = _trigonometric_quotients(theta)
            sine, cosine = np.sin(theta), np.cos(theta)
            along = q1 * sinc - w3 * sine
            x[k, 0] = n0 * along - n1 * q2
            x[k, 1] = n1 * along + n0 * q2
            x[k, 2] = curvature * q1 * q1 * versine + w3 * cosine
            rate = q1 * q1 * d_sine - w3 * q1 * cosine
            kappa_rate[k, 0] = n0 * rate
            kappa_rate[k, 1] = n1 * rate
            kappa_rate[k, 2] = q1 * q1 * d_versine - w3 * q1 * sine
            scale = 1.0 - curvature * w3
            for c in range(2):
                nc = n0 if c == 0 else n1
                mc = -n1 if c == 0 else n0
                jacobian[k, 0, c] = scale * cosine * n0 * nc - n1 * mc
                jacobian[k, 1, c] = scale * cosine * n1 * nc + n0 * mc
                jacobian[k, 2, c] = scale * sine * nc
            jacobian[k, 0, 2] = -sine * n0
            jacobian[k, 1, 2] = -sine * n1
            jacobian[k, 2, 2] = cosine
            for r in range(3):
                for s in range(3):
                    jacobian[k, r, 3 + s] = (
                        jacobian[k, r, 0] * rates[0, s] + jacobian[k, r, 1] * rates[1, s]
                    )
        elif kinds[k] == NUMBERS:
            jacobian[k] = 0.0
            for c in range(3):
                x[k, c] = z[nodes[k] + c]
                jacobian[k, c, c] = 1.0
                kappa_rate[k, c] = 0.0
        elif kinds[k] == BODY_POINT or kinds[k] == BODY_VECTOR:
            _place_body_image(
                z, curvature, n0, n1, kinds[k] == BODY_POINT, nodes[k], shifts[k], rates,
                x[k], jacobian[k], kappa_rate[k],
            )  # fmt: skip
        else:
            q1 = _frame_angle(z, anchors[k], shifts[k], len(z), n0, n1)
            theta = curvature * q1
            sine, cosine = np.sin(theta), np.cos(theta)
            g0, g1, g2 = z[nodes[k]], z[nodes[k] + 1], z[nodes[k] + 2]
            along, across = n0 * g0 + n1 * g1, -n1 * g0 + n0 * g1
            turned, lifted = cosine * along - sine * g2, sine * along + cosine * g2
            x[k, 0] = n0 * turned - n1 * across
            x[k, 1] = n1 * turned + n0 * across
            x[k, 2] = lifted
            kappa_rate[k, 0] = -q1 * lifted * n0
            kappa_rate[k, 1] = -q1 * lifted * n1
            kappa_rate[k, 2] = q1 * turned
            for c in range(2):
                nc = n0 if c == 0 else n1
                mc = -n1 if c == 0 else n0
                jacobian[k, 0, c] = cosine * n0 * nc - n1 * mc
                jacobian[k, 1, c] = cosine * n1 * nc + n0 * mc
                jacobian[k, 2, c] = sine * nc
            jacobian[k, 0, 2] = -sine * n0
            jacobian[k, 1, 2] = -sine * n1
            jacobian[k, 2, 2] = cosine
            for s in range(3):
                turn = curvature * (n0 * rates[0, s] + n1 * rates[1, s])
                jacobian[k, 0, 3 + s] = -turn * lifted * n0
                jacobian[k, 1, 3 + s] = -turn * lifted * n1
                jacobian[k, 2, 3 + s] = turn * turned


@njit(cache=True)
def _curve_body_image(
    z, curvature, n0, n1, is_point, node, shift, rates, along_force, up_force, hessian, mixed
):
    """Second derivatives of one image of a body's vector, contracted with a force."""
    s = len(z) - 3
    l0 = (1.0 + z[s]) * shift[0] + z[s + 2] * shift[1]
    l1 = (1.0 + z[s + 1]) * shift[1] + z[s + 2] * shift[0]
    q = n0 * l0 + n1 * l1
    sine, cosine = np.sin(curvature * q), np.cos(curvature * q)
    along, h2 = n0 * z[node] + n1 * z[node + 1], z[node + 2]
    turned, lifted = cosine * along - sine * h2, sine * along + cosine * h2
    # Forces that work on the rotation, and once more.
    along_rate = -sine * along_force + cosine * up_force
    up_rate = -cosine * along_force - sine * up_force
    twice = -turned * along_force - lifted * up_force
    once = -lifted * along_force + turned * up_force
    dd_q = curvature * curvature * twice
    q_kappa = once + curvature * q * twice
    if is_point:
        dd_q += curvature * along_rate
        q_kappa += q * along_rate
    home = (along_rate * n0, along_rate * n1, up_rate)
    for i in range(3):
        mixed[i] = q * home[i]
    for r in range(3):
        d_q = n0 * rates[0, r] + n1 * rates[1, r]
        mixed[3 + r] = q_kappa * d_q
        for i in range(3):
            hessian[i, 3 + r] = hessian[3 + r, i] = curvature * d_q * home[i]
        for t in range(3):
            hessian[3 + r, 3 + t] = dd_q * d_q * (n0 * rates[0, t] + n1 * rates[1, t])


@njit(cache=True)
def curve_images(z, curvature, direction, kinds, nodes, shifts, anchors, forces, hessian, mixed):
    """Contract second derivatives with forces (n, 3).

    Fills hessian (n, 6, 6) = f . d2x/d(home, S)2 and mixed (n, 6) = f . d2x/d(home, S) dkappa.
    """
    n0, n1 = np.cos(direction), np.sin(direction)
    point, rates, ell = np.empty(3), np.empty((2, 3)), np.empty(6)
    for k in range(len(kinds)):
        _stretch_rates(shifts[k], rates)
        along_force = n0 * forces[k, 0] + n1 * forces[k, 1]
        up_force = forces[k, 2]
        hessian[k] = 0.0
        mixed[k] = 0.0
        if kinds[k] == POSITION:
            _home_point(z, nodes[k], shifts[k], len(z), point)
            q1 = n0 * point[0] + n1 * point[1]
            w3 = point[2]
            sine, cosine = np.sin(curvature * q1), np.cos(curvature * q1)
            radial = -sine * along_force + cosine * up_force
            tangential = cosine * along_force + sine * up_force
            d11 = (1.0 - curvature * w3) * curvature * radial
            d13 = -curvature * tangential
            mixed_1 = -w3 * tangential + (1.0 - curvature * w3) * q1 * radial
            # Everything goes through q1 = n . (w + ...): ell = dq1/d(home, S).
            ell[0], ell[1], ell[2] = n0, n1, 0.0
            for s in range(3):
                ell[3 + s] = n0 * rates[0, s] + n1 * rates[1, s]
            for i in range(6):
                mixed[k, i] = mixed_1 * ell[i]
                for j in range(6):
                    hessian[k, i, j] = d11 * ell[i] * ell[j]
            for i in range(6):
                hessian[k, i, 2] += d13 * ell[i]
                hessian[k, 2, i] += d13 * ell[i]
            mixed[k, 2] -= q1 * tangential
        elif kinds[k] == BODY_POINT or kinds[k] == BODY_VECTOR:
            _curve_body_image(
                z, curvature, n0, n1, kinds[k] == BODY_POINT, nodes[k], shifts[k], rates,
                along_force, up_force, hessian[k], mixed[k],
            )  # fmt: skip
        elif kinds[k] == GRADIENT:
            q1 = _frame_angle(z, anchors[k], shifts[k], len(z), n0, n1)
            sine, cosine = np.sin(curvature * q1), np.cos(curvature * q1)
            g0, g1, g2 = z[nodes[k]], z[nodes[k] + 1], z[nodes[k] + 2]
            along = n0 * g0 + n1 * g1
            turned, lifted = cosine * along - sine * g2, sine * along + cosine * g2
            first = -lifted * along_force + turned * up_force
            second = -turned * along_force - lifted * up_force
            along_rate = -sine * along_force + cosine * up_force
            up_rate = -cosine * along_force - sine * up_force
            ell[0], ell[1], ell[2] = along_rate * n0, along_rate * n1, up_rate
            for i in range(3):
                mixed[k, i] = q1 * ell[i]
            for s in range(3):
                turn = n0 * rates[0, s] + n1 * rates[1, s]
                mixed[k, 3 + s] = turn * first + curvature * q1 * turn * second
                for i in range(3):
                    hessian[k, i, 3 + s] = curvature * turn * ell[i]
                    hessian[k, 3 + s, i] = curvature * turn * ell[i]
                for r in range(3):
                    other = n0 * rates[0, r] + n1 * rates[1, r]
                    hessian[k, 3 + s, 3 + r] = curvature * curvature * turn * other * second


def flat_curvature_rates(images: ImageVectors, z: FloatArray) -> FloatArray:
    """(3, n, 3) derivatives of the images at the flat rest state for unit kappa_xx, kappa_yy,
    kappa_xy.

    x = w + (w . K w)/2 e3 - w3 K w to first order in the symmetric curvature tensor K; vectors turn
    with the surface, g -> g + (g . K X) e3 - g3 K X; numbers stay. A unit kappa_xy is K = e1 e2 +
    e2 e1.
    """
    tensors = np.array([[[1.0, 0], [0, 0]], [[0, 0], [0, 1.0]], [[0, 1.0], [1.0, 0]]])
    home = np.stack([z[images.nodes + c] for c in range(3)], axis=1)
    kinds = images.kinds[:, None]
    # A body's images turn by the curvature of the way to them alone.
    from_home = (kinds == BODY_POINT) | (kinds == BODY_VECTOR)
    place = np.where(kinds == POSITION, home[:, :2], np.where(from_home, 0.0, images.anchors))
    place = place + images.shifts
    is_vector = (images.kinds != POSITION)[:, None]
    is_bent = images.kinds != NUMBERS
    rates = np.zeros((3, len(images.kinds), 3))
    for k, tensor in enumerate(tensors):
        turn = place @ tensor
        sagitta = 0.5 * np.einsum("ni,ni->n", place, turn)
        lift = np.einsum("ni,ni->n", home[:, :2], turn)
        rates[k, :, :2] = -home[:, 2:] * turn
        rates[k, :, 2] = np.where(is_vector[:, 0], lift, 0.0)
        rates[k, :, 2] += np.where(np.isin(images.kinds, (POSITION, BODY_POINT)), sagitta, 0.0)
    return rates * is_bent[:, None]
