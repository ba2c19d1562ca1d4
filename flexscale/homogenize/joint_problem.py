"""Rigid scales on joints: energies, contact and system of unknowns, however they are held."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.curvature_map import Bend, TensorBend
from flexscale.embedding.joint_kernels import Stations, all_openings
from flexscale.embedding.pair_kernels import SLOTS, assemble
from flexscale.embedding.rigid_cell import RigidCell, RigidScales, RigidWorld
from flexscale.embedding.rigid_motion import N_VARIABLES
from flexscale.homogenize.bent_joints import BentJoints, JointState
from flexscale.homogenize.native_model import NativeModel
from flexscale.mechanics.barrier import barrier_stiffness
from flexscale.mechanics.joint_law import JointLaw
from flexscale.mechanics.prism_candidates import Memory
from flexscale.mechanics.prism_contact import PrismContact
from flexscale.patterns.joint_lines import Joint
from flexscale.solve.constraint import ConstrainedSystem
from flexscale.solve.linear import DenseFactorization, Factorization, build_factorization
from flexscale.solve.unconstrained import UnconstrainedSystem


def place_stations(joints: Sequence[Joint], scales: RigidScales) -> Stations:
    """Stations of joints; those of joint k belong to the scales' pair k, others have none."""
    n = len(scales.pairs)
    arms, counts = np.zeros((n, 2, 3)), np.zeros(n, dtype=np.int64)
    for k, joint in enumerate(joints):
        middle = joint.weights @ joint.points / joint.weights.sum()
        arms[k, 0, :2] = middle - scales.anchors[joint.first]
        arms[k, 1, :2] = arms[k, 0, :2] - scales.ways[k]
        counts[k] = len(joint.points)
    middles = arms[: len(joints), 0, :2] + scales.anchors[[joint.first for joint in joints]]
    return Stations(
        arms,
        np.concatenate([[0], np.cumsum(counts)]),
        np.concatenate([joint.points for joint in joints])
        - np.repeat(middles, counts[: len(joints)], axis=0),
        np.concatenate([joint.normals for joint in joints]),
        np.concatenate([joint.weights for joint in joints]),
    )


class JointProblem:
    """Rigid scales on joints of one law.

    Parameters
    ----------
    embedding : unknowns, and where they place scales.
    stations : of the joints of its pairs.
    law : of the joints.
    native : contact and linear solver.
    gap : mm, between scales at rest.
    area : mm2, to which energy densities and moments refer.

    Attributes
    ----------
    contact : barrier between scales; None if switched off.
    barrier_stiffness : N mm-3, with which every line of samples begins.
    part_names : names of the energy parts.
    largest_step : mm-1; longer ones pass from one stable state to another where scales press.
    system : factorizes the Hessian.
    rows, columns : (nnz,) of the values of its upper triangle.
    slots : (n_pairs, SLOTS) places of a pair's second derivatives among these; -1 for none.
    """

    largest_step = 1e-3

    def __init__(
        self,
        embedding: RigidCell,
        stations: Stations,
        law: JointLaw,
        native: NativeModel,
        gap: float,
        area: float,
    ) -> None:
        self.embedding, self.stations, self.law, self.native = embedding, stations, law, native
        self._gap, self.area, self.active = gap, area, embedding.active
        self._law = law.table
        self.contact = self._build_contact()
        self.barrier_stiffness = 0.0 if self.contact is None else self.contact.stiffness
        self.part_names = ("joints", *([] if self.contact is None else ["contact"]))
        self.shift_mode = embedding.shift_mode[self.active]
        self.energy_floor = area * 1e-24 * law.modulus * law.thickness
        self._build_system()

    def _build_contact(self) -> PrismContact | None:
        options = self.native.contact
        if not options.enabled:
            return None
        # The force that stretches a strip of sheet as wide as the gap to twice its length.
        force = self.law.modulus * self.law.thickness * self._gap
        distance = options.activation * self._gap
        stiffness = options.stiffness * barrier_stiffness(force, distance)
        return PrismContact(self.embedding.scales.rows, distance, stiffness)

    def _build_system(self) -> None:
        cell = self.embedding
        position = np.full(cell.n_unknowns + 1, -1, dtype=np.int64)
        position[cell.active] = np.arange(len(cell.active))
        places = position[cell.variables()]
        upper = np.triu_indices(N_VARIABLES)
        first, second = places[:, upper[0]], places[:, upper[1]]
        kept = (first >= 0) & (second >= 0)
        n = len(cell.active)
        keys = (np.minimum(first, second) * n + np.maximum(first, second))[kept]
        diagonal = np.arange(n)
        known = np.unique(np.concatenate([keys, diagonal * n + diagonal]))
        indptr = np.searchsorted(known, np.arange(n + 1) * n)
        self.rows, self.columns = np.divmod(known, n)
        self.slots = np.full((len(places), SLOTS), -1, dtype=np.int32)
        self.slots[kept] = np.searchsorted(known, keys)
        factorization: Factorization = (
            DenseFactorization(indptr, self.columns)
            if n <= DenseFactorization.SMALL
            else build_factorization(
                indptr, self.columns, self.native.solver.linear_solver, self._order(indptr)
            )
        )
        on_diagonal = indptr[:-1].astype(np.int64)
        self.system: ConstrainedSystem | UnconstrainedSystem
        if cell.floats:
            shift = int(np.searchsorted(cell.active, cell.shift_unknown))
            offset = cell.mean_offset[cell.active]
            self.system = ConstrainedSystem(factorization, on_diagonal, offset, shift)
        else:  # what is held needs no constraint
            self.system = UnconstrainedSystem(factorization, on_diagonal)

    def _order(self, indptr: IntArray) -> IntArray | None:
        """None: the solver's own."""
        return None

    @property
    def gap(self) -> float:
        """mm, between scales at rest."""
        return self._gap

    @property
    def n_scales(self) -> int:
        """In the cell or on the sheet."""
        return self.embedding.scales.n_scales

    @property
    def facts(self) -> dict[str, Any]:
        """Which law the joints have."""
        return {"joint_law": self.law.digest}

    def fit_room(self, z: FloatArray, bend: Bend) -> None:
        """Nothing: neighbors have room in the Hessian whether they touch or not."""

    def bent(self, bend: Bend | TensorBend) -> BentJoints:
        """The energy as a function of z under a macroscopic bend."""
        return BentJoints(self, bend)

    def facts_of(self, state: JointState) -> dict[str, Any]:
        """How many stations lie beyond the range in which the law was sampled."""
        openings = all_openings(state.world.poses, self.stations)
        return {"outside_range": int(np.count_nonzero(~self.law.inside(openings)))}

    def assemble(
        self,
        world: RigidWorld,
        bend: Bend | TensorBend,
        gradient: FloatArray,
        values: FloatArray | None = None,
        direction: FloatArray | None = None,
        lift: int = 0,
        split: FloatArray | None = None,
    ) -> tuple[FloatArray, FloatArray]:
        """Energy parts, with derivatives added as `pair_kernels.assemble` says.

        Returns
        -------
        parts (n_parts,) N mm; (n_unknowns + 1,) second derivatives times `direction`.
        """
        cell, rate = self.embedding, np.zeros_like(gradient)
        needed = values is not None or direction is not None
        contact, table = self.contact, cell.scales.rows.table
        barrier = (
            (_NO_MEMORY, 1.0, 1.0, 0.0)
            if contact is None
            else (contact.memory, contact.activation_distance, contact.most, contact.stiffness)
        )
        parts = assemble(
            world.bending, cell.pairs(bend), self.stations, self._law, world.y, table, *barrier,
            lift, gradient, self.slots if needed else self.slots[:0],
            np.zeros(len(self.rows)) if values is None else values,
            np.zeros_like(gradient) if direction is None else direction, rate,
            np.zeros((0, 2)) if split is None else split,
        )  # fmt: skip
        return np.array(parts[: len(self.part_names)]), rate

    def joint_energy(
        self,
        world: RigidWorld,
        bend: Bend | TensorBend,
        gradient: FloatArray,
        values: FloatArray | None = None,
        lift: int = 0,
    ) -> float:
        """N mm, of the joints alone, with derivatives added."""
        unused = np.zeros_like(gradient)
        return float(
            assemble(
                world.bending, self.embedding.pairs(bend), self.stations, self._law, world.y,
                self.embedding.scales.rows.table, _NO_MEMORY, 1.0, 1.0, 0.0, lift, gradient,
                self.slots[:0] if values is None else self.slots,
                np.zeros(0) if values is None else values, unused, unused, np.zeros((0, 2)),
            )[0]
        )  # fmt: skip

    def free_part(self, gradient: FloatArray) -> FloatArray:
        """The gradient by unknowns that nothing else moves: all of them."""
        return gradient

    def factorize(self, values: FloatArray) -> int:
        """As its system does, with what is held but among the unknowns left out."""
        return self.system.factorize(values)

    def split_energies(self, world: RigidWorld, bend: Bend | TensorBend) -> FloatArray:
        """(n_pairs, 2) N mm, energies of each pair's joints and of its contact."""
        split = np.zeros((len(self.embedding.scales.pairs), 2))
        self.assemble(world, bend, np.zeros(self.embedding.n_unknowns + 1), split=split)
        return split


_NO_MEMORY = Memory(np.zeros((0, 3)), np.zeros(0), np.zeros(0))
