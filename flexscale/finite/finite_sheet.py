"""A rectangular sheet of whole and cut scales: what all ways to hold it share."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexscale.arrays import BoolArray
from flexscale.embedding.body_cell import BodyCell
from flexscale.embedding.cell import CellEmbedding
from flexscale.errors import PatternError
from flexscale.homogenize.cell_model import CellModel
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.hold import Embedding, Hold, Periodic
from flexscale.homogenize.native_model import NativeModel, require_finite_sheet
from flexscale.mesh.finite import build_finite_mesh
from flexscale.patterns import Pattern
from flexscale.patterns.clipped import SheetTiles


class FiniteHold(Periodic):
    """What ways to hold a finite sheet share; nothing floats.

    Parameters
    ----------
    tiles : the pattern on the sheet.
    """

    floats = False

    def __init__(self, tiles: SheetTiles) -> None:
        self.tiles = tiles

    def area(self, inner: CellEmbedding) -> float:
        """That of the sheet."""
        return self.tiles.length * self.tiles.width

    def used(self, embedding: Embedding) -> BoolArray:
        """(n_unknowns,) whether an element or a scale depends on them; of S nothing need."""
        assert isinstance(embedding, BodyCell)
        inner: Any = embedding.inner  # of C1 triangles
        used = np.zeros(inner.n_unknowns, dtype=bool)
        indptr, columns = inner.world_map.indptr, inner.world_map.columns
        for row in np.unique(inner.shell.vectors):
            used[columns[indptr[row] : indptr[row + 1]]] = True
        n_bodies = int(embedding.world_map.starts[-1])
        return np.concatenate([np.full(n_bodies, True), used[3 * inner.n_nodes :]])


class FiniteSheet(CellProblem):
    """A sheet whose scales are bodies; the same interface as the periodic cell.

    Parameters
    ----------
    pattern : the scale pattern.
    tiles : the pattern on the sheet.
    hold : how the sheet is held.
    native : as for a cell, with scales of modes and a C1 sheet.

    Raises
    ------
    PatternError, MeshError : the sheet has no scale, or cannot be meshed.
    ConfigError : see `require_finite_sheet`.
    """

    def __init__(
        self, pattern: Pattern, tiles: SheetTiles, hold: Hold, native: NativeModel | None = None
    ) -> None:
        native = native or NativeModel("shell")
        require_finite_sheet(native)
        if not tiles.copies:
            raise PatternError(
                f"A sheet of {tiles.length:g} x {tiles.width:g} mm cuts all scales of the pattern "
                "to slivers: make it larger, or the tiles smaller."
            )
        self.tiles = tiles
        mesh = build_finite_mesh(pattern, tiles, native.mesh)
        super().__init__(mesh, CellModel.of_pattern(pattern, native), hold=hold)
