"""Rigid scales, in a periodic cell or on a sheet: their unknowns, their pairs, where they lie."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.bends import Bend, TensorBend
from flexscale.embedding.pair_places import (
    Bending,
    Pairs,
    place_pairs,
    place_rows,
    place_scales,
)
from flexscale.embedding.pair_rates import pull_forces, row_rates
from flexscale.embedding.rigid_motion import N_MOTION, N_VARIABLES, OF_B, OF_S
from flexscale.mechanics.prism_contact import PrismRows, find_prism_rows
from flexscale.patterns.cell import polygon_area
from flexscale.patterns.joint_lines import Joint
from flexscale.patterns.pattern import Pattern
from flexscale.tilings.lattice import reduction

#: In-plane reach of contact beyond a scale's outline, as shares of the root of the largest tile's
#: area, of the widest gap, and of the height of scales: the higher they are, the farther tops move.
REACH = (0.25, 2.0, 0.6)


@dataclass(frozen=True, eq=False)
class RigidScales:
    """Scales of a cell or a sheet, and pairs of neighbors, each once.

    Attributes
    ----------
    anchors : (n, 2) centroids of the scales' bases at rest, mm.
    shares : (n,) of all bases' area.
    second_moments : (n, 2, 2) mean of r r^T over a base, from its anchor, mm2.
    pairs : (n_pairs, 2) numbers of two scales.
    ways : (n_pairs, 2) from the first one's anchor to that of the second's lattice image, mm.
    rows : corners of scales that can meet.
    """

    anchors: FloatArray
    shares: FloatArray
    second_moments: FloatArray
    pairs: IntArray
    ways: FloatArray
    rows: PrismRows

    @property
    def n_scales(self) -> int:
        """How many there are."""
        return len(self.anchors)


def find_rigid_scales(pattern: Pattern, joints: Sequence[Joint], touch: bool = True) -> RigidScales:
    """Scales of a pattern; first the pairs of its joints, then others whose scales can meet.

    Anchors lie on the sheet's middle surface, below the centroids of the scales' bases.

    Parameters
    ----------
    touch : whether scales touch; without, no rows are made.
    """
    outlines = pattern.outlines()
    facts = [moments(outline) for outline in outlines]
    anchors = np.array([center for _, center, _ in facts])
    areas = np.array([area for area, _, _ in facts])
    names = [(joint.first, joint.second, joint.offset) for joint in joints]
    reach = contact_reach(pattern)
    if touch:
        known = set(names)
        names += [name for name in _near(outlines, pattern.lattice, reach) if name not in known]
    pairs = np.array([(a, b) for a, b, _ in names], dtype=np.int64)
    shifts = np.array([offset for _, _, offset in names]) @ pattern.lattice
    ways = anchors[pairs[:, 1]] + shifts - anchors[pairs[:, 0]]
    base = 0.5 * pattern.substrate_thickness
    rows = find_prism_rows(
        [outline - center for outline, center in zip(outlines, anchors, strict=True)],
        [(int(a), int(b), k) for k, (a, b) in enumerate(pairs)] if touch else [],
        ways,
        (base, base + pattern.scale_height),
        reach,
        len(pairs),
    )
    spread = np.array([moment for _, _, moment in facts])
    return RigidScales(anchors, areas / areas.sum(), spread, pairs, ways, rows)


def contact_reach(pattern: Pattern) -> float:
    """mm at rest, within which features of two scales can meet."""
    largest = max(polygon_area(tile) for tile in pattern.tiles)
    sizes = (float(np.sqrt(largest)), max(pattern.gaps), pattern.scale_height)
    return max(share * size for share, size in zip(REACH, sizes, strict=True))


def moments(outline: FloatArray) -> tuple[float, FloatArray, FloatArray]:
    """Area, centroid (2,) and mean of r r^T from there (2, 2) of a polygon, mm."""
    here = outline - outline[0]
    after = np.roll(here, -1, axis=0)
    cross = here[:, 0] * after[:, 1] - here[:, 1] * after[:, 0]
    area = 0.5 * float(cross.sum())
    center = ((here + after) * cross[:, None]).sum(axis=0) / (6.0 * area)
    here, after = here - center, after - center
    cross = here[:, 0] * after[:, 1] - here[:, 1] * after[:, 0]
    both = here + after
    sums = np.einsum("n,ni,nj->ij", cross, here, here) + np.einsum(
        "n,ni,nj->ij", cross, after, after
    )
    moment = (sums + np.einsum("n,ni,nj->ij", cross, both, both)) / (24.0 * area)
    return area, center + outline[0], moment


def _near(
    outlines: Sequence[FloatArray], lattice: FloatArray, reach: float
) -> list[tuple[int, int, tuple[int, int]]]:
    """Scales a, b and offsets of b at which the two are within reach; each two once."""
    change = reduction(lattice)
    short = change @ lattice
    shapes = [shapely.Polygon(outline) for outline in outlines]
    found = []
    for a, shape in enumerate(shapes):
        for b in range(a, len(shapes)):
            for step in _steps(outlines[a], outlines[b], short, reach):
                offset = step @ change
                m, n = (int(value) for value in np.rint(offset))
                if a == b and (m, n) <= (0, 0):
                    continue
                moved = shapely.Polygon(outlines[b] + step @ short)
                if shape.distance(moved) < reach:
                    found.append((a, b, (m, n)))
    return found


def _steps(first: FloatArray, second: FloatArray, lattice: FloatArray, reach: float) -> FloatArray:
    """(n, 2) multiples of short lattice vectors by which the second comes near the first."""
    low = first.min(axis=0) - second.max(axis=0) - reach
    high = first.max(axis=0) - second.min(axis=0) + reach
    corners = np.array([[x, y] for x in (low[0], high[0]) for y in (low[1], high[1])])
    steps = corners @ np.linalg.inv(lattice)
    least, most = np.floor(steps.min(axis=0)), np.ceil(steps.max(axis=0))
    m, n = (np.arange(a, b + 1) for a, b in zip(least, most, strict=True))
    grid = np.stack(np.meshgrid(m, n, indexing="ij"), axis=-1).reshape(-1, 2)
    shifts = grid @ lattice
    kept = ((shifts >= low) & (shifts <= high)).all(axis=1)
    return np.asarray(grid[kept])


@dataclass(frozen=True)
class RigidWorld:
    """Where the pairs' scales are, in the frames of the first ones.

    Attributes
    ----------
    y : (n_rows, 3) corners of scales that can meet, mm.
    poses : (n_pairs, 4, 3) t and G of `relative_pose`.
    bending : the state.
    """

    y: FloatArray
    poses: FloatArray
    bending: Bending


def _bending(z: FloatArray, bend: Bend | TensorBend) -> Bending:
    return Bending(z, float(bend.curvature), bend.tensor, bend.base)


class RigidCell:
    """Unknowns of rigid scales: six of each, then S.

    Parameters
    ----------
    scales : of a lattice cell, or of a sheet.
    active : (n_active,) unknowns that are sought, increasing. If not given, the scales float: all
        but the in-plane motion of the first one, which is the whole cell's.
    still : whether neither curvature nor S change, as on a sheet that lies in the world.
    stretches : whether S of a cell that floats is sought; else it is held at 0.

    Attributes
    ----------
    n_unknowns : length of z.
    rest : (n_unknowns,) the flat state.
    mean_offset : (n_unknowns,) c of the constraint c.z = 0 [Eq. 8]: mean height of the bases over
        the cylinder, from which `lifts` is taken out; 0 unless scales float.
    shift_mode : (n_unknowns,) all scales moved along their normals; likewise.
    shift_unknown : number of one of these.
    """

    def __init__(
        self,
        scales: RigidScales,
        active: IntArray | None = None,
        still: bool = False,
        stretches: bool = True,
    ) -> None:
        self.scales = scales
        n = scales.n_scales
        self.n_unknowns = 6 * n + 3
        self.rest = np.zeros(self.n_unknowns)
        self.floats = active is None
        sought = self.n_unknowns - (0 if stretches else 3)
        self.active = np.arange(2, sought) if active is None else active
        self.mean_offset, self.shift_mode = np.zeros(self.n_unknowns), np.zeros(self.n_unknowns)
        if self.floats:
            self.mean_offset[2 : 6 * n : 6] = scales.shares
            self.shift_mode[2 : 6 * n : 6] = 1.0
        self.shift_unknown = 2
        self.n_motion = 0 if still else N_MOTION
        self.world_map = self  # places, too
        self._known: tuple[bytes, Pairs] | None = None

    def variables(self) -> IntArray:
        """(n_pairs, 16) unknowns of each pair's variables; n_unknowns stands for kappa."""
        out = np.empty((len(self.scales.pairs), N_VARIABLES), dtype=np.int64)
        for side, first in ((0, 0), (1, OF_B)):
            out[:, first : first + 6] = 6 * self.scales.pairs[:, side, None] + np.arange(6)
        out[:, OF_S:] = self.n_unknowns - 3 + np.arange(N_MOTION)
        return out

    def lifts(self, tensor: FloatArray) -> FloatArray:
        """(n_scales,) height of anchors at which bases lie on the surface on average, by k along a
        tensor, mm2."""
        lifts: FloatArray = 0.5 * np.einsum("ij,nij->n", tensor, self.scales.second_moments)
        return lifts

    def pairs(self, bend: Bend | TensorBend) -> Pairs:
        """What kernels take."""
        scales, key = self.scales, bend.tensor.tobytes() + bend.base.tobytes()
        if self._known is None or self._known[0] != key:  # along a line it stays the same
            lifts = self._lifts_of(bend)[scales.pairs]
            made = Pairs(scales.pairs, scales.ways, lifts, self.n_motion, self.n_unknowns)
            self._known = (key, made)
        return self._known[1]

    def _lifts_of(self, bend: Bend | TensorBend) -> FloatArray:
        """(n_scales, 2) those at the base, mm, and by kappa."""
        return np.stack([self.lifts(bend.base), self.lifts(bend.tensor)], axis=1)

    def forget(self) -> None:
        """Ask `scales` anew, whose anchors have moved."""
        self._known = None

    def place(self, z: FloatArray, bend: Bend | TensorBend) -> RigidWorld:
        """World positions at state z under `bend`."""
        bending, rows = _bending(z, bend), self.scales.rows
        poses, y = np.empty((len(self.scales.pairs), 4, 3)), np.empty((rows.n_rows, 3))
        place_pairs(bending, self.pairs(bend), poses)
        place_rows(poses, rows.table, y)
        return RigidWorld(y, poses, bending)

    def place_images(
        self, z: FloatArray, bend: Bend | TensorBend, numbers: IntArray, places: FloatArray
    ) -> FloatArray:
        """(n, 4, 3) where scales with anchors at places (n, 2) at rest lie in the world.

        First the anchor, mm, then the turn (3, 3).
        """
        return place_scales(_bending(z, bend), numbers, places, self._lifts_of(bend)[numbers])

    def curvature_rates(self, bend: Bend | TensorBend) -> FloatArray:
        """(n_rows, 3) derivative of the flat cell's positions by the curvature."""
        direction = np.zeros(self.n_unknowns + 1)
        direction[-1] = 1.0
        world = self.place(self.rest, bend)
        out = np.empty_like(world.y)
        table = self.scales.rows.table
        row_rates(world.bending, self.pairs(bend), world.poses, table, direction, out)
        return out

    def pull_gradient(self, world: RigidWorld, forces: FloatArray) -> FloatArray:
        """(n_unknowns,) dE/dz for forces dE/dy (n_rows, 3)."""
        out = np.zeros(self.n_unknowns + 1)
        pairs = self.pairs(TensorBend(*world.bending[1:]))
        pull_forces(world.bending, pairs, world.poses, self.scales.rows.table, forces, out)
        return out[:-1]
