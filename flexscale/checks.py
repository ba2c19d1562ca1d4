"""What public functions are given is checked in one way, before they begin.

A public function names a check for each of its parameters::

    @checked(pattern=PATTERN, width=length(), direction=ANGLE)
    def simulate(pattern, width, direction=0.0): ...

A check takes what the caller gave and what it is called, and returns what the function works with:
a float, a tuple, the object itself; or it raises one of our errors with one sentence. Defaults are
not checked, and a parameter whose default is None may be given as None.
"""

from __future__ import annotations

import functools
import inspect
import math
import os
import sys
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any, TypeVar, cast

from flexscale import units
from flexscale.errors import BadInputError, UnitRangeError, UnknownNameError, shown, suggest

Check = Callable[[Any, str], Any]
Checked = TypeVar("Checked", bound=Callable[..., Any])


def checked(**checks: Check) -> Callable[[Checked], Checked]:
    """Decorator of a function or of a class: its arguments pass the checks named for them."""

    def decorate(target: Checked) -> Checked:
        if isinstance(target, type):
            initialize = checked(**checks)(target.__init__)  # type: ignore[misc]
            target.__init__ = initialize  # type: ignore[misc]
            target.__checks__ = checks  # type: ignore[attr-defined]
            return target
        signature = inspect.signature(target)
        parameters = signature.parameters
        missing = set(checks) - set(parameters)
        assert not missing, f"{target.__qualname__} has no parameter {missing}"
        optional = {name for name in checks if parameters[name].default is None}

        @functools.wraps(target)
        def call(*args: Any, **kwargs: Any) -> Any:
            bound = signature.bind(*args, **kwargs)
            for name, value in bound.arguments.items():
                if name in checks and not (value is None and name in optional):
                    bound.arguments[name] = checks[name](value, name.replace("_", " "))
            return target(*bound.args, **bound.kwargs)

        return cast(Checked, call)

    return decorate


def bounds_of(check: Any) -> str:
    """Bounds of the numbers that a check takes, for people: "> 0  < 0.5"; "" if it has none."""
    return str(getattr(check, "bounds", ""))


def choices_of(check: Any) -> tuple[str, ...]:
    """Names that a check takes; none if it takes something else."""
    return tuple(getattr(check, "choices", ()))


def _telling(check: Check, **facts: Any) -> Check:
    """The check, with what `bounds_of` and `choices_of` tell of it."""
    vars(check).update(facts)
    return check


def _range(low: float, high: float, above: float = -math.inf, below: float = math.inf) -> str:
    least = f">= {low:g}" if low > above else f"> {above:g}"
    most = f"<= {high:g}" if high < below else f"< {below:g}"
    finite = ((least, max(low, above)), (most, min(high, below)))
    return "  ".join(text for text, value in finite if math.isfinite(value))


def number(
    unit: str,
    low: float = -math.inf,
    high: float = math.inf,
    *,
    above: float = -math.inf,
    below: float = math.inf,
    name: str = "",
) -> Check:
    """A number in the closed range [low, high] that is also > `above` and < `below`."""

    def check(value: Any, label: str) -> float:
        label = name or label
        if above == 0.0:
            units.require_positive(value, label, unit)
        found = units.require_range(value, label, unit, low, high)
        if not above < found < below:
            limit = f"above {above:g}" if found <= above else f"below {below:g}"
            unit_text = "" if unit == "1" else f" {unit}"
            raise UnitRangeError(
                f"{label} is {found:.12g}{unit_text}, but must be {limit}{unit_text}."
            )
        return found

    return _telling(check, bounds=_range(low, high, above, below))


#: degree, within a turn to either side: far beyond, a direction has no digits left.
ANGLE = number("degree", -360.0, 360.0)


def length(name: str = "") -> Check:
    """A length in mm, within `units.LENGTHS`."""
    return _telling(
        lambda value, label: units.require_length(value, name or label),
        bounds=_range(*units.LENGTHS),
    )


def whole(low: int, high: int, name: str = "") -> Check:
    """A whole number in the closed range [low, high]."""
    return _telling(
        lambda value, label: units.require_whole(value, name or label, low, high),
        bounds=_range(low, high),
    )


def series(unit: str, name: str = "") -> Check:
    """One number, or several in a row: (n,) floats, n >= 1."""
    return lambda value, label: units.require_series(value, name or label, unit)


def point(unit: str, name: str = "") -> Check:
    """Two numbers (x, y)."""

    def check(value: Any, label: str) -> tuple[float, float]:
        label = name or label
        found = units.require_series(value, label, unit)
        if len(found) != 2:
            raise UnitRangeError(f"{label} must be two numbers (x, y) in {unit}, not {len(found)}.")
        for place in found:
            units.require_range(place, label, unit, -units.FARTHEST, units.FARTHEST)
        return found[0], found[1]

    return check


def choice(what: str, known: Collection[str]) -> Check:
    """One of the known names."""
    return _telling(lambda value, label: require_choice(value, what, known), choices=tuple(known))


def choices(what: str, known: Collection[str]) -> Check:
    """One of the known names, or several, each once: (n,) texts, n >= 1."""

    def check(value: Any, label: str) -> tuple[str, ...]:
        listed = value.tolist() if hasattr(value, "tolist") else value
        several = listed if isinstance(listed, list | tuple) else (listed,)
        found = tuple(require_choice(item, what, known) for item in several)
        if not found or len(set(found)) != len(found):
            raise UnitRangeError(
                f"{label} must be one or more names, each once, not {shown(value)}."
            )
        return found

    return check


def require_choice(value: Any, what: str, known: Collection[str]) -> str:
    """Return one of the known names, or refuse another; `what` it is, for the message."""
    if not isinstance(value, str) or value not in known:
        raise UnknownNameError(f"There is no {what} {shown(value)}. {suggest(value, known)}")
    return str(value)


def optional(check: Check) -> Check:
    """None, or what a check takes: where None is not the default but means something."""
    return lambda value, label: None if value is None else check(value, label)


def instance(home: str, remedy: str) -> Check:
    """An object of a class "module:Class", which is not imported: it would be, if there is one."""
    module, _, name = home.partition(":")

    def check(value: Any, label: str) -> Any:
        if not isinstance(value, getattr(sys.modules.get(module), name, ())):
            raise BadInputError(
                f"{label} must be a {name}, not {shown(value)} ({type(value).__name__}): {remedy}."
            )
        return value

    return check


def flag(value: Any, label: str) -> bool:
    """True or False."""
    if not isinstance(value, bool) and type(value).__name__ not in ("bool_", "bool"):
        raise BadInputError(f"{label} is {shown(value)}: give True or False.")
    return bool(value)


def text(value: Any, label: str) -> str:
    """A text."""
    if not isinstance(value, str):
        raise BadInputError(f"{label} must be a text, not {shown(value)} ({type(value).__name__}).")
    return str(value)


def path(value: Any, label: str) -> Path:
    """A place in the file system, as text or path."""
    given = str(value) if isinstance(value, str | os.PathLike) else ""
    try:
        longest = max(len(os.fsencode(part)) for part in [given, *Path(given).parts][1:] or [given])
    except UnicodeEncodeError:
        longest = sys.maxsize
    if not given or "\0" in given or longest > 255:
        raise BadInputError(
            f"{label} must be the path of a file or folder, not {shown(value)} "
            f"({type(value).__name__})."
        )
    return Path(value)


def function(value: Any, label: str) -> Any:
    """Something to be called."""
    if not callable(value):
        raise BadInputError(f"{label} must be a function, not {shown(value)}.")
    return value


def having(*names: str, remedy: str) -> Check:
    """An object with methods of these names."""

    def check(value: Any, label: str) -> Any:
        lacking = [name for name in names if not callable(getattr(type(value), name, None))]
        if lacking:
            raise BadInputError(
                f"{label} must be {remedy}, not {shown(value)} ({type(value).__name__}), which has "
                f"no {', '.join(lacking)}."
            )
        return value

    return check


def place(given: Any, name: str) -> tuple[float, float]:
    """A check of a point of a pattern, mm, no farther away than the longest sheet is long.

    Raises
    ------
    BadInputError : not two finite numbers, or a point too far away.
    """
    values = series("mm", name)(given, name)
    if len(values) != 2:
        raise BadInputError(f"{name} needs two lengths in mm, along x and y, not {len(values)}.")
    farthest = units.LENGTHS[1]
    for value in values:
        units.require_range(value, name, "mm", -farthest, farthest)
    return values[0], values[1]


PATTERN = instance(
    "flexscale.patterns.pattern:Pattern", "make one with fs.Pattern, or take fs.named_pattern"
)
DATASET = instance("xarray:Dataset", "take one that is stored, with fs.open_registry().one(…)")
MODEL = having("sheet_law", remedy="a model, as fs.fit or fs.gap_model makes it")
CHECKPOINT = having("load", "append", remedy="a checkpoint")


def options(home: str) -> Check:
    """Options of a class "module:Class"."""
    return instance(home, f"write fs.{home.partition(':')[2]}(…)")


MESH = options("flexscale.mesh.options:MeshOptions")
SOLID = options("flexscale.mesh.solid_options:SolidOptions")
SOLVER = options("flexscale.solve.solver_options:SolverOptions")
CONTACT = options("flexscale.mechanics.contact_options:ContactOptions")
SUBSTRATE = options("flexscale.mechanics.substrate_options:SubstrateOptions")
SCALES = options("flexscale.mechanics.scale_options:ScaleOptions")
RIG = options("flexscale.sheets.rigs:RigOptions")
SHEET = options("flexscale.sheets.bent_sheet:SheetOptions")
MATERIAL = instance(
    "flexscale.patterns.material:NeoHookean",
    "write fs.NeoHookean(young_modulus=…, poisson_ratio=…), fs.PETG or fs.TPU",
)
