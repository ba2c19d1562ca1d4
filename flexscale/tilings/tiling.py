"""A tiling: a family, its shape parameters and the curves on its edges."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.errors import TilingError, UnitRangeError, shown
from flexscale.tilings.curves import read_curves
from flexscale.tilings.drawn_symmetry import drawn_symmetry
from flexscale.tilings.families import Family, find_family
from flexscale.tilings.geometry import family_geometry
from flexscale.tilings.isometry import Isometry
from flexscale.tilings.lattice import reduction
from flexscale.tilings.outline import build_outline, require_tile, signed_area
from flexscale.tilings.wallpaper import DrawnSymmetry
from flexscale.units import require_series

LARGEST_PARAMETER = 100.0
_SHAPE_NAMES = {"IH20": "hexagon", "IH76": "square"}


class Tiling:
    """One member of a tiling family, with tiles of area 1.

    The tile of parameters 0 is the Laves tile of the family's net: its angle at a vertex of degree
    d is 2π/d, and all its edges touch one circle. Direction x runs along a lattice vector of that
    tiling, parallel or perpendicular to a mirror or glide if there are any, as told in
    `flexscale.tilings.geometry`.

    Each parameter adds a pattern of vertex displacements to that tile, which is then scaled to
    area 1. First comes "stretch" along x and "shear" along the diagonal, if the family can be
    stretched and sheared as a whole; then what moves single vertices; `parameter_names` has the
    names and `flexscale.tilings.shape_space` the definition.

    Parameters
    ----------
    family : "IH01" to "IH93"; see `families`.
    parameters : free shape parameters, displacements of the vertices in units of the root of the
        tile's area, in the root mean square; all 0 if not given.
    edges : edge class -> curve of its first edge, from (0, 0) to (1, 0), the tile on the side
        y > 0: points (n, 2), or a function t -> (x, y) on [0, 1] of which 33 points are taken.
        Classes of kind S and U also take the first half only, up to x = 0.5. The other edges of
        the class follow; classes that are not given are straight, those of kind I must be.

    Attributes
    ----------
    family, parameters, edges : as given, checked; edges as points.
    pattern_name : "hexagon" and "square" for IH20 and IH76, else the family's name.
    prototile : (m, 2) counterclockwise outline, with every tiling vertex and every curve point.
    corners : (n, 2) the tiling vertices of the prototile.
    aspects : one `Isometry` for every lattice class of tiles, the identity first; each tile has an
        edge in common with one before it.
    tiles : tuple of (m, 2) counterclockwise polygons, the images of the prototile.
    lattice : (2, 2) rows t1, t2, right-handed and as short as can be; t1 is the shorter one.
    symbol, group, n_parameters, edge_classes : of the family, see `Family`.
    parameter_names : what each parameter does, such as "stretch" or "vertex 0 outward".

    Raises
    ------
    TilingError : unknown family, parameters or edges that the family does not have, or an outline
        that crosses itself; `outline_of` gives such an outline.
    """

    def __init__(
        self,
        family: str,
        parameters: Sequence[float] | None = None,
        edges: Mapping[str, Any] | None = None,
    ) -> None:
        known = find_family(family)
        geometry = family_geometry(known.name)
        values = _checked_parameters(known, geometry.space.names, parameters)
        given, curves = read_curves(known, edges)
        vertices = _unit_area(geometry.space.vertices(values))
        outline, edge_of_point = build_outline(geometry.symbol, vertices, curves)
        require_tile(known, values, outline, edge_of_point)
        flat = vertices.ravel()
        lattice = _without_rounding(geometry.group.translations @ flat)
        self.family: str = known.name
        self.parameters: tuple[float, ...] = values
        self.edges: dict[str, FloatArray] = given
        self.pattern_name: str = _SHAPE_NAMES.get(known.name, known.name)
        self.prototile: FloatArray = outline
        self.corners: FloatArray = vertices
        self.aspects: tuple[Isometry, ...] = tuple(
            Isometry(motion.linear.matrix, motion.shift @ flat) for motion in geometry.group.aspects
        )
        self.tiles: tuple[FloatArray, ...] = tuple(
            aspect.apply(outline)[:: -1 if aspect.reverses else 1] for aspect in self.aspects
        )
        self.lattice: FloatArray = reduction(lattice) @ lattice
        self.symbol: str = known.symbol
        self.group: str = known.group
        self.n_parameters: int = known.n_parameters
        self.edge_classes = known.edge_classes
        self.parameter_names: tuple[str, ...] = geometry.space.names
        for array in (outline, vertices, self.lattice, *self.tiles, *given.values()):
            array.setflags(write=False)

    def symmetry(self) -> DrawnSymmetry:
        """Symmetry of the tiles as drawn, which may be more than that of the family."""
        return drawn_symmetry(self.tiles, self.lattice)

    def __repr__(self) -> str:
        shape = f", parameters={self.parameters}" if any(self.parameters) else ""
        curves = f", edges of {', '.join(self.edges)} curved" if self.edges else ""
        return f"Tiling({self.family!r}{shape}{curves})"


def outline_of(
    family: str,
    parameters: Sequence[float] | None = None,
    edges: Mapping[str, Any] | None = None,
) -> FloatArray:
    """Outline (m, 2) of a tile of area 1, also where it crosses itself and is no tile.

    The parameters are those of `Tiling`. An outline without area is not scaled.

    Raises
    ------
    TilingError : unknown family, or parameters or edges that the family does not have.
    """
    known = find_family(family)
    geometry = family_geometry(known.name)
    values = _checked_parameters(known, geometry.space.names, parameters)
    _, curves = read_curves(known, edges)
    vertices = _unit_area(geometry.space.vertices(values))
    return build_outline(geometry.symbol, vertices, curves)[0]


def _checked_parameters(
    family: Family, names: tuple[str, ...], parameters: Sequence[float] | None
) -> tuple[float, ...]:
    if parameters is None:
        return (0.0,) * family.n_parameters
    try:
        values = require_series(parameters, "parameters", "1") if _some(parameters) else ()
    except UnitRangeError:
        raise TilingError(
            f"The parameters of tiling family {family.name} must be finite numbers, not "
            f"{shown(parameters)}."
        ) from None
    if len(values) != family.n_parameters:
        meaning = f" ({', '.join(names)})" if names else ""
        raise TilingError(
            f"Tiling family {family.name} has {family.n_parameters} free shape parameter(s)"
            f"{meaning}, but {len(values)} were given."
        )
    if max(map(abs, values), default=0.0) > LARGEST_PARAMETER:
        raise TilingError(
            f"A parameter of tiling family {family.name} is beyond {LARGEST_PARAMETER:g}, not "
            f"{shown(values)}: parameters move vertices, in units of the tile's size."
        )
    return values


def _some(parameters: Any) -> bool:
    """Whether there are any: families without parameters are given none."""
    size = len(parameters) if isinstance(parameters, Sequence) else getattr(parameters, "size", 1)
    return bool(size != 0)


def _without_rounding(vectors: FloatArray) -> FloatArray:
    """Exactly level where only rounding is not: directions are told from the lattice."""
    return np.where(np.abs(vectors) < 1e-14, 0.0, vectors)


def _unit_area(vertices: FloatArray) -> FloatArray:
    """Vertices scaled to area 1 in size; curves on the edges do not change the tile's area."""
    area = abs(signed_area(vertices))
    return vertices / math.sqrt(area) if area > 1e-12 else vertices
