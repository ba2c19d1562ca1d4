"""Tests give the same verdict whatever lies in the checkout's results folder."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import flexscale as fs
from flexscale.errors import MissingDataError
from tests.shipped import ROOT, TWINS

#: The checkout's results folder, named in a test; or a command that takes it as its default.
_CHECKOUT = re.compile(r"""(ROOT|parents\[\d\]) */ *["']results["'] *\)""")


def test_no_test_takes_datasets_from_the_checkout() -> None:
    """They take them from `shipped_results`, ask for the shipped ones, or make their own."""
    found = [
        str(path.relative_to(ROOT))
        for path in sorted((ROOT / "tests").rglob("*.py"))
        if path.name not in ("shipped.py", Path(__file__).name)
        and _CHECKOUT.search(text := path.read_text(encoding="utf-8"))
        and 'source="reference"' not in text
    ]
    assert found == []


@pytest.mark.parametrize(("kind", "pattern"), TWINS[::3])
def test_shipped_datasets_are_told_from_ones_own(
    kind: str, pattern: str, shipped_results: Path, crowded_results: Path
) -> None:
    shipped, crowded = fs.open_registry(shipped_results), fs.open_registry(crowded_results)
    assert len(crowded) == len(shipped) + len(TWINS)
    with pytest.raises(MissingDataError, match=r"\d datasets"):
        crowded.one(kind=kind, pattern=pattern)
    found = crowded.one(kind=kind, pattern=pattern, source="reference")
    assert found.identical(shipped.one(kind=kind, pattern=pattern))
