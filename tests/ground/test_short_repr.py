"""Printing a result tells what it is, in a few lines."""

from __future__ import annotations

import importlib
import inspect
from dataclasses import dataclass, is_dataclass, replace
from types import UnionType
from typing import Any

import numpy as np
import pytest
import shapely

import flexscale as fs
from flexscale.fabricate import Rectangle, printable_sheet
from flexscale.patterns.laid import lay_pattern, rectangle
from flexscale.short_repr import MOST, WIDTH, ShortRepr

#: Classes that hold a few numbers each: the repr of dataclasses is short.
SMALL = {"ContactOptions", "MeshOptions", "NeoHookean", "RigOptions", "ScaleOptions"}
SMALL |= {
    "SheetOptions",
    "SolidOptions",
    "SolverOptions",
    "SubstrateOptions",
    "NamedPattern",
    "NativeModel",
    "Between",
    "Family",
}


def assert_short(result: Any, *words: str) -> None:
    lines = repr(result).splitlines()
    assert 1 <= len(lines) < 20
    assert max(map(len, lines)) <= WIDTH
    assert type(result).__name__ in lines[0]
    for word in words:
        assert word in repr(result)


def public_classes() -> list[type]:
    """Those that are public, and those that public functions return."""
    found: set[type] = set()
    for name in fs.__all__:
        item = getattr(fs, name)
        if inspect.isclass(item):
            found.add(item)
        elif inspect.isfunction(item):
            home = importlib.import_module(item.__module__)
            answer = inspect.get_annotations(item)["return"]
            kind = vars(home).get(answer, None) if isinstance(answer, str) else answer
            if inspect.isclass(kind) and not isinstance(kind, UnionType):
                found.add(kind)
    return sorted(found, key=lambda kind: kind.__name__)


def test_every_public_class_has_a_short_repr() -> None:
    kinds = [kind for kind in public_classes() if is_dataclass(kind)]
    assert {"BentSheet", "MandrelTest", "StageTest", "ScaledSheet"} <= {k.__name__ for k in kinds}
    for kind in kinds:
        assert kind.__name__ in SMALL or not kind.__dataclass_params__.repr, kind


def test_sheets_of_tiles_and_prints_are_told_in_a_few_lines() -> None:
    square = fs.named_pattern("square")
    laid = lay_pattern(square, rectangle(30.0, 20.0), 45.0)
    assert_short(laid, "45", "mm", "tiles", f"{len(laid.tiles)} of tuple", "array (4, 2)")
    sheet = printable_sheet(square, Rectangle(30.0, 20.0))
    assert_short(sheet, "PrintableSheet: Scales and substrate in place", "Rectangle")
    for part in (sheet.plan, sheet.plan.scales[0], sheet.substrate):
        assert_short(part)
    assert "(n, 3) mm" in repr(sheet.substrate)


@dataclass(frozen=True, repr=False)
class Sample(ShortRepr):
    """A result with much in it.

    Further words that are not told.

    Attributes
    ----------
    length, width : mm, along x
        and y.
    states : (n, 3) mm-1.
    outline : of the sheet, mm.
    """

    length: float
    width: float
    states: np.ndarray
    outline: shapely.Polygon
    names: tuple[str, ...] = ()


def test_attributes_come_with_value_or_size_and_meaning() -> None:
    sample = Sample(100.0, 1 / 3, np.zeros((5000, 3)), shapely.box(0, 0, 1, 1), ("a", "b"))
    assert repr(sample).splitlines() == [
        "Sample: A result with much in it.",
        "  length   100              mm, along x and y.",
        "  width    0.333333         mm, along x and y.",
        "  states   array (5000, 3)  (n, 3) mm-1.",
        "  outline  Polygon          of the sheet, mm.",
        "  names    2 of tuple",
    ]
    assert_short(replace(sample, states=np.array([2.5])), "2.5")


@pytest.mark.parametrize("n", [MOST, MOST + 30])
def test_many_attributes_are_cut(n: int) -> None:
    names = {f"attribute_{k}": float for k in range(n)}
    space = {"__annotations__": names, "__doc__": "Many."}
    kind = dataclass(frozen=True, repr=False)(type("Many", (ShortRepr,), space))
    assert_short(kind(*np.arange(float(n))))
