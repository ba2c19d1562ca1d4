"""Laws that benchmarks/laws.py compares: one file for each, found by its name.

A file has NAME, WHAT it is in one line, and `make(data)`, which gives anything with a `sheet_law`.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import xarray as xr

import flexscale as fs


@dataclass(frozen=True)
class LawData:
    """What a law may be made from: a pattern, and what was computed of it on joints."""

    pattern: fs.Pattern
    sweep: xr.Dataset
    tangent: xr.Dataset
    tensor_sweep: xr.Dataset


@dataclass(frozen=True)
class ComparedLaw:
    """A law by name."""

    name: str
    what: str
    make: Callable[[LawData], Any]


def all_laws() -> list[ComparedLaw]:
    """Of the files in this folder, in the order of their names."""
    names = sorted(info.name for info in pkgutil.iter_modules(__path__))
    modules = [importlib.import_module(f"{__name__}.{name}") for name in names]
    return [ComparedLaw(module.NAME, module.WHAT, module.make) for module in modules]
