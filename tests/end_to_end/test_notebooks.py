"""The notebooks run as scripts in some seconds, on the datasets that come with the code.

A user's own datasets of the same patterns lie beside these and must not matter.
"""

from __future__ import annotations

import runpy
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def _quiet(monkeypatch: pytest.MonkeyPatch, crowded_results: Path) -> Iterator[None]:
    """Without a display, and started from a folder beside the results, as Jupyter does."""
    plt.switch_backend("agg")
    folder = crowded_results.parent / "notebooks"
    folder.mkdir(exist_ok=True)
    monkeypatch.chdir(folder)
    yield
    plt.close("all")


def execute(name: str) -> dict[str, Any]:
    """Names that a notebook has at its end."""
    return runpy.run_path(str(ROOT / "notebooks" / f"{name}.py"))


def test_explore_a_sweep() -> None:
    names = execute("explore_sweep")
    assert names["unconverged"] == 0
    assert float(names["along"]) > 5.0 * float(names["across"]), "bricks jam along their courses"


def test_compare_families() -> None:
    names = execute("compare_families")
    assert set(names["overview"].index) == set(names["jams"].index)
    assert len(names["overview"]) == 12
    assert (names["overview"]["ratio"] >= 1.0).all()


def test_from_pattern_to_macro_sheet() -> None:
    names = execute("macro_sheet")
    assert names["sheet"].status.name == "converged"
    assert 0.5 * names["law"] < names["sheet"].energy_density < names["law"]


def test_all_notebooks_are_tested() -> None:
    texts = {path.stem: path.read_text() for path in (ROOT / "notebooks").glob("*.py")}
    assert set(texts) == {"explore_sweep", "compare_families", "macro_sheet"}
    assert all(text.startswith("# %% [markdown]\n") for text in texts.values())
