"""Scales on joints under one bend: energy, gradient and Hessian at a state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.embedding.bends import UNIT_CURVATURES, Bend, TensorBend
from flexscale.embedding.pair_kernels import LIFT_ALL, LIFT_CONTACT
from flexscale.embedding.rigid_cell import RigidWorld
from flexscale.homogenize.keep_many_apart import keep_many_apart
from flexscale.mechanics.energy import ALL, NOTHING
from flexscale.solve.constraint import ConstrainedSystem
from flexscale.solve.unconstrained import UnconstrainedSystem

if TYPE_CHECKING:
    from flexscale.homogenize.joint_problem import JointProblem


@dataclass(frozen=True)
class JointState:
    """Energy and forces at a state z.

    Attributes
    ----------
    parts : (n_parts,) N mm, in the order of `JointProblem.part_names`.
    energy : N mm, their sum.
    gradient : (n_active,) dE/dz of the active unknowns.
    moment : N mm2, dE/dkappa at fixed z.
    forces : (n_unknowns,) dE/dz of all unknowns, held ones as well.
    hessian : (nnz,) upper triangle of the second derivatives by those that are sought.
    kappa_rate : (n_unknowns + 1,) second derivatives by kappa and all unknowns, then kappa.
    """

    z: FloatArray
    world: RigidWorld
    parts: FloatArray
    energy: float
    gradient: FloatArray
    moment: float
    forces: FloatArray
    hessian: FloatArray
    kappa_rate: FloatArray


class BentJoints:
    """Scales on joints under one bend: an `Objective` for `solve.newton`."""

    def __init__(self, problem: JointProblem, bend: Bend | TensorBend) -> None:
        self.problem, self.bend = problem, bend
        self.active, self.shift_mode = problem.active, problem.shift_mode
        self.energy_floor = problem.energy_floor

    @property
    def system(self) -> ConstrainedSystem | UnconstrainedSystem:
        """Linear systems on the pattern of neighbors."""
        return self.problem.system

    def evaluate(self, z: FloatArray) -> JointState:
        """Energy with both derivatives at z: most states that are tried are also kept."""
        problem, cell = self.problem, self.problem.embedding
        world = cell.place(z, self.bend)
        forces, by_kappa = np.zeros(cell.n_unknowns + 1), np.zeros(cell.n_unknowns + 1)
        values = np.zeros(len(problem.rows))
        by_kappa[-1] = 1.0
        parts, rate = problem.assemble(world, self.bend, forces, values, by_kappa)
        return JointState(
            z, world, parts, float(parts.sum()), forces[problem.active], float(forces[-1]),
            forces[:-1], values, rate,
        )  # fmt: skip

    def hessian_values(self, state: JointState, project: str = NOTHING) -> FloatArray:
        """(nnz,) upper triangle of d2E/dz2; `project` replaces parts by their positive part."""
        if project == NOTHING:
            return state.hessian.copy()
        problem = self.problem
        values, unused = np.zeros(len(problem.rows)), np.zeros(problem.embedding.n_unknowns + 1)
        lift = LIFT_ALL if project == ALL else LIFT_CONTACT
        problem.assemble(state.world, self.bend, unused, values, lift=lift)
        return values

    def second_derivatives(
        self, state: JointState, direction: FloatArray | None = None
    ) -> FloatArray:
        """(n_unknowns + 1,) second derivatives by all unknowns, then kappa, times a change of these
        (n_unknowns + 1,); times one of kappa if none is given."""
        if direction is None:
            return state.kappa_rate
        unused = np.zeros(self.problem.embedding.n_unknowns + 1)
        return self.problem.assemble(state.world, self.bend, unused, direction=direction)[1]

    def gradient_rate(self, state: JointState) -> FloatArray:
        """(n_active,) d(dE/dz)/dkappa at fixed z."""
        return self.second_derivatives(state)[self.active]

    def free_share(self, state: JointState, trial: JointState) -> float:
        """Share of the straight way from one state to another on which no scales meet."""
        contact = self.problem.contact
        return 1.0 if contact is None else contact.free_share(state.world.y, trial.world.y)

    def keep_apart(self, state: JointState, wanted: FloatArray) -> FloatArray | None:
        """A state near a wanted one to which no scales meet on the way from `state`."""
        return keep_many_apart(self.problem, state.world.y, wanted, self.bend)

    def tensor_moments(self, state: JointState) -> FloatArray:
        """(3,) (1/A) dE/dk by k_xx, k_yy and 2 k_xy at fixed z [N]; see `moment`."""
        k = self.bend.base + self.bend.curvature * self.bend.tensor
        moments = np.empty(3)
        for i, tensor in enumerate(UNIT_CURVATURES):
            bent = BentJoints(self.problem, TensorBend(0.0, tensor, k))
            gradient = np.zeros(self.problem.embedding.n_unknowns + 1)
            self.problem.assemble(
                self.problem.embedding.place(state.z, bent.bend), bent.bend, gradient
            )
            moments[i] = gradient[-1] / self.problem.area
        return moments

    def membrane_forces(self, state: JointState) -> FloatArray:
        """(3,) N mm-1, xx, yy, xy: (1/A) dE/dF of the stretch F = I + S of the lattice at fixed
        curvature; 0 where S is free."""
        forces: FloatArray = state.forces[-3:] / self.problem.area
        return forces * [1.0, 1.0, 0.5]  # S_xy stands for both off-diagonals

    def steady(self, state: JointState) -> bool:
        """Always: `keep_apart` makes its own matrices."""
        return True

    def moment(self, state: JointState) -> float:
        """M = (1/A) dE/dkappa at fixed z [N], exact at equilibrium (envelope theorem)."""
        return state.moment / self.problem.area
