"""Sentences for people: which samples of a dataset failed, and what an experiment may say."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, get_args, get_origin

import numpy as np
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from flexscale.checks import bounds_of, choices_of
from flexscale.datasets.store import Entry, Store
from flexscale.datasets.variables import statuses
from flexscale.status import SolveStatus
from flexscale.steps.blocks import MATERIALS
from flexscale.steps.option_blocks import Options, option_fields
from flexscale.steps.quantities import markers_of, unit_of

if TYPE_CHECKING:
    import xarray as xr


def failed_samples(dataset: xr.Dataset) -> list[str]:
    """One line per sample that did not converge: status, direction, side, curvature.

    Directions filled in by symmetry are left out; their source is listed. Datasets without a
    status have none.
    """
    lines = []
    for device, status in statuses(dataset).items():
        dims = sorted(map(str, status.dims), key=lambda dim: _ORDER.get(dim, len(_ORDER)))
        for index in np.argwhere(status.values != SolveStatus.converged):
            sample = status[tuple(index)]
            if _is_copied(dataset, sample):
                continue
            facts = [device] * bool(device) + [_fact(sample[dim]) for dim in dims]
            lines.append(f"{SolveStatus(int(sample)).name}: {', '.join(facts)}")
    return lines


_ORDER = {"direction": 0, "side": 1}


def _is_copied(dataset: xr.Dataset, sample: xr.DataArray) -> bool:
    """Whether symmetry filled the sample in."""
    if "symmetry_source" not in dataset:
        return False
    source = dataset["symmetry_source"]
    source = source.sel({dim: sample[dim] for dim in source.dims})
    return bool(source != sample["direction"])


def _fact(coordinate: xr.DataArray) -> str:
    """For instance "closing", or "angle 30 degree"."""
    if coordinate.dtype.kind not in "fi":
        return str(coordinate.values)
    return f"{coordinate.name} {float(coordinate):g} {coordinate.attrs.get('units', '')}".rstrip()


def outcome(store: Store, entry: Entry) -> tuple[str, list[str]]:
    """How the samples of a stored dataset ended.

    Returns
    -------
    For instance ``("  168 samples, 1 not converged", [one line on it])``; ``("", [])`` for
    datasets without samples.
    """
    samples, failed = entry.row["samples"], entry.row["failed"]
    if not samples:
        return "", []
    text = f"  {samples} samples, {failed} not converged" if failed else f"  {samples} samples"
    return text, failed_samples(store.load(entry)) if failed else []


_HEADINGS = ("key", "unit", "default", "bounds", "meaning")


def describe_experiment(block: type[BaseModel]) -> str:
    """Table of every field of an experiment: name, unit, default, bounds, meaning and names."""
    return _line(*_HEADINGS) + _describe(block, "")


def _describe(block: type[BaseModel], prefix: str) -> str:
    lines = []
    for name, field in block.model_fields.items():
        place = f"{prefix}{name}"
        inner, options = _inner_block(field.annotation), _options(field.annotation)
        default = "required" if field.is_required() else _shown(field.default)
        if options is not None or (inner is not None and field.default not in MATERIALS.values()):
            default = default if field.is_required() else ""
        meaning = _with_choices(field.description or "", _choices(field))
        lines.append(_line(place, unit_of(field), default, _bounds(field), meaning))
        for item in option_fields(options) if options is not None else ():
            meaning = _with_choices(item.meaning, item.choices)
            where = f"{place}.{item.name}"
            lines.append(_line(where, item.unit, _shown(item.default), item.bounds, meaning))
        if inner is not None:
            step = ".NAME." if get_origin(field.annotation) is dict else "."
            lines.append(_describe(inner, place + step))
    return "".join(lines)


def _line(place: str, unit: str, default: str, bounds: str, meaning: str) -> str:
    unit = "" if unit == "1" else unit
    return f"{place:<47} {unit:<7} {default:<22} {bounds:<22} {meaning}\n"


_SIGNS = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}


def _bounds(field: FieldInfo) -> str:
    """For instance "> 0"; those of a check of the package are closer than signs beside it."""
    told = [bounds_of(getattr(marker, "func", None)) for marker in markers_of(field)]
    found = ((key, getattr(item, key, None)) for item in markers_of(field) for key in _SIGNS)
    signs = [f"{_SIGNS[key]} {value:g}" for key, value in found if value is not None]
    return "  ".join([item for item in told if item] or signs)


def _choices(field: FieldInfo) -> tuple[str, ...]:
    """Names that a field takes."""
    for marker in markers_of(field):
        if choices := choices_of(getattr(marker, "func", None)):
            return choices
    waiting = [field.annotation]
    while waiting:
        annotation = waiting.pop()
        if get_origin(annotation) is Literal:
            return tuple(map(str, get_args(annotation)))
        waiting += get_args(annotation)
    return ()


def _with_choices(meaning: str, choices: tuple[str, ...]) -> str:
    """The meaning, and the names to choose from unless it has them already."""
    if all(name in meaning for name in choices):
        return meaning
    return f"{meaning}: {', '.join(choices)}"


def _options(annotation: Any) -> type[Options] | None:
    """Class of an option block."""
    return annotation if hasattr(annotation, "to_config") else None


def _inner_block(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    found = (_inner_block(argument) for argument in get_args(annotation))
    return next((block for block in found if block is not None), None)


def _shown(value: Any) -> str:
    names = [name for name, material in MATERIALS.items() if material == value]
    if names:
        return names[0]
    if isinstance(value, tuple):
        few = ", ".join(_shown(item) for item in value[:3])
        return f"[{few}{', …' if len(value) > 3 else ''}]"
    return "-" if value is None else f"{value:g}" if isinstance(value, float) else str(value)
