"""The solid cell: plates in closed form, scales on it, derivatives, and what it refuses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexscale as fs
from flexscale.datasets.given import read_config
from flexscale.embedding.bends import Bend
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.cell_model import CellModel
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import follow_line
from flexscale.homogenize.tangent import solve_tangent
from flexscale.mesh.bare import build_bare_mesh
from flexscale.mesh.layers import layer_levels
from flexscale.system_failures import SystemFailureError
from tests.derivatives import multiply_upper, relative_error
from tests.physics.cells import D, hexagon, square

OBLIQUE = np.array([[3.0, 0.0], [1.0, 2.5]])
#: Few elements: 10 % too stiff, and solved in seconds.
COARSE = fs.NativeModel(
    "solid",
    mesh=fs.MeshOptions(
        along=5.0, corner=2.0, scale_size=10.0, scale_strips=0, scale_layers=1, scale_order=1
    ),
    scales=fs.ScaleOptions("rigid"),
    solid=fs.SolidOptions(edge=0.2, growth=2.0),
)
FREE = COARSE.without_contact


def test_bare_sheet_is_an_isotropic_plate() -> None:
    """C = D [1, nu; nu, 1], twist D (1 - nu)/2, and E t/(1 - nu^2) in its plane, to rounding.

    The field of a bent plate, with its thickness changing by the square of the height, is held by
    the wedges exactly: with Poisson's ratio 0.48 nothing locks.
    """
    model = CellModel.of_pattern(square(), FREE)
    tangent = solve_tangent(CellProblem(build_bare_mesh(OBLIQUE, 1.5), model))
    nu = fs.TPU.poisson_ratio
    shape = np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu)]])
    membrane = fs.TPU.young_modulus * 0.4 / (1.0 - nu**2)
    assert tangent.matrix == pytest.approx(D * shape, abs=1e-9 * D)
    assert tangent.in_plane == pytest.approx(membrane * shape, abs=1e-9 * membrane)


def test_derivatives_match_differences() -> None:
    """Gradient, Hessian, moment and rates at a random bent state of a cell with rigid scales."""
    problem = CellProblem.from_pattern(hexagon(), FREE)
    generator = np.random.default_rng(5)
    n = len(problem.active)
    z = problem.embedding.rest.copy()
    z[problem.active] += 1e-3 * generator.normal(size=n)
    bend, along = Bend(0.002, 0.4), generator.normal(size=n)
    cell, step = problem.bent(bend), 1e-6

    def moved(s: float, curvature: float = 0.0):
        shifted = z.copy()
        shifted[problem.active] += s * along
        return problem.bent(replace(bend, curvature=bend.curvature + curvature)).evaluate(shifted)

    state, ahead, behind = cell.evaluate(z), moved(step), moved(-step)
    slope = (ahead.energy - behind.energy) / (2.0 * step)
    assert state.gradient @ along == pytest.approx(slope, rel=1e-6)
    product = multiply_upper(problem.pull_back, cell.hessian_values(state), along)
    assert relative_error(product, (ahead.gradient - behind.gradient) / (2.0 * step)) < 1e-6
    more, less = moved(0.0, 1e-7), moved(0.0, -1e-7)
    rate = (more.gradient - less.gradient) / 2e-7
    assert relative_error(cell.gradient_rate(state), rate) < 1e-6
    moment = (more.energy - less.energy) / 2e-7 / problem.area
    assert cell.moment(state) == pytest.approx(moment, rel=1e-6)


def test_squares_keep_their_symmetry() -> None:
    """The mesh has the pattern's: both axes are equal, and the twist is coupled with nothing."""
    matrix = fs.tangent_stiffness(square(), model=COARSE).matrix
    assert matrix[0, 0] == pytest.approx(matrix[1, 1], rel=1e-9)
    assert np.abs(matrix[:2, 2]).max() < 1e-9 * matrix[0, 0]


def test_joints_of_squares_are_softer_than_clamped_strips() -> None:
    """Along a side a(0) is 0.544 D P / g, by the plane-strain joint; 45 degree: 710 D.

    Upper bounds: the mesh is coarse at the bond's edge. The clamped strip says 1 and 7570 D.
    """
    fine = replace(
        COARSE,
        mesh=replace(COARSE.mesh, along=2.4, corner=0.4),
        solid=fs.SolidOptions(edge=0.06, growth=2.0),
    )
    tangent = fs.tangent_stiffness(square(), model=fine)
    assert 0.540 * 25.0 < tangent.stiffness(0.0) / D < 1.04 * 0.544 * 25.0
    assert 705.0 < tangent.stiffness(45.0) / D < 1.06 * 710.0


@pytest.mark.parametrize("scales", ["modes", "tets"])
def test_elastic_scales_of_a_hard_material_are_rigid(scales: str) -> None:
    """The three kinds of scales agree where they must: 1e-4, what rigid ones strain evenly."""
    hard = square(scale_material=fs.NeoHookean(young_modulus=2.6e6, poisson_ratio=0.35))
    rigid = fs.tangent_stiffness(hard, model=COARSE).matrix
    elastic = replace(COARSE, scales=fs.ScaleOptions(scales))
    found = fs.tangent_stiffness(hard, model=elastic).matrix
    assert found == pytest.approx(rigid, abs=1e-3 * rigid[0, 0])


def test_moment_is_the_slope_of_the_energy_through_contact() -> None:
    problem = CellProblem.from_pattern(square(), COARSE)
    kappa = (0.004, 0.008, 0.0115, 0.012, 0.0125)
    samples = list(follow_line(problem, Line("closing", 0.0, kappa), COARSE.solver))
    assert [sample["status"] for sample in samples] == [0] * 5
    energy = [sample["energy_density"] for sample in samples]
    assert samples[1]["contact_force"] == 0.0 < samples[3]["contact_force"]
    slope = (energy[4] - energy[2]) / 0.001
    assert samples[3]["moment"] == pytest.approx(slope, rel=0.01)  # a parabola over 0.001
    assert abs(samples[4]["mean_offset"]) < 1e-9


def test_sweeps_work_and_tell_the_model() -> None:
    """One sample: its moment is the tangent's, and its energy is the solid's."""
    found = fs.sweep(square(), [0.0], [1e-4], ["closing"], model=COARSE, workers=1)
    moment = float(found["moment"].squeeze())
    assert moment == pytest.approx(
        1e-4 * fs.tangent_stiffness(square(), model=COARSE).stiffness(0.0), rel=1e-3
    )
    assert read_config(found)["native"] == "solid"
    assert float(found["energy_density_solid"].squeeze()) > 0.0
    assert "energy_density_bending" not in found
    assert 0.0 < found.attrs["mesh_error_at_rest"] < 0.5


def test_levels_are_finest_at_the_upper_face() -> None:
    levels = layer_levels(0.7, 3, 2.0)
    assert levels == pytest.approx([0.0, -0.05, -0.1, -0.2, -0.3, -0.5, -0.7])


def test_recipes_of_shells_do_not_name_the_solid() -> None:
    """What a model does not have is not in its recipe; a solid's recipe makes it again."""
    assert "solid" not in fs.NativeModel("shell").to_config()
    assert "substrate" not in COARSE.to_config()
    assert fs.NativeModel.from_config(COARSE.to_config()) == COARSE
    assert COARSE.to_config()["native"] == "solid"


def test_what_the_memory_does_not_hold_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    class Memory:
        available = 1e6

    monkeypatch.setattr("psutil.virtual_memory", Memory)
    with pytest.raises(SystemFailureError, match=r"would take about 0\.\d+ GB of memory.*edge"):
        fs.tangent_stiffness(square(), model=COARSE)


def test_whole_sheets_are_of_joints() -> None:
    with pytest.raises(fs.errors.ConfigError, match=r"scales on joints, not of .* 'solid'"):
        fs.simulate_native_sheet(
            square(), length=30.0, width=30.0, curvatures=(0.001,), model=COARSE
        )
