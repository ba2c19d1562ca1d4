"""A rectangular sheet of the native model between two end strips on a cylinder (Figs. 13, 14).

Scales that the ends cut are the strips: flat, tangent to the cylinder at the end. Those of the near
end are held; those of the far end are carried along the arc by (1 + Sxx) times the sheet's length.
They keep their place on the cylinder's radius and the cylinder's rotation, and slide along the arc
as one body. So the sheet is a cell that is periodic along its length only, with the pieces at its
seam held.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from flexscale.arrays import IntArray
from flexscale.embedding.bodies import Body
from flexscale.embedding.body_cell import BodyCell
from flexscale.embedding.cell import CellEmbedding
from flexscale.errors import BadInputError
from flexscale.finite.finite_sheet import FiniteHold, FiniteSheet
from flexscale.homogenize.cell_model import CellModel
from flexscale.homogenize.hold import Embedding
from flexscale.homogenize.line import Line, follow_line
from flexscale.homogenize.native_model import NativeModel
from flexscale.mechanics.contact import ContactSurface
from flexscale.mechanics.load_series import require_bends
from flexscale.mesh.periodic_mesh import FREE
from flexscale.patterns import Pattern
from flexscale.patterns.clipped import clip_pattern
from flexscale.sides import SOME_SIDES
from flexscale.solve.solver_options import SolverOptions


class EndStrips(FiniteHold):
    """Scales that the ends cut are strips on a cylinder."""

    def bodies(self, inner: CellEmbedding, model: CellModel) -> list[Body]:
        """The scales; those of the strips turn with the cylinder at the end, and do not leave its
        tangent."""
        bodies = super().bodies(inner, model)
        for k in np.flatnonzero(self.tiles.at_end):
            body = bodies[k]
            anchored = body.anchored(body.anchor * [0.0, 1.0])
            bodies[k] = replace(anchored, second_moment=np.zeros((2, 2)))
        return bodies

    def surface(self, inner: CellEmbedding) -> ContactSurface | None:
        """Scales of a strip are one body: they do not meet one another."""
        surface = inner.contact_surface
        if surface is None or not self.tiles.at_end.any():
            return surface
        scale = np.empty(inner.mesh.n_scale_vertices, dtype=np.int64)
        scale[inner.mesh.tets.ravel()] = np.repeat(inner.mesh.tet_scale, inner.mesh.tets.shape[1])
        known = surface.vertices >= 0
        of_body = np.empty(surface.bodies.max() + 1, dtype=np.int64)
        of_body[surface.bodies[known]] = scale[surface.vertices[known]]
        held = self.tiles.at_end[of_body[surface.bodies]]
        home = np.arange(len(held)) < surface.n_home
        bodies = surface.bodies.copy()
        for strip in (held & home, held & ~home):
            bodies[strip] = bodies[strip].min(initial=0)
        return replace(surface, bodies=bodies)

    def active(self, embedding: Embedding) -> IntArray:
        """All but the strips', what no element depends on, and of the lattice's strain Syy, Sxy."""
        assert isinstance(embedding, BodyCell)
        inner, mesh = embedding.inner, embedding.mesh
        n, n_bodies = embedding.n_unknowns, int(embedding.world_map.starts[-1])
        free = self.used(embedding)
        starts = embedding.world_map.starts
        for k in np.flatnonzero(self.tiles.at_end):
            free[starts[k] : starts[k + 1]] = False
        on_end = np.abs(mesh.positions[:, 0]) < 1e-6 * self.tiles.length
        nodes = inner.vertex_node[on_end & (mesh.vertex_kind == FREE)]
        free[nodes[:, None] + np.arange(9) + n_bodies - 3 * inner.n_nodes] = False
        free[n - 3 :] = True, False, False
        return np.flatnonzero(free)


class NativeSheet(FiniteSheet):
    """A sheet of whole and cut scales; the same interface as the periodic cell.

    Parameters
    ----------
    pattern : its scales are bodies, its sheet is C1.
    length, width : mm; the sheet is bent along its length.
    direction : degree, of the sheet's length in the pattern's coordinates.
    native : as for a cell.

    Attributes
    ----------
    tiles : the pattern on the sheet.
    area : mm2, of the sheet.

    Raises
    ------
    PatternError, MeshError : the sheet cannot be cut from the pattern, or not be meshed.
    ConfigError : see `require_finite_sheet`.
    """

    def __init__(
        self,
        pattern: Pattern,
        length: float,
        width: float,
        direction: float = 0.0,
        native: NativeModel | None = None,
    ) -> None:
        tiles = clip_pattern(pattern, length, width, direction)
        super().__init__(pattern, tiles, EndStrips(tiles), native)


def bend_native_sheet(
    sheet: NativeSheet,
    curvatures: Sequence[float],
    side: str = "closing",
    solver: SolverOptions | None = None,
) -> Iterator[dict[str, Any]]:
    """Bend a native sheet step by step.

    Parameters
    ----------
    curvatures : mm-1, not negative, increasing.
    side : "closing" or "opening".

    Yields
    ------
    dict as of `follow_line`, and `slide` [mm], by which the far end moved away along the arc.

    Raises
    ------
    BadInputError : as of `check_bends`.
    """
    length = sheet.tiles.length
    check_bends(length, curvatures, (side,))
    line = Line(side, 0.0, tuple(float(k) for k in curvatures))
    for sample in follow_line(sheet, line, solver or SolverOptions()):
        told: dict[str, Any] = dict(sample)
        if "stretch" in sample:
            told["slide"] = float(sample["stretch"][0] - 1.0) * length
        yield told


def check_bends(length: float, curvatures: Sequence[float], sides: Sequence[str]) -> None:
    """Refuse bends of a sheet of a length [mm] that cannot be made, before anything is meshed.

    Raises
    ------
    BadInputError : an unknown side, curvatures [mm-1] that do not increase from 0 on, or the sheet
        would run into its own end.
    """
    SOME_SIDES(sides, "sides")
    require_bends(curvatures)
    if curvatures[-1] * length >= 2.0 * np.pi:
        raise BadInputError(
            f"At a curvature of {curvatures[-1]:.12g} mm-1 a sheet of {length:.12g} mm runs into "
            f"its own end: stay below {2.0 * np.pi / length:.4g} mm-1."
        )
