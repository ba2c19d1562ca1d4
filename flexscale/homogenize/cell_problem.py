"""The native model of one pattern: energies on the periodic cell, and the cell under a bend."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexscale.embedding.cell import CellEmbedding
from flexscale.embedding.curvature_map import Bend
from flexscale.embedding.pull_back import PullBack
from flexscale.embedding.world_map import SecondOrder, World
from flexscale.mechanics.energy import Energy, FloatArray
from flexscale.mechanics.neo_hookean import NeoHookeanTets
from flexscale.mechanics.shell import HctShell
from flexscale.mesh.options import MeshOptions
from flexscale.mesh.periodic_mesh import PeriodicMesh
from flexscale.mesh.torus import build_mesh
from flexscale.patterns import NeoHookean, Pattern
from flexscale.solve.constraint import ConstrainedSystem
from flexscale.solve.linear import build_factorization


def plate_stiffness(material: NeoHookean, thickness: float) -> float:
    """D = E t^3 / 12 (1 - nu^2) [N mm]."""
    return material.young_modulus * thickness**3 / (12.0 * (1.0 - material.poisson_ratio**2))


@dataclass(frozen=True)
class CellState:
    """Energy and forces of the cell at a state z.

    Attributes
    ----------
    parts : (n_parts,) N mm, in the order of `CellProblem.part_names`.
    energy : N mm, their sum.
    gradient : (n_active,) dE/dz of the active unknowns.
    forces : (n_rows, 3) dE/dy.
    """

    z: FloatArray
    world: World
    parts: FloatArray
    energy: float
    forces: FloatArray
    gradient: FloatArray


class CellProblem:
    """Substrate and scales of one translational cell, ready to be bent.

    Parameters
    ----------
    mesh : torus mesh.
    substrate_material, substrate_thickness : of the sheet, thickness in mm.
    scale_material : of the scales.
    linear_solver : "auto", "pardiso" or "superlu".
    bond_radius : mm, around a point of a scale's outline, over which the sheet follows the base.

    Attributes
    ----------
    embedding : unknowns and world vectors; `embedding.rest` is the flat state.
    energies : substrate, then scales (contact joins here).
    part_names : names of the energy parts.
    area : rest area of the cell, mm2.
    """

    def __init__(
        self,
        mesh: PeriodicMesh,
        substrate_material: NeoHookean,
        substrate_thickness: float,
        scale_material: NeoHookean,
        linear_solver: str = "auto",
        bond_radius: float = 0.0,
    ) -> None:
        self.mesh = mesh
        self.area = mesh.cell_area
        self.embedding = CellEmbedding(mesh, bond_radius)
        shell = self.embedding.shell
        self.energies: list[Energy] = [
            HctShell(
                shell.corners,
                shell.edge_normals,
                shell.vectors,
                shear_modulus=substrate_material.shear_modulus,
                lame_lambda=substrate_material.lame_lambda,
                poisson_ratio=substrate_material.poisson_ratio,
                thickness=substrate_thickness,
                bending_stiffness=plate_stiffness(substrate_material, substrate_thickness),
            ),
            NeoHookeanTets(
                mesh.scale_positions,
                mesh.tets,
                self.embedding.tet_vectors,
                scale_material.shear_modulus,
                scale_material.lame_lambda,
            ),
        ]
        self.part_names = tuple(name for e in self.energies for name in e.part_names)
        self.active = self.embedding.active
        self.pull_back = PullBack(self.embedding.world_map, self.energies, self.active)
        factorization = build_factorization(
            self.pull_back.indptr, self.pull_back.indices, linear_solver
        )
        position = int(np.searchsorted(self.active, self.embedding.shift_unknown))
        self.system = ConstrainedSystem(
            factorization,
            self.pull_back.diagonal,
            self.embedding.mean_offset[self.active],
            position,
        )
        self.shift_mode = self.embedding.shift_mode[self.active]
        # Energies below this are rounding: strains of 1e-12 all over the sheet.
        volume = self.area * substrate_thickness
        self.energy_floor = 1e-24 * substrate_material.young_modulus * volume

    @classmethod
    def from_pattern(
        cls, pattern: Pattern, options: MeshOptions | None = None, linear_solver: str = "auto"
    ) -> CellProblem:
        """Mesh a pattern and set up its native model."""
        return cls(
            build_mesh(pattern, options or MeshOptions()),
            pattern.substrate_material,
            pattern.substrate_thickness,
            pattern.scale_material,
            linear_solver,
            pattern.bond_radius,
        )

    def bent(self, bend: Bend) -> BentCell:
        """The cell's energy as a function of z under a macroscopic bend."""
        return BentCell(self, bend)


class BentCell:
    """A cell problem under one bend: an `Objective` for `solve.newton`."""

    def __init__(self, problem: CellProblem, bend: Bend) -> None:
        self.problem = problem
        self.bend = bend
        self.system = problem.system
        self.active = problem.active
        self.shift_mode = problem.shift_mode
        self.energy_floor = problem.energy_floor

    def evaluate(self, z: FloatArray) -> CellState:
        """Energy and gradient at z; energy is infinite where an element is inverted."""
        problem = self.problem
        world_map = problem.embedding.world_map
        world = world_map.place(z, self.bend)
        parts = np.concatenate([e.energy_parts(world.y) for e in problem.energies])
        forces = np.zeros_like(world.y)
        gradient = np.zeros(len(self.active))
        energy = float(parts.sum())
        if np.isfinite(energy):
            for e in problem.energies:
                e.add_gradient(world.y, forces)
            gradient = world_map.pull_gradient(world, forces)[self.active]
        return CellState(z, world, parts, energy, forces, gradient)

    def hessian_values(self, state: CellState, project: bool = False) -> FloatArray:
        """(nnz,) upper triangle of d2E/dz2; with `project`, of a positive part of it."""
        blocks = self.problem.pull_back.pair_blocks(state.world.y, project)
        second = self._second_order(state)
        if project:
            second = SecondOrder(_positive_part(second.hessian), second.mixed)
        return self.problem.pull_back.hessian(state.world, blocks, state.forces, second)

    def _second_order(self, state: CellState) -> SecondOrder:
        world_map = self.problem.embedding.world_map
        return world_map.second_order(state.z, self.bend, state.world, state.forces)

    def gradient_rate(self, state: CellState) -> FloatArray:
        """(n_active,) d(dE/dz)/dkappa at fixed z."""
        pull_back = self.problem.pull_back
        blocks = pull_back.pair_blocks(state.world.y)
        rate = pull_back.kappa_rate(state.world, blocks, state.forces, self._second_order(state))
        return rate[self.active]

    def moment(self, state: CellState) -> float:
        """M = (1/A) dE/dkappa at fixed z [N], exact at equilibrium (envelope theorem)."""
        return float(np.sum(state.forces * state.world.kappa_rate)) / self.problem.area


def _positive_part(matrices: FloatArray) -> FloatArray:
    values, modes = np.linalg.eigh(matrices)
    modes *= np.sqrt(np.maximum(values, 0.0))[:, None, :]
    return modes @ np.swapaxes(modes, 1, 2)
