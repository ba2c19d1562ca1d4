"""A rectangular sheet of whole and cut scales, held at its ends: what all ways to hold it share."""

from __future__ import annotations

import numpy as np

from flexscale.errors import PatternError
from flexscale.homogenize.cell_model import CellModel
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.native_model import NativeModel, require_finite_sheet
from flexscale.mesh.finite import build_finite_mesh
from flexscale.patterns import Pattern
from flexscale.patterns.clipped import SheetTiles
from flexscale.solve.unconstrained import UnconstrainedSystem


class FiniteSheet(CellProblem):
    """A sheet whose scales are bodies; the same interface as the periodic cell.

    Parameters
    ----------
    pattern : its scales are bodies, its sheet is C1.
    tiles : the pattern on the sheet.
    native : as for a cell, with scales of modes and a C1 sheet.

    Attributes
    ----------
    area : mm2, of the sheet.

    Raises
    ------
    PatternError, MeshError : the sheet has no scale, or cannot be meshed.
    ConfigError : see `require_finite_sheet`.
    """

    def __init__(
        self, pattern: Pattern, tiles: SheetTiles, native: NativeModel | None = None
    ) -> None:
        native = native or NativeModel()
        require_finite_sheet(native)
        if not tiles.copies:
            raise PatternError(
                f"A sheet of {tiles.length:g} x {tiles.width:g} mm cuts all scales of the pattern "
                "to slivers: make it larger, or the tiles smaller."
            )
        self.tiles = tiles
        super().__init__(
            build_finite_mesh(pattern, tiles, native.mesh), CellModel.of_pattern(pattern, native)
        )
        self.area = tiles.length * tiles.width
        self.shift_mode = np.zeros(len(self.active))

    def used_unknowns(self) -> np.ndarray:
        """(n_unknowns,) whether an element or a scale depends on them; of S nothing need."""
        cell, inner = self.embedding, self.embedding.inner
        used = np.zeros(inner.n_unknowns, dtype=bool)
        indptr, columns = inner.world_map.indptr, inner.world_map.columns
        for row in np.unique(inner.shell.vectors):
            used[columns[indptr[row] : indptr[row + 1]]] = True
        n_bodies = int(cell.world_map.starts[-1])
        return np.concatenate([np.full(n_bodies, True), used[3 * inner.n_nodes :]])

    def build_system(self) -> None:
        """Analyze the present pattern of nonzeros; what is held needs no constraint."""
        self.system = UnconstrainedSystem(self.build_factorization(), self.pull_back.diagonal)
