"""Moves overlapping scales apart, and no farther than needed.

Minimized is the sum over all scales of the mean square displacement of their points, counted from
where the scales were placed, subject to a clearance between all parts of neighbors. Separations are
linearized (`contact_rows`), the quadratic program for all scales at once is solved, scales are
moved, and so on. Which face parts a pair is a choice, so that what is found is a local minimum.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.spatial.transform import Rotation

from flexscale.arrays import FloatArray
from flexscale.synthesis.contact_rows import contact_rows
from flexscale.synthesis.overlap import close_pairs, overlap_of
from flexscale.synthesis.placement import Placement
from flexscale.synthesis.prisms import ConvexParts, Moments
from flexscale.synthesis.quadratic_program import solve_qp
from flexscale.synthesis.separation import EdgePairs, Kept, place_parts, separations

log = logging.getLogger(__name__)

MOST_ITERATIONS = 100  # after which the best state is given back: least overlap, then least motion
_SOFTNESS = 1e-6  # of inequalities, mm per mm of motion
_DAMPING = 1.0  # weight of the distance from the last state: turns bend the linearized separations;
# it doubles whenever a step makes the overlap deeper
_FREE = 5  # iterations after which pairs begin to keep the direction that parts them
_STATIONARY = 2e-3  # of the cost, what one more step would save in the end
_CROSSING = 0.2  # sine of the angle between edges whose common normal is followed
_LARGEST_TURN = 0.1  # rad a step: beyond, linearized separations are far off


@dataclass(frozen=True, eq=False)
class Removal:
    """Scales moved apart.

    Attributes
    ----------
    placement : where they are then.
    converged : whether no scales overlap.
    iterations : quadratic programs solved.
    """

    placement: Placement
    converged: bool
    iterations: int


def remove_overlap(
    parts: ConvexParts,
    moments: Moments,
    placed: Placement,
    *,
    clearance: float,
    turn_weight: float = 1.0,
) -> Removal:
    """Move scales apart.

    Parameters
    ----------
    parts, moments : of the scales.
    placed : where they are.
    clearance : mm, smallest distance wanted between neighbors along the direction that parts them.
    turn_weight : of what turning contributes to the displacements.
    """
    placement, best = placed, (np.inf, np.inf, placed)
    memory: dict[tuple[int, int], int] = {}
    edges, reach = EdgePairs(2.0 * clearance, _CROSSING, 2.0 * clearance), clearance
    weights, damping, deepest = _weights(moments, placed, turn_weight), _DAMPING, np.inf
    for iteration in range(MOST_ITERATIONS + 1):
        world = place_parts(parts, placement)
        pairs = close_pairs(parts.owner, world, reach)
        numbers = np.array([memory.get((a, b), -1) for a, b in pairs.tolist()], dtype=np.int64)
        kept = Kept(numbers, clearance * 2.0 ** (iteration - _FREE), 0.5 * clearance)
        found = separations(world, pairs, edges, kept)
        memory = dict(zip(map(tuple, pairs.tolist()), found.numbers.tolist(), strict=True))
        overlap = overlap_of(parts.owner[pairs], found.distances)
        if iteration == 0:
            # Neighbors farther apart than this do not meet in one step.
            reach = 2.0 * overlap.deepest + 10.0 * clearance
        moved = _displacements(moments, placed, placement)
        cost = float(moved @ weights @ moved)
        best = min(best, (overlap.deepest, cost, placement), key=lambda state: state[:2])
        if iteration == MOST_ITERATIONS:
            break
        contacts = contact_rows(world, parts.owner, pairs, found, reach)
        rows = contacts.matrix(_centers(moments, placement))
        if overlap.deepest > deepest:
            damping *= 2.0
        deepest = overlap.deepest
        pull = damping / (1.0 + damping) * moved
        bounds = clearance - contacts.gaps + rows @ (moved - pull)
        target = solve_qp(weights, rows, bounds, _SOFTNESS) + pull
        saved = cost - float(target @ weights @ target)
        log.debug("%d: deepest %.3g mm, cost %.6g mm2", iteration, overlap.deepest, cost)
        apart = found.distances.min(initial=np.inf) >= 0.5 * clearance
        if apart and saved <= _STATIONARY * cost:
            return Removal(placement, True, iteration)
        step = (target - moved).reshape(-1, 6)
        turn = float(np.linalg.norm(step[:, 3:], axis=1).max())
        placement = _moved(moments, placement, step * min(1.0, _LARGEST_TURN / max(turn, 1e-9)))
    return Removal(best[2], best[0] == 0.0, MOST_ITERATIONS)


def motion_of(
    parts: ConvexParts, moments: Moments, start: Placement, end: Placement
) -> tuple[float, float, float]:
    """How far scales moved.

    Returns
    -------
    Root of the mean of the scales' mean square displacements, mm; the farthest that a point went,
    mm; the largest turn, degree.
    """
    moved = _displacements(moments, start, end)
    squares = float(moved @ _weights(moments, start) @ moved) / len(moments.volumes)
    paths = np.linalg.norm(parts.vertices(end) - parts.vertices(start), axis=2)
    turns = np.linalg.norm(moved.reshape(-1, 6)[:, 3:], axis=1)
    return float(np.sqrt(squares)), float(paths.max()), float(np.rad2deg(turns.max()))


def _centers(moments: Moments, placement: Placement) -> FloatArray:
    turned = np.einsum("nij,nj->ni", placement.rotations, moments.centers)
    return np.asarray(turned + placement.translations)


def _displacements(moments: Moments, start: Placement, now: Placement) -> FloatArray:
    """(6 n,) translations of the centroids, and rotation vectors."""
    shift = _centers(moments, now) - _centers(moments, start)
    turn = Rotation.from_matrix(now.rotations @ start.rotations.transpose(0, 2, 1)).as_rotvec()
    return np.concatenate([shift, turn], axis=1).ravel()


def _moved(moments: Moments, placement: Placement, step: FloatArray) -> Placement:
    """Scales turned about their centroids and translated by (n, 6)."""
    rotations = Rotation.from_rotvec(step[:, 3:]).as_matrix() @ placement.rotations
    centers = _centers(moments, placement) + step[:, :3]
    turned = np.einsum("nij,nj->ni", rotations, moments.centers)
    return Placement(rotations, centers - turned)


def _weights(moments: Moments, placed: Placement, turn_weight: float = 1.0) -> sp.csc_array:
    """(6 n, 6 n): with motions (6 n,), the sum of the mean square displacements of the scales."""
    n = len(moments.volumes)
    blocks = np.zeros((n, 6, 6))
    blocks[:, :3, :3] = np.eye(3)
    turned = placed.rotations @ moments.turning @ placed.rotations.transpose(0, 2, 1)
    blocks[:, 3:, 3:] = turn_weight * turned
    table = (blocks, np.arange(n), np.arange(n + 1))
    return sp.bsr_array(table, shape=(6 * n, 6 * n)).tocsc()
