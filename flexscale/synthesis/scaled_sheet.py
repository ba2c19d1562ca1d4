"""A deformed sheet with its scales on it [paper: "Synthesizing Scale Geometry"]."""

from __future__ import annotations

import logging
import os
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from flexscale import checks
from flexscale.arrays import FloatArray, IntArray
from flexscale.checks import checked, flag, instance, number, point
from flexscale.errors import BadInputError
from flexscale.mesh.obj import write_obj
from flexscale.mesh.prism_surface import prism_surface
from flexscale.mesh.surface_file import surface_file
from flexscale.mesh.vtu import write_vtu
from flexscale.patterns import Pattern
from flexscale.sheets.bent_sheet import BentSheet
from flexscale.short_repr import ShortRepr
from flexscale.status import SolveStatus
from flexscale.synthesis.overlap import Overlap, measure_overlap
from flexscale.synthesis.placement import LaidScale, Placement, fit_placement, lay_scales
from flexscale.synthesis.prisms import build_parts, moments_of
from flexscale.synthesis.remove_overlap import Removal, motion_of
from flexscale.synthesis.remove_overlap import remove_overlap as move_apart
from flexscale.units import LENGTHS

log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False, repr=False)
class ScaledSheet(ShortRepr):
    """Rigid scales on a deformed macro sheet. Lengths in mm, areas at rest.

    Attributes
    ----------
    pattern, sheet : what it was made of.
    scales : outlines at rest, where the sheet's rest rectangle begins at the origin.
    fitted : rigid motions that bring the scales' bases closest to the sheet.
    fit_residuals : (n,) root mean square distances of these bases from the sheet.
    placement : rigid motions of the scales as they are here.
    overlap_before, overlap : of the scales as fitted, and as they are here.
    clearance, turn_weight : of removing overlap; nan if it was not to be removed.
    converged : whether no scales overlap in the end.
    iterations : of removing overlap.
    rms_motion : by which removal moved the scales: root of the mean, over the scales, of the mean
        square displacement of a scale's points.
    largest_motion : by which it moved any point of a scale.
    largest_turn : degree, by which it turned any scale.
    """

    pattern: Pattern
    sheet: BentSheet
    scales: tuple[LaidScale, ...]
    fitted: Placement
    fit_residuals: FloatArray
    placement: Placement
    overlap_before: Overlap
    overlap: Overlap
    clearance: float
    turn_weight: float
    converged: bool
    iterations: int
    rms_motion: float
    largest_motion: float
    largest_turn: float

    @property
    def n_scales(self) -> int:
        """Number of scales, those cut by the border included."""
        return len(self.scales)

    @cached_property
    def scale_surfaces(self) -> tuple[tuple[FloatArray, IntArray], ...]:
        """Vertices (2 m, 3) mm and outward triangles (k, 3) of each scale where it is."""
        found = []
        poses = zip(self.placement.rotations, self.placement.translations, strict=True)
        for scale, (rotation, shift) in zip(self.scales, poses, strict=True):
            vertices, triangles = prism_surface(scale.outline, self.pattern.scale_height)
            found.append((vertices @ rotation.T + shift, triangles))
        return tuple(found)

    @cached_property
    def vertices(self) -> FloatArray:
        """(n_vertices, 3) mm, of the sheet, then of the scales."""
        return np.concatenate([self.sheet.positions, *(v for v, _ in self.scale_surfaces)])

    @cached_property
    def triangles(self) -> IntArray:
        """(n_triangles, 3) of the sheet, then of the scales."""
        starts = np.cumsum([self.sheet.mesh.n_vertices, *(len(v) for v, _ in self.scale_surfaces)])
        moved = [t + start for (_, t), start in zip(self.scale_surfaces, starts[:-1], strict=True)]
        return np.concatenate([self.sheet.mesh.triangles, *moved])

    @cached_property
    def triangle_scale(self) -> IntArray:
        """(n_triangles,) scale that a triangle belongs to, -1 of the sheet."""
        counts = [len(self.sheet.mesh.triangles), *(len(t) for _, t in self.scale_surfaces)]
        return np.repeat(np.arange(-1, self.n_scales), counts)

    @property
    def overlapping(self) -> IntArray:
        """Numbers of the scales that overlap another one."""
        return np.unique(self.overlap.pairs)

    @property
    def title(self) -> str:
        """For headings."""
        side = "closing" if self.sheet.curvature >= 0.0 else "opening"
        return (
            f"{self.pattern.name}, {side} {abs(self.sheet.curvature):g} mm⁻¹ along "
            f"{self.sheet.direction:g}°, deepest overlap {self.overlap.deepest:.3g} mm"
        )

    @checked(path=checks.path)
    def write(self, path: str | os.PathLike[str]) -> None:
        """Write sheet and scales, by the ending of the path: .vtu (ParaView) or .obj (modeling).

        A .vtu file has the cell data `scale` (-1 of the sheet) and `overlap`, mm, the largest that
        the scale has with another; an .obj file has the groups "substrate" and "scale_0" and so on.

        Raises
        ------
        BadInputError : another ending, or a folder that does not exist.
        """
        with surface_file(path) as target:
            self._write(target)

    def _write(self, target: Path) -> None:
        if target.suffix == ".obj":
            names = {-1: "substrate"} | {k: f"scale_{k}" for k in range(self.n_scales)}
            parts = {n: self.triangles[self.triangle_scale == k] for k, n in names.items()}
            write_obj(target, self.vertices, parts)
            return
        depths = np.zeros(self.n_scales + 1)  # the last one is the sheet's
        for side in (0, 1):
            np.maximum.at(depths, self.overlap.pairs[:, side], self.overlap.depths)
        write_vtu(
            target,
            self.vertices,
            {"triangle": self.triangles},
            cell_data={"scale": self.triangle_scale, "overlap": depths[self.triangle_scale]},
        )


@checked(
    pattern=checks.PATTERN,
    sheet=instance("flexscale.sheets.bent_sheet:BentSheet", "make one with fs.simulate_sheet"),
    remove_overlap=flag,
    clearance=number("mm", 1e-6, LENGTHS[1], above=0.0),
    turn_weight=number("1", 1e-6, 1e6, above=0.0),
    center=point("mm"),
)
def synthesize_scales(
    pattern: Pattern,
    sheet: BentSheet,
    *,
    remove_overlap: bool = True,
    clearance: float = 0.01,
    turn_weight: float = 1.0,
    center: tuple[float, float] = (0.0, 0.0),
) -> ScaledSheet:
    """Place a pattern's scales on a deformed macro sheet.

    The outlines are laid over the sheet at rest, in the direction it was simulated with, and cut at
    its border; pieces below 5 % of a tile are left out. Every scale becomes a rigid prism of the
    pattern's scale height whose base follows the sheet as well as it can, on the side that closes.
    Neighbors then overlap where the sheet bends more than their gap allows; they are moved apart,
    no farther than needed, unless this is not wanted.

    Parameters
    ----------
    pattern : whose model the sheet was simulated with.
    sheet : as `fs.simulate_sheet` gives it, with smooth or linear triangles.
    remove_overlap : whether scales are moved apart.
    clearance : mm, distance between neighbors that this aims at.
    turn_weight : how much a scale's turning counts against its sliding: 1 for the mean square of
        how far its points move, which tilts scales like shingles; with more they stay flatter on
        the sheet and spread along it.
    center : (2,) mm, point of the pattern that lies in the middle of the sheet.

    Returns
    -------
    ScaledSheet. If overlap cannot be removed, `converged` is false and one warning says so.

    Raises
    ------
    BadInputError : the sheet did not converge.
    FabricationError : no scale lies wholly on the sheet, or there are too many.
    UnitRangeError : a clearance or weight that is not positive.
    """
    if sheet.status != SolveStatus.converged:
        raise BadInputError(
            f"The sheet at {sheet.curvature:.12g} mm-1 did not converge ({sheet.status.name} after "
            f"{sheet.iterations} iterations), so that nothing can be placed on it: bend it less, "
            "or give SolverOptions with more iterations."
        )
    scales = lay_scales(pattern, sheet, center)
    outlines = [scale.outline for scale in scales]
    fitted, residuals = fit_placement(outlines, sheet)
    parts = build_parts(outlines, pattern.scale_height)
    moments = moments_of(outlines, pattern.scale_height)
    before = measure_overlap(parts, fitted)
    removal = Removal(fitted, before.deepest == 0.0, 0)
    if remove_overlap:
        removal = move_apart(parts, moments, fitted, clearance=clearance, turn_weight=turn_weight)
    after = measure_overlap(parts, removal.placement)
    if remove_overlap and after.deepest > 0.0:
        log.warning(
            "Scales of pattern %r still overlap by up to %.3g mm after %d iterations.",
            pattern.name, after.deepest, removal.iterations,
        )  # fmt: skip
    rms, largest, turn = motion_of(parts, moments, fitted, removal.placement)
    return ScaledSheet(
        pattern=pattern, sheet=sheet, scales=tuple(scales), fitted=fitted, fit_residuals=residuals,
        placement=removal.placement, overlap_before=before, overlap=after,
        clearance=clearance if remove_overlap else float("nan"),
        turn_weight=turn_weight if remove_overlap else float("nan"),
        converged=after.deepest == 0.0, iterations=removal.iterations,
        rms_motion=rms, largest_motion=largest, largest_turn=turn,
    )  # fmt: skip
