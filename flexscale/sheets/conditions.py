"""What holds and loads a sheet: prescribed rows, grips, dead loads."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.errors import BadInputError
from flexscale.sheets.grips import Grip
from flexscale.sheets.sheet import Sheet
from flexscale.sheets.sheet_rows import DERIVATIVE, POSITION

_UNIT = 1e-6  # by which the length of a unit of the parameters may differ from 1
_COMPONENTS = {"x": 0, "y": 1, "z": 2}


class Conditions:
    """Collects what holds and loads a sheet; all of it grows with one load factor.

    A state z of the sheet is all rows, three numbers each, then the unknowns q of the grips. Rows
    and q that are held go from their rest value to their target as the factor goes from 0 to 1,
    and loads are the factor times their full value.

    Attributes
    ----------
    target : (n_z,) values of what is held, at factor 1; rest values elsewhere.
    held : (n_z,) what is held.
    load : (n_z,) dead load on each entry of z [N, N mm for angles and gradients].
    grips, grip_start : grips, and where the q of each begin in z.
    """

    def __init__(self, sheet: Sheet) -> None:
        self.sheet = sheet
        self.target: FloatArray = sheet.rest.ravel().copy()
        self.held: BoolArray = sheet.absent.ravel().copy()
        self.load: FloatArray = np.zeros_like(self.target)
        self.grips: list[Grip] = []
        self.grip_start: list[int] = []

    @property
    def row_loads(self) -> FloatArray:
        """(n_rows, 3) loads on the rows."""
        return self.load[: self.sheet.rest.size].reshape(-1, 3)

    def hold(
        self, rows: IntArray, components: str = "xyz", values: ArrayLike | None = None
    ) -> None:
        """Hold components of rows where they are at rest, or move them to values (n_rows of the
        whole sheet, 3) of which only these are read."""
        places = 3 * rows[:, None] + np.array([_COMPONENTS[c] for c in components])
        self.held[places] = True
        if values is not None:
            self.target[places] = np.asarray(values, dtype=float).ravel()[places]

    def clamp(self, vertices: BoolArray, values: ArrayLike | None = None) -> None:
        """Hold a part of the sheet with positions and derivatives: nothing there can turn."""
        self.hold(self.sheet.rows.rigid(vertices), values=values)

    def hinge(
        self,
        vertices: BoolArray,
        direction: tuple[float, float],
        components: str = "xyz",
        shift: ArrayLike = (0.0, 0.0, 0.0),
    ) -> None:
        """Hold components along a straight line of vertices that runs in a direction of the
        parameters, or shift it (3,) [mm]; the sheet turns about it freely."""
        moved = self.sheet.rest + np.asarray(shift, dtype=float)
        self.hold(self.sheet.rows.positions(vertices), components, moved)
        self.hold(self.sheet.rows.derivatives(vertices, direction), components)

    def mirror(
        self,
        vertices: BoolArray,
        along: tuple[float, float],
        across: tuple[float, float],
        axis: str,
    ) -> None:
        """A plane of symmetry through a line of vertices of a C1 sheet.

        Parameters
        ----------
        along, across : directions of the line and across it, in the parameters.
        axis : "x", "y" or "z", the direction normal to the plane.

        Raises
        ------
        BadInputError : a sheet of linear triangles.
        """
        if not (self.sheet.rows.kinds == DERIVATIVE).any():
            raise BadInputError(
                "Linear triangles cannot be cut at a plane of symmetry, for their edge normals "
                "depend on what lies across: mesh the whole sheet, or take element='c1'."
            )
        self.hinge(vertices, along, axis)
        rest = "xyz".replace(axis, "")
        self.hold(self.sheet.rows.derivatives(vertices, across), rest)

    def grip(
        self,
        grip: Grip,
        load: ArrayLike | None = None,
        held: ArrayLike | None = None,
        values: ArrayLike | None = None,
    ) -> IntArray:
        """Let rows move as one body; returns the places of its q in z.

        Parameters
        ----------
        load : (k,) dead load on q: N on displacements, N mm on an angle.
        held : (k,) which of q are held; none without.
        values : (k,) where those are held: displacements in mm, angles in rad; 0 without.
        """
        n, k = len(self.target), grip.motion.n_unknowns
        places = np.arange(n, n + k)
        full = np.zeros(k) if load is None else np.asarray(load, dtype=float)
        kept = np.zeros(k, dtype=bool) if held is None else np.asarray(held, dtype=bool)
        goal = np.zeros(k) if values is None else np.asarray(values, dtype=float)
        self.target = np.concatenate([self.target, np.where(kept, goal, 0.0)])
        self.load = np.concatenate([self.load, full])
        self.held = np.concatenate([self.held, kept])
        self.held[(3 * grip.rows[:, None] + np.arange(3)).ravel()] = True
        self.grips.append(grip)
        self.grip_start.append(n)
        return places

    def move_grip(self, index: int, grip: Grip) -> None:
        """Put another grip of the same rows and unknowns in the place of one."""
        self.grips[index] = grip

    def load_point(self, vertex: int, force: ArrayLike) -> None:
        """Dead force (3,) [N] on a vertex."""
        chosen = np.zeros(self.sheet.mesh.n_vertices, dtype=bool)
        chosen[vertex] = True
        self._add(self.sheet.rows.positions(chosen), np.asarray(force, dtype=float)[None])

    def load_line(self, vertices: BoolArray, force: ArrayLike) -> None:
        """Dead force per rest length (3,) [N/mm] along the boundary edges between vertices.

        On C1 sheets the edge is the cubic through its end points and derivatives there, and the
        load works on its mean; lengths are those of the parameters, so the sheet is flat at rest.
        """
        mesh, rows = self.sheet.mesh, self.sheet.rows
        per_length = np.asarray(force, dtype=float)
        edges = mesh.edges[mesh.boundary & vertices[mesh.edges].all(axis=1)]
        if not len(edges):
            raise BadInputError(
                "A line load needs a boundary edge, but none has both ends among the vertices it "
                "was given: give all vertices along a side."
            )
        for first, second in edges.tolist():
            span = mesh.points[second] - mesh.points[first]
            length = float(np.linalg.norm(span))
            for vertex, sign in ((first, 1.0), (second, -1.0)):
                own = np.flatnonzero((rows.ends == vertex).all(axis=1))
                self._add(own[rows.kinds[own] == POSITION], 0.5 * length * per_length[None])
                slopes = own[rows.kinds[own] != POSITION]
                if len(slopes):
                    # x along the edge is a combination of the two derivatives of the vertex.
                    shares = np.linalg.solve(rows.directions[slopes].T, span / length)
                    self._check_unit(shares @ self.sheet.rest[slopes], mesh.points[vertex])
                    self._add(slopes, sign * length**2 / 12.0 * np.outer(shares, per_length))

    @staticmethod
    def _check_unit(derivative: FloatArray, place: FloatArray) -> None:
        if abs(np.linalg.norm(derivative) - 1.0) > _UNIT:
            raise BadInputError(
                f"A line load needs parameters that are lengths along its line, but at parameters "
                f"({place[0]:.4g}, {place[1]:.4g}) one unit is {np.linalg.norm(derivative):.4g} mm "
                "long at rest: choose other parameters, or load points."
            )

    def load_area(self, force: ArrayLike) -> None:
        """Dead force per rest area (3,) [N/mm2] on a sheet that is flat at rest."""
        shares = self.sheet.energy.area_shares(len(self.sheet.rest))
        drawn = float(shares[self.sheet.rows.kinds == POSITION].sum())
        if abs(drawn - self.sheet.area) > _UNIT * drawn:
            raise BadInputError(
                f"A load per area needs a sheet that is drawn as it is at rest, but an area of "
                f"{drawn:.4g} in its parameters is {self.sheet.area:.4g} mm2 at rest: load points "
                "instead."
            )
        self.load[: self.sheet.rest.size] += np.outer(shares, np.asarray(force, float)).ravel()

    def _add(self, rows: IntArray, forces: FloatArray) -> None:
        self.load[3 * rows[:, None] + np.arange(3)] += forces
