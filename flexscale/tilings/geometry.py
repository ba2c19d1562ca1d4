"""Geometry of a family, derived from its symbol once and kept.

The family's coordinates: the Laves tile stands about the origin, and direction x runs along a
lattice vector of the tiling with parameters 0. Where the group has mirrors or glides, it is the
shortest lattice vector parallel or perpendicular to one of them, else the shortest of all; of
several equally short ones, the one that leaves edge 0 lowest, its outward normal nearest to -y, and
of two such the one that leaves it on the right. The linear parts of the group are the same for all
parameters, and so are the directions of its mirrors and glides.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.tilings.angles import UNIT
from flexscale.tilings.families import find_family
from flexscale.tilings.group import FamilyGroup, edge_motion, generate_group
from flexscale.tilings.laves import laves_tile
from flexscale.tilings.shape_space import ShapeSpace, build_shape_space
from flexscale.tilings.symbols import IncidenceSymbol


@dataclass(frozen=True)
class FamilyGeometry:
    """A family's tiles and how they repeat.

    Attributes
    ----------
    symbol : parsed incidence symbol.
    facing : degrees, direction of the outward normal of edge 0 of the Laves tile.
    group : motions and translations, as functions of the vertices.
    space : all tiles of the family.
    """

    symbol: IncidenceSymbol
    facing: float
    group: FamilyGroup
    space: ShapeSpace


@cache
def family_geometry(name: str) -> FamilyGeometry:
    """The geometry of the family called `name`.

    Raises
    ------
    TilingError : there is no such family.
    """
    family = find_family(name)
    symbol, net = IncidenceSymbol(family.symbol), family.net
    tile = laves_tile(net, 0.0)
    facing = _facing(generate_group(symbol, net, tile, 0.0), tile)
    tile = laves_tile(net, facing)
    group = generate_group(symbol, net, tile, facing)
    motions = [(edges, edge_motion(net, facing, edges)) for edges in symbol.edge_motions]
    return FamilyGeometry(symbol, facing, group, build_shape_space(tile, motions))


def _facing(group: FamilyGroup, tile: FloatArray) -> float:
    """Degrees by which a tile whose edge 0 faces +x must be turned to stand in its coordinates."""
    basis = group.translations @ tile.ravel()
    steps = np.array([step for step in product(range(-4, 5), repeat=2) if any(step)])
    vectors = steps @ basis
    angles = np.degrees(np.arctan2(vectors[:, 1], vectors[:, 0]))
    # A reflection's axis lies at half its turn; with the perpendiculars: at all multiples of 90°.
    axes = [0.5 * UNIT * part.turn for part in group.linear_parts if part.reverses]
    if axes:
        off_axis = [np.abs((angles - axis + 45.0) % 90.0 - 45.0) for axis in axes]
        on_axis = np.min(off_axis, axis=0) < 1e-6
        vectors, angles = vectors[on_axis], angles[on_axis]
    lengths = np.round(np.linalg.norm(vectors, axis=1), 9)
    shortest = -angles[lengths == lengths.min()]
    facing = min(shortest, key=_height_of_edge)
    # Exact where it is a multiple of 15°, as it is whenever there are mirrors or glides.
    whole = UNIT * round(facing / UNIT)
    return whole if abs(facing - whole) < 1e-6 else float(facing)


def _height_of_edge(facing: float) -> tuple[float, float]:
    """What is least for an edge at the bottom, and on the right if two are equally low."""
    return round(math.sin(math.radians(facing)), 9), -math.cos(math.radians(facing))
