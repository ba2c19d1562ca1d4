"""A tiling: a family, its shape parameters and the curves on its edges."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexscale.errors import TilingError
from flexscale.tilings.families import find_family

FloatArray = NDArray[np.float64]


class Tiling:
    """One member of a tiling family, with tiles of area 1.

    Parameters
    ----------
    family : "IH20" (regular hexagon) or "IH76" (square); see `families`.
    parameters : free shape parameters of the family; these two families have none.
    edges : edge class -> (n, 2) curve from (0, 0) to (1, 0); the edges of these two families lie
        on mirrors of the tiling and stay straight.

    Attributes
    ----------
    family, parameters, edges : as given, checked.
    pattern_name : name of the shape, "hexagon".
    tiles : tuple of (n, 2) counterclockwise polygons, one per lattice class.
    lattice : (2, 2) rows t1, t2, right-handed.

    Raises
    ------
    TilingError : unknown family, or parameters or edges that the family does not have.
    """

    def __init__(
        self,
        family: str,
        parameters: Sequence[float] | None = None,
        edges: Mapping[str, Any] | None = None,
    ) -> None:
        known = find_family(family)
        given = () if parameters is None else tuple(float(value) for value in parameters)
        if given:
            raise TilingError(
                f"Tiling family {family} has no free shape parameters, but {len(given)} were "
                "given: leave `parameters` out."
            )
        if edges:
            raise TilingError(
                f"The edges of tiling family {family} lie on mirrors and are straight, but curves "
                f"were given for {', '.join(map(repr, edges))}: leave `edges` out."
            )
        self.family: str = known.name
        self.pattern_name: str = known.pattern_name
        self.parameters: tuple[float, ...] = given
        self.edges: dict[str, FloatArray] = {}
        self.tiles: tuple[FloatArray, ...] = known.tiles
        self.lattice: FloatArray = known.lattice

    def __repr__(self) -> str:
        return f"Tiling({self.family!r})"
