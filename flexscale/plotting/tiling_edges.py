"""One tile with its edges: class letters, kinds as line styles, and how each class's curve lies.

The ticks are one tick of the class's curve, a third of the way from its start on its side y > 0,
with all images of that tick on the tile. A J edge has one tick, which tells start and side; a U
edge two on the same side, an S edge two on opposite sides. An I edge is straight and has none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from flexscale.arrays import FloatArray
from flexscale.plotting.style import FAILED_COLOR, NOTE_COLOR
from flexscale.plotting.tiling_shapes import OUTLINE_COLOR, AspectLook, draw_tiles

KIND_LINESTYLES: dict[str, Any] = {
    "J": "-",
    "U": (0, (5.0, 1.6)),
    "S": (0, (5.0, 1.4, 1.0, 1.4)),
    "I": (0, (1.0, 1.2)),
}
KIND_MEANINGS = {
    "J": "J  any curve",
    "U": "U  symmetric in its bisector",
    "S": "S  symmetric about its middle",
    "I": "I  straight, on a mirror",
}
_TICK_AT = 1.0 / 3.0  # of the curve's length
_TICK = 0.05  # lengths in roots of the tile's area
_LETTER = 0.11
_VERTEX = 0.09
_MARGIN = 0.2
#: (start of the curve to its end, side y > 0 to the other) that the kind's own symmetry exchanges.
_OWN_SYMMETRY = {"U": (True, False), "S": (True, True)}


@dataclass(frozen=True, eq=False)
class TileEdge:
    """An edge of the tile.

    Attributes
    ----------
    letter, kind : of its class.
    points : (k, 2) counterclockwise, both ends included, the tile to the left.
    backward : whether the class's curve starts at the end of this edge.
    outside : whether the side y > 0 of the class's curve lies outside of the tile.
    wrong : whether it keeps the outline from being a tile.
    """

    letter: str
    kind: str
    points: FloatArray
    backward: bool = False
    outside: bool = False
    wrong: bool = False


def tick_marks(edge: TileEdge) -> list[tuple[FloatArray, FloatArray]]:
    """Foot and tip, (2,) each, of the ticks on an edge."""
    if edge.kind == "I":
        return []
    ways = [(edge.backward, edge.outside)]
    if edge.kind in _OWN_SYMMETRY:
        ends, sides = _OWN_SYMMETRY[edge.kind]
        ways.append((edge.backward != ends, edge.outside != sides))
    marks = []
    for backward, outside in ways:
        foot, inward = _along(edge.points, 1.0 - _TICK_AT if backward else _TICK_AT)
        marks.append((foot, foot + (-_TICK if outside else _TICK) * inward))
    return marks


def draw_edges(
    axes: Axes, edges: Sequence[TileEdge], crossings: FloatArray, look: AspectLook
) -> None:
    """The tile of the given edges, counterclockwise from vertex 0.

    Parameters
    ----------
    crossings : (n, 2) points where the outline meets itself.
    look : how the tile is filled.
    """
    outline = np.concatenate([edge.points[:-1] for edge in edges])
    draw_tiles(axes, [outline], look, pale=True, linewidth=0.0)
    halo = [withStroke(linewidth=2.0, foreground="white")]
    named: set[str] = set()
    for number, edge in enumerate(edges):
        color = FAILED_COLOR if edge.wrong else OUTLINE_COLOR
        style = KIND_LINESTYLES[edge.kind]
        axes.plot(*edge.points.T, color=color, linestyle=style, linewidth=1.6, zorder=3)
        for foot, tip in tick_marks(edge):
            axes.plot(*np.stack([foot, tip]).T, color=color, linewidth=1.0, zorder=3)
        middle, inward = _along(edge.points, 0.5)
        place = middle + _LETTER * inward
        axes.text(
            place[0],
            place[1],
            edge.letter,
            color=color,
            ha="center",
            va="center",
            weight="normal" if edge.letter in named else "bold",
            path_effects=halo,
            zorder=4,
        )
        named.add(edge.letter)
        vertex = edge.points[0]
        axes.plot(*vertex, marker="o", color=OUTLINE_COLOR, markersize=2.5, zorder=4)
        place = vertex + _VERTEX * _outward(edges[number - 1], edge)
        axes.text(
            place[0], place[1], str(number), size=6, color=NOTE_COLOR, ha="center", va="center"
        )
    if len(crossings):
        axes.plot(
            *crossings.T, linestyle="none", marker="x", color=FAILED_COLOR, markersize=8, zorder=5
        )
    low, high = outline.min(axis=0) - _MARGIN, outline.max(axis=0) + _MARGIN
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    axes.set_aspect("equal")


def kind_handles(edges: Sequence[TileEdge]) -> list[Line2D]:
    """Legend entries of the kinds of edges there are, and of wrong ones."""
    kinds = {edge.kind for edge in edges}
    handles = [
        Line2D([], [], color=OUTLINE_COLOR, linestyle=style, linewidth=1.6, label=KIND_MEANINGS[k])
        for k, style in KIND_LINESTYLES.items()
        if k in kinds
    ]
    if any(edge.wrong for edge in edges):
        handles.append(Line2D([], [], color=FAILED_COLOR, linewidth=1.6, label="at fault"))
    return handles


def _along(points: FloatArray, fraction: float) -> tuple[FloatArray, FloatArray]:
    """Point at a fraction of a polyline's length, and the unit normal to its left."""
    steps = np.diff(points, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    passed = np.concatenate([[0.0], np.cumsum(lengths)])
    at = fraction * passed[-1]
    segment = min(int(np.searchsorted(passed, at, side="right")) - 1, len(steps) - 1)
    along = steps[segment] / max(lengths[segment], np.finfo(float).tiny)
    return points[segment] + (at - passed[segment]) * along, np.array([-along[1], along[0]])


def _outward(before: TileEdge, after: TileEdge) -> FloatArray:
    """Unit vector away from the tile at the vertex between two edges."""
    normals = _along(before.points, 1.0)[1] + _along(after.points, 0.0)[1]
    return -normals / max(float(np.linalg.norm(normals)), 1e-6)
