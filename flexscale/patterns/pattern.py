"""A scale pattern: tiles on a lattice, the gap between their scales, sizes and materials."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from flexscale.errors import PatternError, suggest
from flexscale.patterns.cell import TiledCell, build_cell
from flexscale.patterns.material import PETG, TPU, NeoHookean
from flexscale.patterns.outlines import scale_outline
from flexscale.patterns.symmetry import BoolArray, FloatArray, Isometry, polygon_isometries
from flexscale.tilings import Tiling
from flexscale.units import require_positive

CUSTOM = "custom"


@dataclass(frozen=True)
class Prototile:
    """One shape of tile, as it is copied about.

    Attributes
    ----------
    polygon : (n, 2) counterclockwise corners, all tiling vertices included, mm.
    sharp : (n,) flags of corners that deserve small elements.
    stabiliser : isometries that carry the tile onto itself, the identity first.
    outline : (m, 2) counterclockwise outline of its scale, mm.
    """

    polygon: FloatArray
    sharp: BoolArray
    stabiliser: tuple[Isometry, ...]
    outline: FloatArray


@dataclass(frozen=True)
class TileCopy:
    """A tile of the cell: which prototile, and the isometry that carries it there."""

    prototile: int
    placement: Isometry


class Pattern:
    """A periodic pattern of scales on a sheet. Immutable; `with_` makes changed copies.

    Parameters
    ----------
    tiling : the tiling whose tiles carry the scales.
    tile_area : mm², mean area of a tile.
    gap : mm, width of the gap between neighboring scales.
    scale_height : mm.
    substrate_thickness : mm.
    scale_material, substrate_material : Neo-Hookean solids.
    name : what to call the pattern; the tiling's own name ("hexagon") if not given.

    Attributes
    ----------
    family : "IH20", "IH76" or "custom".
    tiles : tuple of (n_i, 2) counterclockwise polygons, mm, one per lattice class. Every vertex of
        the tiling is a corner, also one in the middle of a straight edge.
    lattice : (2, 2) rows t1, t2, right-handed, mm.
    prototiles, copies : the tiles up to congruence, and where each tile of `tiles` comes from.

    Raises
    ------
    PatternError : polygons or gap do not make a pattern.
    UnitRangeError : a size or modulus is out of its range.
    """

    name: str
    family: str
    tiling: Tiling | None
    tile_area: float
    gap: float
    scale_height: float
    substrate_thickness: float
    scale_material: NeoHookean
    substrate_material: NeoHookean
    tiles: tuple[FloatArray, ...]
    lattice: FloatArray
    prototiles: tuple[Prototile, ...]
    copies: tuple[TileCopy, ...]

    def __init__(
        self,
        tiling: Tiling,
        *,
        tile_area: float = 100.0,
        gap: float = 0.4,
        scale_height: float = 4.0,
        substrate_thickness: float = 0.4,
        scale_material: NeoHookean = PETG,
        substrate_material: NeoHookean = TPU,
        name: str | None = None,
    ) -> None:
        if not isinstance(tiling, Tiling):
            raise PatternError(
                f"A pattern needs a Tiling, not {tiling!r}: write Pattern(Tiling('IH76')), or "
                "Pattern.from_polygons for your own polygons."
            )
        factor = np.sqrt(require_positive(tile_area, "tile area", "mm²"))
        lattice = factor * tiling.lattice
        cell = build_cell([factor * tile for tile in tiling.tiles], *lattice)
        sizes = (gap, scale_height, substrate_thickness)
        self._fill(cell, name or tiling.pattern_name, sizes, scale_material, substrate_material)
        self._set(family=tiling.family, tiling=tiling)

    @classmethod
    def from_polygons(
        cls,
        tiles: Sequence[ArrayLike],
        t1: ArrayLike,
        t2: ArrayLike,
        *,
        gap: float = 0.4,
        scale_height: float = 4.0,
        substrate_thickness: float = 0.4,
        scale_material: NeoHookean = PETG,
        substrate_material: NeoHookean = TPU,
        name: str = CUSTOM,
    ) -> Pattern:
        """Pattern of any polygons that cover the plane when shifted by a lattice.

        Parameters
        ----------
        tiles : polygons (n_i, 2), mm, one per lattice class, in either orientation.
        t1, t2 : (2,) lattice vectors, mm; they are exchanged if left-handed.

        The other parameters are those of the class.
        """
        pattern = cls.__new__(cls)
        cell = build_cell(list(tiles), t1, t2)
        sizes = (gap, scale_height, substrate_thickness)
        pattern._fill(cell, name, sizes, scale_material, substrate_material)
        pattern._set(family=CUSTOM, tiling=None)
        return pattern

    def _fill(
        self,
        cell: TiledCell,
        name: str,
        sizes: tuple[float, float, float],
        scale_material: NeoHookean,
        substrate_material: NeoHookean,
    ) -> None:
        gap, scale_height, substrate_thickness = sizes
        for material in (scale_material, substrate_material):
            if not isinstance(material, NeoHookean):
                raise PatternError(f"A material must be a NeoHookean, not {material!r}.")
        gap = require_positive(gap, "gap", "mm")
        prototiles, copies = _find_prototiles(cell, gap)
        self._set(
            name=str(name),
            gap=gap,
            scale_height=require_positive(scale_height, "scale height", "mm"),
            substrate_thickness=require_positive(substrate_thickness, "substrate thickness", "mm"),
            scale_material=scale_material,
            substrate_material=substrate_material,
            tiles=cell.tiles,
            lattice=cell.lattice,
            tile_area=float(np.linalg.det(cell.lattice)) / len(cell.tiles),
            prototiles=prototiles,
            copies=copies,
        )
        for array in (cell.lattice, *cell.tiles):
            array.setflags(write=False)

    def _set(self, **values: Any) -> None:
        for key, value in values.items():
            object.__setattr__(self, key, value)

    def __setattr__(self, key: str, value: Any) -> None:
        raise AttributeError(f"A Pattern cannot be changed: use pattern.with_({key}=…).")

    @property
    def cell_area(self) -> float:
        """Area of the lattice cell, mm²."""
        return float(np.linalg.det(self.lattice))

    @property
    def n_scales(self) -> int:
        """Number of scales in the cell."""
        return len(self.tiles)

    def outlines(self) -> tuple[FloatArray, ...]:
        """Scale outlines (m_i, 2), counterclockwise, mm, one per tile."""
        found = []
        for copy in self.copies:
            outline = copy.placement.apply(self.prototiles[copy.prototile].outline)
            found.append(outline[::-1] if copy.placement.reverses else outline)
        return tuple(found)

    def with_(self, **changes: Any) -> Pattern:
        """Copy with some constructor parameters changed."""
        shape = {"tiling", "tile_area"} if self.tiling else set()
        known = shape | {"name", *_SIZES, *_MATERIALS}
        for key in changes:
            if key not in known:
                raise PatternError(
                    f"Pattern {self.name!r} has no parameter {key!r} to change. "
                    f"{suggest(key, sorted(known))}"
                )
        kept = {key: getattr(self, key) for key in known} | changes
        if self.tiling:
            return Pattern(**kept)
        return Pattern.from_polygons(self.tiles, *self.lattice, **kept)

    def to_config(self) -> dict[str, Any]:
        """All that defines the pattern, in plain numbers, texts, lists and dicts (mm, MPa)."""
        config: dict[str, Any] = {"name": self.name, "family": self.family}
        if self.tiling:
            config["parameters"] = list(self.tiling.parameters)
            config["tile_area"] = self.tile_area
        else:
            config["tiles"] = [tile.tolist() for tile in self.tiles]
            config["lattice"] = self.lattice.tolist()
        config |= {key: getattr(self, key) for key in _SIZES}
        return config | {key: asdict(getattr(self, key)) for key in _MATERIALS}

    @classmethod
    def from_config(cls, config: Mapping[str, Any]) -> Pattern:
        """Rebuild what `to_config` describes; sizes and materials left out take their defaults."""
        values = dict(config)
        family = values.pop("family", CUSTOM)
        shape = {"tiles", "lattice"} if family == CUSTOM else {"parameters", "tile_area"}
        for key in values:
            if key not in shape | {"name", *_SIZES, *_MATERIALS}:
                raise PatternError(
                    f"A pattern of family {family!r} has no key {key!r}. "
                    f"{suggest(key, sorted(shape | {'name', *_SIZES, *_MATERIALS}))}"
                )
        for key in _MATERIALS:
            if key in values:
                values[key] = NeoHookean(**values[key])
        if family != CUSTOM:
            return cls(Tiling(family, values.pop("parameters", None)), **values)
        if not shape <= values.keys():
            raise PatternError("A custom pattern needs the keys 'tiles' and 'lattice'.")
        tiles, lattice = values.pop("tiles"), values.pop("lattice")
        return cls.from_polygons(tiles, *lattice, **values)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Pattern) and self.to_config() == other.to_config()

    def __hash__(self) -> int:
        return hash((self.name, self.family, self.gap, self.scale_height, self.n_scales))

    def __repr__(self) -> str:
        return f"Pattern({self.name!r}, {self.family}, {self.n_scales} scale(s), gap {self.gap:g} mm)"


_SIZES = ("gap", "scale_height", "substrate_thickness")
_MATERIALS = ("scale_material", "substrate_material")


def _find_prototiles(
    cell: TiledCell, gap: float
) -> tuple[tuple[Prototile, ...], tuple[TileCopy, ...]]:
    """Sort the tiles by congruence, corners and their sharpness included."""
    tolerance = 10.0 * cell.tolerance
    prototiles: list[Prototile] = []
    copies: list[TileCopy] = []
    for number, (polygon, sharp) in enumerate(zip(cell.tiles, cell.sharp, strict=True)):
        for index, known in enumerate(prototiles):
            found = polygon_isometries(known.polygon, known.sharp, polygon, sharp, tolerance)
            if found:
                copies.append(TileCopy(index, found[0]))
                break
        else:
            stabiliser = polygon_isometries(polygon, sharp, polygon, sharp, tolerance)
            outline = scale_outline(polygon, gap, number)
            copies.append(TileCopy(len(prototiles), stabiliser[0]))
            prototiles.append(Prototile(polygon, sharp, tuple(stabiliser), outline))
    return tuple(prototiles), tuple(copies)
