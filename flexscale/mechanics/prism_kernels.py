"""Distances between walls, edges and corners of two prisms, and the barrier between them.

A candidate is four rows of world positions: a corner and three corners of a wall (two along its
base, one above the first), or two edges. Distances are those of the closed sets: where the nearest
point of a wall lies on its rim, that of the corner to an edge or a corner. The barrier is that of
Incremental Potential Contact (Li et al. 2020), b(D) = -(D - D_hat)^2 ln(D / D_hat) of the squared
distance D; that of two edges is multiplied by their mollifier, since nearest points of parallel
edges are not unique, and corners before walls see those anyway. The sum over all candidates is
smooth, and has the symmetry of the prisms.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray
from flexscale.mechanics.jets import add_product, add_scaled, compose, constant, cross

N_WORK = 16  # rows of jets that `barrier_jet` works in
PARALLEL = 1e-3  # squared sine of the angle of two edges, below which their barrier fades
_SAME_WAY = 1e-9  # squared sine, below which two edges are a point and a line
_TOUCHING = 1e-16  # of D_hat: nearer is rounding
_SHARE = 0.9  # of a distance that one step of collision detection may use up
_NEARER = 0.5  # share of a distance that is left of what is nearer than the least one


@njit(cache=True, error_model="numpy")
def _dot(a: FloatArray, b: FloatArray) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True, error_model="numpy")
def nearest(is_wall: bool, x: FloatArray, shares: FloatArray) -> tuple[float, int]:
    """Squared distance of a candidate, and how many of its features are at their rims.

    x : (4, 3) rows. shares : (4,) filled with the weights of the rows in the arrow between nearest
    points, from the second thing to the first.

    Returns
    -------
    squared distance, and code: 0 point to point, 1 point to line, 2 point to plane, 3 two lines.
    """
    if is_wall:
        e, f, r = x[2] - x[1], x[3] - x[1], x[0] - x[1]
        a, b = _dot(r, e) / _dot(e, e), _dot(r, f) / _dot(f, f)
        rims = 0
        if a <= 0.0 or a >= 1.0:
            a, rims = min(max(a, 0.0), 1.0), rims + 1
        if b <= 0.0 or b >= 1.0:
            b, rims = min(max(b, 0.0), 1.0), rims + 1
        shares[0], shares[1], shares[2], shares[3] = 1.0, a + b - 1.0, -a, -b
        code = 2 - rims
    else:
        u, v, r = x[1] - x[0], x[3] - x[2], x[0] - x[2]
        uu, uv, vv, ur, vr = _dot(u, u), _dot(u, v), _dot(v, v), _dot(u, r), _dot(v, r)
        det = uu * vv - uv * uv
        apart = det > _SAME_WAY * uu * vv
        s = min(max((uv * vr - vv * ur) / det, 0.0), 1.0) if apart else 0.5
        t = (uv * s + vr) / vv
        if t < 0.0:
            t = 0.0
            s = min(max(-ur / uu, 0.0), 1.0)
        elif t > 1.0:
            t = 1.0
            s = min(max((uv - ur) / uu, 0.0), 1.0)
        shares[0], shares[1], shares[2], shares[3] = 1.0 - s, s, t - 1.0, -t
        inner_s, inner_t = 0.0 < s < 1.0, 0.0 < t < 1.0
        code = 3 if inner_s and inner_t and apart else (1 if inner_s or inner_t else 0)
    arrow = shares[0] * x[0] + shares[1] * x[1] + shares[2] * x[2] + shares[3] * x[3]
    return _dot(arrow, arrow), code


@njit(cache=True, error_model="numpy")
def barrier(d: float, d_hat: float) -> tuple[float, float, float]:
    """b(D) and its two derivatives by D, for D < D_hat."""
    r, ln = d - d_hat, np.log(d / d_hat)
    return -r * r * ln, -2.0 * r * ln - r * r / d, -2.0 * ln - 4.0 * r / d + (r / d) ** 2


@njit(cache=True, error_model="numpy")
def mollifier(sine: float) -> tuple[float, float, float]:
    """m of the squared sine of two edges' angle, and its two derivatives."""
    if sine >= PARALLEL:
        return 1.0, 0.0, 0.0
    s = sine / PARALLEL
    return s * (2.0 - s), 2.0 * (1.0 - s) / PARALLEL, -2.0 / PARALLEL**2


@njit(cache=True, error_model="numpy")
def energy_of(is_wall: bool, x: FloatArray, d_hat: float, shares: FloatArray) -> float:
    """Barrier of a candidate, of stiffness 1; d_hat : mm2, squared."""
    squared, _ = nearest(is_wall, x, shares)
    if squared >= d_hat:
        return 0.0
    if squared <= _TOUCHING * d_hat:
        return np.inf
    energy = barrier(squared, d_hat)[0]
    return energy if is_wall else energy * mollifier(_sine(x))[0]


@njit(cache=True, error_model="numpy")
def _sine(x: FloatArray) -> float:
    u, v = x[1] - x[0], x[3] - x[2]
    uv = _dot(u, v)
    return max(1.0 - uv * uv / (_dot(u, u) * _dot(v, v)), 0.0)


@njit(cache=True, error_model="numpy")
def _combine(weights: FloatArray, rows: FloatArray, out: FloatArray) -> None:
    """out (3, jet) = sum of weights times rows."""
    for c in range(3):
        constant(out[c], 0.0)
        for k in range(4):
            if weights[k] != 0.0:
                add_scaled(out[c], weights[k], rows[k, c])


@njit(cache=True, error_model="numpy")
def _inner(a: FloatArray, b: FloatArray, out: FloatArray, n: int, order: int) -> None:
    constant(out, 0.0)
    for i in range(3):
        add_product(out, 1.0, a[i], b[i], n, order)


@njit(cache=True, error_model="numpy")
def _ratio(
    above: FloatArray, below: FloatArray, inverse: FloatArray, out: FloatArray, n: int, order: int
) -> None:
    v = below[0]
    compose(inverse, below, 1.0 / v, -1.0 / v**2, 2.0 / v**3, n, order)
    constant(out, 0.0)
    add_product(out, 1.0, above, inverse, n, order)


@njit(cache=True, error_model="numpy")
def barrier_jet(
    is_wall: bool,
    rows: FloatArray,
    d_hat: float,
    work: FloatArray,
    out: FloatArray,
    n: int,
    order: int,
) -> bool:
    """Barrier of a candidate with its derivatives by n variables; False beyond D_hat.

    rows : (4, 3, jet) positions; work : (N_WORK, jet); out : (jet,).
    """
    shares, x = np.empty(4), np.empty((4, 3))
    for k in range(4):
        for c in range(3):
            x[k, c] = rows[k, c, 0]
    squared, code = nearest(is_wall, x, shares)
    if squared >= d_hat:
        return False
    distance, one, two, part = work[0], work[1], work[2], work[3]
    arrow, u, v, normal = work[4:7], work[7:10], work[10:13], work[13:16]
    weights = np.zeros(4)
    if code == 0:
        _combine(shares, rows, arrow)
        _inner(arrow, arrow, distance, n, order)
    elif code == 1:
        if is_wall:  # the rim on which the nearest point lies
            a, b = -shares[2], -shares[3]
            weights[2 if b <= 0.0 or b >= 1.0 else 3] = 1.0
            weights[1] = -1.0
            shares[1] = a + b - 1.0
        elif shares[0] == 0.0 or shares[1] == 0.0:
            weights[2], weights[3] = -1.0, 1.0
        else:
            weights[0], weights[1] = -1.0, 1.0
        # The nearest point may be any fixed one of the line.
        _combine(shares, rows, arrow)
        _combine(weights, rows, u)
        cross(arrow, u, normal, n, order)
        _inner(normal, normal, one, n, order)
        _inner(u, u, two, n, order)
        _ratio(one, two, part, distance, n, order)
    else:
        if is_wall:
            weights[1], weights[2] = -1.0, 1.0
            _combine(weights, rows, u)
            weights[2], weights[3] = 0.0, 1.0
        else:
            weights[0], weights[1] = -1.0, 1.0
            _combine(weights, rows, u)
            weights[0], weights[1], weights[2], weights[3] = 0.0, 0.0, -1.0, 1.0
        _combine(weights, rows, v)
        _combine(shares, rows, arrow)
        cross(u, v, normal, n, order)
        _inner(arrow, normal, part, n, order)
        constant(one, 0.0)
        add_product(one, 1.0, part, part, n, order)
        _inner(normal, normal, two, n, order)
        _ratio(one, two, part, distance, n, order)
    b = barrier(distance[0], d_hat)
    constant(out, 0.0)
    compose(out, distance, b[0], b[1], b[2], n, order)
    if is_wall:
        return True
    sine = _sine(x)
    if sine < PARALLEL:
        weights[:] = 0.0
        weights[0], weights[1] = -1.0, 1.0
        _combine(weights, rows, u)
        weights[0], weights[1], weights[2], weights[3] = 0.0, 0.0, -1.0, 1.0
        _combine(weights, rows, v)
        cross(u, v, normal, n, order)
        _inner(normal, normal, one, n, order)
        _inner(u, u, part, n, order)
        _inner(v, v, distance, n, order)
        constant(two, 0.0)
        add_product(two, 1.0, part, distance, n, order)
        _ratio(one, two, part, distance, n, order)
        m = mollifier(distance[0])
        compose(part, distance, m[0], m[1], m[2], n, order)
        constant(one, 0.0)
        add_product(one, 1.0, part, out, n, order)
        out[:] = one
    return True


@njit(cache=True, error_model="numpy")
def _from_segment(point: FloatArray, start: FloatArray, end: FloatArray) -> float:
    """Squared distance of a point from a segment."""
    length, along, squared = 0.0, 0.0, 0.0
    for c in range(3):
        way, arrow = end[c] - start[c], point[c] - start[c]
        length, along, squared = length + way * way, along + way * arrow, squared + arrow * arrow
    if length > 0.0:
        t = min(max(along / length, 0.0), 1.0)
        squared = 0.0
        for c in range(3):
            arrow = point[c] - start[c] - t * (end[c] - start[c])
            squared += arrow * arrow
    return squared


@njit(cache=True, error_model="numpy")
def squared_on_the_way(is_wall: bool, x: FloatArray) -> float:
    """Squared distance of a candidate on the straight way between two states.

    There walls are sheared, since corners do not go straight where scales turn: the nearest point
    of a parallelogram is not where those of its sides are, as `nearest` has it. And edges that are
    almost parallel count like all others.
    """
    if is_wall:
        e, f, r = x[2] - x[1], x[3] - x[1], x[0] - x[1]
        ee, ef, ff, re, rf = _dot(e, e), _dot(e, f), _dot(f, f), _dot(r, e), _dot(r, f)
        det = ee * ff - ef * ef
        a, b = (ff * re - ef * rf) / det, (ee * rf - ef * re) / det
        if 0.0 <= a <= 1.0 and 0.0 <= b <= 1.0:
            r = r - a * e - b * f
            return _dot(r, r)
        far = x[2] + f
        low = min(_from_segment(x[0], x[1], x[2]), _from_segment(x[0], x[3], far))
        return min(low, _from_segment(x[0], x[1], x[3]), _from_segment(x[0], x[2], far))
    least = min(_from_segment(x[0], x[2], x[3]), _from_segment(x[1], x[2], x[3]))
    least = min(least, _from_segment(x[2], x[0], x[1]), _from_segment(x[3], x[0], x[1]))
    u, v, r = x[1] - x[0], x[3] - x[2], x[0] - x[2]
    uu, uv, vv, ur, vr = _dot(u, u), _dot(u, v), _dot(v, v), _dot(u, r), _dot(v, r)
    det = uu * vv - uv * uv
    if det > 0.0:
        s, t = (uv * vr - vv * ur) / det, (uu * vr - uv * ur) / det
        if 0.0 <= s <= 1.0 and 0.0 <= t <= 1.0:
            r = r + s * u - t * v
            least = min(least, _dot(r, r))
    return least


@njit(cache=True, error_model="numpy")
def free_share_of(
    is_wall: bool, start: FloatArray, end: FloatArray, least: float, most_steps: int
) -> float:
    """Share of a candidate's straight way, (4, 3) to (4, 3), on which nothing passes through.

    Additive conservative advancement (Li et al. 2021): no step is longer than the distance. What is
    farther apart than `least`, mm, comes no nearer: distances of edges that are almost parallel
    round at 1e-8 mm.
    """
    way = end - start
    mean = 0.25 * (way[0] + way[1] + way[2] + way[3])
    lengths = np.empty(5)
    for k in range(4):
        way[k] -= mean
        lengths[k] = np.sqrt(_dot(way[k], way[k]))
    if is_wall:
        far = way[2] + way[3] - way[1]
        wall = max(max(lengths[1], lengths[2]), max(lengths[3], np.sqrt(_dot(far, far))))
        speed = lengths[0] + wall
    else:
        speed = max(lengths[0], lengths[1]) + max(lengths[2], lengths[3])
    distance = np.sqrt(squared_on_the_way(is_wall, start))
    least = min(least, _NEARER * distance)
    if distance - least > speed:
        return 1.0
    stop, done = least + 0.1 * (distance - least), 0.0
    step = _SHARE * (distance - least) / speed
    for _ in range(most_steps):
        distance = np.sqrt(squared_on_the_way(is_wall, start + (done + step) * way))
        if done > 0.0 and distance < stop:
            return done
        done += step
        if done >= 1.0:
            return 1.0
        step = _SHARE * (distance - least) / speed
    return done
