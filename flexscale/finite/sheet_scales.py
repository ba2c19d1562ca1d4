"""Rigid scales of a whole sheet, of which some may be one body, and their joints.

Joints that end at the sheet's border are strained as far as the walls beside them reach, and beyond
by the rule of all joints: towards the border as towards a vertex of the tiling. There the solid's
joints are shorter, by 0.15 of the gap in bending (docs/models.md).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import psutil
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.rigid_cell import RigidScales, contact_reach, moments
from flexscale.errors import BadInputError, PatternError
from flexscale.mechanics.prism_contact import find_prism_rows
from flexscale.patterns.joint_lines import Joint, joints_between
from flexscale.patterns.laid import LaidPattern
from flexscale.patterns.pattern import Pattern

#: Bytes for each scale of a sheet, with unknowns, tables of pairs and factors: as measured, with
#: as much again in reserve. Curved outlines take more of them than straight ones.
BYTES_A_SCALE = 150_000


@dataclass(frozen=True, eq=False)
class SheetScales:
    """Scales of a sheet as bodies.

    Attributes
    ----------
    laid : the pattern on the sheet.
    bodies : (n_tiles,) number of the body that each scale is part of.
    scales : the bodies, with pairs and what can meet.
    joints : those of joint k belong to the scales' pair k.
    """

    laid: LaidPattern
    bodies: IntArray
    scales: RigidScales
    joints: list[Joint]

    def held_together(self) -> bool:
        """Whether joints connect all bodies."""
        n = self.scales.n_scales
        a, b = self.scales.pairs[: len(self.joints)].T
        graph = coo_array((np.ones(len(a)), (a, b)), shape=(n, n))
        return int(connected_components(graph, directed=False)[0]) == 1


def require_moderate_scales(pattern: Pattern, area: float) -> None:
    """Refuse a sheet of an area, mm2, whose scales would not fit into memory.

    Raises
    ------
    BadInputError : with the number of scales and the memory expected.
    """
    n_scales = area / pattern.tile_area
    needed, available = n_scales * BYTES_A_SCALE, psutil.virtual_memory().available
    if needed > available:
        raise BadInputError(
            f"A sheet of {area:.4g} mm2 has about {n_scales:.3g} scales and would take about "
            f"{needed / 1e9:.3g} GB of memory, of which {available / 1e9:.3g} GB are free: make it "
            "smaller, or the tiles larger."
        )


def require_connected(sheet: SheetScales) -> None:
    """Refuse a sheet in parts.

    Raises
    ------
    PatternError : joints do not connect all bodies.
    """
    if not sheet.held_together():
        raise PatternError(
            "The border cuts this sheet into parts that no joint connects: make it wider, or "
            "turn the pattern."
        )


def find_sheet_scales(
    laid: LaidPattern,
    groups: list[tuple[IntArray, FloatArray]],
    touch: bool = True,
) -> SheetScales:
    """Bodies of a sheet: groups of scales that are one, then all others one by one.

    Parameters
    ----------
    groups : scales (n_i,) that are one body, and its anchor (2,), mm.
    touch : whether scales touch; without, no rows are made.

    Raises
    ------
    PatternError : no two scales face one another.
    """
    n = len(laid.tiles)
    bodies = np.full(n, -1, dtype=np.int64)
    for number, (members, _) in enumerate(groups):
        bodies[members] = number
    alone = np.flatnonzero(bodies < 0)
    bodies[alone] = len(groups) + np.arange(len(alone))
    facts = [moments(laid.outlines[k]) for k in alone]
    anchors = np.array([*(anchor for _, anchor in groups), *(center for _, center, _ in facts)])
    # Bodies of several scales do not leave the surface at their anchor: they have no lift.
    spread = np.array([*(np.zeros((2, 2)) for _ in groups), *(moment for _, _, moment in facts)])
    areas = np.zeros(len(anchors))
    np.add.at(areas, bodies, [moments(outline)[0] for outline in laid.outlines])
    joints = joints_between(laid.tiles, laid.gaps.tolist(), bodies)
    if not joints:
        raise PatternError("A sheet of a single scale has no joint that bends: make it larger.")
    reach = contact_reach(laid.pattern)
    meetings = _meetings(laid, bodies, reach) if touch else np.zeros((0, 2), dtype=np.int64)
    pairs, of_meeting = _pairs(joints, bodies[meetings])
    ways = anchors[pairs[:, 1]] - anchors[pairs[:, 0]]
    base = 0.5 * laid.pattern.substrate_thickness
    rows = find_prism_rows(
        [outline - anchors[body] for outline, body in zip(laid.outlines, bodies, strict=True)],
        [(int(a), int(b), int(k)) for (a, b), k in zip(meetings, of_meeting, strict=True)],
        ways,
        (base, base + laid.pattern.scale_height),
        reach,
        len(pairs),
    )
    scales = RigidScales(anchors, areas / areas.sum(), spread, pairs, ways, rows)
    return SheetScales(laid, bodies, scales, joints)


def _meetings(laid: LaidPattern, bodies: IntArray, reach: float) -> IntArray:
    """(n, 2) scales of different bodies within reach, that of the smaller body first."""
    shapes = np.array([shapely.Polygon(outline) for outline in laid.outlines])
    first, second = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=reach)
    kept = bodies[first] < bodies[second]
    found = np.stack([first[kept], second[kept]], axis=1)
    order = np.lexsort((found[:, 1], found[:, 0]))
    return np.asarray(found[order])


def _pairs(joints: list[Joint], meeting: IntArray) -> tuple[IntArray, IntArray]:
    """(n_pairs, 2) bodies, those of the joints first, and the pair of each meeting (n, 2)."""
    names = [(joint.first, joint.second) for joint in joints]
    number = {name: k for k, name in enumerate(names)}
    of_meeting = np.empty(len(meeting), dtype=np.int64)
    for k, (a, b) in enumerate(meeting.tolist()):
        of_meeting[k] = number.setdefault((a, b), len(number))
    return np.array(list(number), dtype=np.int64), of_meeting
