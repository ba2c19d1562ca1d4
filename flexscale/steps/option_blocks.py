"""Blocks that are option classes of lower floors, taken with their defaults and docstrings."""

from __future__ import annotations

import dataclasses
import re
from typing import Annotated, Any, NamedTuple, Protocol

from pydantic import BeforeValidator, PlainSerializer
from pydantic_core import PydanticCustomError

from flexscale.checks import bounds_of, choices_of
from flexscale.errors import shown, suggest
from flexscale.mechanics.contact_options import ContactOptions
from flexscale.mechanics.scale_options import ScaleOptions
from flexscale.mechanics.substrate_options import SubstrateOptions
from flexscale.mesh.options import MeshOptions
from flexscale.mesh.solid_options import SolidOptions
from flexscale.solve.solver_options import SolverOptions
from flexscale.steps.quantities import UNITS, Quantity


class Options(Protocol):
    """A frozen dataclass that checks itself; `to_config` holds what results depend on."""

    def to_config(self) -> dict[str, Any]:
        """Fields as plain numbers and text."""


class OptionField(NamedTuple):
    """One field of an option class, as its docstring and its check declare it."""

    name: str
    unit: str
    default: Any
    meaning: str
    bounds: str
    choices: tuple[str, ...]


def option_fields(options: type[Options]) -> list[OptionField]:
    """Fields of an option class that an experiment may set.

    The docstring's lines ``name : unit, meaning.`` give unit and meaning; the unit may be missing.
    """
    entries = re.findall(r"^    (\w+) : (.+(?:\n {8}.+)*)", options.__doc__ or "", re.MULTILINE)
    documented = {name: " ".join(text.split()).rstrip(".") for name, text in entries}
    checks, found = getattr(options, "__checks__", {}), []
    for field in dataclasses.fields(options):  # type: ignore[arg-type]
        if field.metadata.get("experiment", True):
            text = documented.get(field.name, "")
            unit, comma, meaning = text.partition(", ")
            known = comma and unit in UNITS
            found.append(
                OptionField(
                    field.name,
                    unit if known else "",
                    field.default,
                    meaning if known else text,
                    bounds_of(checks.get(field.name)),
                    choices_of(checks.get(field.name)),
                )
            )
    return found


def _read(options: type[Options], value: Any) -> Any:
    """The options that a mapping names; they check themselves, as they do in Python."""
    if isinstance(value, options):
        return value
    if not isinstance(value, dict):
        raise PydanticCustomError(
            "options", "a mapping of options is needed, not {given}", {"given": shown(value)}
        )
    fields = {field.name: field for field in option_fields(options)}
    for key in value:
        if key not in fields:
            raise PydanticCustomError(
                "unknown_key",
                "there is no key {key}. {hint}",
                {"key": shown(key), "hint": suggest(key, fields)},
            )
    return options(**{key: _value(fields[key], item) for key, item in value.items()})


def _value(field: OptionField, given: Any) -> Any:
    """A number with its unit, where the option is a number; a refusal tells which `option`."""
    if isinstance(field.default, bool) or not isinstance(field.default, int | float):
        return given
    try:
        return Quantity(field.unit or "1").read(given)
    except PydanticCustomError as error:
        facts = (error.context or {}) | {"option": field.name}
        raise PydanticCustomError(error.type, error.message_template, facts) from error


_as_config = PlainSerializer(lambda options: options.to_config())
Mesh = Annotated[MeshOptions, BeforeValidator(lambda value: _read(MeshOptions, value)), _as_config]
Contact = Annotated[
    ContactOptions, BeforeValidator(lambda value: _read(ContactOptions, value)), _as_config
]
Solver = Annotated[
    SolverOptions, BeforeValidator(lambda value: _read(SolverOptions, value)), _as_config
]
Scales = Annotated[
    ScaleOptions, BeforeValidator(lambda value: _read(ScaleOptions, value)), _as_config
]
Substrate = Annotated[
    SubstrateOptions, BeforeValidator(lambda value: _read(SubstrateOptions, value)), _as_config
]
Solid = Annotated[
    SolidOptions, BeforeValidator(lambda value: _read(SolidOptions, value)), _as_config
]
