"""The tiling families that can be built, at unit tile area, in the pattern's coordinates."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexscale.errors import TilingError, suggest

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Family:
    """One family of Grünbaum and Shephard's list, by its number there.

    Attributes
    ----------
    name : "IH20".
    pattern_name : what its default tile is called, "hexagon".
    tiles : tuple of (n, 2) counterclockwise polygons, one per lattice class, total area 1 per tile.
    lattice : (2, 2) rows t1, t2, right-handed.
    """

    name: str
    pattern_name: str
    tiles: tuple[FloatArray, ...]
    lattice: FloatArray


def _regular_hexagon() -> Family:
    # Neighbors lie at 0°, 60°, …, so the walls' normals do too and the corners stand at 30°, 90°, …
    inradius = math.sqrt(1.0 / (2.0 * math.sqrt(3.0)))
    height = math.sqrt(3.0) * inradius
    half_side = inradius / math.sqrt(3.0)
    corners = [
        (inradius, -half_side),
        (inradius, half_side),
        (0.0, 2.0 * half_side),
        (-inradius, half_side),
        (-inradius, -half_side),
        (0.0, -2.0 * half_side),
    ]
    lattice = np.array([(2.0 * inradius, 0.0), (inradius, height)])
    return Family("IH20", "hexagon", (np.array(corners),), lattice)


def _square() -> Family:
    corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
    return Family("IH76", "square", (np.array(corners),), np.eye(2))


_FAMILIES = {family.name: family for family in (_regular_hexagon(), _square())}


def families() -> tuple[str, ...]:
    """Names of the families that can be built, sorted."""
    return tuple(sorted(_FAMILIES))


def find_family(name: str) -> Family:
    """The family called `name`.

    Raises
    ------
    TilingError : no such family, or one of the 93 whose construction this version does not have.
    """
    if name in _FAMILIES:
        return _FAMILIES[name]
    available = ", ".join(families())
    number = re.fullmatch(r"IH(\d{2})", str(name))
    if number and 1 <= int(number.group(1)) <= 93:
        raise TilingError(
            f"Tiling family {name} is one of the 93 isohedral families, but this version builds "
            f"only {available}: use one of these, or give the tiles with Pattern.from_polygons."
        )
    raise TilingError(
        f"Tiling family {name!r} does not exist: families are called IH01 to IH93, "
        f"and this version builds {available}. {suggest(name, families())}"
    )
