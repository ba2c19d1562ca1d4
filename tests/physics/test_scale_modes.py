"""Scales of few modes against the finite elements they come from."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import flexscale as fs
from flexscale.embedding.bends import Bend
from flexscale.embedding.display import Display
from flexscale.errors import UnknownNameError
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import follow_line
from flexscale.homogenize.tangent import solve_tangent
from flexscale.solve.solver_options import SolverOptions
from tests.derivatives import directional_difference, relative_error
from tests.physics.cells import hexagon, square

MESH = fs.MeshOptions(
    across=2, corner=0.25, growth=1.6, across_grading=1.0, scale_rim=0.45, scale_strips=1,
    scale_size=3.4, scale_corner=0.9, scale_growth=3.0, scale_layers=3, layer_growth=3.0,
)  # fmt: skip
#: The coarsest on which modes still meet the tets in contact: a tenth of the time.
COARSEST = fs.MeshOptions(
    across=2, corner=0.4, scale_rim=0.45, scale_strips=1, scale_size=5.0, scale_corner=2.0,
    scale_growth=3.0, scale_layers=2, layer_growth=3.0,
)  # fmt: skip
MODES, TETS = fs.ScaleOptions("modes"), fs.ScaleOptions("tets")


@cache
def problem(make, scales, contact=True, mesh=MESH):
    """A cell on one mesh, with scales of either kind."""
    options = fs.ContactOptions(enabled=contact)
    return CellProblem.from_pattern(
        make(), fs.NativeModel("shell", contact=options, scales=scales, mesh=mesh)
    )


@pytest.mark.parametrize(("make", "direction"), [(square, 0.0), (square, 45.0), (hexagon, 10.0)])
def test_modes_give_the_stiffness_of_the_tets(make, direction):
    """They are a subspace and come from above; the cutoff leaves 0.5 % on so coarse a mesh."""
    tets = solve_tangent(problem(make, TETS, False)).stiffness(direction)
    modes = solve_tangent(problem(make, MODES, False)).stiffness(direction)
    assert -1e-9 < modes / tets - 1.0 < 5e-3


def test_more_modes_come_nearer_to_the_tets():
    tets = solve_tangent(problem(hexagon, TETS, False)).stiffness(0.0)
    errors, counts = [], []
    for cutoff in (0.1, 5e-3, 2e-4):
        few = problem(hexagon, fs.ScaleOptions(cutoff=cutoff), False)
        errors.append(solve_tangent(few).stiffness(0.0) / tets - 1.0)
        counts.append(few.bodies[0].modes.shape[2])
    assert errors[0] > 20.0 * errors[1] > 100.0 * errors[2] > 0.0
    assert counts == sorted(counts)


@pytest.mark.parametrize(
    ("mesh", "curvatures"),
    [
        pytest.param(COARSEST, (0.006, 0.012), id="coarsest"),
        pytest.param(MESH, (0.006, 0.012, 0.02), marks=pytest.mark.slow, id="to twice the onset"),
    ],
)
def test_modes_touch_as_the_tets_do(mesh, curvatures):
    """Squares along a side, in contact: moments differ by less than 2 %, stretches by 2e-3."""
    line, found = Line("closing", 0.0, curvatures), []
    for scales in (TETS, MODES):
        samples = list(follow_line(problem(square, scales, mesh=mesh), line, SolverOptions()))
        assert all(sample["status"] == 0 for sample in samples)
        assert [sample["contact_pairs"] > 0 for sample in samples] == [k > 0.01 for k in curvatures]
        found.append(samples[-1])
    assert found[1]["moment"] == pytest.approx(found[0]["moment"], rel=0.02)
    assert found[1]["stretch"] == pytest.approx(found[0]["stretch"], abs=2e-3)


def test_bodies_and_tets_are_shown_alike():
    """Scales and sheet of the bent cell lie at the same places, to 2 % of the gap."""
    bend, line, shown = Bend(0.008, 0.4), Line("closing", float(np.degrees(0.4)), (0.008,)), []
    for scales in (TETS, MODES):
        cell = problem(hexagon, scales)
        (sample,) = follow_line(cell, line, SolverOptions())
        points = Display(cell.embedding).place(sample["state"], bend)
        shown.append(points - points[:1])
    assert np.abs(shown[0] - shown[1]).max() < 0.02 * 0.4


def test_energy_of_a_body():
    """Derivatives, and no energy for rotations however large."""
    body = problem(square, MODES).bodies[0]
    rng = np.random.default_rng(2)
    turn = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    unknowns = np.concatenate(
        [rng.standard_normal(3), turn.ravel(), np.zeros(body.n_unknowns - 12)]
    )
    assert body.energy(unknowns) < 1e-20
    unknowns += 0.01 * rng.standard_normal(len(unknowns))
    step = rng.standard_normal(len(unknowns))
    slope = directional_difference(lambda h: body.energy(unknowns + h * step), 1e-4)
    assert body.gradient(unknowns) @ step == pytest.approx(float(slope), rel=1e-6)
    curve = directional_difference(lambda h: body.gradient(unknowns + h * step), 1e-4)
    assert relative_error(body.hessian(unknowns) @ step, curve) < 1e-6
    assert np.linalg.eigvalsh(body.hessian(unknowns, project=True)).min() > -1e-8


def test_unknown_scale_model_is_refused():
    with pytest.raises(UnknownNameError, match="Did you mean 'tets'"):
        fs.ScaleOptions("tetts")
