"""From an experiment file through contact to a fit that agrees with closed forms."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml

import flexscale as fs
from flexscale.datasets.registry import open_registry
from flexscale.datasets.store import Store
from flexscale.steps.events import EventWriter
from flexscale.steps.experiment import load_experiment
from flexscale.steps.plan import build_plan
from flexscale.steps.worker import run_job
from tests.end_to_end.test_run import run

FILE = """
patterns:
  square: {{family: IH76}}
native: shell
mesh: {{{mesh}scale_size: 10, scale_layers: 1, scale_order: 1, scale_strips: 0}}
sweep:
  sides: [closing]
  directions: {{start: 0, stop: 180, step: 22.5}}
  curvatures: [0, 0.003, 0.006, 0.009, 0.011, 0.0125, 0.015]
fit: {{}}
figures: [{figures}]
"""
RUNS = [
    pytest.param(("across: 2, along: 2, corner: 0.5, ", ("fit",)), id="coarse"),
    pytest.param(("", ("fit", "fitted_curves")), marks=pytest.mark.slow, id="default sheet"),
]


def run_here(file: Path, results: Path) -> None:
    """All jobs of an experiment in this process: what starts them is in `test_run`."""
    plan = build_plan(load_experiment(file))
    for job in plan:
        run_job(plan, job, Store(results), 1, EventWriter(None))


@pytest.fixture(scope="module", params=RUNS)
def results(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("fit")
    mesh, figures = request.param
    (folder / "fit.yaml").write_text(FILE.format(mesh=mesh, figures=", ".join(figures)))
    if mesh:
        run_here(folder / "fit.yaml", folder / "results")
    else:
        code, _, err = run(folder / "fit.yaml", folder / "results")
        assert code == 0, err
    return folder / "results"


def figures(results: Path) -> list[str]:
    """Those that the experiment asks for."""
    asked: list[str] = yaml.safe_load((results.parent / "fit.yaml").read_text())["figures"]
    return asked


def test_fit_of_squares_agrees_with_closed_forms(results: Path) -> None:
    model = fs.MacroModel.from_dataset(open_registry(results).one(kind="fit"))
    assert model.n_parameters == 21
    assert model.n_ignored == 0
    law = model.laws.law(0)
    # Hinges in the gaps only, before contact: a = D P / g. The fit averages over curvatures.
    bending_stiffness = 26.0 * 0.4**3 / 12.0 / (1.0 - 0.48**2)
    for side_by_side in (0, 4):
        assert law.a[side_by_side] == pytest.approx(bending_stiffness * 10.0 / 0.4, rel=0.02)
        # Tops of the scales meet: kappa_0 = g / (P h); the barrier starts a little before.
        assert law.kappa_0[side_by_side] == pytest.approx(0.4 / (10.0 * 4.0), rel=0.03)
        assert law.b[side_by_side] > 100.0 * law.a[side_by_side]


def test_fit_knows_where_it_comes_from(results: Path) -> None:
    registry = open_registry(results)
    dataset = registry.one(kind="fit", pattern="square")
    assert json.loads(dataset.attrs["flexscale_inputs"]) == sorted(
        registry.find(kind=kind).one().id for kind in ("sweep", "tangent")
    )
    assert float(dataset["gap"]) == 0.4


def test_a_figure_names_both_datasets(results: Path) -> None:
    ids = [open_registry(results).find(kind=kind).one().id for kind in ("fit", "sweep")]
    for name in figures(results):
        (path,) = (results / "local" / "figures").glob(f"square-{name}-*.json")
        assert [source["id"] for source in json.loads(path.read_text())["sources"]] == ids
        assert path.with_suffix(".png").stat().st_size > 3000


@pytest.mark.slow
def test_second_run_does_nothing(results: Path) -> None:
    code, out, err = run(results.parent / "fit.yaml", results)
    assert (code, err) == (0, "")
    assert out.count("reused") == 4 + len(figures(results))
