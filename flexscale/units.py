"""Checks of physical values at the boundaries: mm, N, MPa, N mm; degrees at the surface.

What counts as a number is the same everywhere: a real number, or an array of none or more
dimensions of real numbers, from Python, numpy or xarray. Texts, truth values, complex numbers,
dates and masked entries are none. Where a series of numbers is asked for, one number is a series of
one.
"""

from __future__ import annotations

import itertools
import math
import numbers
from collections.abc import Iterator, Sequence, Sized

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.errors import UnitRangeError, shown

#: and beyond some 10 m the tolerances of geometry, in parts of a millimeter, lose their meaning.
LENGTHS = (1e-3, 1e4)
#: mm2, bounds of tiles: those of squares with sides within the bounds of lengths, to 1 m2 and more.
AREAS = (1e-4, 1e7)
#: MPa, bounds of Young's moduli: from the softest gels to what stands for a rigid body.
MODULI = (1e-3, 1e9)
#: Bounds of Poisson's ratio: nearer to -1 or 1/2 the solid loses its stiffness against shear or
#: resists changes of volume without bound, and equilibria lose their digits.
RATIOS = (-0.95, 0.4999)
FARTHEST = 1e9  # mm from the origin: farther, places have lost the digits that meshes need
MOST_VALUES = 10_000  # of a series


def _with_unit(value: object, unit: str) -> str:
    text = f"{value:.12g}" if isinstance(value, float) else shown(value)
    return text if unit in ("", "1") else f"{text} {unit}"


def require_finite(value: object, name: str, unit: str) -> float:
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
    given = _item(value)
    if isinstance(given, bool) or not isinstance(given, numbers.Real):
        raise UnitRangeError(
            f"{name} must be a number{_in(unit)}, not {shown(value)} ({type(value).__name__})."
        )
    try:
        number = float(given)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise UnitRangeError(
            f"{name} is {_with_unit(number, unit)}, but must be finite: give a number{_in(unit)}."
        )
    return number


def require_positive(value: object, name: str, unit: str) -> float:
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


def require_range(value: object, name: str, unit: str, low: float, high: float) -> float:
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


def require_length(value: object, name: str) -> float:
    """Return a length [mm] as float, or refuse what is not positive and within `LENGTHS`."""
    return require_range(require_positive(value, name, "mm"), name, "mm", *LENGTHS)


def require_whole(value: object, name: str, low: int, high: int) -> int:
    """Return `value` as int, or refuse what is not a whole number in the closed range."""
    number = require_range(value, name, "1", low, high)
    if number != int(number):
        raise UnitRangeError(f"{name} is {number:.12g}, but is counted: give a whole number.")
    return int(number)


def require_array(value: object, name: str, unit: str) -> FloatArray:
    """Return finite real numbers as an array of floats of the same shape, of any.

    Raises
    ------
    UnitRangeError : anything but real numbers in rows of equal length, nan or infinite ones.
    """
    refusal = f"{name} must be numbers{_in(unit)}, all finite, not {shown(value)}."
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        raise UnitRangeError(refusal)
    longest = max(_lengths(value), default=0)
    if longest > 100 * MOST_VALUES:
        raise UnitRangeError(f"{name} are {longest} numbers, more than can be taken.")
    try:
        array = np.asarray(value)
        if array.dtype.kind == "O":  # for instance numbers too large for numpy
            array = array.astype(float) if _all_real(array) else array
    except (TypeError, ValueError, OverflowError, RecursionError):
        raise UnitRangeError(refusal) from None
    if array.dtype.kind not in "iuf" or not np.isfinite(array).all():
        raise UnitRangeError(refusal)
    return array.astype(float)


def _lengths(value: object, depth: int = 4) -> Iterator[int]:
    """Lengths of nested sequences, which numpy would spread out in memory."""
    if isinstance(value, list | tuple | range):
        yield len(value)
        if depth and len(value) <= 100 * MOST_VALUES and not isinstance(value, range):
            for item in value:
                if isinstance(item, list | tuple | range):
                    yield from _lengths(item, depth - 1)


def require_series(value: object, name: str, unit: str) -> tuple[float, ...]:
    """Return one number, or several in a row, as floats.

    Raises
    ------
    UnitRangeError : no number, more than `MOST_VALUES`, more than one row, or as `require_finite`.
    """
    in_a_row = getattr(value, "ndim", int(isinstance(value, Sequence))) > 0
    if isinstance(value, str | bytes) or not in_a_row:
        return (require_finite(value, name, unit),)
    size = len(value) if isinstance(value, Sized) else 0
    if not 0 < size <= MOST_VALUES:
        raise UnitRangeError(
            f"{name} must be one or more numbers{_in(unit)}, at most {MOST_VALUES}, not {size}."
        )
    row = value if isinstance(value, Sequence) else np.ma.asarray(value)
    return tuple(require_finite(item, name, unit) for item in row)


def require_increasing(values: Sequence[float], name: str, unit: str) -> None:
    """Refuse numbers of which one is not greater than the one before it."""
    for before, after in itertools.pairwise(values):
        if after <= before:
            raise UnitRangeError(
                f"{name} must increase, but {_with_unit(after, unit)} follows "
                f"{_with_unit(before, unit)}: sort them, and give each once."
            )


def _item(value: object) -> object:
    """The number in an array without dimensions; anything else as it is."""
    if isinstance(value, numbers.Number) or getattr(value, "ndim", None) != 0:
        return value
    if np.ma.is_masked(value):
        return value
    item = getattr(value, "item", None)
    return item() if callable(item) else value


def _all_real(array: np.ndarray) -> bool:
    return all(
        isinstance(item, numbers.Real) and not isinstance(item, bool) for item in array.ravel()
    )


def _in(unit: str) -> str:
    return "" if unit in ("", "1") else f" in {unit}"
