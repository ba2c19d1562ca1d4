"""What a picture shows, from a tiling or from what was to become one."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from flexscale.arrays import FloatArray
from flexscale.errors import TilingError
from flexscale.plotting.outline_contacts import outline_contacts
from flexscale.plotting.tiling import TilingPicture
from flexscale.plotting.tiling_edges import TileEdge
from flexscale.tilings import Family, Tiling, families, outline_of
from flexscale.tilings.curves import read_curves
from flexscale.tilings.drawn_symmetry import drawn_symmetry
from flexscale.tilings.outline import build_outline, signed_area
from flexscale.tilings.symbols import IncidenceSymbol

_LINE_LENGTH = 140  # characters under a picture

_HOW_TO_READ = (
    "Left: strong colors for one tile of each aspect, pale for their lattice images; the cell of "
    "t1 and t2.",
    "Right: numbers of the vertices; letters of the edge classes, bold on the first edge of each, "
    "to which its curve belongs;",
    "ticks a third of the way along that curve, on its side y > 0, and where the symmetry of the "
    "tiling carries them.",
)
_STRIPED = "Striped: mirror images of tile 0."
_MARKING = (
    "This type needs markings on its tiles: without them it is not to be told from a more "
    "symmetric one."
)


def picture_of(tiling: Tiling) -> TilingPicture:
    """Picture of a tiling."""
    family = _family(tiling.family)
    drawn = drawn_symmetry(tiling.tiles, tiling.lattice)
    curves = read_curves(family, tiling.edges)[1]
    mirrored = tuple(aspect.reverses for aspect in tiling.aspects)
    n_aspects = len(tiling.aspects)
    counted = f"{n_aspects} aspects" if n_aspects > 1 else "1 aspect"
    remarks = list(_HOW_TO_READ)
    if any(mirrored):
        remarks[0] += f" {_STRIPED}"
    if family.needs_marking:
        remarks.append(_MARKING)
    return TilingPicture(
        headings=(
            f"{family.name}  {family.symbol}",
            f"group {family.group}, drawn {drawn.group}; {counted}",
            _parameter_text(tiling.parameter_names, tiling.parameters),
        ),
        edges=_edges(family, tiling.corners, curves),
        tiles=tiling.tiles,
        mirrored=mirrored,
        lattice=tiling.lattice,
        remarks=tuple(remarks),
    )


def picture_of_fault(
    family_name: str,
    parameters: Sequence[float] | None,
    edges: Mapping[str, FloatArray],
    error: TilingError,
) -> TilingPicture | None:
    """Picture of an outline that is no tile, or of curves that their classes do not allow.

    Curves that are not allowed are drawn as they were given.

    Parameters
    ----------
    edges : class letter -> (n, 2) points.
    error : what is wrong.

    Returns
    -------
    None if there is no outline: no such family or class, not its number of parameters, or
    points that are not finite.
    """
    try:
        corners = outline_of(family_name, parameters)
    except TilingError:
        return None
    family = _family(family_name)
    curves: dict[str, FloatArray] = {}
    refused = set()
    for letter, points in edges.items():
        try:
            curves |= read_curves(family, {letter: points})[1]
        except TilingError:
            if letter not in family.curve_kinds() or not np.isfinite(points).all():
                return None
            curves[letter] = points
            refused.add(letter)
    outline, edge_of_point = _outline(family, corners, curves)
    pairs, crossings = outline_contacts(outline)
    wrong = set(edge_of_point[pairs.ravel()].tolist())
    wrong |= {k for k, edge in enumerate(family.edge_classes) if edge.letter in refused}
    if not wrong and signed_area(outline) <= 0.0:
        wrong = set(range(len(corners)))
    names = Tiling(family.name).parameter_names
    values = parameters if parameters is not None else [0.0] * len(names)
    return TilingPicture(
        headings=(
            f"{family.name}  {family.symbol}: no tile",
            _parameter_text(names, values),
        ),
        edges=_edges(family, corners, curves, wrong),
        crossings=crossings,
        remarks=tuple(textwrap.wrap(str(error), _LINE_LENGTH)),
    )


def _family(name: str) -> Family:
    return next(family for family in families() if family.name == name)


def _parameter_text(names: Sequence[str], values: Sequence[float]) -> str:
    if not names:
        return "no free shape parameters"
    if not any(values):
        return f"all {len(names)} parameters 0" if len(names) > 1 else f"parameter {names[0]} 0"
    return ", ".join(f"{name} {value:g}" for name, value in zip(names, values, strict=True))


def _outline(
    family: Family, corners: FloatArray, curves: Mapping[str, FloatArray]
) -> tuple[FloatArray, NDArray[np.int64]]:
    return build_outline(IncidenceSymbol(family.symbol), corners, curves)


def _edges(
    family: Family,
    corners: FloatArray,
    curves: Mapping[str, FloatArray],
    wrong: set[int] | None = None,
) -> tuple[TileEdge, ...]:
    outline, edge_of_point = _outline(family, corners, curves)
    relations = IncidenceSymbol(family.symbol).edge_relations
    edges = []
    for number, (edge, relation) in enumerate(zip(family.edge_classes, relations, strict=True)):
        _, backward, outside = relation
        end = corners[(number + 1) % len(corners)]
        points = np.concatenate([outline[edge_of_point == number], end[None]])
        at_fault = number in (wrong or ())
        edges.append(TileEdge(edge.letter, edge.kind, points, backward, outside, at_fault))
    return tuple(edges)
