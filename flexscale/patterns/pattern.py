"""A scale pattern: tiles on a lattice, the gap between their scales, sizes and materials."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from flexscale import checks
from flexscale.arrays import FloatArray
from flexscale.checks import Check, checked, instance, length, number
from flexscale.errors import PatternError, SchemaError, suggest
from flexscale.names import require_name
from flexscale.patterns.cell import TiledCell, build_cell
from flexscale.patterns.corners import ROUNDING
from flexscale.patterns.drawing import read_drawing
from flexscale.patterns.gaps import GAP, ONE_GAP, Gap, gaps_of_tiles, narrowest_gap, simplest
from flexscale.patterns.material import PETG, TPU, NeoHookean, warn_of_soft_scales
from flexscale.patterns.pattern_config import CUSTOM, MATERIALS, SIZES, read_config
from flexscale.patterns.polygons import lattice_vector, polygons
from flexscale.patterns.prototiles import CONGRUENT, Prototile, TileCopy, find_prototiles
from flexscale.patterns.typed_cell import symmetrized_drawing, typed_cell
from flexscale.tilings import Tiling
from flexscale.tilings.drawn_symmetry import TOLERANCE, drawn_symmetry, primitive_cell
from flexscale.tilings.wallpaper import DrawnSymmetry
from flexscale.units import AREAS, LENGTHS, require_range


def _name(value: Any, label: str) -> str:
    """Check of a pattern's name, which becomes a folder."""
    try:
        return require_name(value, "pattern")
    except SchemaError as error:
        raise PatternError(str(error)) from error


#: Checks of what both constructors take.
_OF_SCALES: dict[str, Check] = {
    "scale_height": length(),
    "substrate_thickness": length(),
    "bond_radius": number("mm", 0.0, LENGTHS[1]),
    "scale_material": checks.MATERIAL,
    "substrate_material": checks.MATERIAL,
    "name": _name,
}


class Pattern:
    """A periodic pattern of scales on a sheet. Immutable; `with_` makes changed copies.

    Parameters
    ----------
    tiling : the tiling whose tiles carry the scales.
    tile_area : mm², mean area of a tile.
    gap : mm, width of the gap between neighboring scales. `from_polygons` takes one for each tile
        as well: each scale then ends half its own gap within its tile, and the gap between two
        scales is the mean of theirs.
    scale_height : mm.
    substrate_thickness : mm.
    bond_radius : mm, how far around a point of a scale's outline the sheet grips the scale's base;
        twice the substrate's thickness if not given: its weight falls off smoothly, so that the
        mean distance of the grip is then the thickness. 0 ties points to points: line loads then
        sink into the scale the deeper the finer its mesh.
    scale_material, substrate_material : Neo-Hookean solids.
    name : what to call the pattern; the tiling's own name ("hexagon") if not given.

    Attributes
    ----------
    family : "IH01" to "IH93", or "custom".
    tiles : tuple of (n_i, 2) counterclockwise polygons, mm, one per lattice class. Every vertex of
        the tiling is a corner, also one in the middle of a straight edge.
    lattice : (2, 2) rows t1, t2, right-handed, mm.
    gap : mm, the narrowest between two scales.
    gaps : mm, of the scale on each tile.
    prototiles, copies : the tiles up to congruence and gap, and where each tile of `tiles` comes
        from.

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
    gaps: tuple[float, ...]
    scale_height: float
    substrate_thickness: float
    bond_radius: float
    scale_material: NeoHookean
    substrate_material: NeoHookean
    tiles: tuple[FloatArray, ...]
    lattice: FloatArray
    prototiles: tuple[Prototile, ...]
    copies: tuple[TileCopy, ...]
    _given: tuple[tuple[FloatArray, ...], FloatArray]
    _given_bond_radius: float | None
    _given_gap: Gap

    @checked(
        tiling=instance(
            "flexscale.tilings.tiling:Tiling",
            "write Pattern(Tiling('IH76')), or Pattern.from_polygons for your own polygons",
        ),
        tile_area=number("mm²", *AREAS, above=0.0),
        gap=ONE_GAP,
        **_OF_SCALES,
    )
    def __init__(
        self,
        tiling: Tiling,
        *,
        tile_area: float = 100.0,
        gap: float = 0.4,
        scale_height: float = 4.0,
        substrate_thickness: float = 0.4,
        bond_radius: float | None = None,
        scale_material: NeoHookean = PETG,
        substrate_material: NeoHookean = TPU,
        name: str | None = None,
    ) -> None:
        factor = np.sqrt(tile_area)
        # As drawn, the tiling of a type may repeat itself within the type's own cell.
        tiles, lattice = primitive_cell(tiling.tiles, tiling.lattice)
        cell = build_cell([factor * tile for tile in tiles], factor * lattice)
        sizes = (gap, scale_height, substrate_thickness, bond_radius)
        self._fill(cell, name or tiling.pattern_name, sizes, scale_material, substrate_material)
        self._set(family=tiling.family, tiling=tiling, tile_area=tile_area)

    @classmethod
    @checked(
        tiles=polygons,
        t1=lattice_vector,
        t2=lattice_vector,
        symmetrize=checks.flag,
        gap=GAP,
        **_OF_SCALES,
    )
    def from_polygons(
        cls,
        tiles: Sequence[ArrayLike],
        t1: ArrayLike,
        t2: ArrayLike,
        *,
        gap: Gap = 0.4,
        scale_height: float = 4.0,
        substrate_thickness: float = 0.4,
        bond_radius: float | None = None,
        scale_material: NeoHookean = PETG,
        substrate_material: NeoHookean = TPU,
        name: str = CUSTOM,
        symmetrize: bool = False,
    ) -> Pattern:
        """Pattern of any polygons that cover the plane when shifted by a lattice.

        Where they were drawn does not matter: the first corner of the first tile becomes the
        origin. Corners count to 1e-9 of a tile's size, and to the last decimal that is typed:
        where the pattern is symmetric to within it, it becomes exactly so.

        Parameters
        ----------
        tiles : polygons (n_i, 2), mm, one per lattice class, in either orientation.
        t1, t2 : (2,) lattice vectors, mm; they are exchanged if left-handed.
        gap : mm, one for all scales, or one for each polygon, in their order.
        symmetrize : whether to make it the most symmetric pattern within 1e-3 of a tile's size,
            also where that moves corners by more than their last decimal.

        The other parameters are those of the class.
        """
        pattern = cls.__new__(cls)
        drawing = read_drawing(tiles, t1, t2)
        if symmetrize:
            drawing = symmetrized_drawing(drawing)
        cell = typed_cell(drawing)
        sizes = (gap, scale_height, substrate_thickness, bond_radius)
        pattern._fill(cell, name, sizes, scale_material, substrate_material)
        # Kept as drawn: rebuilding from the corners merged here would move the last bits.
        pattern._set(family=CUSTOM, tiling=None, _given=(drawing.tiles, drawing.lattice))
        return pattern

    def _fill(
        self,
        cell: TiledCell,
        name: str,
        sizes: tuple[Gap, float, float, float | None],
        scale_material: NeoHookean,
        substrate_material: NeoHookean,
    ) -> None:
        gap, scale_height, substrate_thickness, bond_radius = sizes
        spread = _bond_radius(bond_radius, substrate_thickness, cell)
        gaps = gaps_of_tiles(gap, len(cell.tiles))
        prototiles, copies = find_prototiles(cell, gaps)
        self._set(
            name=name,
            gap=narrowest_gap(cell.tiles, cell.lattice, gaps, cell.size),
            gaps=gaps,
            _given_gap=simplest(gap),
            scale_height=scale_height,
            substrate_thickness=substrate_thickness,
            bond_radius=spread,
            _given_bond_radius=None if bond_radius is None else spread,
            scale_material=scale_material,
            substrate_material=substrate_material,
            tiles=cell.tiles,
            lattice=cell.lattice,
            tile_area=_tile_area(cell),
            prototiles=prototiles,
            copies=copies,
        )
        for array in (cell.lattice, *cell.tiles):
            array.setflags(write=False)
        warn_of_soft_scales(scale_material, substrate_material)

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

    def symmetry(self) -> DrawnSymmetry:
        """Wallpaper group of the pattern as drawn, and the directions that bend differently.

        Scales have one height and material: the symmetry of the sheet is that of tiles and gaps.
        """
        tolerance = TOLERANCE if self.tiling else CONGRUENT
        return drawn_symmetry(self.tiles, self.lattice, tolerance=tolerance, marks=self.gaps)

    def symmetrize(self) -> Pattern:
        """The most symmetric pattern of which the tiles lie within 1e-3 of their size.

        For polygons that were rounded more than their digits tell. Those of families are exact.
        """
        if self.tiling:
            return self
        tiles, lattice = self._given
        kept = {key: getattr(self, key) for key in ("name", *SIZES, *MATERIALS)}
        kept |= {"gap": self._given_gap, "bond_radius": self._given_bond_radius}
        return Pattern.from_polygons(tiles, *lattice, symmetrize=True, **kept)

    def with_(self, **changes: Any) -> Pattern:
        """Copy with some constructor parameters changed.

        A `bond_radius` that was not given follows a changed `substrate_thickness`.
        """
        shape = {"tiling", "tile_area"} if self.tiling else set()
        known = shape | {"name", *SIZES, *MATERIALS}
        for key in changes:
            if key not in known:
                raise PatternError(
                    f"Pattern {self.name!r} has no parameter {key!r} to change. "
                    f"{suggest(key, sorted(known))}"
                )
        kept = {key: getattr(self, key) for key in known}
        kept |= {"gap": self._given_gap, "bond_radius": self._given_bond_radius} | changes
        if self.tiling:
            return Pattern(**kept)
        tiles, lattice = self._given
        return Pattern.from_polygons(tiles, *lattice, **kept)

    def to_config(self) -> dict[str, Any]:
        """All that defines the pattern, in plain numbers, texts, lists and dicts (mm, MPa)."""
        config: dict[str, Any] = {"name": self.name, "family": self.family}
        if self.tiling:
            config["parameters"] = list(self.tiling.parameters)
            if self.tiling.edges:
                curves = self.tiling.edges
                config["edges"] = {letter: curves[letter].tolist() for letter in sorted(curves)}
            config["tile_area"] = self.tile_area
        else:
            tiles, lattice = self._given
            config["tiles"] = [tile.tolist() for tile in tiles]
            config["lattice"] = lattice.tolist()
        config |= {key: getattr(self, key) for key in SIZES}
        if isinstance(self._given_gap, tuple):
            config["gap"] = list(self._given_gap)
        return config | {key: asdict(getattr(self, key)) for key in MATERIALS}

    @classmethod
    def from_config(cls, config: Mapping[str, Any]) -> Pattern:
        """Rebuild what `to_config` describes; sizes and materials left out take their defaults."""
        tiling, cell, values = read_config(config)
        if tiling is not None:
            return cls(tiling, **values)
        tiles, lattice = cell
        return cls.from_polygons(tiles, *lattice, **values)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Pattern) and self.to_config() == other.to_config()

    def __hash__(self) -> int:
        return hash((self.name, self.family, self.gap, self.scale_height, self.n_scales))

    def __repr__(self) -> str:
        gaps = " to ".join(f"{gap:g}" for gap in sorted({min(self.gaps), max(self.gaps)}))
        return f"Pattern({self.name!r}, {self.family}, {self.n_scales} scale(s), gap {gaps} mm)"


def _bond_radius(given: float | None, thickness: float, cell: TiledCell) -> float:
    """The bond radius, mm: as given, or twice the substrate's thickness."""
    if given is None:
        return 2.0 * thickness
    largest = float(np.sqrt(np.linalg.det(cell.lattice) / len(cell.tiles)))
    return require_range(given, "bond radius", "mm", 0.0, largest)


def _tile_area(cell: TiledCell) -> float:
    """Mean area of the tiles, mm²."""
    area = float(np.linalg.det(cell.lattice)) / len(cell.tiles)
    # An area asked for at a bound may come out beyond it by rounding.
    if (1.0 - ROUNDING) * AREAS[0] <= area <= (1.0 + ROUNDING) * AREAS[1]:
        return area
    return require_range(area, "tile area", "mm²", *AREAS)
