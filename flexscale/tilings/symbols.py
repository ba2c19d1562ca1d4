"""Incidence symbols of isohedral types, and the isometries between edges that they ask for.

A symbol such as ``[a+ b+ c+ c- b- ; a c+ b+]`` has two halves. The first names the edges of a tile,
counterclockwise: equal letters are carried onto each other by symmetries of the tile, the sign
tells whether the letter's arrow runs along the outline (+) or against it (-), and a letter without
sign is an edge that a symmetry of the tile turns end for end. The second half tells for every
letter, in order of appearance, which label the neighboring tile has on that edge: the sign is + if
the two arrows run against each other, as they do between a tile and its shifted copy, and - if they
run the same way, as they do on a mirror.

A tile lies to the left of its edges and its neighbor to the right. So an isometry that carries the
tile to its neighbor across an edge keeps orientation if and only if it reverses the edge's course,
and a symmetry of the tile keeps orientation if and only if it keeps the course.

Source: B. Grünbaum and G. C. Shephard, "The eighty-one types of isohedral tilings in the plane",
Math. Proc. Camb. Phil. Soc. 82 (1977) 177-196.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property


@dataclass(frozen=True)
class Label:
    """Name of an edge: its letter, and 1, -1 or 0 for +, - or no sign."""

    letter: str
    sign: int


@dataclass(frozen=True)
class EdgeMotion:
    """Isometry known by what it does to an edge of the tile.

    Attributes
    ----------
    source, target : edge k runs from vertex k to the next; the source is carried onto the target.
    flips : whether the start of the source comes to the end of the target.
    reverses : whether orientation is reversed.
    """

    source: int
    target: int
    flips: bool
    reverses: bool


@dataclass(frozen=True)
class EdgeClass:
    """What may be drawn on an edge.

    Attributes
    ----------
    letter : first letter of the class: edges of one class are images of each other.
    kind : "J" any curve, "S" symmetric about its middle, "U" symmetric in its perpendicular
        bisector, "I" straight, on a mirror.
    """

    letter: str
    kind: str


# (mirror x, mirror y) that keeps a class's curve -> its kind. The first two together are the third,
# so that an edge with two of these symmetries is straight.
_OWN_SYMMETRY = {(False, True): "I", (True, True): "S", (True, False): "U"}


class IncidenceSymbol:
    """A parsed symbol.

    Parameters
    ----------
    text : as in ``[a+ b+ c+ c- b- ; a c+ b+]``.

    Attributes
    ----------
    labels : of the tile's edges, counterclockwise.
    across : letter -> label on the other side of that edge.
    """

    def __init__(self, text: str) -> None:
        tile, adjacent = text.strip("[]").split(";")
        self.labels: tuple[Label, ...] = _read_labels(tile)
        letters = list(dict.fromkeys(label.letter for label in self.labels))
        self.across: dict[str, Label] = dict(zip(letters, _read_labels(adjacent), strict=True))

    @cached_property
    def symmetries(self) -> tuple[EdgeMotion, ...]:
        """Symmetries of the tile, by what they do to edge 0, without the identity."""
        n = len(self.labels)
        turned = [
            EdgeMotion(0, shift, flips=False, reverses=False)
            for shift in range(1, n)
            if all(self.labels[(k + shift) % n] == self.labels[k] for k in range(n))
        ]
        mirrored = [
            EdgeMotion(0, last, flips=True, reverses=True)
            for last in range(n)
            if all(self.labels[(last - k) % n] == _mirrored(self.labels[k]) for k in range(n))
        ]
        return (*turned, *mirrored)

    @cached_property
    def neighbors(self) -> tuple[EdgeMotion, ...]:
        """For every edge, one isometry that carries the tile to its neighbor there.

        The others differ from it by symmetries of the tile. One that keeps orientation is taken if
        there is one.
        """
        found = []
        for target, label in enumerate(self.labels):
            other = self.across[label.letter]
            candidates = [
                EdgeMotion(source, target, flips=flips, reverses=not flips)
                for flips in (True, False)
                for source, partner in enumerate(self.labels)
                if partner.letter == other.letter
                and (-1 if flips else 1) in _courses(label, other, partner)
            ]
            found.append(candidates[0])
        return tuple(found)

    @cached_property
    def edge_motions(self) -> tuple[EdgeMotion, ...]:
        """What `neighbors` do, and what `symmetries` do to every edge."""
        n = len(self.labels)
        inside = [
            EdgeMotion(k, (motion.target + sign * k) % n, motion.flips, motion.reverses)
            for motion in self.symmetries
            for sign in [-1 if motion.flips else 1]
            for k in range(n)
        ]
        return (*self.neighbors, *inside)

    @cached_property
    def edge_relations(self) -> tuple[tuple[int, bool, bool], ...]:
        """For every edge: first edge of its class, and how its curve follows from that one's.

        A curve in an edge's own frame, from (0, 0) to (1, 0) with the tile to its left, goes to
        (1 - x, y) in opposite order under motions that flip the edge, and to (x, -y) if it changes
        sides, which neighbor maps do: a motion changes sides if just one of "flips" and "reverses"
        holds.

        Returns
        -------
        (first, mirror x, mirror y) of each edge.
        """
        return tuple((first, *min(ways)) for first, ways in self._ways_from_first)

    @cached_property
    def edge_classes(self) -> tuple[EdgeClass, ...]:
        """Class of every edge: its kind is how its own curve must be symmetric."""
        classes = []
        for first, _ in self._ways_from_first:
            own = self._ways_from_first[first][1]
            kind = next((kind for way, kind in _OWN_SYMMETRY.items() if way in own), "J")
            classes.append(EdgeClass(self.labels[first].letter, kind))
        return tuple(classes)

    @cached_property
    def _ways_from_first(self) -> tuple[tuple[int, frozenset[tuple[bool, bool]]], ...]:
        """First edge of each edge's class, and all (mirror x, mirror y) that lead here from it."""
        n = len(self.labels)
        found: list[tuple[int, frozenset[tuple[bool, bool]]] | None] = [None] * n
        for first in range(n):
            if found[first] is not None:
                continue
            queue = [(first, False, False)]
            for edge, x, y in queue:  # grows as new ways turn up
                for motion in self.edge_motions:
                    changes_sides = motion.flips != motion.reverses
                    way = (motion.target, x != motion.flips, y != changes_sides)
                    if motion.source == edge and way not in queue:
                        queue.append(way)
            for edge in {edge for edge, _, _ in queue}:
                found[edge] = (first, frozenset((x, y) for e, x, y in queue if e == edge))
        return tuple(entry for entry in found if entry is not None)


def _read_labels(text: str) -> tuple[Label, ...]:
    signs = {"+": 1, "-": -1, "": 0}
    return tuple(Label(letter, signs[sign]) for letter, sign in re.findall(r"([a-z])([+-]?)", text))


def _mirrored(label: Label) -> Label:
    return Label(label.letter, -label.sign)


def _courses(label: Label, other: Label, partner: Label) -> tuple[int, ...]:
    """Whether the partner edge can run along the edge (1) or against it (-1) on the other side."""
    if label.sign == 0:
        return (-1, 1)
    return (-other.sign * label.sign * partner.sign,)
