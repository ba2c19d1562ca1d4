"""What can meet of pairs of prisms: all that is near of many candidates, found by what moved."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.mechanics.prism_kernels import (
    energy_of,
    free_share_of,
    nearest,
    squared_on_the_way,
)


class Candidates(NamedTuple):
    """What can meet of pairs of prisms; those of a pair stand together.

    second : (n_rows,) whether a row is of a pair's second scale; rest : (n_rows, 3) of its corner
    from the scale's anchor, mm; row_starts : (n_pairs + 1,). stencils : (n, 4) rows; is_wall : (n,)
    a corner and three of a wall, or two edges; starts : (n_pairs + 1,).
    """

    second: BoolArray
    rest: FloatArray
    row_starts: IntArray
    stencils: IntArray
    is_wall: BoolArray
    starts: IntArray


class Memory(NamedTuple):
    """Distances once measured. What scales have moved since then bounds what they are now, so that
    those that are far need not be measured at each step; results do not depend on it.

    places : (n_rows, 3) where they were measured, mm; distances : (n,); least : (n_pairs,) mm.
    """

    places: FloatArray
    distances: FloatArray
    least: FloatArray


@njit(cache=True, error_model="numpy")
def _rows_of(y: FloatArray, stencil: IntArray, x: FloatArray) -> None:
    for i in range(4):
        for c in range(3):
            x[i, c] = y[stencil[i], c]


@njit(cache=True, error_model="numpy")
def greatest_way(y: FloatArray, before: FloatArray, table: Candidates, k: int) -> float:
    """By how much distances between scales of pair k may differ between two places y, at most."""
    greatest = np.zeros(2)
    for r in range(table.row_starts[k], table.row_starts[k + 1]):
        a, b, c = y[r, 0] - before[r, 0], y[r, 1] - before[r, 1], y[r, 2] - before[r, 2]
        side = 1 if table.second[r] else 0
        squared = a * a + b * b + c * c
        if not squared <= greatest[side]:  # unknown places before: nan
            greatest[side] = squared
    return np.sqrt(greatest[0]) + np.sqrt(greatest[1])


@njit(cache=True, error_model="numpy")
def moved_since(y: FloatArray, table: Candidates, k: int, memory: Memory, most: float) -> float:
    """By how much pair k moved since its distances were measured; they are anew if by `most`.

    Places may be those on the straight way between two states, where walls are sheared.
    """
    way = greatest_way(y, memory.places, table, k)
    if way < most:
        return way
    for r in range(table.row_starts[k], table.row_starts[k + 1]):
        memory.places[r] = y[r]
    least, x = np.inf, np.empty((4, 3))
    for s in range(table.starts[k], table.starts[k + 1]):
        _rows_of(y, table.stencils[s], x)
        memory.distances[s] = np.sqrt(squared_on_the_way(table.is_wall[s], x))
        least = min(least, memory.distances[s])
    memory.least[k] = least
    return 0.0


@njit(cache=True, error_model="numpy")
def barrier_energy(
    y: FloatArray, table: Candidates, memory: Memory, d_hat: float, most: float
) -> float:
    """Barrier of all candidates, of stiffness 1; d_hat in mm, not squared."""
    energy, x, shares = 0.0, np.empty((4, 3)), np.empty(4)
    for k in range(len(table.starts) - 1):
        way = moved_since(y, table, k, memory, most)
        if memory.least[k] - way >= d_hat:
            continue
        for s in range(table.starts[k], table.starts[k + 1]):
            if memory.distances[s] - way < d_hat:
                _rows_of(y, table.stencils[s], x)
                energy += energy_of(table.is_wall[s], x, d_hat * d_hat, shares)
    return energy


@njit(cache=True, error_model="numpy")
def closer_than(
    y: FloatArray,
    table: Candidates,
    memory: Memory,
    reach: float,
    most: float,
    found: IntArray,
    shares: FloatArray,
) -> tuple[int, float]:
    """Candidates closer than a reach, (n,) and the weights (n, 4) of their arrows; how many, and
    the smallest squared distance among them."""
    n, own, x, smallest = 0, np.empty(4), np.empty((4, 3)), np.inf
    for k in range(len(table.starts) - 1):
        way = moved_since(y, table, k, memory, most)
        if memory.least[k] - way >= reach:
            continue
        for s in range(table.starts[k], table.starts[k + 1]):
            if memory.distances[s] - way >= reach:
                continue
            _rows_of(y, table.stencils[s], x)
            squared = nearest(table.is_wall[s], x, own)[0]
            if squared < reach * reach:
                smallest = min(smallest, squared)
                found[n], shares[n] = s, own
                n += 1
    return n, smallest


@njit(cache=True, error_model="numpy")
def all_free_share(
    start: FloatArray,
    end: FloatArray,
    table: Candidates,
    memory: Memory,
    most: float,
    least: float,
    most_steps: int,
) -> float:
    """Smallest free share of all candidates; what is farther apart than `least` stays so."""
    share, x0, x1 = 1.0, np.empty((4, 3)), np.empty((4, 3))
    for k in range(len(table.starts) - 1):
        speed = greatest_way(end, start, table, k)
        way = moved_since(start, table, k, memory, most)
        if memory.least[k] - way > speed + least:
            continue
        for s in range(table.starts[k], table.starts[k + 1]):
            if memory.distances[s] - way > speed + least:
                continue
            _rows_of(start, table.stencils[s], x0)
            _rows_of(end, table.stencils[s], x1)
            x1 = x0 + share * (x1 - x0)
            share *= free_share_of(table.is_wall[s], x0, x1, least, most_steps)
    return share
