"""Comparison with the 81 types of `tactile`, a port of C. S. Kaplan's tables of tile vertices."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from flexscale.errors import TilingError
from flexscale.tilings import Family, families, fit_parameters

tactile = pytest.importorskip("tactile")

UNMARKED = [family for family in families() if not family.needs_marking]


def renumberings(n: int) -> Iterator[tuple[list[int], list[int]]]:
    """All ways around a polygon: vertices in order, and the edges between them."""
    for start in range(n):
        forward = [(start + k) % n for k in range(n)]
        backward = [(start - k) % n for k in range(n)]
        yield forward, forward
        yield backward, [(k - 1) % n for k in backward]


def in_family(family: Family, theirs: object) -> bool:
    """Whether the tile is in the family, up to similarity and renumbering, edge by edge."""
    shapes = list(theirs.shapes)
    vertices = np.array([(point.x, point.y) for point in theirs.verts])
    for order, edges in renumberings(len(vertices)):
        letters = {shapes[e].id: c.letter for e, c in zip(edges, family.edge_classes, strict=True)}
        if len(letters) == len(family.curve_kinds()) and all(
            (letters[shapes[e].id], shapes[e].shape.name) == (c.letter, c.kind)
            for e, c in zip(edges, family.edge_classes, strict=True)
        ):
            try:
                fit_parameters(family.name, vertices[order])
            except TilingError:
                continue
            return True
    return False


def test_the_same_types_need_no_marking() -> None:
    assert sorted(map(int, tactile.tiling_types)) == [int(family.name[2:]) for family in UNMARKED]


@pytest.mark.parametrize("family", UNMARKED, ids=lambda family: family.name)
def test_their_tiles_are_in_our_family(family: Family) -> None:
    theirs = tactile.IsohedralTiling(int(family.name[2:]))
    assert theirs.num_parameters == family.n_parameters
    assert in_family(family, theirs)
    random = np.random.default_rng(int(family.name[2:]))
    default = list(theirs.parameters)
    for _ in range(3):
        theirs.parameters = [value + random.uniform(-0.1, 0.1) for value in default]
        assert in_family(family, theirs)
