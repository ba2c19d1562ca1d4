"""The periodic cell of rigid scales: its unknowns, its pairs of neighbors, and where they lie."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.embedding.curvature_map import Bend, TensorBend
from flexscale.embedding.pair_kernels import place_pairs, place_rows, pull_forces, unknowns_of
from flexscale.embedding.rigid_motion import N_VARIABLES, OF_KAPPA
from flexscale.mechanics.jets import jet_size
from flexscale.mechanics.prism_contact import PrismRows, find_prism_rows
from flexscale.patterns.cell import polygon_area
from flexscale.patterns.joint_lines import Joint
from flexscale.patterns.pattern import Pattern
from flexscale.tilings.lattice import reduction

#: In-plane reach of contact beyond a scale's outline, as shares of the root of the largest tile's
#: area, of the gap, and of the height of scales: the higher they are, the farther tops move.
REACH = (0.25, 2.0, 0.6)


@dataclass(frozen=True, eq=False)
class RigidScales:
    """Scales of a cell, and pairs of neighbors, each once.

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
        """How many there are in the cell."""
        return len(self.anchors)


def find_rigid_scales(pattern: Pattern, joints: Sequence[Joint], touch: bool = True) -> RigidScales:
    """Scales of a pattern; first the pairs of its joints, then others whose scales can meet.

    Anchors lie on the sheet's middle surface, below the centroids of the scales' bases.

    Parameters
    ----------
    touch : whether scales touch; without, no rows are made.
    """
    outlines = pattern.outlines()
    facts = [_moments(outline) for outline in outlines]
    anchors = np.array([center for _, center, _ in facts])
    areas = np.array([area for area, _, _ in facts])
    names = [(joint.first, joint.second, joint.offset) for joint in joints]
    largest = max(polygon_area(tile) for tile in pattern.tiles)
    sizes = (float(np.sqrt(largest)), pattern.gap, pattern.scale_height)
    reach = max(share * size for share, size in zip(REACH, sizes, strict=True))
    if touch:
        known = set(names)
        names += [name for name in _near(outlines, pattern.lattice, reach) if name not in known]
    pairs = np.array([(a, b) for a, b, _ in names], dtype=np.int64)
    shifts = np.array([offset for _, _, offset in names]) @ pattern.lattice
    ways = anchors[pairs[:, 1]] + shifts - anchors[pairs[:, 0]]
    base = 0.5 * pattern.substrate_thickness
    rows = find_prism_rows(
        [outline - center for outline, center in zip(outlines, anchors, strict=True)],
        [(int(a), int(b)) for a, b in pairs] if touch else [],
        ways if touch else ways[:0],
        (base, base + pattern.scale_height),
        reach,
    )
    moments = np.array([moment for _, _, moment in facts])
    return RigidScales(anchors, areas / areas.sum(), moments, pairs, ways, rows)


def _moments(outline: FloatArray) -> tuple[float, FloatArray, FloatArray]:
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
    poses : (n_pairs, 24, jet) see `rigid_motion.place_pair`, of first order.
    """

    y: FloatArray
    poses: FloatArray


class RigidCell:
    """Unknowns of a cell of rigid scales: six of each, then S.

    Attributes
    ----------
    n_unknowns : length of z.
    rest : (n_unknowns,) the flat state.
    active : unknowns that are sought; of the first scale, in-plane motion is the whole cell's.
    mean_offset : (n_unknowns,) c of the constraint c.z = 0 [Eq. 8]: mean height of the bases over
        the cylinder, from which `lifts` is taken out.
    shift_mode : (n_unknowns,) all scales moved along their normals.
    shift_unknown : number of one of these.
    """

    def __init__(self, scales: RigidScales) -> None:
        self.scales = scales
        n = scales.n_scales
        self.n_unknowns = 6 * n + 3
        self.rest = np.zeros(self.n_unknowns)
        self.active = np.arange(2, self.n_unknowns)
        self.mean_offset, self.shift_mode = np.zeros(self.n_unknowns), np.zeros(self.n_unknowns)
        self.mean_offset[2 : 6 * n : 6] = scales.shares
        self.shift_mode[2 : 6 * n : 6] = 1.0
        self.shift_unknown = 2
        self.world_map = self  # places, too

    def variables(self) -> IntArray:
        """(n_pairs, 16) unknowns of each pair's variables; n_unknowns stands for kappa."""
        out = np.empty((len(self.scales.pairs), N_VARIABLES), dtype=np.int64)
        for k, (a, b) in enumerate(self.scales.pairs):
            unknowns_of(a, b, self.n_unknowns, out[k])
        return out

    def lifts(self, tensor: FloatArray) -> FloatArray:
        """(n_scales,) height of anchors by kappa at which bases lie on the cylinder on average."""
        lifts: FloatArray = 0.5 * np.einsum("ij,nij->n", tensor, self.scales.second_moments)
        return lifts

    def poses(
        self, z: FloatArray, bend: Bend | TensorBend, order: int, needed: BoolArray | None = None
    ) -> FloatArray:
        """(n_pairs, 24, jet) of `rigid_motion.place_pair`, of the pairs (n_pairs,) needed."""
        needed = np.ones(len(self.scales.pairs), dtype=bool) if needed is None else needed
        size = jet_size(N_VARIABLES) if order > 1 else 1 + order * N_VARIABLES
        out = np.empty((len(self.scales.pairs), 24, size))
        tensor = bend.tensor
        place_pairs(
            z, bend.curvature, tensor, self.scales.pairs, self.lifts(tensor), self.scales.ways,
            needed, order, out,
        )  # fmt: skip
        return out

    def place(self, z: FloatArray, bend: Bend | TensorBend) -> RigidWorld:
        """World positions at state z under `bend`."""
        poses, rows = self.poses(z, bend, 1), self.scales.rows
        y = np.empty((len(rows.pair), 3))
        place_rows(poses, rows.pair, rows.second, rows.rest, y)
        return RigidWorld(y, poses)

    def curvature_rates(self, bend: Bend | TensorBend) -> FloatArray:
        """(n_rows, 3) derivative of the flat cell's positions by the curvature."""
        poses, rows = self.poses(self.rest, bend, 1), self.scales.rows
        rate = poses[rows.pair, :, 1 + OF_KAPPA].reshape(-1, 2, 12)
        own = rate[np.arange(len(rate)), rows.second.astype(int)]
        turned = np.einsum("rcj,rj->rc", own[:, 3:].reshape(-1, 3, 3), rows.rest)
        return np.asarray(own[:, :3] + turned)

    def pull_gradient(self, world: RigidWorld, forces: FloatArray) -> FloatArray:
        """(n_unknowns,) dE/dz for forces dE/dy (n_rows, 3)."""
        return self.pull_all(world, forces)[:-1]

    def pull_all(self, world: RigidWorld, forces: FloatArray) -> FloatArray:
        """(n_unknowns + 1,) dE/dz and dE/dkappa at fixed z."""
        rows, out = self.scales.rows, np.zeros(self.n_unknowns + 1)
        blocks = np.zeros((0, N_VARIABLES, N_VARIABLES))
        pull_forces(
            world.poses, self.scales.pairs, rows.pair, rows.second, rows.rest, forces, 1, out,
            blocks,
        )  # fmt: skip
        return out
