"""Pictures of experiments: whose they are, when they are drawn again, and that none is lost."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from flexscale.datasets.identity import Recipe
from flexscale.datasets.store import Entry, Store
from flexscale.steps.catalog import FIGURES, STEPS
from flexscale.steps.figures import draw_figure, figure_is_current, figure_path
from tests.macro.fit_samples import law_sweep


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path / "results")


def sweep_of(store: Store, experiment: str, **changes: float) -> Entry:
    """A sweep of the same pattern as computed by another experiment."""
    return store.publish(law_sweep(**changes), "sweep", Recipe("sweep", 1, {"of": experiment}))


def test_experiments_do_not_draw_over_each_others_pictures(store: Store) -> None:
    """Neither files of one name in two folders, nor one file before and after it was changed."""
    first, second = sweep_of(store, "first"), sweep_of(store, "second", softening=6.0)
    paths = [draw_figure("polar", "squares", [entry], store) for entry in (first, second)]
    assert paths[0] != paths[1]
    assert paths[0].read_bytes() != paths[1].read_bytes()
    for path, entry in zip(paths, (first, second), strict=True):
        assert path.name == f"squares-polar-{entry.id.split(':')[1]}.png"
        told = json.loads(path.with_suffix(".json").read_text())
        assert [source["id"] for source in told["sources"]] == [entry.id]
        assert figure_is_current("polar", "squares", [entry], store)


def test_a_picture_is_drawn_again_when_a_part_of_it_is_gone(store: Store) -> None:
    entry = sweep_of(store, "first")
    assert not figure_is_current("polar", "squares", [entry], store)
    path = draw_figure("polar", "squares", [entry], store)
    assert figure_is_current("polar", "squares", [entry], store)
    path.with_suffix(".json").write_text("[]")
    assert not figure_is_current("polar", "squares", [entry], store)


@pytest.mark.parametrize("name", FIGURES)
def test_the_first_dataset_of_a_figure_tells_which_the_others_are(name: str) -> None:
    """Its id stands in the picture's name for all of them."""
    first, *others = FIGURES[name].needs
    assert set(others) <= set(STEPS[first].block.takes)


def test_pictures_of_one_experiment_differ_by_pattern_and_figure(store: Store) -> None:
    entry = sweep_of(store, "first")
    asked = [(name, pattern) for name in FIGURES for pattern in ("a", "a-b", "b")]
    assert len({figure_path(*item, [entry], store) for item in asked}) == len(asked)
