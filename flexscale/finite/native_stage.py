"""A rectangular sheet of the native model between two hinges that come closer (Figs. 10, 11).

The sheet lies in the world as it is: unknowns are those of the cell under no bend, where
curvilinear coordinates are the world's, and scales turn as far as they like. Scales that an end
cuts are one strip, a body of its own with its anchor on the hinge, the line x = 0 or x = length at
the sheet's midsurface. The hinge's line stays straight and as long as it is: of the strip's frame
g_2 is held along it, and g_1, g_3 stay normal to it. What is left to the strip is its turn about
the line, and the strain in its section, of which hard scales have next to none. Where the sheet
itself reaches the end, its nodes lie on the line too, and turn freely.

Both hinges keep their height, and the near one its place. The far one hangs on a machine: a spring
of stiffness k [N/mm] to each of its points, in x. With a k that is huge it is where the machine is;
a softer one lets it follow while scales make room for each other. The machine's place x_m =
length - shortening sets the state, and the force that presses on the hinges is, at equilibrium,

    F = dE/d(shortening) = -sum over the far points dE/dx.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.bodies import N_FRAME, Body
from flexscale.embedding.body_cell import BodyCell
from flexscale.embedding.cell import CellEmbedding
from flexscale.embedding.curvature_map import GRADIENT, POSITION, Bend, place_images
from flexscale.finite.finite_sheet import FiniteHold, FiniteSheet
from flexscale.homogenize.cell_model import CellModel
from flexscale.homogenize.cell_problem import BentCell, CellState
from flexscale.homogenize.hold import Embedding
from flexscale.homogenize.native_model import NativeModel
from flexscale.homogenize.scale_modes import build_bodies
from flexscale.mechanics.energy import NOTHING
from flexscale.mesh.finite import strips
from flexscale.mesh.periodic_mesh import FREE
from flexscale.patterns import Pattern
from flexscale.patterns.clipped import SheetTiles

FLAT = Bend(0.0, 0.0)
_HELD = (0, 1, 2, 4, 6, 7, 8, 10)  # unknowns of a strip that its hinge holds
_TURNING = (3, 5, 9, 11)
_ON_LINE = 1e-6  # share of the length
_HARD = 1e8  # the far hinge is off its place by far less than what matters, and more than rounding


@dataclass(frozen=True)
class Machine:
    """What carries the far hinge.

    Attributes
    ----------
    place : mm, x where its springs are slack.
    stiffness : N/mm, of the spring to each point of the hinge.
    """

    place: float
    stiffness: float


class Hinges(FiniteHold):
    """Scales that an end cuts are one strip, which turns about the end's line.

    Attributes
    ----------
    far : indices in z of the x of all points of the far hinge, once `active` was asked for.
    turning : indices in z of what turns about the hinges, likewise.
    """

    far: IntArray
    turning: IntArray

    def bodies(self, inner: CellEmbedding, model: CellModel) -> list[Body]:
        """The scales, and the strips, anchored on their hinges."""
        ends = (0.0, self.tiles.length)
        hinged = {k: x for k, x in zip(strips(self.tiles), ends, strict=True) if k >= 0}
        bodies = build_bodies(
            inner, model.scale_material, model.sheet_support, model.scales.cutoff, hinged
        )
        middle, unlifted = 0.5 * self.tiles.width, np.zeros((2, 2))
        for k, x in hinged.items():
            anchored = bodies[k].anchored(np.array([x, middle]))
            bodies[k] = replace(anchored, second_moment=unlifted)
        return bodies

    def active(self, embedding: Embedding) -> IntArray:
        """All but the hinges', what no element depends on, and the lattice's strain."""
        assert isinstance(embedding, BodyCell)
        inner, mesh = embedding.inner, embedding.mesh
        starts = embedding.world_map.starts
        free = self.used(embedding)
        to_z = int(starts[-1]) - 3 * inner.n_nodes
        far: list[int] = []
        turning: list[int] = []
        for strip, x in zip(strips(self.tiles), (0.0, self.tiles.length), strict=True):
            on_line = np.abs(mesh.positions[:, 0] - x) < _ON_LINE * self.tiles.length
            nodes = inner.vertex_node[on_line & (mesh.vertex_kind == FREE)] + to_z
            nodes = nodes[free[nodes]]
            points = list(nodes)
            # Of a node's x, x_u, x_v the hinge holds the first and the last.
            free[nodes[:, None] + np.array([0, 1, 2, 6, 7, 8])] = False
            turning += (nodes[:, None] + np.array([3, 4, 5])).ravel().tolist()
            if strip >= 0:
                points.append(starts[strip])
                free[starts[strip] + np.array(_HELD)] = False
                turning += (starts[strip] + np.array(_TURNING)).tolist()
            far = points
        self.far, self.turning = np.array(far, dtype=np.int64), np.array(turning, dtype=np.int64)
        free[self.far] = True
        free[-3:] = False
        return np.flatnonzero(free)


class NativeStage(FiniteSheet):
    """A sheet of whole and cut scales between two hinges.

    Parameters
    ----------
    pattern : the scale pattern.
    tiles : the pattern on the sheet, not glued.
    native : as of a `FiniteSheet`.

    Attributes
    ----------
    far : indices in z of the x of all points of the far hinge.
    turning : indices in z of what turns about the hinges.
    far_active : their places among the active unknowns.
    hard : N/mm, stiffness of a machine beside which the sheet is nothing.
    """

    def __init__(
        self, pattern: Pattern, tiles: SheetTiles, native: NativeModel | None = None
    ) -> None:
        hold = Hinges(tiles)
        super().__init__(pattern, tiles, hold, native)
        self.far, self.turning = hold.far, hold.turning
        self.far_active = np.searchsorted(self.active, self.far)
        model = self.model
        gaps = model.substrate_material.young_modulus * model.substrate_thickness / model.gap
        self.hard = _HARD * gaps * tiles.width

    def carried(self, shortening: float, stiffness: float) -> CarriedSheet:
        """The sheet with its far hinge on a machine that has come closer by so much [mm]."""
        return CarriedSheet(self, Machine(self.tiles.length - shortening, stiffness))

    def moved(self, z: FloatArray, shortening: float) -> FloatArray:
        """z with the far hinge where it belongs at a shortening [mm]."""
        out = z.copy()
        out[self.far] = self.tiles.length - shortening
        return out

    def force(self, state: CellState) -> float:
        """F = dE/d(shortening) [N], of the sheet's energy alone."""
        world_map = self.embedding.world_map
        gradient = world_map.pull_gradient(state.world, state.forces)
        return -float(gradient[self.far].sum())

    def bend_rate(self) -> FloatArray:
        """(n_unknowns,) dz/dkappa of the flat sheet whose ends turn with a cylinder, and slide."""
        flat = self.bent(FLAT)
        state = flat.evaluate(self.embedding.rest)
        values = flat.hessian_values(state)
        values[self.pull_back.diagonal[np.searchsorted(self.active, self.turning)]] += self.hard
        self.system.factorize(values)
        rate = np.zeros_like(state.z)
        rate[self.active], _ = self.system.solve(-flat.gradient_rate(state))
        return rate

    def arc(self, rate: FloatArray, shortening: float, sign: float) -> FloatArray:
        """z of the sheet on a circular arc with its ends as far apart as the hinges.

        rate : `bend_rate`, which tells how scales and gaps share the bend.
        sign : +1 for closing, -1 for opening.
        """
        length, slide = self.tiles.length, float(rate[self.far].mean())

        def chord(turn: float) -> float:
            return (length + sign * turn / length * slide) * float(np.sinc(0.5 * turn / np.pi))

        turn = brentq(lambda turn: chord(turn) - length + shortening, 0.0, 2.0 * np.pi)
        bend = Bend(sign * turn / length, 0.0)
        bent = self.embedding.rest + bend.curvature * rate
        cosine, sine = np.cos(0.5 * turn), sign * np.sin(0.5 * turn)
        to_chord = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
        z = self.uncurled(bent, bend, to_chord)
        held = np.setdiff1d(np.arange(len(z)), self.active)
        z[held] = self.embedding.rest[held]
        return self.moved(z, shortening)

    def uncurled(self, bent: FloatArray, bend: Bend, turn: FloatArray) -> FloatArray:
        """z under no bend of the state in the world that `bent` is under a bend, turned by a
        rotation (3, 3)."""
        cell, z = self.embedding, bent.copy()
        starts = cell.world_map.starts
        frames = cell.world_map.place_bodies(bent, bend).frames @ turn.T
        for k, start in enumerate(starts[:-1]):
            z[start : start + N_FRAME] = frames[4 * k : 4 * k + 4].ravel()
        images = cell.inner.world_map.images
        of_sheet = np.isin(images.kinds, (POSITION, GRADIENT))
        nodes = images.nodes[of_sheet] + int(starts[-1]) - 3 * cell.inner.n_nodes
        n = len(nodes)
        vectors, jacobian, kappa_rate = np.empty((n, 3)), np.empty((n, 3, 6)), np.empty((n, 3))
        place_images(
            bent, bend.curvature, bend.direction, images.kinds[of_sheet], nodes,
            images.shifts[of_sheet], images.anchors[of_sheet], vectors, jacobian, kappa_rate,
        )  # fmt: skip
        z[nodes[:, None] + np.arange(3)] = vectors @ turn.T
        return z

    def deflection(self, z: FloatArray) -> float:
        """Height [mm] of the middle of the sheet over the line between the hinges."""
        tiles, mesh, cell = self.tiles, self.mesh, self.embedding
        apart = mesh.positions - 0.5 * np.array([tiles.length, tiles.width])
        vertex = int(np.argmin((apart**2).sum(axis=1)))
        scale = int(mesh.vertex_scale[vertex])
        starts = cell.world_map.starts
        if scale < 0:
            to_z = int(starts[-1]) - 3 * cell.inner.n_nodes
            return float(z[cell.inner.vertex_node[vertex] + to_z + 2])
        arm = mesh.positions[vertex] - self.bodies[scale].anchor
        up = z[starts[scale] + 2 : starts[scale] + N_FRAME : 3]
        return float(up[0] + arm @ up[1:3])


class CarriedSheet(BentCell):
    """Energy of a sheet and of the machine that carries its far hinge: an `Objective`."""

    problem: NativeStage

    def __init__(self, problem: NativeStage, machine: Machine) -> None:
        super().__init__(problem, FLAT)
        self.machine = machine

    def evaluate(self, z: FloatArray) -> CellState:
        """Energy and gradient at z, the machine's included; `parts` are the sheet's."""
        state, stage = super().evaluate(z), self.problem
        apart = z[stage.far] - self.machine.place
        gradient = state.gradient.copy()
        gradient[stage.far_active] += self.machine.stiffness * apart
        energy = state.energy + 0.5 * self.machine.stiffness * float(apart @ apart)
        return replace(state, energy=energy, gradient=gradient)

    def hessian_values(self, state: CellState, project: str = NOTHING) -> FloatArray:
        """(nnz,) upper triangle of the second derivatives."""
        values = super().hessian_values(state, project)
        values[self.problem.pull_back.diagonal[self.problem.far_active]] += self.machine.stiffness
        return values

    def rate(self, state: CellState) -> FloatArray:
        """(n_unknowns,) dz/d(shortening) at an equilibrium: one factorization."""
        stage, system = self.problem, self.system
        system.factorize(self.hessian_values(state))
        push = np.zeros(len(self.active))
        push[stage.far_active] = -self.machine.stiffness
        out = np.zeros_like(state.z)
        out[self.active], _ = self.system.solve(push)
        return out
