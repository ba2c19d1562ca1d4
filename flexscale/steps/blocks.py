"""Blocks of an experiment file; every field declares default, unit, meaning and bounds once.

Defaults that belong to a class of a lower floor are taken from its signature, not repeated.
"""

from __future__ import annotations

import dataclasses
import inspect
import itertools
from functools import partial
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, model_validator
from pydantic_core import PydanticCustomError

from flexscale.checks import length
from flexscale.errors import UnknownNameError, shown, suggest
from flexscale.patterns.gaps import GAP
from flexscale.patterns.material import PETG, RIGID, TPU, TPU_MEASURED, NeoHookean
from flexscale.patterns.named import find_named_pattern
from flexscale.patterns.pattern import Pattern
from flexscale.steps.quantities import declared, one_or_each, series, several, unit, within
from flexscale.units import MODULI, RATIOS

Length = Annotated[float, unit("mm")]
#: A length of something, which is positive; other lengths are places.
Size = Annotated[float, unit("mm"), within(length(), "a length")]
#: Of one gap, or of each polygon's.
Gaps = Annotated[Any, one_or_each("mm"), within(GAP, "gap")]
Area = Annotated[float, unit("mm2")]
Curvature = Annotated[float, unit("mm-1")]
Modulus = Annotated[float, unit("MPa")]
Direction = Annotated[float, unit("degree")]
DoubleBending = Annotated[float, unit("N mm3")]
Number = Annotated[float, unit("1")]
Numbers = Annotated[tuple[Number, ...], series("1")]
Lengths = Annotated[tuple[Length, ...], series("mm")]
Directions = Annotated[tuple[Direction, ...], series("degree")]
Curvatures = Annotated[tuple[Curvature, ...], series("mm-1")]
Side = Literal["closing", "opening"]

MATERIALS = {"PETG": PETG, "RIGID": RIGID, "TPU": TPU, "TPU_MEASURED": TPU_MEASURED}
_NAMES = " or ".join(MATERIALS)


class Block(BaseModel):
    """Part of an experiment file: frozen; unknown keys are errors with a did-you-mean."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    @model_validator(mode="before")
    @classmethod
    def _know_all_keys(cls, data: Any) -> Any:
        if isinstance(data, dict):
            for key in data:
                if key not in cls.model_fields:
                    raise PydanticCustomError(
                        "unknown_key",
                        "there is no key {key}. {hint}",
                        {"key": shown(key), "hint": suggest(key, cls.model_fields)},
                    )
        return data


def increasing(values: tuple[float, ...]) -> tuple[float, ...]:
    """Validator of a series: the values, if they increase strictly."""
    for before, after in itertools.pairwise(values):
        if after <= before:
            raise PydanticCustomError(
                "order",
                "values must increase, but {after} follows {before}",
                {"before": f"{before:g}", "after": f"{after:g}"},
            )
    return values


def _within_half_turn(values: tuple[float, ...]) -> tuple[float, ...]:
    """Validator of bending directions (degree): increasing, and none twice the same."""
    if values and (values[0] < 0.0 or values[-1] >= 180.0):
        raise PydanticCustomError(
            "range", "directions lie in [0, 180) degree: bending has period 180", {}
        )
    return increasing(values)


def _from_flat(values: tuple[float, ...]) -> tuple[float, ...]:
    """Validator of curvatures (mm-1) along which a cell is followed: from 0 on, increasing."""
    if values and values[0] != 0.0:
        raise PydanticCustomError(
            "range", "the first curvature must be 0: every sweep starts from the flat sheet", {}
        )
    return increasing(values)


def _once_each(sides: tuple[str, ...]) -> tuple[str, ...]:
    if len(set(sides)) != len(sides):
        raise PydanticCustomError("twice", "a side is named twice", {})
    return sides


Sides = Annotated[tuple[Side, ...], several, AfterValidator(_once_each)]
BendingDirections = Annotated[Directions, AfterValidator(_within_half_turn)]
CurvaturesFromFlat = Annotated[Curvatures, AfterValidator(_from_flat)]


def _default(owner: type, name: str) -> Any:
    return inspect.signature(owner).parameters[name].default


def _material(value: Any, default: NeoHookean) -> Any:
    """A material may be given by name; a constant that is left out is that of the default."""
    if isinstance(value, str):
        if value not in MATERIALS:
            raise PydanticCustomError(
                "unknown_material",
                "there is no material {name}. {hint}",
                {"name": shown(value), "hint": suggest(value, MATERIALS)},
            )
        value = MATERIALS[value]
    if isinstance(value, NeoHookean):
        return dataclasses.asdict(value)
    if isinstance(value, dict):
        given = {key: item for key, item in value.items() if item is not None}
        return dataclasses.asdict(default) | given
    return value


class MaterialBlock(Block):
    """Neo-Hookean material."""

    young_modulus: Modulus | None = declared(
        None,
        "Young's modulus, that of the default material if left out",
        ge=MODULI[0],
        le=MODULI[1],
    )
    poisson_ratio: Number | None = declared(
        None,
        "Poisson ratio, that of the default material if left out",
        ge=RATIOS[0],
        le=RATIOS[1],
    )


ScaleMaterial = Annotated[
    MaterialBlock,
    BeforeValidator(partial(_material, default=_default(Pattern, "scale_material"))),
]
SubstrateMaterial = Annotated[
    MaterialBlock,
    BeforeValidator(partial(_material, default=_default(Pattern, "substrate_material"))),
]
Point = tuple[Length, Length]
CurvePoint = tuple[Number, Number]
#: What a name of the catalog stands for.
_OF_NAME = ("family", "parameters", "edges", "tiles", "lattice", "symmetrize")


class PatternBlock(Block):
    """Scale pattern: a named one, a tiling family, or polygons with two lattice vectors.

    A name stands for its family, parameters and edges, which take its place when read.
    """

    named: str | None = declared(None, "pattern of the catalog, such as pinwheel3")
    family: str | None = declared(None, "isohedral tiling family, such as IH20")
    parameters: Numbers | None = declared(None, "free shape parameters of the family")
    edges: dict[str, tuple[CurvePoint, ...]] | None = declared(
        None, "curve of an edge class of the family, points from (0, 0) to (1, 0)"
    )
    tile_area: Area | None = declared(
        None,
        f"mean area of a family's tiles, {_default(Pattern, 'tile_area'):g} mm2 if left out",
        gt=0.0,
    )
    tiles: tuple[tuple[Point, ...], ...] | None = declared(
        None, "polygons of one cell instead of a family, each a list of corners"
    )
    lattice: tuple[Point, Point] | None = declared(None, "the two lattice vectors of `tiles`")
    symmetrize: bool | None = declared(
        None, "whether `tiles` that are nearly symmetric become exactly so"
    )
    gap: Gaps = declared(
        _default(Pattern, "gap"),
        "gap between neighboring scales; of `tiles` also a list, one for each: between two it is "
        "their mean",
    )
    scale_height: Size = declared(_default(Pattern, "scale_height"), "scale height", gt=0.0)
    substrate_thickness: Size = declared(
        _default(Pattern, "substrate_thickness"), "substrate thickness", gt=0.0
    )
    bond_radius: Length | None = declared(
        None, "how far a scale's outline grips the sheet, 2 substrate_thickness if left out", ge=0.0
    )
    scale_material: ScaleMaterial = declared(
        _default(Pattern, "scale_material"), f"material of the scales, or {_NAMES}"
    )
    substrate_material: SubstrateMaterial = declared(
        _default(Pattern, "substrate_material"), f"material of the substrate, or {_NAMES}"
    )

    @model_validator(mode="before")
    @classmethod
    def _name_stands_for_a_shape(cls, data: Any) -> Any:
        if not isinstance(data, dict) or not isinstance(data.get("named"), str):
            return data
        extra = sorted(key for key in _OF_NAME if data.get(key) is not None)
        if extra:
            raise _bad_shape([], extra)
        try:
            entry = find_named_pattern(data["named"])
        except UnknownNameError as error:
            raise PydanticCustomError("unknown_pattern", "{said}", {"said": str(error)}) from error
        return data | {"named": None, "family": entry.family} | entry.shape

    @model_validator(mode="after")
    def _one_kind_of_shape(self) -> Self:
        of_family = {"parameters", "edges", "tile_area"}
        shape = {"family"} if self.family is not None else {"tiles", "lattice"}
        barred = {"tiles", "lattice", "symmetrize"} if self.family is not None else of_family
        missing = sorted(key for key in shape if getattr(self, key) is None)
        extra = sorted(key for key in barred if getattr(self, key) is not None)
        if missing or extra:
            raise _bad_shape(missing, extra)
        return self

    def build(self, name: str) -> Pattern:
        """The pattern called `name`; PatternError or TilingError when it cannot be built."""
        config = {key: value for key, value in self.model_dump().items() if value is not None}
        return Pattern.from_config(config | {"name": name})


def _bad_shape(missing: list[str], extra: list[str]) -> PydanticCustomError:
    said = [f"{', '.join(missing)} missing"] if missing else []
    said += [f"{', '.join(extra)} out of place"] if extra else []
    return PydanticCustomError(
        "pattern_shape",
        "a pattern has either `named`, or `family` (with `parameters` and `edges` if wanted), or "
        "`tiles` with `lattice`: {problem}",
        {"problem": " and ".join(said)},
    )
