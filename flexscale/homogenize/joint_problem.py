"""Rigid scales on joints: energies, contact and system of unknowns, however they are held."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.bends import Bend, TensorBend
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
from flexscale.mechanics.stacked_laws import as_laws, digest_of, stack_laws
from flexscale.patterns.joint_lines import Joint
from flexscale.solve.constraint import ConstrainedSystem
from flexscale.solve.linear import DenseFactorization, Factorization, build_factorization
from flexscale.solve.unconstrained import UnconstrainedSystem


def place_stations(joints: Sequence[Joint], scales: RigidScales, gaps: Sequence[float]) -> Stations:
    """Stations of joints; those of joint k belong to the scales' pair k, others have none.

    Parameters
    ----------
    gaps : mm, that joints have, each once, the narrowest first, as their laws are in order.
    """
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
        np.searchsorted(gaps, np.concatenate([joint.gaps for joint in joints])),
    )


class JointProblem:
    """Rigid scales on joints, those of equal gaps of one law.

    Parameters
    ----------
    embedding : unknowns, and where they place scales.
    stations : of the joints of its pairs.
    laws : of the joints, or one of all, by the numbers of the stations.
    native : contact and linear solver.
    gaps : mm, the narrowest and the widest between scales at rest.
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
        laws: JointLaw | Sequence[JointLaw],
        native: NativeModel,
        gaps: tuple[float, float],
        area: float,
    ) -> None:
        self.embedding, self.stations, self.native = embedding, stations, native
        self.laws = as_laws(laws)
        self._gaps, self.area, self.active = gaps, area, embedding.active
        self._tables = stack_laws(self.laws)
        self.contact = self._build_contact()
        self.barrier_stiffness = 0.0 if self.contact is None else self.contact.stiffness
        self.part_names = ("joints", *([] if self.contact is None else ["contact"]))
        self.shift_mode = embedding.shift_mode[self.active]
        self.energy_floor = area * 1e-24 * self.laws[0].modulus * self.laws[0].thickness
        self._build_system()

    def _build_contact(self) -> PrismContact | None:
        options = self.native.contact
        if not options.enabled:
            return None
        # The force that stretches a strip of sheet as wide as the gap to twice its length.
        force = self.laws[0].modulus * self.laws[0].thickness * self.gap
        distance = options.activation * self.gap
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
        """mm, the narrowest between scales at rest."""
        return self._gaps[0]

    @property
    def widest_gap(self) -> float:
        """mm, the widest between scales at rest."""
        return self._gaps[1]

    @property
    def n_scales(self) -> int:
        """In the cell or on the sheet."""
        return self.embedding.scales.n_scales

    @property
    def facts(self) -> dict[str, Any]:
        """Which laws the joints have."""
        return {"joint_law": digest_of(self.laws)}

    def fit_room(self, z: FloatArray, bend: Bend) -> None:
        """Nothing: neighbors have room in the Hessian whether they touch or not."""

    def bent(self, bend: Bend | TensorBend) -> BentJoints:
        """The energy as a function of z under a macroscopic bend."""
        return BentJoints(self, bend)

    def facts_of(self, state: JointState) -> dict[str, Any]:
        """How many stations lie beyond the range in which their law was sampled."""
        openings = all_openings(state.world.poses, self.stations)
        outside = 0
        for number, law in enumerate(self.laws):
            inside = law.inside(openings[self.stations.laws == number])
            outside += int(np.count_nonzero(~inside))
        return {"outside_range": outside}

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
            world.bending, cell.pairs(bend), self.stations, self._tables, world.y, table, *barrier,
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
                world.bending, self.embedding.pairs(bend), self.stations, self._tables, world.y,
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
