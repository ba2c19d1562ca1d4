"""Sizes of the elements of a solid substrate, besides those along the gap and of the scales."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from flexscale.checks import checked, length, number
from flexscale.errors import MeshError
from flexscale.mesh.options import MOST_GROWTH, MeshOptions

MOST_ROWS = 32  # across half a gap, or layers, or strips
STRIPS_REACH = 2.0  # thicknesses, from the outline inward: deeper, the sheet hardly strains


@checked(
    edge=length("solid option edge"),
    growth=number("1", 1.0, MOST_GROWTH, above=0.0, name="solid option growth"),
)
@dataclass(frozen=True)
class SolidOptions:
    """How a solid substrate is graded towards the edge of its bond to the scales.

    Attributes
    ----------
    edge : mm, size of the elements at the scales' outlines: across the gap, under the scales, and
        downward.
    growth : ratio of neighboring sizes away from there, at least 1.
    """

    edge: float = 0.03
    growth: float = 2.0

    def to_config(self) -> dict[str, Any]:
        """The options as plain numbers; `SolidOptions(**config)` makes them again."""
        return asdict(self)

    def finer(self, factor: float) -> SolidOptions:
        """Options with all elements smaller by `factor`, graded over the same distances."""
        return SolidOptions(self.edge / factor, self.growth ** (1.0 / factor))

    def n_rows(self, width: float) -> int:
        """Rows of elements in a width, mm, of which none is wider than these options ask for.

        Raises
        ------
        MeshError : they are more than `MOST_ROWS`.
        """
        sizes = self.edge * self.growth ** np.arange(MOST_ROWS)
        n = int(np.searchsorted(np.cumsum(sizes), width * (1.0 - 1e-9))) + 1
        if n > MOST_ROWS:
            raise MeshError(
                f"The solid substrate would have more than {MOST_ROWS} rows of elements in "
                f"{width:g} mm: give a larger solid option `edge` (now {self.edge:g} mm) or "
                f"`growth` (now {self.growth:g})."
            )
        return n

    def in_plane(self, mesh: MeshOptions, gap: float) -> MeshOptions:
        """Sizes of the sheet's mesh, for a gap in mm."""
        return replace(mesh, across=2 * self.n_rows(0.5 * gap), across_grading=self.growth)

    def under_scales(self, mesh: MeshOptions, thickness: float) -> MeshOptions:
        """Sizes of the sheet's mesh under the scales, in the terms of a scale's base."""
        return replace(
            mesh,
            scale_rim=self.edge,
            scale_strips=self.n_rows(STRIPS_REACH * thickness),
            scale_growth=self.growth,
        )
