"""A cell on joints under one bend: energy, gradient and Hessian at a state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.embedding.curvature_map import Bend, TensorBend
from flexscale.embedding.pair_kernels import (
    add_blocks,
    gather_column,
    pull_forces,
    pull_stencils,
)
from flexscale.embedding.rigid_cell import RigidWorld
from flexscale.embedding.rigid_motion import N_VARIABLES, OF_KAPPA
from flexscale.homogenize.keep_apart import keep_apart
from flexscale.mechanics.energy import ALL, NOTHING
from flexscale.solve.constraint import ConstrainedSystem

if TYPE_CHECKING:
    from flexscale.homogenize.joint_cell import JointCell


@dataclass(frozen=True)
class JointState:
    """Energy and forces of the cell at a state z.

    Attributes
    ----------
    parts : (n_parts,) N mm, in the order of `JointCell.part_names`.
    energy : N mm, their sum.
    gradient : (n_active,) dE/dz of the active unknowns.
    moment : N mm2, dE/dkappa at fixed z.
    """

    z: FloatArray
    world: RigidWorld
    parts: FloatArray
    energy: float
    gradient: FloatArray
    moment: float


_NO_BLOCKS = np.zeros((0, N_VARIABLES, N_VARIABLES))


class BentJoints:
    """A cell of joints under one bend: an `Objective` for `solve.newton`."""

    def __init__(self, problem: JointCell, bend: Bend | TensorBend) -> None:
        self.problem, self.bend = problem, bend
        self.active, self.shift_mode = problem.active, problem.shift_mode
        self.energy_floor = problem.energy_floor

    @property
    def system(self) -> ConstrainedSystem:
        """Linear systems on the pattern of neighbors."""
        return self.problem.system

    def evaluate(self, z: FloatArray) -> JointState:
        """Energy and gradient at z."""
        problem, cell = self.problem, self.problem.embedding
        world = cell.place(z, self.bend)
        gradient = np.zeros(cell.n_unknowns + 1)
        parts = [problem.joints(world.poses, 1, gradient, _NO_BLOCKS)]
        if problem.contact is not None:
            parts.append(float(problem.contact.energy_parts(world.y)[0]))
            if 0.0 < parts[1] < np.inf:
                forces = np.zeros_like(world.y)
                problem.contact.add_gradient(world.y, forces)
                gradient += cell.pull_all(world, forces)
        values = np.array(parts)
        return JointState(
            z, world, values, float(values.sum()), gradient[problem.active], float(gradient[-1])
        )

    def blocks(self, state: JointState, project: str = NOTHING) -> FloatArray:
        """(n_pairs, 16, 16) second derivatives by each pair's variables."""
        problem, cell = self.problem, self.problem.embedding
        scales, rows = cell.scales, cell.scales.rows
        needed = problem.jointed.copy()
        touching = problem.contact is not None and state.parts[1] > 0.0
        if problem.contact is not None and touching:
            stencils, slopes, hessians = problem.contact.derivatives(
                state.world.y, project != NOTHING
            )
            needed[rows.pair[stencils[:, 0]]] = True
        poses = cell.poses(state.z, self.bend, 2, needed)
        blocks = np.zeros((len(scales.pairs), N_VARIABLES, N_VARIABLES))
        unused = np.zeros(cell.n_unknowns + 1)
        problem.joints(poses, 2, unused, blocks)
        if touching:
            forces = np.zeros_like(state.world.y)
            np.add.at(forces, stencils.ravel(), slopes.reshape(-1, 3))
            where = (rows.pair, rows.second, rows.rest)
            pull_forces(poses, scales.pairs, *where, forces, 2, unused, blocks)
            pull_stencils(poses, *where, stencils, hessians, blocks)
        if project == ALL:
            values, modes = np.linalg.eigh(blocks[:, :OF_KAPPA, :OF_KAPPA])
            modes *= np.sqrt(np.maximum(values, 0.0))[:, None, :]
            blocks[:, :OF_KAPPA, :OF_KAPPA] = modes @ modes.transpose(0, 2, 1)
        return blocks

    def hessian_values(self, state: JointState, project: str = NOTHING) -> FloatArray:
        """(nnz,) upper triangle of d2E/dz2; `project` replaces parts by their positive part."""
        values = np.zeros(len(self.problem.rows))
        add_blocks(self.blocks(state, project), self.problem.slots, values)
        return values

    def gradient_rate(self, state: JointState) -> FloatArray:
        """(n_active,) d(dE/dz)/dkappa at fixed z."""
        cell = self.problem.embedding
        out = np.zeros(cell.n_unknowns + 1)
        gather_column(self.blocks(state), cell.scales.pairs, OF_KAPPA, out)
        return out[self.active]

    def free_share(self, state: JointState, trial: JointState) -> float:
        """Share of the straight way from one state to another on which no scales meet."""
        contact = self.problem.contact
        return 1.0 if contact is None else contact.free_share(state.world.y, trial.world.y)

    def keep_apart(self, state: JointState, wanted: FloatArray) -> FloatArray | None:
        """A state near a wanted one to which no scales meet on the way from `state`."""
        return keep_apart(self.problem, state.world.y, wanted, self.bend)

    def moment(self, state: JointState) -> float:
        """M = (1/A) dE/dkappa at fixed z [N], exact at equilibrium (envelope theorem)."""
        return state.moment / self.problem.area
