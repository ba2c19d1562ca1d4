"""The native model `joints`: rigid scales on line joints, bent as a periodic cell."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from typing import Any

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.embedding.curvature_map import Bend, TensorBend
from flexscale.embedding.pair_kernels import (
    all_joints,
    all_openings,
    gather_column,
)
from flexscale.embedding.rigid_cell import RigidCell, find_rigid_scales
from flexscale.embedding.rigid_motion import N_VARIABLES, OF_KAPPA
from flexscale.errors import PatternError
from flexscale.homogenize.bent_joints import BentJoints, JointState
from flexscale.homogenize.joint_display import JointDisplay
from flexscale.homogenize.joint_validity import doubts
from flexscale.homogenize.native_model import NativeModel
from flexscale.homogenize.problem import FlatBends
from flexscale.joints.library import joint_law
from flexscale.mechanics.barrier import barrier_stiffness
from flexscale.mechanics.joint_law import JointLaw
from flexscale.mechanics.prism_contact import PrismContact
from flexscale.patterns.joint_lines import Joint, find_joints
from flexscale.patterns.pattern import Pattern
from flexscale.solve.constraint import ConstrainedSystem
from flexscale.solve.linear import DenseFactorization, Factorization, build_factorization

log = logging.getLogger(__name__)


class JointCell:
    """Rigid scales of one lattice cell on joints of one law, to be bent: a `Problem`.

    Parameters
    ----------
    pattern : the scale pattern.
    law : of its joints.
    native : contact and linear solver.

    Attributes
    ----------
    embedding : unknowns, and where they place scales.
    contact : barrier between scales; None if switched off.
    barrier_stiffness : N mm-3, with which every line of samples begins.
    part_names : names of the energy parts.
    largest_step : mm-1; longer ones pass from one stable state to another where scales press.
    area : rest area, mm2.
    system : factorizes the Hessian.
    jointed : (n_pairs,) whether a pair of neighbors shares joints; others can only touch.
    rows, columns : (nnz,) of the values of its upper triangle.
    slots : (n_pairs, 16, 16) place of an entry of a pair's block among these; -1 for none.
    """

    largest_step = 1e-3

    def __init__(self, pattern: Pattern, law: JointLaw, native: NativeModel) -> None:
        self.pattern, self.law, self.native = pattern, law, native
        joints = find_joints(pattern)
        scales = find_rigid_scales(pattern, joints, native.contact.enabled)
        self.embedding = RigidCell(scales)
        self.active, self.area = self.embedding.active, pattern.cell_area
        self._place_joints(joints)
        self.contact = self._build_contact()
        self.barrier_stiffness = 0.0 if self.contact is None else self.contact.stiffness
        self.part_names = ("joints", *([] if self.contact is None else ["contact"]))
        self.shift_mode = self.embedding.shift_mode[self.active]
        sheet = pattern.substrate_material.young_modulus * pattern.substrate_thickness
        self.energy_floor = self.area * 1e-24 * sheet
        self._build_system()

    @classmethod
    def from_pattern(cls, pattern: Pattern, native: NativeModel) -> JointCell:
        """The cell of a pattern on the joints that its gap, sheet and materials make.

        Raises
        ------
        PatternError : joints cannot be computed, do not hold the scales together, or are those of
            another sheet.
        """
        law, sheet = native.law or joint_law(pattern), pattern.substrate_material
        if not np.allclose(
            (law.thickness, law.modulus),
            (pattern.substrate_thickness, sheet.young_modulus),
            rtol=1e-9,
        ):
            raise PatternError(
                f"The law given is of a sheet of {law.thickness:g} mm and {law.modulus:g} MPa, the "
                f"pattern's of {pattern.substrate_thickness:g} mm, {sheet.young_modulus:g} MPa: "
                "take the law of this pattern."
            )
        cell = cls(pattern, law, native)
        rest = cell.bent(Bend(0.0, 0.0))
        if cell.system.factorize(rest.hessian_values(rest.evaluate(cell.embedding.rest))) > 0:
            raise PatternError(
                f"Joints do not hold the scales of this pattern together: at a gap of "
                f"{pattern.gap:g} mm too few of their walls face one another. Narrow the gap."
            )
        for doubt in cell.doubts:
            log.warning("%s: %s.", pattern.name, doubt)
        return cell

    def _place_joints(self, joints: Sequence[Joint]) -> None:
        scales = self.embedding.scales
        n = len(scales.pairs)
        self._arms = np.zeros((n, 2, 3))
        counts = np.zeros(n, dtype=np.int64)
        points, normals, weights = [], [], []
        for k, joint in enumerate(joints):
            middle = joint.weights @ joint.points / joint.weights.sum()
            self._arms[k, 0, :2] = middle - scales.anchors[joint.first]
            self._arms[k, 1, :2] = self._arms[k, 0, :2] - scales.ways[k]
            counts[k] = len(joint.points)
            points.append(joint.points - middle)
            normals.append(joint.normals)
            weights.append(joint.weights)
        self._starts = np.concatenate([[0], np.cumsum(counts)])
        self.jointed = counts > 0
        self._stations = tuple(np.concatenate(x) for x in (points, normals, weights))
        law = self.law
        self._law = (law.exponents, law.coefficients, law.thickness, law.modulus, law.bounds)

    def _build_contact(self) -> PrismContact | None:
        options, pattern = self.native.contact, self.pattern
        if not options.enabled:
            return None
        # The force that stretches a strip of sheet as wide as the gap to twice its length.
        modulus = pattern.substrate_material.young_modulus
        force = modulus * pattern.substrate_thickness * pattern.gap
        distance = options.activation * pattern.gap
        stiffness = options.stiffness * barrier_stiffness(force, distance)
        return PrismContact(self.embedding.scales.rows, distance, stiffness)

    def _build_system(self) -> None:
        cell = self.embedding
        position = np.full(cell.n_unknowns + 1, -1, dtype=np.int64)
        position[cell.active] = np.arange(len(cell.active))
        places = position[cell.variables()]
        first = np.broadcast_to(places[:, :, None], (*places.shape, N_VARIABLES))
        second = np.broadcast_to(places[:, None, :], first.shape)
        kept = (first >= 0) & (second >= 0) & (first <= second)
        n = len(cell.active)
        diagonal = np.arange(n)
        keys = np.unique(np.concatenate([first[kept] * n + second[kept], diagonal * n + diagonal]))
        indptr = np.searchsorted(keys, np.arange(n + 1) * n)
        self.rows, self.columns = np.divmod(keys, n)
        self.slots = np.full(first.shape, -1, dtype=np.int64)
        self.slots[kept] = np.searchsorted(keys, first[kept] * n + second[kept])
        small = n <= DenseFactorization.SMALL
        factorization: Factorization = (
            DenseFactorization(indptr, keys % n)
            if small
            else build_factorization(indptr, keys % n, self.native.solver.linear_solver)
        )
        self.system = ConstrainedSystem(
            factorization,
            indptr[:-1].astype(np.int64),
            cell.mean_offset[cell.active],
            int(np.searchsorted(cell.active, cell.shift_unknown)),
        )

    @property
    def gap(self) -> float:
        """mm, between scales at rest."""
        return self.pattern.gap

    @property
    def n_scales(self) -> int:
        """In the cell."""
        return self.embedding.scales.n_scales

    @property
    def facts(self) -> dict[str, Any]:
        """Which law the joints have."""
        return {"joint_law": self.law.digest}

    @property
    def doubts(self) -> tuple[str, ...]:
        """Sentences on what of the pattern joints were not compared with solids for."""
        return doubts(self.pattern)

    @property
    def parts(self) -> tuple[type[JointCell], tuple[Any, ...]]:
        """What makes it again in another process."""
        return JointCell, (self.pattern, self.law, self.native)

    def fit_room(self, z: FloatArray, bend: Bend) -> None:
        """Nothing: neighbors have room in the Hessian whether they touch or not."""

    def bent(self, bend: Bend | TensorBend) -> BentJoints:
        """The cell's energy as a function of z under a macroscopic bend."""
        return BentJoints(self, bend)

    def flat_bends(self) -> FlatBends:
        """Answers of the flat cell to small bends; its system is left factorized at rest."""
        cell, scales = self.embedding, self.embedding.scales
        # Of energies quadratic in k: those of kappa_xx, kappa_yy, 2 kappa_xy, and of two at a time.
        units = np.array(
            [[[1.0, 0.0], [0.0, 0.0]], [[0.0, 0.0], [0.0, 1.0]], [[0.0, 0.5], [0.5, 0.0]]]
        )
        rates, loads = [], []
        fixed, second = np.empty((3, 3)), np.empty(cell.n_unknowns + 1)
        state = self.bent(TensorBend(0.0, units[0])).evaluate(cell.rest)
        for i, j in ((0, 1), (0, 2), (1, 2), (0, 0), (1, 1), (2, 2)):
            bent = self.bent(TensorBend(0.0, units[i] + units[j] if i != j else units[i]))
            second[:] = 0.0
            gather_column(bent.blocks(state), scales.pairs, OF_KAPPA, second)
            fixed[i, j] = fixed[j, i] = second[-1]
            if i == j:
                loads.append(second[self.active].copy())
                rates.append(cell.curvature_rates(bent.bend))
        for i, j in ((0, 1), (0, 2), (1, 2)):
            fixed[i, j] = fixed[j, i] = 0.5 * (fixed[i, j] - fixed[i, i] - fixed[j, j])
        self.system.factorize(self.bent(TensorBend(0.0, units[0])).hessian_values(state))
        relaxed = [self.system.solve(-load)[0] for load in loads]
        return FlatBends(state, rates, fixed, loads, relaxed)

    def display(self) -> JointDisplay:
        """What places scales and sheet for pictures."""
        return JointDisplay(self.pattern, self.embedding, self.contact)

    def facts_of(self, state: JointState) -> dict[str, Any]:
        """How many stations lie beyond the range in which the law was sampled."""
        return {"outside_range": int(np.count_nonzero(~self.law.inside(self.openings(state))))}

    def openings(self, state: JointState) -> FloatArray:
        """(n_stations, 4) of all joints' stations u, w, s in mm and phi in radian."""
        scales = self.embedding.scales
        return all_openings(
            state.world.poses, scales.pairs, self._arms, self._starts, *self._stations[:2]
        )

    def joints(
        self, poses: FloatArray, order: int, gradient: FloatArray, blocks: FloatArray
    ) -> float:
        """Energy of the joints, with derivatives added as `pair_kernels.all_joints` says."""
        scales = self.embedding.scales
        where = (scales.pairs, self._arms, self._starts, *self._stations)
        return float(all_joints(poses, *where, *self._law, order, gradient, blocks))
