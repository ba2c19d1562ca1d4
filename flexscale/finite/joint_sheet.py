"""A whole sheet of rigid scales on joints, held somewhere: what all ways to hold it share."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.embedding.bends import Bend
from flexscale.embedding.rigid_cell import RigidCell
from flexscale.finite.sheet_scales import SheetScales, require_connected
from flexscale.homogenize.bent_joints import JointState
from flexscale.homogenize.joint_cell import laws_of
from flexscale.homogenize.joint_problem import JointProblem, place_stations
from flexscale.homogenize.native_model import NativeModel
from flexscale.patterns.joint_lines import joint_gaps
from flexscale.solve.linear import nested_dissection

FLAT = Bend(0.0, 0.0)


@dataclass(frozen=True)
class ScalesAt:
    """Where the scales of a sheet are, and what they carry.

    Attributes
    ----------
    places : (n_scales, 3) where the centroid of each base was at rest, now, mm; on the middle
        surface.
    turns : (n_scales, 3, 3) rotations.
    energy : (n_scales,) N mm, half that of all joints and contacts of a scale; those of a body of
        several scales are spread evenly.
    contact_force : (n_scales,) N, sum of the forces by which others press on its corners.
    """

    places: FloatArray
    turns: FloatArray
    energy: FloatArray
    contact_force: FloatArray


class JointSheet(JointProblem):
    """Scales of a sheet on joints.

    Parameters
    ----------
    sheet : the scales.
    native : contact and linear solver; of the model `joints`.
    free : (6 n_bodies + 3,) unknowns that are sought.
    still : whether the sheet lies in the world, under no macroscopic bend.

    Raises
    ------
    PatternError : joints cannot be computed, or do not hold the sheet together.
    """

    def __init__(
        self, sheet: SheetScales, native: NativeModel, free: BoolArray, still: bool
    ) -> None:
        pattern = sheet.laid.pattern
        require_connected(sheet)
        self.sheet, self.pattern, self.still = sheet, pattern, still
        embedding = RigidCell(sheet.scales, np.flatnonzero(free), still)
        super().__init__(
            embedding,
            place_stations(sheet.joints, sheet.scales, joint_gaps(pattern)),
            laws_of(pattern, native),
            native,
            (pattern.gap, max(pattern.gaps)),
            sheet.laid.area,
        )

    def _order(self, indptr: IntArray) -> IntArray | None:
        """Scales by nested dissection, then S, which all of them depend on."""
        n = len(self.active)
        of_all = int(np.count_nonzero(self.active >= self.embedding.n_unknowns - 3))
        if not of_all:
            return None
        inner = self.columns < n - of_all
        rows = self.rows[inner]
        starts = np.searchsorted(rows, np.arange(n - of_all + 1))
        order = nested_dissection(starts, self.columns[inner])
        return None if order is None else np.concatenate([order, np.arange(n - of_all, n)])

    def scales_at(self, state: JointState, bend: Bend = FLAT) -> ScalesAt:
        """Where all scales are at a state."""
        sheet, scales = self.sheet, self.sheet.scales
        poses = self.embedding.place_images(
            state.z, bend, np.arange(scales.n_scales), scales.anchors
        )[sheet.bodies]
        centers = np.array([outline.mean(axis=0) for outline in sheet.laid.outlines])
        arms = np.pad(centers - scales.anchors[sheet.bodies], ((0, 0), (0, 1)))
        turns = poses[:, 1:]
        places = poses[:, 0] + np.einsum("nij,nj->ni", turns, arms)
        members = np.bincount(sheet.bodies, minlength=scales.n_scales)
        of_body = np.zeros(scales.n_scales)
        split = self.split_energies(state.world, bend)
        for side in (0, 1):
            np.add.at(of_body, scales.pairs[:, side], 0.5 * split.sum(axis=1))
        force = np.zeros(scales.n_scales)
        if self.contact is not None:
            on_rows = np.zeros_like(state.world.y)
            self.contact.add_gradient(state.world.y, on_rows)
            sizes, rows = np.linalg.norm(on_rows, axis=1), scales.rows
            np.add.at(force, scales.pairs[rows.pair, rows.table.second.astype(int)], sizes)
        share = 1.0 / members[sheet.bodies]
        return ScalesAt(places, turns, of_body[sheet.bodies] * share, force[sheet.bodies] * share)
