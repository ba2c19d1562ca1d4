"""Outlines of tiles: edges with their curves, and whether they make a tile.

A simple outline that runs counterclockwise is enough for a tiling. Copies of the tile laid around
a vertex by the motions of the group close up there, because their linear parts do, so its angles
sum to 2π times a whole number of turns m ≥ 1; all interior angles together are (n - 2)π, which is
what the net's degrees give with m = 1 everywhere. So no two tiles overlap at a vertex, nowhere
along an edge, and the tiles cover the plane once.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from flexscale.arrays import FloatArray, IntArray
from flexscale.errors import TilingError
from flexscale.tilings.curves import image_of_curve
from flexscale.tilings.families import Family
from flexscale.tilings.symbols import IncidenceSymbol

TOUCH = 1e-9  # of the root of the tile's area: closer points touch


def signed_area(outline: FloatArray) -> float:
    """Area of a polygon (n, 2), positive if counterclockwise."""
    x, y = outline.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def build_outline(
    symbol: IncidenceSymbol, vertices: FloatArray, curves: Mapping[str, FloatArray]
) -> tuple[FloatArray, IntArray]:
    """Outline of a tile.

    Parameters
    ----------
    vertices : (n, 2) tiling vertices.
    curves : class letter -> whole curve (k, 2); the other edges are straight.

    Returns
    -------
    outline : (m, 2) points, the tiling vertices among them.
    edge_of_point : (m,) edge on which a point lies; edge k starts with vertex k.
    """
    straight = np.array([(0.0, 0.0), (1.0, 0.0)])
    pieces = []
    ends = np.roll(vertices, -1, axis=0)
    for edge, (start, end) in enumerate(zip(vertices, ends, strict=True)):
        _, mirror_x, mirror_y = symbol.edge_relations[edge]
        curve = curves.get(symbol.edge_classes[edge].letter, straight)
        x, y = image_of_curve(curve, mirror_x, mirror_y)[:-1].T
        along = end - start
        across = np.array([-along[1], along[0]])
        pieces.append(start + np.outer(x, along) + np.outer(y, across))
    counts = [len(piece) for piece in pieces]
    return np.concatenate(pieces), np.repeat(np.arange(len(vertices)), counts)


def require_tile(
    family: Family, parameters: tuple[float, ...], outline: FloatArray, edge_of_point: IntArray
) -> None:
    """Refuse an outline that crosses or touches itself or runs clockwise.

    Raises
    ------
    TilingError : names family, parameters and edges.
    """
    values = ", ".join(f"{value:g}" for value in parameters)
    where = f"Tiling family {family.name}" + (f" with parameters ({values})" if values else "")
    remedy = "Smaller parameters or flatter curves mend it; `outline_of` shows the outline."
    met = _find_contact(outline)
    if met is not None:
        x, y = outline[met[0]]
        raise TilingError(
            f"{where} gives no tile: {_name_edges(family, edge_of_point[list(met)])} near "
            f"({x:.3g}, {y:.3g}), in units of the root of the tile's area. {remedy}"
        )
    area = signed_area(outline)
    if not area > 0.0:
        raise TilingError(
            f"{where} gives no tile: its outline runs clockwise (signed area {area:.3g}), it has "
            f"been turned inside out. {remedy}"
        )


def _name_edges(family: Family, met: IntArray) -> str:
    first, second = (f"{k} (class {family.edge_classes[k].letter!r})" for k in sorted(met))
    if first == second:
        return f"edge {first} of its outline crosses or touches itself"
    return f"edges {first} and {second} of its outline cross or touch"


def _find_contact(outline: FloatArray) -> tuple[int, int] | None:
    """Two segments, by their first points, that cross or touch other than end to start."""
    n = len(outline)
    starts, along = outline, np.roll(outline, -1, axis=0) - outline
    lengths = np.einsum("ij,ij->i", along, along)
    # sides[i, j]: on which side of segment i point j lies, as an area.
    arms = outline[None, :] - starts[:, None]
    sides = along[:, None, 0] * arms[..., 1] - along[:, None, 1] * arms[..., 0]
    places = np.einsum("ijk,ik->ij", arms, along) / np.maximum(lengths, TOUCH**2)[:, None]
    nearest = np.clip(places, 0.0, 1.0)[..., None] * along[:, None]
    apart = np.linalg.norm(arms - nearest, axis=2)
    here = np.arange(n)
    apart[here, here] = apart[here, (here + 1) % n] = np.inf
    segment, point = np.unravel_index(np.argmin(apart), apart.shape)
    if apart[segment, point] < TOUCH:
        return int(segment), int(point)
    splits = sides * np.roll(sides, -1, axis=1) < 0.0
    crossing = splits & splits.T
    # Neighbors share a point, which rounding may put on either side.
    crossing[here, here] = crossing[here, (here + 1) % n] = crossing[(here + 1) % n, here] = False
    if not crossing.any():
        return None
    first, second = np.unravel_index(np.argmax(crossing), crossing.shape)
    return int(first), int(second)
