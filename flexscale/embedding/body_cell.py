"""The periodic cell whose scales are bodies: its unknowns, and what they place."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.embedding.bends import Bend
from flexscale.embedding.bodies import N_FRAME, Body
from flexscale.embedding.body_map import BodyMap
from flexscale.embedding.cell import CellEmbedding


class BodyCell:
    """Unknowns of a cell: anchor, frame and amplitudes of each scale, then the sheet's and S.

    Parameters
    ----------
    inner : the cell with points and vectors of scales as unknowns.
    bodies : the scales.

    Attributes
    ----------
    As of `CellEmbedding`: mesh, world_map, n_unknowns, rest, active, shift_unknown, mean_offset,
    shift_mode, contact_surface.
    """

    def __init__(self, inner: CellEmbedding, bodies: Sequence[Body]) -> None:
        self.inner, self.mesh = inner, inner.mesh
        self.contact_surface = inner.contact_surface
        self.world_map = BodyMap(inner.world_map, bodies)
        self.n_unknowns = self.world_map.n_unknowns
        n_inner, start = 3 * inner.n_nodes, int(self.world_map.starts[-1])
        held = np.setdiff1d(np.arange(n_inner, inner.n_unknowns), inner.active) - n_inner + start
        self.active = np.setdiff1d(np.arange(self.n_unknowns), [0, 1, *held])
        self.shift_unknown = 2
        rest, offset, shift = [], [], []
        for body in bodies:
            n = body.modes.shape[2]
            rest.append(np.concatenate([body.anchor, [0.0], np.eye(3).ravel(), np.zeros(n)]))
            up = np.zeros(body.n_unknowns)
            up[2] = 1.0
            shift.append(up)
            offset.append(body.share * np.concatenate([up[: -n or None], body.mean_modes]))
        self.rest = self.world_map.join(rest, inner.rest)
        self.mean_offset = self.world_map.join(offset, inner.mean_offset)
        self.shift_mode = self.world_map.join(shift, inner.shift_mode)

    def scale_positions(self, z: FloatArray, bend: Bend) -> FloatArray:
        """(n_scale_vertices, 3) of the home scales in the world, mm."""
        frames = self.world_map.place_bodies(z, bend).frames
        out = np.empty((self.mesh.n_scale_vertices, 3))
        for k, (body, unknowns) in enumerate(
            zip(self.world_map.bodies, self.world_map.split(z), strict=True)
        ):
            places = body.vertex_arms + body.shapes @ unknowns[N_FRAME:]
            out[body.vertices] = frames[4 * k] + places @ frames[4 * k + 1 : 4 * k + 4]
        return out
