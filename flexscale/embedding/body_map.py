"""World vectors of a cell whose scales are bodies: z -> points and vectors of the bodies -> y.

The inner map takes the bodies' points and vectors in the world as unknowns (`PointNodes`); here
they follow from the anchors, frames and amplitudes of the bodies. The unknowns z are those of each
body (p, g_1, g_2, g_3, q), then those of the sheet and S as in the inner map.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.embedding.bends import Bend
from flexscale.embedding.bodies import N_FRAME, Body
from flexscale.embedding.curvature_map import (
    GRADIENT,
    POSITION,
    ImageVectors,
    curve_images,
    flat_curvature_rates,
    place_images,
)
from flexscale.embedding.world_map import SecondOrder, World, WorldMap, positive_part


@dataclass(frozen=True)
class PlacedBodies:
    """The bodies' frames, and their points and vectors, in the world.

    Attributes
    ----------
    frames : (4 n_bodies, 3) p, g_1, g_2, g_3 of each; frame_jacobian (4 n_bodies, 3, 3) in their
        home unknowns; frame_rate (4 n_bodies, 3) by kappa.
    points : (n_points, 3) of all bodies; point_rate (n_points, 3) by kappa.
    jacobians : (3 m, n_unknowns) of each body's points.
    """

    frames: FloatArray
    frame_jacobian: FloatArray
    frame_rate: FloatArray
    points: FloatArray
    point_rate: FloatArray
    jacobians: tuple[FloatArray, ...]


@dataclass(frozen=True)
class BodyWorld:
    """World vectors at a state, as of `WorldMap`, with the bodies they come from.

    Attributes
    ----------
    y, kappa_rate : (n_rows, 3), the latter at fixed z.
    inner : of the inner map; its `kappa_rate` and `image_kappa_rate` are at fixed z too.
    bodies : in the world.
    zeta : unknowns of the inner map.
    """

    y: FloatArray
    kappa_rate: FloatArray
    inner: World
    bodies: PlacedBodies
    zeta: FloatArray


@dataclass(frozen=True)
class BodySecondOrder:
    """Second derivatives of the map contracted with forces, and of the bodies' elastic energies.

    Attributes
    ----------
    inner : of the inner map.
    blocks : (n_unknowns, n_unknowns) of each body, with its elastic Hessian.
    mixed : (n_unknowns,) of each body, with kappa.
    """

    inner: SecondOrder
    blocks: tuple[FloatArray, ...]
    mixed: tuple[FloatArray, ...]

    def positive_part(self) -> BodySecondOrder:
        """Without directions of negative curvature, block by block."""
        blocks = tuple(positive_part(block[None])[0] for block in self.blocks)
        return replace(self, inner=self.inner.positive_part(), blocks=blocks)


class BodyMap:
    """The map z -> y of a periodic cell with bodies.

    Parameters
    ----------
    inner : map from points and vectors of the bodies, sheet and S.
    bodies : scales, in the order of their points in the inner map.

    Attributes
    ----------
    n_unknowns : length of z; starts : (n_bodies + 1,) where each body's unknowns begin, the last
        one where the sheet's do.
    """

    def __init__(self, inner: WorldMap, bodies: Sequence[Body]) -> None:
        self.inner, self.bodies = inner, tuple(bodies)
        counts = [body.n_unknowns for body in self.bodies]
        self.starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
        points = [body.n_points for body in self.bodies]
        self.point_starts = np.concatenate([[0], np.cumsum(points)]).astype(np.int64)
        self.n_unknowns = int(self.starts[-1] + inner.n_unknowns - 3 * self.point_starts[-1])
        n = len(self.bodies)
        nodes = self.starts[:-1, None] + 3 * np.arange(4)
        anchors = np.repeat([body.anchor for body in self.bodies], 4, axis=0)
        kinds = np.tile([POSITION, GRADIENT, GRADIENT, GRADIENT], n)
        self._frames = ImageVectors(kinds, nodes.ravel(), np.zeros((4 * n, 2)), anchors)

    @property
    def n_rows(self) -> int:
        """Number of world vectors."""
        return self.inner.n_rows

    def split(self, z: FloatArray) -> list[FloatArray]:
        """The unknowns of each body."""
        return [z[a:b] for a, b in zip(self.starts[:-1], self.starts[1:], strict=True)]

    def join(self, bodies: Sequence[FloatArray], zeta: FloatArray) -> FloatArray:
        """(n_unknowns,) of the bodies' parts and of the sheet's in the inner map's order."""
        return np.concatenate([*bodies, zeta[3 * self.point_starts[-1] :]])

    def elastic_parts(self, z: FloatArray) -> FloatArray:
        """(1,) elastic energy of all bodies, N mm."""
        pairs = zip(self.bodies, self.split(z), strict=True)
        return np.array([sum(body.energy(unknowns) for body, unknowns in pairs)])

    def add_elastic_gradient(self, z: FloatArray, gradient: FloatArray) -> None:
        """Add the derivatives of the elastic energy to `gradient (n_unknowns,)`."""
        for k, (body, unknowns) in enumerate(zip(self.bodies, self.split(z), strict=True)):
            gradient[self.starts[k] : self.starts[k + 1]] += body.gradient(unknowns)

    def _lifts(self, bend: Bend) -> FloatArray:
        """(4 n_bodies,) rate of w3 of p with kappa, 0 for the frame's vectors."""
        n = np.array([np.cos(bend.direction), np.sin(bend.direction)])
        lifts = np.zeros((len(self.bodies), 4))
        lifts[:, 0] = [0.5 * n @ body.second_moment @ n for body in self.bodies]
        return lifts.ravel()

    def _frame_arguments(self, z: FloatArray, bend: Bend) -> tuple:
        lifted = z.copy()
        lifted[self._frames.nodes + 2] += bend.curvature * self._lifts(bend)
        f = self._frames
        return (lifted, bend.curvature, bend.direction, f.kinds, f.nodes, f.shifts, f.anchors)

    def place_bodies(self, z: FloatArray, bend: Bend) -> PlacedBodies:
        """Frames, points and vectors of the bodies in the world."""
        n = len(self._frames.kinds)
        frames, jacobian, rate = np.empty((n, 3)), np.empty((n, 3, 6)), np.empty((n, 3))
        place_images(*self._frame_arguments(z, bend), frames, jacobian, rate)
        jacobian = jacobian[:, :, :3]
        rate += jacobian[:, :, 2] * self._lifts(bend)[:, None]
        points, rates, jacobians = [], [], []
        for k, (body, unknowns) in enumerate(zip(self.bodies, self.split(z), strict=True)):
            four = slice(4 * k, 4 * k + 4)
            coefficients = np.column_stack([body.is_point, body.places(unknowns[N_FRAME:])])
            points.append(coefficients @ frames[four])
            rates.append(coefficients @ rate[four])
            whole = np.empty((body.n_points, 3, body.n_unknowns))
            whole[:, :, :N_FRAME] = np.einsum("ja,acd->jcad", coefficients, jacobian[four]).reshape(
                body.n_points, 3, N_FRAME
            )
            whole[:, :, N_FRAME:] = np.tensordot(
                frames[four][1:].T, body.modes, axes=(1, 1)
            ).transpose(1, 0, 2)
            jacobians.append(whole.reshape(3 * body.n_points, -1))
        return PlacedBodies(
            frames, jacobian, rate, np.concatenate(points), np.concatenate(rates), tuple(jacobians)
        )

    def place(self, z: FloatArray, bend: Bend) -> BodyWorld:
        """World vectors and first derivatives at state z under `bend`."""
        placed = self.place_bodies(z, bend)
        zeta = np.concatenate([placed.points.ravel(), z[self.starts[-1] :]])
        inner = self.inner.place(zeta, bend)
        zeta_rate = np.zeros_like(zeta)
        zeta_rate[: 3 * self.point_starts[-1]] = placed.point_rate.ravel()
        home = zeta_rate[self.inner.images.nodes[:, None] + np.arange(3)]
        image_rate = inner.image_kappa_rate + np.einsum(
            "ncd,nd->nc", inner.image_jacobian[:, :, :3], home
        )
        rate = self.inner.combine(zeta, image_rate)
        inner = replace(inner, kappa_rate=rate, image_kappa_rate=image_rate)
        return BodyWorld(inner.y, rate, inner, placed, zeta)

    def pull_zeta(self, world: BodyWorld, gradient: FloatArray) -> FloatArray:
        """(n_unknowns,) dE/dz from dE/dzeta."""
        parts = []
        for k, jacobian in enumerate(world.bodies.jacobians):
            a, b = 3 * self.point_starts[k], 3 * self.point_starts[k + 1]
            parts.append(jacobian.T @ gradient[a:b])
        return self.join(parts, gradient)

    def pull_gradient(self, world: BodyWorld, forces: FloatArray) -> FloatArray:
        """(n_unknowns,) dE/dz for forces dE/dy (n_rows, 3)."""
        return self.pull_zeta(world, self.inner.pull_gradient(world.inner, forces))

    def second_order(
        self, z: FloatArray, bend: Bend, world: BodyWorld, forces: FloatArray
    ) -> BodySecondOrder:
        """forces . d2y, and the Hessians of the bodies' elastic energies."""
        inner = self.inner.second_order(world.zeta, bend, world.inner, forces)
        on_points = self.inner.pull_gradient(world.inner, forces)[: 3 * self.point_starts[-1]]
        on_points = on_points.reshape(-1, 3)
        # Bodies move under kappa at fixed z: so does the home of their images.
        rate = np.zeros_like(world.zeta)
        rate[: on_points.size] = world.bodies.point_rate.ravel()
        home = rate[self.inner.images.nodes[:, None] + np.arange(3)]
        mixed = inner.mixed + np.einsum("nij,nj->ni", inner.hessian[:, :, :3], home)
        inner = replace(inner, mixed=mixed)
        on_frames = np.empty((4 * len(self.bodies), 3))
        moments = []
        for k, (body, unknowns) in enumerate(zip(self.bodies, self.split(z), strict=True)):
            part = on_points[self.point_starts[k] : self.point_starts[k + 1]]
            on_frames[4 * k] = body.is_point @ part
            on_frames[4 * k + 1 : 4 * k + 4] = body.places(unknowns[N_FRAME:]).T @ part
            moments.append(np.tensordot(part, body.modes, axes=(0, 0)))  # (3 world, 3 frame, n)
        n = len(on_frames)
        hessian, frame_mixed = np.empty((n, 6, 6)), np.empty((n, 6))
        curve_images(*self._frame_arguments(z, bend), on_frames, hessian, frame_mixed)
        frame_mixed += hessian[:, :, 2] * self._lifts(bend)[:, None]
        blocks, mixes = [], []
        for k, moment in enumerate(moments):
            body = self.bodies[k]
            block = body.hessian(z[self.starts[k] : self.starts[k + 1]])
            mix = np.zeros(len(block))
            for a in range(4):
                own = slice(3 * a, 3 * a + 3)
                block[own, own] += hessian[4 * k + a, :3, :3]
                mix[own] = frame_mixed[4 * k + a, :3]
                if a > 0:
                    turned = world.bodies.frame_jacobian[4 * k + a].T @ moment[:, a - 1]
                    block[own, N_FRAME:] += turned
                    block[N_FRAME:, own] += turned.T
                    mix[N_FRAME:] += world.bodies.frame_rate[4 * k + a] @ moment[:, a - 1]
            blocks.append(block)
            mixes.append(mix)
        return BodySecondOrder(inner, tuple(blocks), tuple(mixes))

    def flat_rates(self, z: FloatArray) -> list[FloatArray]:
        """Three (n_rows, 3): derivatives of y at the flat rest state by unit kappa_xx, kappa_yy,
        and kappa_xy."""
        frames = flat_curvature_rates(self._frames, z)
        tensors = ((0, 0), (1, 1), (0, 1))
        for k, (i, j) in enumerate(tensors):
            moments = [body.second_moment[i, j] for body in self.bodies]
            frames[k, ::4, 2] += (0.5 if i == j else 1.0) * np.array(moments)
        zeta = np.concatenate(
            [self.place_bodies(z, Bend(0.0, 0.0)).points.ravel(), z[self.starts[-1] :]]
        )
        images = self.inner.images
        rates = flat_curvature_rates(images, zeta)
        found = []
        for k in range(3):
            zeta_rate = np.zeros_like(zeta)
            points = [
                np.column_stack([body.is_point, body.arms]) @ frames[k, 4 * i : 4 * i + 4]
                for i, body in enumerate(self.bodies)
            ]
            zeta_rate[: 3 * self.point_starts[-1]] = np.concatenate(points).ravel()
            # At rest the images of bodies are moved copies of them.
            home = zeta_rate[images.nodes[:, None] + np.arange(3)]
            found.append(self.inner.combine(zeta, rates[k] + home))
        return found
