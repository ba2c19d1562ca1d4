"""Sentences for people: which samples of a dataset failed, and what an experiment may say."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, get_args, get_origin

import numpy as np
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from flexscale.datasets.store import Entry, Store
from flexscale.datasets.variables import statuses
from flexscale.mechanics.contact_options import ContactOptions
from flexscale.mesh.options import MeshOptions
from flexscale.solve.newton import SolverOptions
from flexscale.status import SolveStatus
from flexscale.steps.blocks import MATERIALS
from flexscale.steps.option_blocks import option_fields
from flexscale.steps.quantities import unit_of

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
    source = dataset["symmetry_source"].sel(side=sample["side"], direction=sample["direction"])
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


def describe_fields(block: type[BaseModel], prefix: str = "") -> str:
    """Lines on every field of an experiment block: name, unit, default and bounds, meaning."""
    lines = []
    for name, field in block.model_fields.items():
        place, meaning = f"{prefix}{name}", field.description or ""
        inner = _inner_block(field.annotation)
        facts = [f"{_SIGNS[key]} {value:g}" for key, value in _bounds(field).items()]
        if field.is_required():
            facts.insert(0, "required")
        elif inner is None or field.default in MATERIALS.values():
            facts.insert(0, _shown(field.default))
        if field.annotation in (MeshOptions, ContactOptions, SolverOptions):
            lines.append(_line(place, "", "", meaning))
            lines += [
                _line(f"{place}.{item.name}", item.unit, _shown(item.default), item.meaning)
                for item in option_fields(field.annotation)
            ]
            continue
        lines.append(_line(place, unit_of(field), "  ".join(facts), meaning))
        if inner is not None:
            step = ".NAME." if get_origin(field.annotation) is dict else "."
            lines.append(describe_fields(inner, place + step))
    return "".join(lines)


def _line(place: str, unit: str, facts: str, meaning: str) -> str:
    return f"{place:<47} {unit if unit != '1' else '':<7} {facts:<22} {meaning}\n"


_SIGNS = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}


def _bounds(field: FieldInfo) -> dict[str, float]:
    found = ((key, getattr(item, key, None)) for item in field.metadata for key in _SIGNS)
    return {key: value for key, value in found if value is not None}


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
