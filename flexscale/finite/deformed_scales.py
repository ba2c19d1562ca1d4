"""The scales of a bent sheet as they lie in space, for pictures and other programs."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from flexscale import checks
from flexscale.arrays import FloatArray, IntArray
from flexscale.checks import ANGLE, checked, length, number
from flexscale.errors import BadInputError
from flexscale.finite.native_sheet import NativeSheet, check_bends
from flexscale.finite.sheet_scales import require_moderate_scales
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.line import follow_line
from flexscale.homogenize.native_model import NativeModel, native_model, require_joints
from flexscale.mesh.obj import write_obj
from flexscale.mesh.prism_surface import prism_surface
from flexscale.mesh.surface_file import surface_file
from flexscale.mesh.vtu import write_vtu
from flexscale.patterns.pattern import Pattern
from flexscale.patterns.sheet_outline import sheet_outline
from flexscale.short_repr import ShortRepr
from flexscale.sides import ONE_SIDE
from flexscale.status import SolveStatus


@dataclass(frozen=True, eq=False, repr=False)
class DeformedScales(ShortRepr):
    """Rigid scales where a bend brings them. Lengths in mm.

    Attributes
    ----------
    pattern : of the scales.
    title : for headings.
    outlines : (m_i, 2) of the scales at rest, in the sheet's coordinates.
    places : (n, 3) of the corners' means of the bases' outlines, on the sheet's middle surface.
    turns : (n, 3, 3) rotations of the scales.
    energy : (n,) N mm, half that of all joints and contacts of each scale.
    contact_force : (n,) N, sum of the forces by which others press on its corners.
    """

    pattern: Pattern
    title: str
    outlines: tuple[FloatArray, ...]
    places: FloatArray
    turns: FloatArray
    energy: FloatArray
    contact_force: FloatArray

    @property
    def n_scales(self) -> int:
        """Number of scales, those cut by the border included."""
        return len(self.outlines)

    @cached_property
    def surfaces(self) -> tuple[tuple[FloatArray, IntArray], ...]:
        """Vertices (2 m, 3) mm and outward triangles (k, 3) of each scale."""
        base, found = 0.5 * self.pattern.substrate_thickness, []
        for outline, place, turn in zip(self.outlines, self.places, self.turns, strict=True):
            vertices, triangles = prism_surface(
                outline - outline.mean(axis=0), self.pattern.scale_height
            )
            vertices[:, 2] += base
            found.append((vertices @ turn.T + place, triangles))
        return tuple(found)

    @cached_property
    def vertices(self) -> FloatArray:
        """(n_vertices, 3) mm."""
        return np.concatenate([vertices for vertices, _ in self.surfaces])

    @cached_property
    def triangles(self) -> IntArray:
        """(n_triangles, 3)."""
        starts = np.cumsum([0, *(len(vertices) for vertices, _ in self.surfaces)])
        moved = [t + start for (_, t), start in zip(self.surfaces, starts[:-1], strict=True)]
        return np.concatenate(moved)

    @cached_property
    def triangle_scale(self) -> IntArray:
        """(n_triangles,) scale that a triangle belongs to."""
        return np.repeat(np.arange(self.n_scales), [len(t) for _, t in self.surfaces])

    @property
    def overlapping(self) -> IntArray:
        """None: contact keeps them apart."""
        return np.zeros(0, dtype=np.int64)

    @checked(path=checks.path)
    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the scales, by the ending of the path: .vtu (ParaView) or .obj (modeling).

        A .vtu file has the cell data `scale`, `energy` [N mm] and `contact_force` [N]; an .obj file
        has the groups "scale_0" and so on.

        Raises
        ------
        BadInputError : another ending, or a folder that does not exist.
        """
        of = self.triangle_scale
        with surface_file(path) as target:
            if target.suffix == ".obj":
                parts = {f"scale_{k}": self.triangles[of == k] for k in range(self.n_scales)}
                write_obj(target, self.vertices, parts)
            else:
                data = {"energy": self.energy[of], "contact_force": self.contact_force[of]}
                write_vtu(
                    target,
                    self.vertices,
                    {"triangle": self.triangles},
                    cell_data={"scale": of, **data},
                )


@checked(
    pattern=checks.PATTERN,
    length=length("sheet length"),
    width=length("sheet width"),
    curvature=number("mm-1", 0.0, 1.0),
    side=ONE_SIDE,
    direction=ANGLE,
    offset=checks.place,
    outline=sheet_outline,
    model=native_model,
)
def deform_native_sheet(
    pattern: Pattern,
    length: float = 100.0,
    width: float = 50.0,
    *,
    curvature: float,
    side: str = "closing",
    direction: float = 0.0,
    offset: Sequence[float] = (0.0, 0.0),
    outline: ArrayLike | None = None,
    model: NativeModel | str = "joints",
) -> DeformedScales:
    """Where the scales of a sheet lie that is bent between end strips (Fig. 13).

    Parameters
    ----------
    curvature : mm-1, not negative.
    side : "closing" or "opening".
    pattern, length, width, direction, offset, outline, model : as of `simulate_native_sheet`.

    Raises
    ------
    PatternError, ConfigError, BadInputError : as there, or if the sheet does not converge.
    """
    native = native_model(model)
    require_joints(native)
    check_bends(length, (curvature,), (side,))
    require_moderate_scales(pattern, length * width)
    sheet = NativeSheet(pattern, length, width, direction, offset, native=native, outline=outline)
    line = Line(side, 0.0, (curvature,))
    (sample,) = follow_line(sheet, line, native.solver)
    status = SolveStatus(sample["status"])
    if status != SolveStatus.converged:
        raise BadInputError(
            f"The sheet does not converge on the way to {curvature:g} mm-1 ({status.name}): bend "
            "it less, or give SolverOptions with more iterations."
        )
    bend = line.bend(curvature)
    found = sheet.scales_at(sheet.bent(bend).evaluate(sample["state"]), bend)
    title = f"{pattern.name}, {side} {curvature:g} mm⁻¹ along {direction:g}°".lstrip(", ")
    return DeformedScales(
        pattern, title, sheet.sheet.laid.outlines, found.places, found.turns, found.energy,
        found.contact_force,
    )  # fmt: skip
