"""record.json: what it must hold, down to the last value."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    ValidationError,
    model_validator,
)

from flexscale.datasets.identity import SHORT_DIGEST
from flexscale.datasets.schema import SCHEMAS
from flexscale.datasets.untrusted import parse_json, read_regular
from flexscale.datasets.variables import SCALARS
from flexscale.errors import IntegrityError, SchemaError
from flexscale.names import is_name

RECORD_FILE = "record.json"
LARGEST_RECORD = 64 * 2**20  # bytes

_NUMBERS = {item.name for item in SCALARS if item.dtype == "float64"}
_TEXTS = {item.name for item in SCALARS if item.dtype == "text"}


def _printable(text: str) -> str:
    if not text.isprintable():
        raise ValueError("it holds control characters")
    return text


def _name(text: str) -> str:
    if not is_name(text):
        raise ValueError("it is no name: letters, digits, '.', '_', '+' and '-' only")
    return text


def _time(text: str) -> str:
    datetime.fromisoformat(text)
    return _printable(text)


def _kind(text: str) -> str:
    if text not in SCHEMAS:
        raise ValueError("there is no such kind of dataset")
    return text


def _scalars(values: dict[str, float | str]) -> dict[str, float | str]:
    for name, value in values.items():
        if name in _TEXTS:
            if not is_name(value):
                raise ValueError(f"{name} is no name")
        elif name not in _NUMBERS or isinstance(value, str):
            raise ValueError(f"{name} is no scalar of a dataset, or no number")
    if not values.keys() >= _TEXTS:
        raise ValueError(f"it lacks {' or '.join(sorted(_TEXTS))}")
    return values


Text = Annotated[str, Field(max_length=1000), AfterValidator(_printable)]
Name = Annotated[str, AfterValidator(_name)]
Kind = Annotated[str, AfterValidator(_kind)]
Digest = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
Identifier = Annotated[str, Field(pattern=rf"^[a-z_]{{1,40}}:[0-9a-f]{{{SHORT_DIGEST}}}$")]
Count = Annotated[int, Field(ge=0, lt=2**53)]
Amount = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]


class _Part(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid")


class _Recipe(_Part):
    step: Name
    version: Annotated[int, Field(ge=1, lt=2**31)]
    parameters: dict[str, Any]


class _Input(_Part):
    id: Identifier
    content_digest: Digest


class _Code(_Part):
    version: Text
    commit: Annotated[str, Field(pattern=r"^[0-9a-f]{0,64}$")]
    dirty: Annotated[int, Field(ge=0, le=1)]


class _Environment(BaseModel):
    model_config = ConfigDict(strict=True, extra="allow")
    created: Annotated[str, AfterValidator(_time)]


class _Run(BaseModel):
    """Facts of the run; more may be added, those that are read have their types."""

    model_config = ConfigDict(strict=True, extra="allow")
    wall_seconds: Amount = 0.0
    cpu_seconds: Amount = 0.0
    workers: Annotated[int, Field(ge=1, lt=2**31)] = 1
    resumed: bool = False
    failed_samples: list[Any] = []


class _Record(_Part):
    kind: Kind
    schema_: Annotated[str, Field(alias="schema")]
    recipe: _Recipe
    recipe_digest: Digest
    content_digest: Digest
    inputs: list[_Input]
    scalars: Annotated[dict[str, float | str], AfterValidator(_scalars)]
    sizes: dict[Name, Count]
    samples: Count
    failed: Count
    code: _Code
    environment: _Environment
    run: _Run
    file_sha256: Digest
    file_bytes: Count

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.failed > self.samples:
            raise ValueError(f"{self.failed} of {self.samples} samples failed")
        if not all(math.isfinite(v) for v in self.scalars.values() if not isinstance(v, str)):
            raise ValueError("a scalar is not finite")
        return self


def read_record(folder: Path) -> dict[str, Any]:
    """Contents of a folder's record.json, complete and of the right types.

    Raises
    ------
    IntegrityError : missing, unreadable, malformed, or of another dataset.
    SchemaError : it follows a schema that this FlexScale does not know.
    """
    path = folder / RECORD_FILE
    advice = f"Remove the folder {folder} and run the step again."
    try:
        record = parse_json(read_regular(path, LARGEST_RECORD))
    except FileNotFoundError as error:
        raise IntegrityError(f"{path} is missing. {advice}") from error
    except ValueError as error:
        raise IntegrityError(f"{path} is damaged: {error!s:.100}. {advice}") from error
    _require_known_schema(record, path)
    try:
        _Record.model_validate(record)
    except ValidationError as error:
        raise IntegrityError(f"{path} is damaged: {_told(error)}. {advice}") from error
    names = (record["scalars"]["family"], record["scalars"]["pattern"])
    place = "/".join((record["kind"], *names, record["recipe_digest"][:SHORT_DIGEST]))
    if (found := "/".join(folder.parts[-4:])) != place:
        raise IntegrityError(f"{path} belongs to {place}, not to {found}. {advice}")
    result: dict[str, Any] = record
    return result


def _require_known_schema(record: Any, path: Path) -> None:
    """SchemaError when the record names a version of its schema other than ours."""
    if not isinstance(record, Mapping):
        return
    kind, schema = record.get("kind"), record.get("schema")
    if not isinstance(kind, str) or not isinstance(schema, str) or kind not in SCHEMAS:
        return
    known = SCHEMAS[kind]
    match = re.fullmatch(rf"{kind}/([0-9]{{1,6}})", schema, re.ASCII)
    if match is None:
        raise IntegrityError(
            f"{path} is damaged: a {kind} cannot follow the schema {schema!r:.60}."
        )
    if int(match[1]) > known.version:
        raise SchemaError(
            f"{path} was made by a newer FlexScale: schema {schema}; this one knows {known.name}."
        )
    if schema != known.name:
        raise SchemaError(
            f"{path} was made by an older FlexScale: schema {schema}; this one knows {known.name}. "
            "Run its experiment again."
        )


def _told(error: ValidationError) -> str:
    """The first fault, with its place."""
    fault = error.errors(include_url=False)[0]
    where = ".".join(str(part) for part in fault["loc"])
    message = str(fault["msg"]).removeprefix("Value error, ")
    return f"{f'{where[:80]}: ' if where else ''}{message[:150]}"
