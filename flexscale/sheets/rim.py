"""A disc on the mandrel: its sizes, and where its rim has vertices to push."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexscale.errors import BadInputError
from flexscale.mesh.sheet import SheetMesh, disc
from flexscale.units import require_positive

#: mm, radius of the hub that holds the disc; the paper gives none.
HUB = 10.0
ANGLES = tuple(15.0 * k for k in range(24))  # degree, around the rim, if nothing else is said
# The rim has six vertices a ring: rings in fours give it one every 15 degrees or more often.
_RINGS = 4
_CLOSE = 1e-6  # degree between an angle and a vertex; share of the hub's radius


@dataclass(frozen=True)
class Rim:
    """Sizes of a disc in rings of triangles.

    Attributes
    ----------
    radius, hub : mm.
    size : mm, sides of the triangles; rings come in fours, of the number closest to it.

    Raises
    ------
    UnitRangeError : a size that is not positive.
    BadInputError : a hub that leaves nothing of the disc.
    """

    radius: float = 100.0
    hub: float = HUB
    size: float = 5.0

    def __post_init__(self) -> None:
        require_positive(self.radius, "disc radius", "mm")
        require_positive(self.hub, "hub radius", "mm")
        require_positive(self.size, "element size", "mm")
        if self.hub > self.radius * (1.0 - 0.5 / self.rings):
            raise BadInputError(
                f"A hub of {self.hub:.12g} mm and triangles of {self.radius / self.rings:.4g} mm "
                f"leave nothing of a disc of {self.radius:.12g} mm to push: make them smaller."
            )

    @property
    def rings(self) -> int:
        """Number of rings of triangles."""
        return _RINGS * max(1, round(self.radius / (_RINGS * self.size)))

    @property
    def n_vertices(self) -> int:
        """Number of vertices of the rim."""
        return 6 * self.rings

    def mesh(self) -> SheetMesh:
        """The disc outside of its hub; the rim's vertices come last, from 0 degree on."""
        whole = disc(self.radius, self.rings, self.hub)
        # Vertices come from the middle outward, so what lies in the hub comes first.
        inside = np.hypot(*whole.points.T) < self.hub * (1.0 - _CLOSE)
        kept = ~inside[whole.triangles].any(axis=1)
        n_inside = int(inside.sum())
        return SheetMesh(whole.points[n_inside:], whole.triangles[kept] - n_inside)

    def place(self, angle: float) -> int:
        """Which vertex of the rim is at an angle [degree], counted from 0 degree.

        Raises
        ------
        BadInputError : none is there.
        """
        spacing = 360.0 / self.n_vertices
        nearest = round(angle / spacing)
        if abs(nearest * spacing - angle) > _CLOSE:
            raise BadInputError(
                f"The rim has no vertex to push at {angle:.12g} degree: triangles of "
                f"{self.radius / self.rings:.6g} mm put one every {spacing:.6g} degree; take "
                "multiples of that, or another element size."
            )
        return nearest % self.n_vertices

    def require_indentation(self, indentation: float) -> float:
        """Return the indentation [mm], or refuse one out of range.

        Raises
        ------
        UnitRangeError : not positive and finite.
        BadInputError : the disc would have to bend by more than a right angle.
        """
        if require_positive(indentation, "indentation", "mm") >= self.radius - self.hub:
            raise BadInputError(
                f"An indentation of {indentation:.12g} mm bends a disc of {self.radius:.12g} mm on "
                f"a hub of {self.hub:.12g} mm by more than a right angle: stay below "
                f"{self.radius - self.hub:.6g} mm."
            )
        return float(indentation)
