"""Rows of the world map, collected one by one; each is made once and found again by its key."""

from __future__ import annotations

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.embedding.curvature_map import ImageVectors
from flexscale.embedding.world_map import WorldMap

#: Weights of a row that is one image vector and nothing else.
FREE_ROW = np.array([[1.0, 0.0, 0.0]])


class Rows:
    """Collects rows of the world map.

    Attributes
    ----------
    row_of : key -> number of the row.
    """

    def __init__(self) -> None:
        self.row_of: dict[tuple, int] = {}
        self.image_of: dict[tuple, int] = {}
        self.images: list[tuple[int, int, FloatArray, FloatArray]] = []
        self.counts: list[int] = []
        self.terms: list[int] = []
        self.weights: list[tuple[float, float, float]] = []
        self.slide: list[int] = []

    def image(self, kind: int, node: int, shift: FloatArray, anchor: FloatArray) -> int:
        key = (node, *np.round(shift, 9).tolist())
        if key not in self.image_of:
            self.image_of[key] = len(self.images)
            self.images.append((kind, node, shift, anchor))
        return self.image_of[key]

    def add(self, key: tuple, terms: list[int], weights: np.ndarray, slide: int = -1) -> int:
        self.row_of[key] = len(self.counts)
        self.counts.append(len(terms))
        self.terms.extend(terms)
        self.weights.extend(map(tuple, weights))
        self.slide.append(slide)
        return self.row_of[key]

    def copy(self, row: int) -> int:
        """Another row equal to one there is, for an element that needs it twice."""
        key = ("copy", row)
        if key in self.row_of:
            return self.row_of[key]
        start = sum(self.counts[:row])
        part = slice(start, start + self.counts[row])
        return self.add(key, self.terms[part], np.array(self.weights[part]), self.slide[row])

    def world_map(self, n_unknowns: int) -> WorldMap:
        kinds, nodes, shifts, anchors = zip(*self.images, strict=True)
        images = ImageVectors(
            np.array(kinds, dtype=np.int64),
            np.array(nodes, dtype=np.int64),
            np.array(shifts, dtype=float),
            np.array(anchors, dtype=float),
        )
        indptr = np.concatenate([[0], np.cumsum(self.counts)]).astype(np.int64)
        return WorldMap(
            images,
            indptr,
            np.array(self.terms, dtype=np.int64),
            np.array(self.weights, dtype=float),
            np.array(self.slide, dtype=np.int64),
            n_unknowns,
        )
