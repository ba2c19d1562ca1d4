"""Virtual testing devices: discs on the mandrel, strips on the stage."""

from __future__ import annotations

import logging

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

import flexscale as fs
from flexscale.errors import BadInputError, UnitRangeError, UnknownNameError
from flexscale.homogenize.tangent import TangentStiffness
from flexscale.mechanics.linear_law import isotropic_sheet
from flexscale.sheets.mandrel import MandrelRig, MandrelTest
from flexscale.sheets.stage import StageRig, StageTest
from flexscale.solve.solver_options import SolverOptions
from flexscale.status import SolveStatus
from tests.macro.fit_samples import kappa_0_of, law_sweep, tangent

YOUNG, THICKNESS = 25.0, 0.4  # MPa, mm
BEAM = YOUNG * THICKNESS**3 / 12.0  # N mm, bending stiffness per width at nu = 0
COARSE = fs.RigOptions(size=12.5)


def isotropic(poisson_ratio: float):
    return isotropic_sheet(YOUNG, poisson_ratio, THICKNESS)


def elastica(shortening: np.ndarray, length: float, stiffness: float) -> np.ndarray:
    """N, force between the pinned ends of an inextensible strip of a bending stiffness [N mm2]:
    P = 4 K^2 B/L^2 where the chord is (2 E/K - 1) L, K and E complete elliptic integrals of m."""

    def modulus(s: float) -> float:
        return brentq(lambda m: 2.0 * (1.0 - ellipe(m) / ellipk(m)) - s / length, 1e-12, 0.999)

    return np.array([4.0 * ellipk(modulus(s)) ** 2 * stiffness / length**2 for s in shortening])


def all_found(test: MandrelTest | StageTest) -> MandrelTest | StageTest:
    assert (test.status == SolveStatus.converged).all()
    assert (test.negative_eigenvalues == 0).all()
    return test


def fold_model(fold: int) -> fs.MacroModel:
    """A model of six- or fourfold symmetry, whose scales touch early."""

    def wave(directions: np.ndarray) -> np.ndarray:
        return np.cos(fold * np.deg2rad(directions))

    cubic = 20.0 if fold == 4 else 0.0  # a sixfold plate is isotropic before contact
    c, d, shear = 60.0 + cubic, 10.0 - cubic, 25.0 - cubic
    sweep = law_sweep(
        before=lambda directions: 60.0 + cubic * wave(directions),
        beyond=lambda directions: 400.0 + 90.0 * wave(directions),
        closing=lambda directions: 0.004 + 0.0012 * wave(directions),
    )
    return fs.fit(
        sweep,
        TangentStiffness(
            np.array([[c, d, 0.0], [d, c, 0.0], [0.0, 0.0, shear]]),
            np.array([[300.0, 90.0, 0.0], [90.0, 300.0, 0.0], [0.0, 0.0, 105.0]]),
        ),
    )


@pytest.fixture(scope="module")
def model() -> fs.MacroModel:
    return fs.fit(law_sweep(), tangent())


def disc(size: float, element: str = "c1") -> MandrelTest:
    """An isotropic disc on a mesh that has a ring at the hub, pushed at 0 and 30 degree."""
    options = fs.RigOptions(element=element, size=size)
    rig = MandrelRig(isotropic(0.45), hub=25.0, options=options)
    return all_found(rig.test(angles=[0.0, 30.0]))


@pytest.fixture(scope="module")
def discs() -> list[MandrelTest]:
    """Two meshes, one twice as fine as the other."""
    return [disc(25.0), disc(12.5)]


#: N, on a mesh twice as fine again, which takes most of the time of all.
FINEST = 2.17448e-3


@pytest.mark.slow
def test_the_finest_disc_gives_the_force_that_others_are_held_against():
    finest = disc(6.25)
    assert finest.force.mean() == pytest.approx(FINEST, rel=1e-5)
    assert np.ptp(finest.force) / FINEST < 0.001


def test_an_isotropic_disc_gives_the_same_force_at_every_angle(discs):
    """The paper's calibration. The mesh has six equal, mirrored sectors, so 0 to 30 degrees is the
    full circle: 20 % apart at 25 mm, 0.3 % at 12.5 mm and 0.01 % at 6.25 mm."""
    spreads = [np.ptp(disc.force) / disc.force.mean() for disc in discs]
    assert spreads[0] > 0.1
    assert spreads[1] < 0.01


def test_the_mandrel_force_converges_with_the_mesh(discs):
    """Second order, for the force is that on a point and the rim a polygon: 8 % and 1.3 % above the
    finest of the three."""
    errors = [disc.force.mean() / FINEST - 1.0 for disc in discs]
    assert 0.0 < errors[1] < 0.02
    assert errors[1] < errors[0] / 4.0


@pytest.mark.parametrize(
    ("size", "bound", "rate"),
    [(12.5, 0.1, 1.4), pytest.param(6.25, 0.06, 1.8, marks=pytest.mark.slow)],
)
def test_the_papers_triangles_come_to_the_same_mandrel_force(size, bound, rate):
    """From below, and slowly: 14 % at 25 mm, 9 % at 12.5 mm, 4 % at 6.25 mm, 1.4 % at 3.125 mm."""
    coarse, fine = (
        1.0 - disc(length, "edge_angle").force[0] / FINEST for length in (2.0 * size, size)
    )
    assert 0.0 < fine < bound
    assert fine < coarse / rate


def test_the_mandrel_force_is_the_derivative_of_the_energy():
    rig = MandrelRig(isotropic(0.3), options=fs.RigOptions(size=25.0))
    before, at, after = (all_found(rig.test(z, [15.0])) for z in (14.99, 15.0, 15.01))
    slope = (after.energy - before.energy) / 0.02
    assert at.force == pytest.approx(slope, rel=1e-5)


def test_a_sixfold_model_has_a_sixfold_force():
    """Mesh and energy have the symmetry, so forces agree as far as they are solved; a scale pattern
    makes the lobes: 30 % between them, where the mesh makes 2 %."""
    test = all_found(
        fs.simulate_mandrel(fold_model(6), indentation=20.0, angles=[0, 60, 30, 90], options=COARSE)
    )
    assert test.force[1] == pytest.approx(test.force[0], rel=1e-6)
    assert test.force[3] == pytest.approx(test.force[2], rel=1e-6)
    assert test.force[2] > 1.2 * test.force[0]


def test_a_fourfold_model_has_a_fourfold_force():
    """The mesh is not fourfold: a quarter of a turn agrees to its error, 0.2 % here."""
    test = all_found(
        fs.simulate_mandrel(
            fold_model(4), indentation=20.0, angles=[0, 90, 45, 135], options=COARSE
        )
    )
    assert test.force[1] == pytest.approx(test.force[0], rel=5e-3)
    assert test.force[3] == pytest.approx(test.force[2], rel=5e-3)
    assert test.force[2] > 1.1 * test.force[0]


def test_half_a_turn_is_solved_once_for_it_gives_the_same(model):
    rig = MandrelRig(model.sheet_law(), options=fs.RigOptions(size=25.0))
    one, other = rig.push(15.0, 12.0), rig.push(195.0, 12.0)
    assert other.force == pytest.approx(one.force, rel=1e-6)
    assert rig.push(30.0, 12.0).force != pytest.approx(one.force, rel=1e-2)
    test = rig.test(12.0, [15.0, 195.0, -165.0])
    assert (test.force == test.force[0]).all()
    assert test.force[0] == pytest.approx(one.force, rel=1e-9)


def test_the_side_of_the_mandrel_matters_once_scales_touch(model):
    sides = [
        fs.simulate_mandrel(
            model, indentation=depth, angles=[90.0], side=side, options=fs.RigOptions(size=25.0)
        )
        for depth in (3.0, 30.0)
        for side in ("closing", "opening")
    ]
    forces = [float(all_found(test).force[0]) for test in sides]
    assert forces[0] == pytest.approx(forces[1], rel=1e-6)
    assert forces[2] > 1.05 * forces[3]


SHORTENINGS = np.array([0.1, 0.5, 2.0, 10.0, 30.0, 50.0])


def test_a_strip_on_the_stage_is_the_elastica():
    """nu = 0, where plates bend as beams: 0.02 % at 5 mm, and Euler's load at the onset."""
    rig = StageRig(isotropic(0.0), options=fs.RigOptions(size=5.0))
    test = all_found(rig.test(SHORTENINGS))
    exact = elastica(SHORTENINGS, 100.0, 50.0 * BEAM)
    assert test.force == pytest.approx(exact, rel=5e-4)
    # Beyond the onset the force grows by s/(2L) of it.
    euler = np.pi**2 * BEAM * 50.0 / 100.0**2
    assert test.force[0] / (1.0 + 0.1 / 200.0) == pytest.approx(euler, rel=1e-4)


def test_a_strip_with_a_poisson_ratio_lies_between_beam_and_plate():
    """Free edges curl while the strip is nearly flat (beam, B) and cannot once it is bent (plate,
    B/(1 - nu^2)), but for the edges themselves: the force over that of a beam rises from 1.158 to
    1.24, the plate's is 1.254."""
    rig = StageRig(isotropic(0.45), options=fs.RigOptions(size=10.0))
    test = all_found(rig.test(SHORTENINGS))
    stiffening = test.force / elastica(SHORTENINGS, 100.0, 50.0 * BEAM)
    assert (np.diff(stiffening) > 0.0).all()
    assert stiffening[0] > 1.1
    assert stiffening[-1] < 1.0 / (1.0 - 0.45**2)


def test_the_stage_force_is_the_derivative_of_the_energy(model):
    shortenings = [4.99, 5.0, 5.01]
    test = all_found(fs.simulate_stage(model, shortenings=shortenings, options=COARSE))
    slope = (test.energy[2] - test.energy[0]) / 0.02
    assert test.force[1] == pytest.approx(slope, rel=1e-4)


def test_closing_and_opening_part_where_scales_touch(model):
    shortenings = [0.5, 1.0, 8.0, 20.0]
    closing, opening = (
        all_found(fs.simulate_stage(model, shortenings=shortenings, side=side, options=COARSE))
        for side in ("closing", "opening")
    )
    onset = kappa_0_of(np.arange(0.0, 180.0)).min()
    before = opening.largest_curvature < onset
    assert before.tolist() == [True, True, False, False]
    assert closing.force[before] == pytest.approx(opening.force[before], rel=1e-6)
    assert (closing.force[~before] > [1.1 * opening.force[2], 2.0 * opening.force[3]]).all()
    assert (closing.deflection > 0.0).all()
    assert (opening.deflection > 0.0).all()


def test_the_direction_of_a_strip_is_that_of_its_law(model):
    """Before contact; both directions couple to those across alike, so forces go as a nearly."""
    one, mirrored = (
        all_found(
            fs.simulate_stage(model, shortenings=[0.5], direction=angle, options=COARSE)
        ).force[0]
        for angle in (30.0, 150.0)
    )
    a_one, a_mirrored = (float(model.moment(1e-4, angle)) for angle in (30.0, 150.0))
    assert a_one > 1.2 * a_mirrored
    assert one / mirrored == pytest.approx(a_one / a_mirrored, rel=0.1)


def test_what_does_not_converge_is_stored_as_missing(model):
    solver = SolverOptions(max_iterations=1)
    disc = fs.simulate_mandrel(model, angles=[0.0], options=fs.RigOptions(size=25.0), solver=solver)
    strip = fs.simulate_stage(model, shortenings=[8.0], options=COARSE, solver=solver)
    for test in (disc, strip):
        assert test.status[0] != SolveStatus.converged
        values = (test.force, test.energy, test.largest_curvature, test.positions)
        assert all(np.isnan(value).all() for value in values)


def test_rigs_that_bend_beyond_the_sweep_warn_once(model, caplog):
    with caplog.at_level(logging.WARNING):
        fs.simulate_stage(model, shortenings=[20.0, 30.0], side="opening", options=COARSE)
    assert len(caplog.records) == 1
    assert "fitted up to 0.02" in caplog.text


@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        ({"indentation": 120.0}, BadInputError, "120 mm bends a disc of 100 mm"),
        ({"indentation": -1.0}, UnitRangeError, "indentation is -1 mm"),
        ({"hub": 99.0}, BadInputError, "hub of 99 mm"),
        ({"hub": 0.0}, UnitRangeError, "hub radius is 0 mm"),
        ({"angles": [0.0, 4.0]}, BadInputError, "no vertex to push at 4 degree"),
        ({"angles": [np.nan]}, UnitRangeError, "mandrel angle is nan degree"),
        ({"angles": []}, UnitRangeError, "one or more numbers"),
        ({"side": "close"}, UnknownNameError, "closing"),
    ],
)
def test_bad_input_to_the_mandrel_is_refused(model, change, error, words):
    with pytest.raises(error, match=words):
        fs.simulate_mandrel(model, **change)


@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        ({"shortenings": [1.0, 100.0]}, BadInputError, "100 mm is more than a strip of 100 mm"),
        ({"shortenings": [2.0, 1.0]}, BadInputError, "must increase"),
        ({"shortenings": [0.0, 1.0]}, UnitRangeError, "shortening is 0 mm"),
        ({"direction": np.inf}, UnitRangeError, "direction is inf degree"),
        ({"width": -5.0}, UnitRangeError, "strip width is -5 mm"),
        ({"side": "open"}, UnknownNameError, "opening"),
    ],
)
def test_bad_input_to_the_stage_is_refused(model, change, error, words):
    with pytest.raises(error, match=words):
        fs.simulate_stage(model, **change)


@pytest.mark.parametrize("change", [{"size": 0.0}, {"steps": 0}, {"steps": 1.5}])
def test_options_out_of_range_are_refused(change):
    with pytest.raises(UnitRangeError):
        fs.RigOptions(**change)


@pytest.mark.parametrize("simulate", [fs.simulate_mandrel, fs.simulate_stage])
def test_a_model_without_in_plane_stiffness_is_refused(simulate):
    paper = fs.fit(law_sweep(), variant="paper")
    with pytest.raises(BadInputError, match="in-plane stiffness"):
        simulate(paper)
