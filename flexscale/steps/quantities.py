"""Values with units in experiment files: a number in our unit, or text such as '0.4 mm'.

One value where a series may stand is a series of one, as everywhere.
"""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Callable
from typing import Any, NamedTuple, get_args

from pydantic import AfterValidator, BeforeValidator, Field
from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError

from flexscale.errors import BadInputError, shown
from flexscale.units import MOST_VALUES

#: Our unit -> every accepted spelling and what to multiply with to get to our unit.
UNITS: dict[str, dict[str, float]] = {
    "mm": {"mm": 1.0, "cm": 10.0, "m": 1000.0, "um": 1e-3, "µm": 1e-3, "in": 25.4},
    "mm2": {"mm2": 1.0, "mm^2": 1.0, "mm²": 1.0, "cm2": 100.0, "cm^2": 100.0, "cm²": 100.0},
    "mm-1": {
        "mm-1": 1.0,
        "1/mm": 1.0,
        "mm^-1": 1.0,
        "mm⁻¹": 1.0,
        "m-1": 1e-3,
        "1/m": 1e-3,
        "m^-1": 1e-3,
        "m⁻¹": 1e-3,
    },
    "MPa": {"MPa": 1.0, "GPa": 1000.0, "kPa": 1e-3, "Pa": 1e-6, "N/mm2": 1.0, "N/mm^2": 1.0},
    "N/mm": {"N/mm": 1.0, "N mm-1": 1.0, "kN/m": 1.0, "N/m": 1e-3},
    "N mm3": {"N mm3": 1.0, "N mm^3": 1.0, "N mm³": 1.0},
    "s": {"s": 1.0, "min": 60.0, "h": 3600.0},
    "degree": {"degree": 1.0, "degrees": 1.0, "deg": 1.0, "°": 1.0, "rad": 180.0 / math.pi},
}

_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\S.*?)?\s*")


class Quantity(NamedTuple):
    """Unit of a field; stands in its annotation and feeds validation and documentation."""

    unit: str

    def read(self, value: Any) -> Any:
        """Number in our unit; what is neither text nor a number is left to pydantic to refuse."""
        if isinstance(value, bool):
            raise _refuse(value, self.unit)
        if not isinstance(value, str):
            return value
        match = _NUMBER.fullmatch(_plain(value))
        if match is None:
            raise _refuse(value, self.unit)
        number, unit = match.groups()
        if not unit:
            return float(number)
        factor = _PLAIN_UNITS.get(self.unit, {}).get(unit)
        if factor is None:
            raise _refuse(value, self.unit)
        # Division is exact where the factor's inverse is a whole number: 400 um is 0.4 mm.
        inverse = round(1.0 / factor) if factor < 1.0 else 0
        exact = inverse and abs(inverse * factor - 1.0) < 1e-12
        return float(number) / inverse if exact else float(number) * factor

    def read_each(self, value: Any) -> Any:
        """As `read`, of one value or of a list of them."""
        several = isinstance(value, list | tuple)
        return [self.read(item) for item in value] if several else self.read(value)

    def expand(self, value: Any) -> Any:
        """List of numbers from {start, stop, step} or from a single one; else left to pydantic."""
        if isinstance(value, str | int | float):
            return [value]
        if isinstance(value, list | tuple) and len(value) > MOST_VALUES:
            raise PydanticCustomError(
                "series", "at most {most} values, not {n}", {"most": MOST_VALUES, "n": len(value)}
            )
        if not isinstance(value, dict):
            return value
        if set(value) != {"start", "stop", "step"}:
            raise PydanticCustomError(
                "series", "a range has exactly the keys start, stop (not included) and step", {}
            )
        start, stop, step = (self.read(value[key]) for key in ("start", "stop", "step"))
        if not all(map(_is_finite, (start, stop, step))) or not (
            step > 0.0 and 0.0 < (stop - start) / step <= MOST_VALUES
        ):
            raise PydanticCustomError(
                "series",
                "a range needs step > 0, stop > start and at most {most} values",
                {"most": MOST_VALUES},
            )
        # A little short of `stop`, so that rounding never adds it; 12 digits keep 0.0015 itself.
        count = math.ceil((stop - start) / step - 1e-9)
        return [float(f"{start + index * step:.12g}") for index in range(count)]


def _plain(text: str) -> str:
    """A text as a keyboard without accents, raised digits and Greek letters of its own has it."""
    return unicodedata.normalize("NFKC", text).replace("\N{MINUS SIGN}", "-")


_PLAIN_UNITS = {
    unit: {_plain(spelling): factor for spelling, factor in spellings.items()}
    for unit, spellings in UNITS.items()
}


def _is_finite(number: Any) -> bool:
    try:
        return isinstance(number, int | float) and math.isfinite(number)
    except OverflowError:  # an integer larger than any float
        return False


def _refuse(value: Any, unit: str) -> PydanticCustomError:
    if unit not in UNITS:
        return PydanticCustomError(
            "quantity",
            "{value} is not a number: write a plain number, without a unit",
            {"value": shown(value)},
        )
    known = ", ".join(UNITS[unit])
    return PydanticCustomError(
        "quantity",
        "{value} is not a value in {unit}: write a plain number, or a number and one of the "
        "units {known}",
        {"value": shown(value), "unit": unit, "known": known},
    )


def unit(name: str) -> BeforeValidator:
    """Marker for `Annotated[float, unit("mm")]`: accepts 0.4 and '0.4 mm'."""
    return BeforeValidator(Quantity(name).read)


def one_or_each(name: str) -> BeforeValidator:
    """Marker for a value, or for one of each of several things: accepts '0.4 mm' and [0.4, 0.8]."""
    return BeforeValidator(Quantity(name).read_each)


def within(check: Callable[[float, str], object], what: str) -> AfterValidator:
    """Marker for what a check of the package takes: bounds and their sentences are written once.

    Parameters
    ----------
    check : takes a value and what it is, and raises BadInputError.
    what : "a length".
    """

    def validate(value: Any) -> Any:
        try:
            return check(value, what)
        except BadInputError as error:
            raise PydanticCustomError("bounds", "{said}", {"said": str(error)}) from error

    vars(validate).update(vars(check))  # bounds and choices, which `run --fields` tells
    return AfterValidator(validate)


#: Marker for a list of names, or a single one.
several = BeforeValidator(lambda value: [value] if isinstance(value, str) else value)


def declared(default: Any, meaning: str, **bounds: Any) -> Any:
    """Field with its default, meaning and bounds, declared here and nowhere else.

    Parameters
    ----------
    default : `...` for a required field.
    meaning : what it is, a few words; shown by `flexscale run --fields`.
    bounds : pydantic's gt, ge, lt, le, min_length, …
    """
    return Field(default, description=meaning, validate_default=True, **bounds)


def markers_of(field: FieldInfo) -> list[Any]:
    """All that a field's annotation is marked with, and the annotations within it."""
    found, waiting = [*field.metadata], [field.annotation]
    while waiting:
        annotation = waiting.pop()
        found += getattr(annotation, "__metadata__", ())
        waiting += [item for item in get_args(annotation) if get_args(item)]
    return found


def unit_of(field: FieldInfo) -> str:
    """Unit a field was annotated with, that of its items for a series; "" for text."""
    for marker in markers_of(field):
        quantity = getattr(getattr(marker, "func", None), "__self__", None)
        if isinstance(quantity, Quantity):
            return quantity.unit
    return ""


def series(name: str) -> BeforeValidator:
    """Marker for a tuple of values: a list, a single one, or {start, stop, step} without `stop`."""
    return BeforeValidator(Quantity(name).expand)
