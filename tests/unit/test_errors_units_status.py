"""Floor 0: exit codes, sentences, unit checks, status flags."""

from __future__ import annotations

import numpy as np
import pytest

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
