"""The native model of one pattern: energies on the periodic cell, and the cell under a bend."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.embedding.bends import Bend
from flexscale.embedding.bodies import Body
from flexscale.embedding.body_cell import BodyCell
from flexscale.embedding.body_map import BodySecondOrder, BodyWorld
from flexscale.embedding.body_pull_back import BodyPullBack
from flexscale.embedding.cell import CellEmbedding
from flexscale.embedding.display import Display
from flexscale.embedding.pull_back import PullBack
from flexscale.embedding.world_map import SecondOrder, World
from flexscale.errors import PatternError
from flexscale.homogenize.cell_model import CellModel
from flexscale.homogenize.keep_apart import keep_apart
from flexscale.homogenize.native_model import NativeModel
from flexscale.homogenize.problem import FlatBends
from flexscale.homogenize.scale_modes import build_bodies, build_rigid_bodies
from flexscale.homogenize.substrate import build_embedding, build_substrate
from flexscale.mechanics.barrier import barrier_stiffness
from flexscale.mechanics.contact import ContactSurface, ScaleContact
from flexscale.mechanics.energy import ALL, NOTHING, Energy
from flexscale.mechanics.neo_hookean import NeoHookeanTets
from flexscale.mesh.periodic_mesh import PeriodicMesh
from flexscale.mesh.torus import build_mesh
from flexscale.patterns import NeoHookean, Pattern
from flexscale.solve.constraint import ConstrainedSystem
from flexscale.solve.linear import build_factorization
from flexscale.solve.ordering import elimination_order


def _build_tets(embedding: CellEmbedding, material: NeoHookean) -> NeoHookeanTets:
    return NeoHookeanTets(
        embedding.mesh.scale_positions,
        embedding.mesh.tets,
        embedding.tet_vectors,
        material.shear_modulus,
        material.lame_lambda,
    )


def _build_contact(surface: ContactSurface | None, model: CellModel) -> ScaleContact | None:
    if surface is None:
        return None
    # The force that stretches a strip of sheet as wide as the gap to twice its length.
    modulus = model.substrate_material.young_modulus
    force = modulus * model.substrate_thickness * model.gap
    distance = model.contact.activation * model.gap
    stiffness = model.contact.stiffness * barrier_stiffness(force, distance)
    return ScaleContact(surface, distance, stiffness)


def _build_bodies(inner: CellEmbedding, model: CellModel) -> list[Body]:
    if model.scales.model == "rigid":
        return build_rigid_bodies(inner, model.scale_material, model.rigid_stiffness)
    return build_bodies(inner, model.scale_material, model.sheet_support, model.scales.cutoff)


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
    world: World | BodyWorld
    parts: FloatArray
    energy: float
    forces: FloatArray
    gradient: FloatArray


class CellProblem:
    """Substrate and scales of one translational cell, to be bent.

    Parameters
    ----------
    mesh : torus mesh.
    model : materials, sizes, contact, linear solver.
    bodies : the scales, if they are bodies and known already.

    Attributes
    ----------
    embedding : unknowns and world vectors; `embedding.rest` is the flat state.
    energies : of world vectors: the substrate's, and the scales' if they are tets.
    bodies : the scales if they are bodies, else none.
    contact : barrier between scales; None without scales or if switched off.
    barrier_stiffness : N mm-3, with which every line of samples begins.
    part_names : names of the energy parts.
    largest_step : mm-1, none: from sample to sample.
    area : rest area, mm2.
    system : factorizes on the present pattern of nonzeros, which contact may enlarge.

    Raises
    ------
    PatternError : scales touch or intersect at rest.
    """

    largest_step = np.inf

    def __init__(
        self,
        mesh: PeriodicMesh,
        model: CellModel,
        bodies: Sequence[Body] | None = None,
    ) -> None:
        self.mesh, self.model = mesh, model
        tets = model.scales.model == "tets" or mesh.n_scales == 0
        edge = model.contact.edge if model.contact.enabled else None
        inner = build_embedding(mesh, model, edge, tets)
        self.area = mesh.cell_area
        self.energies: list[Energy] = build_substrate(inner, model)
        self.contact = _build_contact(inner.contact_surface, model)
        self.barrier_stiffness = 0.0 if self.contact is None else self.contact.stiffness
        names = [name for e in self.energies for name in e.part_names]
        self.part_names = (*names, "scales", *([] if self.contact is None else ["contact"]))
        self.bodies: tuple[Body, ...] = ()
        self.embedding: Any = inner
        if tets:
            self.energies.append(_build_tets(inner, model.scale_material))
        else:
            self.bodies = tuple(_build_bodies(inner, model) if bodies is None else bodies)
            self.embedding = BodyCell(inner, self.bodies)
        self._check_start()
        self.active = self.embedding.active
        # Cells with tets and with bodies have worlds of their own, and the same calls.
        self.pull_back: Any = self._build_pull_back(inner)
        self.build_system()
        self.shift_mode = self.embedding.shift_mode[self.active]
        # Energies below this are rounding: strains of 1e-12 in the sheet, of 3e-15 in the scales.
        sheet = model.substrate_material.young_modulus * model.substrate_thickness
        scales = model.scale_material.young_modulus * mesh.scale_height
        self.energy_floor = mesh.cell_area * (1e-24 * sheet + 1e-29 * scales)

    @property
    def n_scales(self) -> int:
        """In the cell."""
        return self.mesh.n_scales

    @property
    def facts(self) -> dict[str, Any]:
        """Nothing: pattern and options say it all."""
        return {}

    @property
    def doubts(self) -> tuple[str, ...]:
        """None: what a shell in the gap is not, is told where the model is chosen."""
        return ()

    @property
    def parts(self) -> tuple[type[CellProblem], tuple[Any, ...]]:
        """What makes it again in another process."""
        return CellProblem, (self.mesh, self.model, self.bodies)

    @property
    def gap(self) -> float:
        """mm, the narrowest between scales at rest."""
        return self.model.gap

    @property
    def widest_gap(self) -> float:
        """mm, the widest between scales at rest."""
        return max(self.model.gap, self.model.widest_gap)

    def _build_pull_back(self, inner: CellEmbedding) -> PullBack | BodyPullBack:
        """What takes Hessians by world vectors to those by the active unknowns."""
        if not self.bodies:
            return PullBack(inner.world_map, self.energies, self.active, self.contact)
        everything = np.arange(inner.n_unknowns)
        of_sheet = PullBack(inner.world_map, self.energies, everything)
        return BodyPullBack(self.embedding.world_map, of_sheet, self.active, self.contact)

    def _check_start(self) -> None:
        if self.contact is None:
            return
        y = self.embedding.world_map.place(self.embedding.rest, Bend(0.0, 0.0)).y
        reach = self.contact.activation_distance
        apart = self.contact.smallest_distance(y, reach)
        if self.contact.intersects(y):
            raise PatternError(
                "Scales of this cell cut through one another before it is bent: its mesh cannot "
                "be used with contact. Make the cell from a pattern, or leave contact out."
            )
        if apart <= reach:
            raise PatternError(
                f"Two scales are {apart:.3g} mm apart before the sheet is bent, but contact starts "
                f"at {reach:.3g} mm: lower the contact activation, or widen the gap."
            )

    @classmethod
    def from_pattern(cls, pattern: Pattern, native: NativeModel | None = None) -> CellProblem:
        """Mesh a pattern and set up its native model, the default one if not told."""
        native = native or NativeModel("shell")
        mesh = build_mesh(pattern, native.mesh, native.solid_options)
        return cls(mesh, CellModel.of_pattern(pattern, native))

    def fit_room(self, z: FloatArray, bend: Bend) -> None:
        """Room in the Hessian for contact at z alone: results must not depend on earlier states."""
        if self.pull_back.fit_room(self.embedding.world_map.place(z, bend).y):
            self.build_system()

    def build_system(self) -> None:
        """Analyze the present pattern of nonzeros."""
        pattern = (self.pull_back.indptr, self.pull_back.indices)
        groups = getattr(self.pull_back, "groups", None)
        order = None if groups is None else elimination_order(*pattern, groups)
        factorization = build_factorization(*pattern, self.model.linear_solver, order)
        self.system = ConstrainedSystem(
            factorization,
            self.pull_back.diagonal,
            self.embedding.mean_offset[self.active],
            int(np.searchsorted(self.active, self.embedding.shift_unknown)),
        )

    def bent(self, bend: Bend) -> BentCell:
        """The cell's energy as a function of z under a macroscopic bend."""
        return BentCell(self, bend)

    def flat_bends(self) -> FlatBends:
        """Answers of the flat cell to small bends; its system is left factorized at rest."""
        cell, world_map = self.bent(Bend(0.0, 0.0)), self.embedding.world_map
        state = cell.evaluate(self.embedding.rest)
        blocks = self.pull_back.pair_blocks(state.world.y)
        self.system.factorize(cell.hessian_values(state))
        # kappa_xy counts once: 2 kappa_xy = 1 is half the tensor e1 e2 + e2 e1.
        factors = (1.0, 1.0, 0.5)
        found = world_map.flat_rates(self.embedding.rest)
        rates = [factor * rate for factor, rate in zip(factors, found, strict=True)]
        stressed = [self.pull_back.multiply(blocks, r) for r in rates]
        loads = [world_map.pull_gradient(state.world, s)[self.active] for s in stressed]
        relaxed = [self.system.solve(-load)[0] for load in loads]
        fixed = np.array([[np.sum(rate * force) for force in stressed] for rate in rates])
        return FlatBends(state, rates, fixed, loads, relaxed)

    def display(self) -> Display:
        """What places scales and sheet for pictures."""
        return Display(self.embedding, self.contact)

    def facts_of(self, state: CellState) -> dict[str, Any]:
        """Nothing that joints do not tell as well."""
        return {}


class BentCell:
    """A cell problem under one bend: an `Objective` for `solve.newton`."""

    def __init__(self, problem: CellProblem, bend: Bend) -> None:
        self.problem = problem
        self.bend = bend
        self.active = problem.active
        self.shift_mode = problem.shift_mode
        self.energy_floor = problem.energy_floor

    @property
    def system(self) -> ConstrainedSystem:
        """Linear systems on the present pattern."""
        return self.problem.system

    def evaluate(self, z: FloatArray) -> CellState:
        """Energy and gradient at z; energy is infinite where an element is inverted."""
        problem = self.problem
        world_map = problem.embedding.world_map
        world = world_map.place(z, self.bend)
        energies: list[Energy | ScaleContact] = [*problem.energies]
        if problem.contact is not None:
            energies.append(problem.contact)
        found = [e.energy_parts(world.y) for e in energies]
        found.insert(len(problem.energies), world_map.elastic_parts(z))
        parts = np.concatenate(found)
        forces = np.zeros_like(world.y)
        gradient = np.zeros(len(self.active))
        energy = float(parts.sum())
        if np.isfinite(energy):
            for e in energies:
                e.add_gradient(world.y, forces)
            gradient = world_map.pull_gradient(world, forces)
            world_map.add_elastic_gradient(z, gradient)
            gradient = gradient[self.active]
        return CellState(z, world, parts, energy, forces, gradient)

    def hessian_values(self, state: CellState, project: str = NOTHING) -> FloatArray:
        """(nnz,) upper triangle of d2E/dz2; `project` replaces parts by their positive part."""
        if self.problem.pull_back.cover(state.world.y):
            self.problem.build_system()
        blocks = self.problem.pull_back.pair_blocks(state.world.y, project)
        second = self._second_order(state)
        if project == ALL:
            second = second.positive_part()
        return self.problem.pull_back.hessian(state.world, blocks, state.forces, second)

    def _second_order(self, state: CellState) -> SecondOrder | BodySecondOrder:
        world_map = self.problem.embedding.world_map
        return world_map.second_order(state.z, self.bend, state.world, state.forces)

    def gradient_rate(self, state: CellState) -> FloatArray:
        """(n_active,) d(dE/dz)/dkappa at fixed z."""
        pull_back = self.problem.pull_back
        blocks = pull_back.pair_blocks(state.world.y)
        rate = pull_back.kappa_rate(state.world, blocks, state.forces, self._second_order(state))
        return rate[self.active]

    def free_share(self, state: CellState, trial: CellState) -> float:
        """Share of the straight way from one state to another on which no scales meet."""
        contact = self.problem.contact
        return 1.0 if contact is None else contact.free_share(state.world.y, trial.world.y)

    def keep_apart(self, state: CellState, wanted: FloatArray) -> FloatArray | None:
        """A state near a wanted one to which no scales meet on the way from `state`."""
        return keep_apart(self.problem, state.world.y, wanted, self.bend)

    def steady(self, state: CellState) -> bool:
        """Factorize at a state; whether it is stable, since `keep_apart` needs compliances."""
        return self.problem.system.factorize(self.hessian_values(state)) == 0

    def moment(self, state: CellState) -> float:
        """M = (1/A) dE/dkappa at fixed z [N], exact at equilibrium (envelope theorem)."""
        return float(np.sum(state.forces * state.world.kappa_rate)) / self.problem.area
