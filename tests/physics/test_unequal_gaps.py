"""Scales of unequal gaps on joints: closed forms, what touches first, invariance, derivatives."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import shapely
from scipy.optimize import brentq, minimize_scalar

import flexscale as fs
from flexscale.embedding.bends import Bend
from flexscale.finite.native_sheet import NativeSheet, bend_native_sheet
from flexscale.finite.sheet_scales import find_sheet_scales
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.flat_contact import solve_flat_contact
from flexscale.homogenize.joint_cell import JointCell
from flexscale.homogenize.joint_problem import place_stations
from flexscale.homogenize.line import follow_line
from flexscale.homogenize.tangent import solve_tangent
from flexscale.mechanics.stacked_laws import stack_laws
from flexscale.patterns import Pattern
from flexscale.patterns.joint_lines import find_joints, joint_gaps
from flexscale.patterns.laid import lay_pattern, rectangle
from tests.derivatives import directional_difference, relative_error
from tests.physics.test_joint_cell import OBLIQUE, full

SIDE = 10.0
SQUARE = SIDE * np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
PAIRS = (0.4, 0.4, 0.8, 0.8)  # along a row: gaps of 0.4, 0.6, 0.8 and 0.6 mm
MODEL = fs.NativeModel(solver=fs.SolverOptions(tolerance=1e-12))


def row_of(tile: np.ndarray, gaps: tuple[float, ...]) -> Pattern:
    """Tiles one after the other along their first side, each with its gap, in equal rows."""
    step, up = tile[1] - tile[0], tile[3] - tile[0]
    tiles = [tile + k * step for k in range(len(gaps))]
    return Pattern.from_polygons(tiles, len(gaps) * step, up, gap=gaps)


@cache
def rows() -> Pattern:
    return row_of(SQUARE, PAIRS)


def bare(pattern: Pattern) -> np.ndarray:
    """Stiffness at rest."""
    return solve_tangent(JointCell.from_pattern(pattern, MODEL.without_contact)).matrix


def laws() -> dict[float, fs.JointLaw]:
    return {gap: fs.joint_law(rows(), gap=gap) for gap in joint_gaps(rows())}


def test_hinges_in_series_and_side_by_side() -> None:
    """Across the rows one moment turns all joints of a row; along them all joints turn alike."""
    across, along = [], []
    for joint in find_joints(rows()):
        stiffness = joint.weights.sum() * laws()[joint.gaps[0]].stiffness
        (across if abs(joint.normals[0, 0]) > 0.5 else along).append(stiffness)
    assert (len(across), len(along)) == (4, 4)
    turned = sum(np.linalg.inv(stiffness)[3, 3] for stiffness in across)
    hinge = 1.0 / np.linalg.inv(sum(along))[3, 3]
    found = bare(rows())
    assert found[0, 0] == pytest.approx(4.0 / turned, rel=1e-9)
    assert found[1, 1] == pytest.approx(hinge / 4.0, rel=1e-9)
    assert found[0, 0] < 0.95 * found[1, 1]  # the two differ by their gaps alone


def test_the_narrowest_gaps_close_first() -> None:
    """Where tops meet over the joint of 0.4 mm, all joints carry its moment, each by its law."""
    across = [joint for joint in find_joints(rows()) if abs(joint.normals[0, 0]) > 0.5]
    lengths = {joint.gaps[0]: joint.weights.sum() for joint in across}

    here = laws()

    def opening(gap: float, turn: float) -> float:
        def energy(u: float) -> float:
            return float(here[gap].evaluate(np.array([[u, 0.0, 0.0, turn]]))[0][0])

        return float(minimize_scalar(energy, bounds=(-0.3, 0.5), method="bounded",
                                     options={"xatol": 1e-10}).x)  # fmt: skip

    def moment(gap: float, turn: float) -> float:
        pose = np.array([[opening(gap, turn), 0.0, 0.0, turn]])
        return lengths[gap] * float(here[gap].evaluate(pose)[1][0, 3])

    def between_tops(turn: float) -> float:
        return opening(0.4, turn) + 0.4 * np.cos(turn / 2) - 2.0 * 4.2 * np.sin(turn / 2)

    touching = brentq(between_tops, 0.02, 0.2)
    carried = moment(0.4, touching)
    turns = [
        brentq(lambda turn, gap=gap: moment(gap, turn) - carried, 0.0, 0.3)
        for gap in (joint.gaps[0] for joint in across)
    ]
    assert max(turns) > 1.2 * min(turns)
    length = 4.0 * SIDE + sum(
        opening(joint.gaps[0], turn) for joint, turn in zip(across, turns, strict=True)
    )
    onset = sum(turns) / length
    problem = JointCell.from_pattern(rows(), MODEL)
    before, behind = follow_line(
        problem, Line("closing", 0.0, (0.99 * onset, 1.01 * onset)), MODEL.solver
    )
    assert before["contact_pairs"] == 0
    assert behind["contact_pairs"] > 0
    bend = Bend(1.01 * onset, 0.0)
    state = problem.bent(bend).evaluate(behind["state"])
    pressed = problem.split_energies(state.world, bend)[:, 1] > 0.0
    joints = find_joints(rows())
    assert {joints[k].gaps[0] for k in np.flatnonzero(pressed)} == {0.4}
    assert problem.contact.activation_distance == pytest.approx(0.005 * 0.4)


def test_derivatives_are_exact() -> None:
    problem = JointCell.from_pattern(row_of(OBLIQUE, (0.4, 0.4, 0.8)), MODEL)
    assert len(problem.laws) == 3
    generator = np.random.default_rng(1)
    z = 0.002 * generator.normal(size=problem.embedding.n_unknowns)
    way = np.zeros_like(z)
    way[problem.active] = generator.normal(size=len(problem.active))
    bent = problem.bent(Bend(0.005, 0.4))
    state = bent.evaluate(z)
    slope = directional_difference(lambda s: bent.evaluate(z + s * way).energy, 3e-5)
    assert state.gradient @ way[problem.active] == pytest.approx(slope, rel=1e-7)
    bend = directional_difference(lambda s: bent.evaluate(z + s * way).gradient, 3e-5)
    product = full(problem, bent.hessian_values(state)) @ way[problem.active]
    assert relative_error(product, bend) < 1e-7


@pytest.mark.parametrize("tile", [SQUARE, OBLIQUE], ids=["square", "oblique"])
def test_other_cells_of_the_same_sheet(tile: np.ndarray) -> None:
    """Twice the cell, and one that begins elsewhere: at rest and bent."""
    small = row_of(tile, PAIRS)
    size = np.abs(bare(small)).max()
    bent = fs.sweep(small, [25.0], [0.0, 0.004], model=MODEL, workers=1).moment.values
    for gaps in (PAIRS * 2, (0.8, 0.4, 0.4, 0.8)):
        other = row_of(tile, gaps)
        assert np.abs(bare(other) - bare(small)).max() < 1e-9 * size
        again = fs.sweep(other, [25.0], [0.0, 0.004], model=MODEL, workers=1).moment.values
        assert again == pytest.approx(bent, rel=1e-8, abs=1e-15)


def test_equal_gaps_are_one_gap() -> None:
    listed, single = row_of(SQUARE, (0.4, 0.4)), row_of(SQUARE, (0.4,) * 2).with_(gap=0.4)
    assert listed == single
    assert listed.to_config()["gap"] == 0.4
    assert np.array_equal(bare(listed), bare(single))


def test_one_law_twice_is_one_law_to_the_last_bit() -> None:
    problem = JointCell.from_pattern(fs.named_pattern("hexagon"), MODEL)
    bent, z = problem.bent(Bend(0.005, 0.4)), problem.embedding.rest
    once = bent.hessian_values(bent.evaluate(z))
    problem._tables = stack_laws(problem.laws * 2)
    numbers = np.arange(len(problem.stations.laws)) % 2
    problem.stations = problem.stations._replace(laws=numbers)
    assert np.array_equal(bent.hessian_values(bent.evaluate(z)), once)


def test_symmetric_directions_are_those_of_tiles_and_gaps() -> None:
    """Squares alone would bend alike along both sides."""
    curvatures = [0.0, 0.004]
    data = [
        fs.sweep(rows(), [0.0, 30.0, 90.0, 150.0], curvatures, ("closing",), symmetry=symmetry,
                 model=MODEL, workers=1).moment.values[0, :, 1]
        for symmetry in (True, False)
    ]  # fmt: skip
    assert data[0] == pytest.approx(data[1], rel=1e-8)
    assert data[1][1] == pytest.approx(data[1][3], rel=1e-8)  # by a mirror
    assert data[1][0] < 0.97 * data[1][2]


@pytest.mark.slow
def test_the_solid_changes_as_much() -> None:
    """By gaps of 0.4 and 0.8 mm in turn in place of 0.6 mm, on a mesh that is 5 to 10 % too stiff.

    Across the rows all gaps stay 0.6 mm wide, and joints are as soft but shorter.
    """
    solid = fs.NativeModel(
        "solid",
        mesh=fs.MeshOptions(
            along=2.5, corner=1.0, scale_size=10.0, scale_strips=0, scale_layers=1, scale_order=1
        ),
        solid=fs.SolidOptions(edge=0.1),
    )
    changes = []
    for model in (MODEL, solid):
        equal, unequal = (
            fs.tangent_stiffness(row_of(SQUARE, gaps), model=model).matrix.diagonal()
            for gaps in ((0.6, 0.6), (0.4, 0.8))
        )
        changes.append(unequal / equal)
    assert changes[0] == pytest.approx(changes[1], rel=0.005)
    assert changes[0][1] > 1.05


def test_a_turned_strip_is_hinges_in_series() -> None:
    """Eight squares, of which both ends are held and turned: one moment turns seven joints."""
    sheet = NativeSheet(rows(), 80.0, 10.0, offset=(0.0, 5.0), ends="turned")
    assert all(sheet.sheet.laid.whole)
    found = {gap: law.stiffness for gap, law in laws().items()}
    joints = sheet.sheet.joints
    assert [joint.gaps[0] for joint in joints].count(0.6) == 3
    softness = sum(
        np.linalg.inv(found[joint.gaps[0]])[3, 3] / joint.weights.sum() for joint in joints
    )
    (sample,) = bend_native_sheet(sheet, (1e-5,), "opening")
    energy = sample["energy_density"] * sheet.area
    assert energy == pytest.approx(0.5 * (80.0 * 1e-5) ** 2 / softness, rel=1e-3)


def test_scales_of_one_body_may_have_several_gaps_to_another() -> None:
    tiles = [SQUARE + np.array([SIDE * k, 0.0]) for k in range(3)]
    bricks = Pattern.from_polygons(tiles, [30.0, 0.0], [15.0, 10.0], gap=(0.4, 0.8, 1.0))
    laid = lay_pattern(bricks, rectangle(60.0, 40.0))
    low = np.array([tile[:, 1].min() for tile in laid.tiles])
    row = np.flatnonzero(low == low.min())
    sheet = find_sheet_scales(laid, [(row, np.array([30.0, 0.0]))])
    gaps = joint_gaps(bricks)
    assert gaps == (0.6, 0.7, 0.9)
    assert max(len(set(joint.gaps)) for joint in sheet.joints) == 2
    stations = place_stations(sheet.joints, sheet.scales, gaps)
    of_all = np.concatenate([joint.gaps for joint in sheet.joints])
    assert np.array_equal(np.array(gaps)[stations.laws], of_all)


HEXAGON = np.array([[np.cos(a), np.sin(a)] for a in np.radians(30.0 + 60.0 * np.arange(6))])
WAVE = np.array([[0.0, 0.0], [3.0, 0.8], [7.0, -0.8], [10.0, 0.0]])
BENT = np.concatenate([WAVE, WAVE[::-1] + np.array([0.0, 10.0])])


@pytest.mark.parametrize(
    ("tile", "t1", "t2"),
    [
        (SQUARE, SQUARE[1], SQUARE[3]),
        (6.0 * HEXAGON, 6.0 * np.array([np.sqrt(3.0), 0.0]), [3.0 * np.sqrt(3.0), 9.0]),
        (BENT, [10.0, 0.0], [0.0, 10.0]),
    ],
    ids=["square", "hexagon", "bent"],
)
def test_joints_lie_midway(tile: np.ndarray, t1: np.ndarray, t2: np.ndarray) -> None:
    """Half the gap from both scales, and where they face each other no longer than their walls."""
    steps = [np.multiply(k, t1) for k in range(3)]
    pattern = Pattern.from_polygons(
        [tile + step for step in steps], 3.0 * np.asarray(t1), t2, gap=(0.4, 0.8, 1.0)
    )
    outlines = [shapely.Polygon(outline) for outline in pattern.outlines()]
    for joint in find_joints(pattern):
        gap = 0.5 * (pattern.gaps[joint.first] + pattern.gaps[joint.second])
        assert joint.gaps == pytest.approx(gap)
        shift = np.array(joint.offset) @ pattern.lattice
        points = shapely.points(joint.points)
        here = shapely.distance(outlines[joint.first], points)
        there = shapely.distance(outlines[joint.second], shapely.points(joint.points - shift))
        facing = np.minimum(here, there) < 0.5 * gap + 1e-6
        assert facing.mean() > 0.6
        middle = np.sort(np.abs(here - there)[facing])
        # A mitre of a bent line is not as far from the wall as the line is beside it.
        assert middle[len(middle) // 2] < 1e-9
        assert np.median(here[facing]) == pytest.approx(0.5 * gap, rel=1e-9)
    apart = min(
        outlines[a].distance(shapely.transform(outlines[b], lambda xy, s=shift: xy + s))
        for a in range(3)
        for b in range(3)
        for shift in (np.array([m, n]) @ pattern.lattice for m in (-1, 0, 1) for n in (-1, 0, 1))
        if a != b or shift.any()
    )
    assert apart == pytest.approx(pattern.gap, rel=1e-6)


def test_laws_are_given_for_every_gap() -> None:
    found = tuple(laws().values())
    given = fs.NativeModel(law=found, solver=MODEL.solver)
    known = fs.tangent_stiffness(rows(), model=given).matrix
    assert np.array_equal(known, fs.tangent_stiffness(rows(), model=MODEL).matrix)
    with pytest.raises(fs.errors.PatternError, match=r"laws given are 1, .* 0\.4, 0\.6, 0\.8 mm"):
        fs.tangent_stiffness(rows(), model=fs.NativeModel(law=found[0]))
    with pytest.raises(fs.errors.PatternError, match=r"gaps of 0\.4, 0\.6, 0\.8 mm: say which"):
        fs.joint_law(rows())
    with pytest.raises(fs.errors.PatternError, match=r"none of 0\.5 mm"):
        fs.joint_law(rows(), gap=0.5)


def test_onset_of_gap_models_lies_between_those_of_their_gaps() -> None:
    onset = fs.gap_model(rows(), model=MODEL).onset(0.0)
    narrow, wide = (
        fs.gap_model(row_of(SQUARE, (gap,)), model=MODEL).onset(0.0) for gap in (0.4, 0.8)
    )
    assert narrow < onset < wide


def test_gap_models_know_the_widest_gaps_too() -> None:
    problem = JointCell.from_pattern(rows(), MODEL)
    assert (problem.gap, problem.widest_gap) == (0.4, 0.8)
    distances = solve_flat_contact(problem).distances
    assert distances.min() == pytest.approx(0.4)
    assert np.isclose(distances, 0.8).any()
