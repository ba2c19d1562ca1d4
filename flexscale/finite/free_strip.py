"""A strip of whole and cut scales without ends, bent along its length; its sides are free.

It lies between a cell, which is held straight across, and a narrow sheet: what free sides do to a
sheet, and that it curls across into a saddle, is all that tells them apart. It is periodic along
its length, where its mean normal displacement is held as a cell's is. It does not twist: strips of
patterns without a mirror along or across them would, and are stiffer so.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.curvature_map import Bend
from flexscale.errors import BadInputError
from flexscale.finite.finite_sheet import FiniteHold, FiniteSheet
from flexscale.homogenize.cell_problem import BentCell
from flexscale.homogenize.hold import Embedding
from flexscale.homogenize.native_model import NativeModel
from flexscale.mesh.periodic_mesh import FREE
from flexscale.patterns import Pattern
from flexscale.patterns.strip import clip_strip


class FreeSides(FiniteHold):
    """A strip without ends whose sides are free; its mean height floats as a cell's."""

    floats = True

    def active(self, embedding: Embedding) -> IntArray:
        """What an element depends on, less what a cell pins; of the lattice's strain Sxx."""
        free = self.used(embedding)
        free[np.setdiff1d(np.arange(len(free)), embedding.active)] = False
        free[-3:] = True, False, False
        return np.flatnonzero(free)


class FreeStrip(FiniteSheet):
    """A strip; the same interface as the periodic cell, bent in the direction 0.

    Parameters
    ----------
    pattern : its scales are bodies, its sheet is C1.
    width : mm.
    direction : degree, of the strip in the pattern; a lattice vector lies along it.
    periods : of the pattern along the strip.
    center : (2,) mm, point of the pattern in the middle of the width.
    native : as for a cell.

    Raises
    ------
    PatternError, MeshError : the strip cannot be cut from the pattern, or not be meshed.
    """

    def __init__(
        self,
        pattern: Pattern,
        width: float,
        direction: float = 0.0,
        *,
        periods: int = 1,
        center: ArrayLike | None = None,
        native: NativeModel | None = None,
    ) -> None:
        tiles = clip_strip(pattern, width, direction, periods=periods, center=center)
        super().__init__(pattern, tiles, FreeSides(tiles), native)

    def bent(self, bend: Bend) -> BentCell:
        """The strip's energy under a bend along its length.

        Raises
        ------
        BadInputError : another direction, in which its sides would undo the bend.
        """
        if bend.curvature != 0.0 and bend.direction != 0.0:
            raise BadInputError(
                "A free strip is bent along its length only, in the direction 0, not in "
                f"{np.degrees(bend.direction):g} degree: give the direction to the strip itself."
            )
        return super().bent(bend)

    def curl(self, z: FloatArray) -> float:
        """Mean curvature across the strip [mm-1], closing > 0, of a parabola through the sheet."""
        mesh, inner = self.mesh, self.embedding.inner
        free = np.flatnonzero(mesh.vertex_kind == FREE)
        to_z = int(self.embedding.world_map.starts[-1]) - 3 * inner.n_nodes
        heights = z[inner.vertex_node[free] + to_z + 2]
        return float(2.0 * np.polyfit(mesh.positions[free, 1], heights, 2)[0])
