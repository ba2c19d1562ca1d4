"""A macro sheet: a mesh with a sheet law on elements chosen by name."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexscale.arrays import BoolArray, FloatArray
from flexscale.errors import ConfigError, UnknownNameError, suggest
from flexscale.mechanics.sheet_law import SheetLaw
from flexscale.mechanics.sheet_shell import SheetShell
from flexscale.mechanics.sheet_triangles import SheetTriangles
from flexscale.mechanics.substrate_options import SUBSTRATE_ELEMENTS
from flexscale.mesh.sheet import SheetMesh
from flexscale.sheets.sheet_rows import ANGLE, SheetRows, linear_rows, smooth_rows
from flexscale.sheets.surfaces import Surface, plane


@dataclass(frozen=True, eq=False)
class Sheet:
    """Rows and energy of a sheet, without anything that holds or loads it.

    Attributes
    ----------
    mesh : triangles in the parameters (u, v), which are rest coordinates in mm if it is flat.
    rows : what the rows of y are.
    energy : over the rows.
    rest : (n_rows, 3).
    absent : (n_rows, 3) components of rows that nothing depends on.
    """

    mesh: SheetMesh
    rows: SheetRows
    energy: SheetShell | SheetTriangles
    rest: FloatArray
    absent: BoolArray

    def place(self, surface: Surface) -> FloatArray:
        """(n_rows, 3) rows of the sheet laid on a surface, edge normals those of the surface."""
        y = self.rows.place(surface)
        if isinstance(self.energy, SheetTriangles):
            self.energy.set_edge_angles(y, self._edge_normals(surface))
        return y

    def _edge_normals(self, surface: Surface) -> FloatArray:
        """(n_triangles, 3, 3) unit normals of a surface at the middles of edges."""
        middles = self.mesh.points[self.mesh.edges].mean(axis=1)
        gradients = surface(middles)[1]
        normals = np.cross(gradients[:, :, 0], gradients[:, :, 1])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        return normals[self.mesh.triangle_edges]

    @property
    def area(self) -> float:
        """Rest area, mm2."""
        return float(self.energy.weights.sum())

    def curvatures(self, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Largest |principal curvature| (n,) [mm-1] at points (n, 2) [parameters] of the sheet."""
        b11, b12, b22 = np.moveaxis(self.energy.states(y)[..., 3:], -1, 0)
        mean, radius = 0.5 * (b11 + b22), np.hypot(0.5 * (b11 - b22), b12)
        return (abs(mean) + radius).ravel(), self.energy.points.reshape(-1, 2)


def build_sheet(
    mesh: SheetMesh,
    law: SheetLaw,
    *,
    element: str = "c1",
    surface: Surface = plane,
    clamped: BoolArray | None = None,
    material_direction: float = 0.0,
) -> Sheet:
    """Discretize a sheet.

    Parameters
    ----------
    mesh : triangles.
    law : energy per rest area.
    element : "c1", or the paper's linear triangles with "edge_angle".
    surface : rest shape over the mesh; curved ones for "c1" only.
    clamped : (n_vertices,) vertices that will be held or gripped with all around them; linear
        triangles need to know.
    material_direction : rad, from the first parameter's direction to the material's first axis.

    Raises
    ------
    UnknownNameError : no element of that name.
    ConfigError : linear triangles on a surface that is not the plane of the mesh.
    """
    if element not in SUBSTRATE_ELEMENTS:
        raise UnknownNameError(
            f"There is no sheet element {element!r}. {suggest(element, SUBSTRATE_ELEMENTS)}"
        )
    energy: SheetShell | SheetTriangles
    if element == "c1":
        smooth = smooth_rows(mesh)
        rows, rest = smooth.rows, smooth.rows.place(surface)
        energy = SheetShell(
            mesh.points[mesh.triangles], smooth.edge_normals, smooth.vectors, law, rest,
            vertex_frames=smooth.vertex_frames, material_direction=material_direction,
        )  # fmt: skip
        return Sheet(mesh, rows, energy, rest, np.zeros(rest.shape, dtype=bool))
    if surface is not plane:
        raise ConfigError(
            f"The element {element!r} is for sheets that are flat at rest; take element='c1' for a "
            "curved one, or draw the mesh where it lies."
        )
    held = np.zeros(mesh.n_vertices, dtype=bool) if clamped is None else clamped
    linear = linear_rows(mesh, held)
    rows, rest = linear.rows, linear.rows.place(plane)
    energy = SheetTriangles(linear.stencils, law, material_direction=material_direction)
    absent = np.zeros(rest.shape, dtype=bool)
    absent[rows.kinds == ANGLE] = True
    turning = linear.stencils.vectors[:, 6:][linear.stencils.signs != 0.0]
    absent[turning, 0] = False
    return Sheet(mesh, rows, energy, rest, absent)
