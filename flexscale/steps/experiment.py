"""Experiment files: read, checked completely, and resolved before anything is computed."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Self

import numpy as np
from pydantic import ValidationError, field_validator, model_validator
from pydantic_core import PydanticCustomError

from flexscale.checks import choice
from flexscale.errors import (
    BadInputError,
    ConfigError,
    MeshError,
    SchemaError,
    UnitRangeError,
    shown,
)
from flexscale.homogenize.finite_options import require_finite_options
from flexscale.macro.polar import Variant
from flexscale.macro.samples import require_axes
from flexscale.macro.uniaxial import Weighting
from flexscale.mechanics.contact_options import ContactOptions
from flexscale.mechanics.scale_options import ScaleOptions
from flexscale.mechanics.substrate_options import SubstrateOptions
from flexscale.mesh.estimate import require_moderate_mesh, require_moderate_sheet
from flexscale.mesh.options import MeshOptions
from flexscale.names import require_name
from flexscale.patterns.pattern import Pattern
from flexscale.solve.solver_options import SolverOptions
from flexscale.steps.blocks import (
    BendingDirections,
    Block,
    Curvature,
    Curvatures,
    Direction,
    Directions,
    DoubleBending,
    PatternBlock,
    Side,
    Sides,
    increasing,
)
from flexscale.steps.figures import FIGURES
from flexscale.steps.option_blocks import Contact, Mesh, Scales, Solver, Substrate
from flexscale.steps.quantities import declared, several, within
from flexscale.steps.sheet_blocks import (
    NativeRigBlock,
    NativeSheetBlock,
    RigsBlock,
    SheetBlock,
    TurnedSheetBlock,
)
from flexscale.steps.yaml_file import read_yaml

FigureName = Annotated[str, within(choice("figure", FIGURES), "figure")]
_MOST_MISTAKES = 20  # of a file, told at once
#: Blocks of steps that have other names than these.
_BLOCKS = {"shape": "shapes", "rig": "rigs"}


class SweepBlock(Block):
    """Bending in many directions to many curvatures."""

    sides: Sides = declared(
        ("closing", "opening"), "sides to bend to: closing, opening", min_length=1
    )
    directions: BendingDirections = declared(
        ...,
        "directions along which the sheet curves, fold lines run across; increasing, from 0 to "
        "below 180",
        min_length=1,
    )
    curvatures: Curvatures = declared(..., "curvatures, increasing from 0", min_length=1)
    symmetry: bool = declared(True, "solve equivalent directions once; false solves all")

    @field_validator("curvatures")
    @classmethod
    def _curvatures_from_zero(cls, values: tuple[float, ...]) -> tuple[float, ...]:
        if values[0] != 0.0:
            raise PydanticCustomError(
                "range", "the first curvature must be 0: every sweep starts from the flat sheet", {}
            )
        return increasing(values)


class TangentBlock(Block):
    """Bending stiffness of the flat sheet."""

    directions: Directions = declared(
        tuple(1.5 * index for index in range(120)),
        "directions at which a is tabulated",
        min_length=1,
    )

    @field_validator("directions")
    @classmethod
    def _directions_increase(cls, values: tuple[float, ...]) -> tuple[float, ...]:
        return increasing(values)


class FitBlock(Block):
    """Macro model: two-regime law in every direction, fitted to the sweep."""

    weighting: Weighting = declared(
        "relative", "errors relative to each sample, or absolute as in the paper"
    )
    variant: Variant = declared(
        "tangent", "energy of a curvature tensor: on the tangent of the flat sheet, or the paper's"
    )
    w_biaxial: DoubleBending | None = declared(
        None, "resistance to double curvature, from the tile's size if left out", ge=0.0
    )


class ShapeBlock(Block):
    """A deformed cell to look at."""

    side: Side = declared("closing", "side to bend to: closing, opening")
    direction: Direction = declared(0.0, "along which the sheet curves", ge=0.0, lt=180.0)
    curvature: Curvature = declared(..., "curvature", gt=0.0)


class Experiment(Block):
    """An experiment: patterns, and what to compute and draw for each of them."""

    patterns: dict[str, PatternBlock] = declared(..., "name and description of each pattern")
    mesh: Mesh = declared(MeshOptions(), "mesh sizes")
    contact: Contact = declared(ContactOptions(), "how scales touch")
    substrate: Substrate = declared(SubstrateOptions(), "elements of the substrate")
    scales: Scales = declared(ScaleOptions(), "how scales are modeled")
    solver: Solver = declared(SolverOptions(), "how equilibria are sought")
    tangent: TangentBlock | None = declared(None, "stiffness of the flat sheet; {} for defaults")
    sweep: SweepBlock | None = declared(None, "bending sweep")
    fit: FitBlock | None = declared(None, "two-regime law of the sweep; {} for defaults")
    shapes: tuple[ShapeBlock, ...] = declared((), "deformed cells")
    sheet: SheetBlock | None = declared(None, "the fit between end strips; {} for defaults")
    turned_sheet: TurnedSheetBlock | None = declared(
        None, "sheets between end strips, with the pattern turned on them; {} for defaults"
    )
    native_sheet: NativeSheetBlock | None = declared(
        None, "the scales themselves between end strips; {} for defaults, which take hours"
    )
    rigs: RigsBlock | None = declared(None, "the fit on the testing devices")
    native_rig: NativeRigBlock | None = declared(
        None, "the scales themselves on the stage; {} for defaults, which take hours"
    )
    figures: Annotated[tuple[FigureName, ...], several] = declared(
        (), "figures to draw for each pattern"
    )

    @field_validator("patterns")
    @classmethod
    def _some_pattern_with_a_name(
        cls, patterns: dict[str, PatternBlock]
    ) -> dict[str, PatternBlock]:
        if not patterns:
            raise PydanticCustomError("empty", "an experiment needs at least one pattern", {})
        named: dict[str, PatternBlock] = {}
        for given, block in patterns.items():
            try:
                name = require_name(given, "pattern")
            except SchemaError as error:
                raise PydanticCustomError("name", "{said}", {"said": str(error)}) from error
            for other in named:
                if other.casefold() == name.casefold():
                    raise PydanticCustomError(
                        "name",
                        "the patterns {first} and {second} would share their files where file "
                        "systems do not tell cases apart: call one of them otherwise",
                        {"first": repr(other), "second": repr(name)},
                    )
            named[name] = block
        return named

    @model_validator(mode="after")
    def _figures_have_data(self) -> Self:
        for name in self.figures:
            step = FIGURES[name].needs[0]
            block = _BLOCKS.get(step, step)
            if getattr(self, block) in (None, ()):
                raise PydanticCustomError(
                    "figure",
                    "the figure {name} needs the block `{block}`, which is missing",
                    {"name": repr(name), "block": block},
                )
        return self

    @model_validator(mode="after")
    def _fit_has_a_sweep_that_suffices(self) -> Self:
        if self.fit is not None:
            if self.sweep is None:
                raise PydanticCustomError(
                    "fit", "`fit` needs the block `sweep`, which is missing", {}
                )
            require_axes(np.array(self.sweep.directions), np.array(self.sweep.curvatures))
        return self

    @model_validator(mode="after")
    def _turned_sheets_have_a_sweep_to_fit(self) -> Self:
        if self.turned_sheet is not None:
            if self.sweep is None:
                raise PydanticCustomError(
                    "fit", "`turned_sheet` needs the block `sweep`, which is missing", {}
                )
            require_axes(np.array(self.sweep.directions), np.array(self.sweep.curvatures))
        return self

    @model_validator(mode="after")
    def _sheets_have_a_fit(self) -> Self:
        for name in ("sheet", "rigs"):
            if getattr(self, name) is not None and self.fit is None:
                raise PydanticCustomError(
                    "fit", "`{name}` needs the block `fit`, which is missing", {"name": name}
                )
        return self

    @model_validator(mode="after")
    def _finite_sheets_are_made_of_what_they_can(self) -> Self:
        if self.native_sheet is not None or self.native_rig is not None:
            require_finite_options(self.substrate, self.scales)
        return self

    def build_patterns(self) -> dict[str, Pattern]:
        """Every pattern, built and checked, curvatures against the scale height included.

        Raises
        ------
        BadInputError : polygons, sizes or a family are not usable; names the pattern.
        UnitRangeError : a curvature folds the curvature map.
        """
        built = {}
        for name, block in self.patterns.items():
            try:
                built[name] = block.build(name)
            except BadInputError as error:
                raise type(error)(f"patterns.{name}: {error}") from error
            self._refuse_folds(built[name])
            self._refuse_large_meshes(built[name])
        return built

    def _refuse_large_meshes(self, pattern: Pattern) -> None:
        try:
            require_moderate_mesh(pattern, self.mesh)
            for block in (self.native_sheet, self.native_rig):
                if block is not None:
                    require_moderate_sheet(pattern, self.mesh, block.length, block.width)
        except MeshError as error:
            raise MeshError(f"patterns.{pattern.name}: {error}") from error

    def _refuse_folds(self, pattern: Pattern) -> None:
        closing = [shape.curvature for shape in self.shapes if shape.side == "closing"]
        if self.sweep is not None and "closing" in self.sweep.sides:
            closing.append(self.sweep.curvatures[-1])
        largest, limit = max(closing, default=0.0), 1.0 / pattern.scale_height
        if largest >= limit:
            raise UnitRangeError(
                f"patterns.{pattern.name}: at a closing curvature of {largest:g} mm-1 the bending "
                f"center lies inside the scales, which are {pattern.scale_height:g} mm high: stay "
                f"below {limit:g} mm-1."
            )


def parse_experiment(content: Any, where: str) -> Experiment:
    """Experiment from plain data.

    Parameters
    ----------
    content : what the file held.
    where : name of the file, for messages.

    Raises
    ------
    ConfigError : one line per mistake: place, mistake and what is allowed.
    BadInputError : mesh, contact or solver options contradict each other, or the sweep is too
        small for a fit.
    """
    if not isinstance(content, dict):
        raise ConfigError(f"{where} holds no experiment: it needs at least the key 'patterns'.")
    try:
        return Experiment.model_validate(content)
    except ValidationError as error:
        mistakes = error.errors(include_url=False)
        lines = [f"{where}: {_sentence(dict(item))}" for item in mistakes[:_MOST_MISTAKES]]
        if len(mistakes) > _MOST_MISTAKES:
            lines.append(f"{where}: and {len(mistakes) - _MOST_MISTAKES} more mistakes.")
        raise ConfigError("\n".join(lines)) from error
    except BadInputError as error:  # options and fits check themselves
        raise type(error)(f"{where}: {error}") from error


def load_experiment(path: Path) -> Experiment:
    """Experiment file, read and checked.

    Raises
    ------
    ConfigError : the file cannot be read, is no YAML, or says something that is not allowed.
    """
    return parse_experiment(read_yaml(path), str(path))


def _sentence(item: dict[str, Any]) -> str:
    # Blocks of options are one value to pydantic: which of them is meant is told beside it.
    option = item.get("ctx", {}).get("option")
    loc = (*item["loc"], *([option] if option else []))
    parts = (str(part) if isinstance(part, int) else shown(part)[1:-1] for part in loc)
    place = ".".join(parts) or "top level"
    message = str(item["msg"])
    given = item.get("input")
    said = isinstance(given, int | float | str) and shown(given) not in message
    # Where the message holds the value or the key already, it is not told again.
    if said and item["type"] not in ("missing", "unknown_key", "bounds"):
        message += f", not {shown(given)}"
    return f"{place}: {message.rstrip('.')}."
