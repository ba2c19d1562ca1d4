"""Checks of physical values at the boundaries: mm, N, MPa, N mm; degrees at the surface."""

from __future__ import annotations

import math
import numbers

from flexscale.errors import UnitRangeError


def _with_unit(value: object, unit: str) -> str:
    shown = f"{value:.12g}" if isinstance(value, float) else repr(value)
    return shown if unit in ("", "1") else f"{shown} {unit}"


def require_finite(value: float, name: str, unit: str) -> float:
    """Return `value` as float, or refuse what is not a finite real number.

    Parameters
    ----------
    value : the number to check.
    name : what it is, as the user knows it ("gap").
    unit : its unit ("mm"); "1" for a pure number.

    Raises
    ------
    UnitRangeError : not a real number, nan or infinite.
    """
    given: object = value  # callers pass what users typed, whatever the annotation says
    if isinstance(given, bool) or not isinstance(given, numbers.Real):
        raise UnitRangeError(
            f"{name} must be a number{_in(unit)}, not {given!r} ({type(given).__name__})."
        )
    number = float(given)
    if not math.isfinite(number):
        raise UnitRangeError(
            f"{name} is {_with_unit(number, unit)}, but must be finite: give a number{_in(unit)}."
        )
    return number


def require_positive(value: float, name: str, unit: str) -> float:
    """Return `value` as float, or refuse what is not finite and greater than zero.

    Parameters and errors as in `require_finite`.
    """
    number = require_finite(value, name, unit)
    if number <= 0.0:
        raise UnitRangeError(
            f"{name} is {_with_unit(number, unit)}, but must be positive: "
            f"give a number greater than 0{'' if unit in ('', '1') else ' ' + unit}."
        )
    return number


def require_range(value: float, name: str, unit: str, low: float, high: float) -> float:
    """Return `value` as float, or refuse what does not lie in the closed range [low, high].

    Parameters
    ----------
    value, name, unit : as in `require_finite`.
    low, high : bounds in `unit`, both allowed; infinite bounds are open.
    """
    number = require_finite(value, name, unit)
    if not low <= number <= high:
        raise UnitRangeError(
            f"{name} is {_with_unit(number, unit)}, but must lie between "
            f"{_with_unit(float(low), unit)} and {_with_unit(float(high), unit)}."
        )
    return number


def _in(unit: str) -> str:
    return "" if unit in ("", "1") else f" in {unit}"
