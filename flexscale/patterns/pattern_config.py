"""What `Pattern.from_config` takes: sizes and materials in plain numbers, checked by name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from flexscale.errors import PatternError, shown, suggest
from flexscale.patterns.material import NeoHookean
from flexscale.tilings import Tiling

CUSTOM = "custom"
SIZES = ("gap", "scale_height", "substrate_thickness", "bond_radius")
MATERIALS = ("scale_material", "substrate_material")
_OF_FAMILY, _OF_POLYGONS = ("parameters", "edges", "tile_area"), ("tiles", "lattice", "symmetrize")


def read_config(config: Mapping[str, Any]) -> tuple[Tiling | None, tuple[Any, Any], dict[str, Any]]:
    """The tiling of a family, or tiles and lattice, and the constructor's other parameters.

    Raises
    ------
    PatternError : no dict, an unknown key, or no tiles; see `Tiling` for its parameters.
    """
    if not isinstance(config, Mapping):
        raise PatternError(f"A pattern's configuration must be a dict, not {shown(config)}.")
    values = dict(config)
    family = values.pop("family", CUSTOM)
    if not isinstance(family, str):
        raise PatternError(f"A pattern's family must be a text, not {shown(family)}.")
    known = {"name", *SIZES, *MATERIALS, *(_OF_POLYGONS if family == CUSTOM else _OF_FAMILY)}
    for key in values:
        if key not in known:
            raise PatternError(
                f"A pattern of family {family!r} has no key {key!r}. {suggest(key, sorted(known))}"
            )
    for key in MATERIALS:
        if key in values:
            values[key] = _material(key, values[key])
    if family != CUSTOM:
        tiling = Tiling(family, values.pop("parameters", None), values.pop("edges", None))
        return tiling, (None, None), values
    if not {"tiles", "lattice"} <= values.keys():
        raise PatternError("A custom pattern needs the keys 'tiles' and 'lattice'.")
    tiles, lattice = values.pop("tiles"), values.pop("lattice")
    if not isinstance(lattice, list | tuple | np.ndarray) or len(lattice) != 2:
        raise PatternError("The key 'lattice' of a custom pattern must hold two vectors in mm.")
    return None, (tiles, lattice), values


def _material(key: str, given: Any) -> NeoHookean:
    """A material as `Pattern.to_config` writes it."""
    if isinstance(given, NeoHookean):
        return given
    if not isinstance(given, Mapping) or set(given) != {"young_modulus", "poisson_ratio"}:
        raise PatternError(
            f"{key} must have exactly the keys 'young_modulus' (MPa) and 'poisson_ratio', "
            f"not {shown(given)}."
        )
    return NeoHookean(**given)
