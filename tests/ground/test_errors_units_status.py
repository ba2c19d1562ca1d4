"""Floor 0: exit codes, sentences, unit checks, status flags."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
import xarray as xr

from flexscale import errors, units
from flexscale.status import FLAG_MEANINGS, SolveStatus


def test_exit_codes_follow_the_interface() -> None:
    codes = {
        "FlexScaleError": 1,
        "PatternError": 2,
        "TilingError": 2,
        "MeshError": 2,
        "UnitRangeError": 2,
        "ConfigError": 2,
        "UnknownNameError": 2,
        "MissingDataError": 4,
        "MissingSystemPartError": 4,
        "IntegrityError": 4,
        "NonReproducibleError": 4,
        "SchemaError": 4,
    }
    assert {name: getattr(errors, name).exit_code for name in codes} == codes


def test_suggest_finds_typos_in_any_case_and_lists_the_rest() -> None:
    sentence = errors.suggest("Hexagn", ["square", "hexagon"])
    assert sentence == "Did you mean 'hexagon'? Known: 'hexagon', 'square'."
    assert errors.suggest("xyz", ["a"]) == "Known: 'a'."
    assert errors.suggest("xyz", []) == "Nothing is known here yet."
    assert "(20 in all)" in errors.suggest("xyz", range(20))


@pytest.mark.parametrize("value", [0.0, -0.4, float("nan"), float("inf"), True, "0.4", None])
def test_require_positive_refuses_with_name_and_unit(value: object) -> None:
    with pytest.raises(errors.UnitRangeError, match=r"^gap .*mm.*\.$"):
        units.require_positive(value, "gap", "mm")  # type: ignore[arg-type]


def test_unit_checks_return_plain_floats() -> None:
    assert type(units.require_positive(np.float32(0.5), "gap", "mm")) is float
    assert units.require_range(3, "order", "1", 1, 3) == 3.0


def test_require_range_names_both_bounds() -> None:
    with pytest.raises(errors.UnitRangeError) as caught:
        units.require_range(0.5, "Poisson's ratio", "1", 0.0, 0.49)
    assert str(caught.value) == "Poisson's ratio is 0.5, but must lie between 0 and 0.49."


def test_flag_meanings_stand_in_the_order_of_their_values() -> None:
    names = FLAG_MEANINGS.split()
    assert [SolveStatus[name] for name in names] == list(range(len(SolveStatus)))
    assert all(status.sentence.endswith(".") for status in SolveStatus)


NOT_NUMBERS = [
    None, True, np.bool_(True), "0.4", b"1", 1j, object(), [1.0], {}, np.array([0.4]),
    np.array("0.4"), np.array(1j), np.ma.masked, 10**400, math.nan, -math.inf, np.array(math.nan),
]  # fmt: skip


@pytest.mark.parametrize("value", NOT_NUMBERS, ids=lambda value: type(value).__name__)
def test_what_is_no_finite_number_is_refused_with_name_and_unit(value: object) -> None:
    with pytest.raises(errors.UnitRangeError, match=r"^gap .*mm"):
        units.require_finite(value, "gap", "mm")


def test_numbers_come_in_many_types() -> None:
    numbers = [2, 2.0, np.int8(2), np.float32(2.0), Fraction(2), np.array(2.0), xr.DataArray(2)]
    assert [units.require_finite(number, "gap", "mm") for number in numbers] == [2.0] * 7


@pytest.mark.parametrize("value", [0.4, [0.4], (0.4,), np.array(0.4), np.array([0.4])])
def test_one_number_is_a_series_of_one(value: object) -> None:
    assert units.require_series(value, "gaps", "mm") == (0.4,)


@pytest.mark.parametrize(
    "value",
    [[], "0.4", ["0.4"], [[0.4]], [0.4, None], {0.4}, {"a": 0.4}, np.zeros((2, 2)), iter([0.4]),
     range(10**12), np.ma.array([0.4, 0.5], mask=[0, 1]), [math.nan], [True]],
    ids=lambda value: type(value).__name__,
)  # fmt: skip
def test_what_is_no_series_is_refused(value: object) -> None:
    with pytest.raises(errors.UnitRangeError, match=r"^gaps "):
        units.require_series(value, "gaps", "mm")


@pytest.mark.parametrize(
    "value",
    [None, "1", ["1"], [[1, 2], [3]], [True, "a"], 1j, [math.inf], {"a": 1}, np.array(["1"]),
     np.array([None]), np.ma.array([1.0], mask=[1]), np.zeros(2, dtype=[("a", float)]),
     np.array(["2020"], dtype="datetime64[Y]"), [10**400]],
    ids=str,
)  # fmt: skip
def test_what_is_no_array_of_numbers_is_refused(value: object) -> None:
    with pytest.raises(errors.UnitRangeError, match=r"^gaps must be numbers in mm, all finite"):
        units.require_array(value, "gaps", "mm")


@pytest.mark.parametrize("value", [range(10**12), [[0.1, 0.2], range(10**12)], [[[[0.1] * 10**7]]]])
def test_numbers_that_no_memory_holds_are_refused_at_once(value: object) -> None:
    with pytest.raises(errors.UnitRangeError, match="more than can be taken"):
        units.require_array(value, "gaps", "mm")


def test_lengths_lie_between_a_micrometer_and_ten_meters() -> None:
    assert units.require_length(100, "width") == 100.0
    for value in (1e-6, 1e6):
        with pytest.raises(errors.UnitRangeError, match=r"must lie between 0\.001 mm and 10000 mm"):
            units.require_length(value, "width")


def _nested() -> list[object]:
    found: list[object] = []
    found.append(found)
    return found


@pytest.mark.parametrize(
    "value", ["x" * 9000, 10**5000, list(range(9000)), np.zeros(9000), _nested(), {0: "y" * 900}],
    ids=["text", "number", "list", "array", "endless", "dict"],
)  # fmt: skip
def test_values_in_messages_are_cut_to_a_line(value: object) -> None:
    said = errors.shown(value)
    assert 0 < len(said) < 200
    assert "\n" not in said


def test_messages_can_be_printed_whatever_went_into_them() -> None:
    said = str(errors.ConfigError(f"There is no \x1b[31m {'x' * 9000}\nhere\ud800."))
    assert "\x1b" not in said
    assert [len(line) <= errors.LONGEST_LINE for line in said.split("\n")] == [True, True]
    assert said.startswith("There is no \\x1b[31m x")
    assert said.encode()
