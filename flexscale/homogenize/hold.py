"""How a problem is held: which scales are anchored where, what may move, what touches.

A problem is unknowns, energies, contact, and a hold. The periodic cell's is here; those of finite
sheets are in `finite`.
"""

from __future__ import annotations

from typing import Protocol

from flexscale.arrays import IntArray
from flexscale.embedding.bodies import Body
from flexscale.embedding.body_cell import BodyCell
from flexscale.embedding.cell import CellEmbedding
from flexscale.homogenize.cell_model import CellModel
from flexscale.homogenize.scale_modes import build_bodies, build_rigid_bodies
from flexscale.mechanics.contact import ContactSurface

Embedding = CellEmbedding | BodyCell


class Hold(Protocol):
    """How a problem is held.

    Attributes
    ----------
    floats : whether nothing but a constraint holds the mean normal displacement.
    """

    floats: bool

    def area(self, inner: CellEmbedding) -> float:
        """Rest area, mm2, to which energy densities and moments refer."""

    def bodies(self, inner: CellEmbedding, model: CellModel) -> list[Body]:
        """The scales, anchored as they are held."""

    def surface(self, inner: CellEmbedding) -> ContactSurface | None:
        """What contact sees; None without."""

    def active(self, embedding: Embedding) -> IntArray:
        """Indices of the unknowns that are sought."""


class Periodic:
    """The periodic cell: nothing is held but what would move it as a whole."""

    floats = True

    def area(self, inner: CellEmbedding) -> float:
        """That of the cell."""
        return inner.mesh.cell_area

    def bodies(self, inner: CellEmbedding, model: CellModel) -> list[Body]:
        """The scales as they are."""
        if model.scales.model == "rigid":
            return build_rigid_bodies(inner, model.scale_material, model.rigid_stiffness)
        return build_bodies(inner, model.scale_material, model.sheet_support, model.scales.cutoff)

    def surface(self, inner: CellEmbedding) -> ContactSurface | None:
        """All surfaces of scales."""
        return inner.contact_surface

    def active(self, embedding: Embedding) -> IntArray:
        """All that the embedding leaves free."""
        return embedding.active
