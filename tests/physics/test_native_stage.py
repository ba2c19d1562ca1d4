"""Strips of the native model between hinges: against the elastica, and derivatives."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import fsolve

import flexscale as fs
from flexscale.datasets.checks import check_dataset
from flexscale.embedding.curvature_map import Bend
from flexscale.errors import BadInputError, PatternError, UnitRangeError, UnknownNameError
from flexscale.finite.native_stage import FLAT, NativeStage
from flexscale.finite.stage_line import follow_shortenings
from flexscale.mesh.finite import build_finite_mesh, strips
from flexscale.patterns.cell import TiledCell
from flexscale.patterns.clipped import SheetTiles, clip_pattern
from flexscale.patterns.prototiles import find_prototiles
from flexscale.solve.solver_options import SolverOptions

COARSE = fs.MeshOptions().finer(0.5)
LENGTH, WIDTH, GAP, STRIP = 60.0, 10.0, 0.4, 5.0
BARE = (2.0, 6.0, 15.0)  # shortenings, mm


def rectangle(low: float, high: float) -> np.ndarray:
    return np.array([[low, 0.0], [high, 0.0], [high, WIDTH], [low, WIDTH]])


def bare_tiles() -> SheetTiles:
    """One tile with a scale at each end, and sheet alone between them."""
    ends = rectangle(0.0, STRIP), rectangle(LENGTH - STRIP, LENGTH)
    sharp = np.ones(4, dtype=bool)
    cell = TiledCell(ends, (sharp, sharp), np.diag([LENGTH, WIDTH]), LENGTH, 1e-3)
    at_far = np.array([False, True])
    return SheetTiles(
        LENGTH, WIDTH, 0.0, np.zeros(2), *find_prototiles(cell, GAP), np.array([True, True]),
        at_far, ((rectangle(STRIP, LENGTH - STRIP), sharp),), glued=False,
    )  # fmt: skip


@pytest.fixture(scope="module")
def bare() -> NativeStage:
    """Without Poisson's effect, so that the sheet is a beam."""
    square = fs.named_pattern("square")
    beam = dataclasses.replace(square.substrate_material, poisson_ratio=0.0)
    mesh = dataclasses.replace(COARSE, along=3.0)
    return NativeStage(
        square.with_(substrate_material=beam),
        bare_tiles(),
        native=fs.NativeModel("shell", mesh=mesh),
    )


@pytest.fixture(scope="module")
def squares() -> NativeStage:
    """Two whole squares in a row between halves."""
    tiles = clip_pattern(fs.named_pattern("square"), 30.0, 10.0, glued=False)
    return NativeStage(
        fs.named_pattern("square"), tiles, native=fs.NativeModel("shell", mesh=COARSE)
    )


def linked_elastica(shortening: float, stiffness: float) -> float:
    """N, between hinges that rigid links join to an inextensible beam of a stiffness [N mm2].

    The angle to the chord has EI theta'^2 / 2 = N (cos theta - cos theta_m), and turns by N times
    the height, c sin theta_0, at the link's end: cos theta_m = cos theta_0 - N c^2 sin^2 theta_0 /
    2 EI. With sin(theta / 2) = sin(theta_m / 2) sin u both integrals are regular.
    """
    link, half = STRIP - 0.5 * GAP, 0.5 * LENGTH - STRIP + 0.5 * GAP

    def excess(unknowns: np.ndarray) -> list[float]:
        angle, force = unknowns
        height = link * np.sin(angle)
        k2 = 0.5 * (1.0 - np.cos(angle) + 0.5 * force * height**2 / stiffness)
        last = np.arcsin(np.sin(0.5 * angle) / np.sqrt(k2))

        def per_length(u: float) -> float:
            return float(np.sqrt(stiffness / force) / np.sqrt(1.0 - k2 * np.sin(u) ** 2))

        length = quad(per_length, 0.0, last)[0]
        lost = quad(lambda u: 2.0 * k2 * np.sin(u) ** 2 * per_length(u), 0.0, last)[0]
        lost += link * (1.0 - np.cos(angle))
        return [length - half, 2.0 * lost - shortening]

    euler = np.pi**2 * stiffness / LENGTH**2
    start = np.sqrt(6.0 * shortening / LENGTH)
    (_, force), _, status, message = fsolve(excess, [start, 1.2 * euler], full_output=True)
    assert status == 1, message
    return float(force)


def test_bare_sheet_is_the_elastica(bare: NativeStage) -> None:
    """Neither stretch (1e-5) nor the mesh matters to 0.1 %, whichever way the sheet bends."""
    beam = WIDTH * bare.model.plate_stiffness
    exact = np.array([linked_elastica(shortening, beam) for shortening in BARE])
    for side in ("closing", "opening"):
        samples = list(follow_shortenings(bare, BARE, side, SolverOptions()))
        force = np.array([sample["force"] for sample in samples])
        assert force / exact == pytest.approx(1.0, abs=1e-3)
        assert all(sample["deflection"] > 0.0 for sample in samples)
    assert exact[-1] > 1.1 * exact[0]


@pytest.mark.parametrize(("side", "at"), [("closing", 0.2), ("opening", 0.1)])
def test_force_is_the_derivative_of_the_energy(squares: NativeStage, side: str, at: float) -> None:
    """In contact, and without."""
    step = 1e-4
    shortenings = (0.05, at - step, at, at + step)
    samples = list(follow_shortenings(squares, shortenings, side, SolverOptions(tolerance=1e-12)))
    assert all(sample["status"] == 0 for sample in samples)
    slope = (samples[3]["energy"] - samples[1]["energy"]) / (2.0 * step)
    assert samples[2]["force"] == pytest.approx(slope, rel=1e-5)
    assert (samples[2]["contact_pairs"] > 0) == (side == "closing")


def test_closing_stiffens_by_contact(squares: NativeStage) -> None:
    """Two hinges that scales lock; opening they go on turning."""
    force = {}
    for side in ("closing", "opening"):
        *_, last = follow_shortenings(squares, (0.05, 0.4), side, SolverOptions())
        assert last["status"] == 0
        assert (last["contact_pairs"] > 0) == (side == "closing")
        force[side] = last["force"]
    assert force["closing"] > 5.0 * force["opening"]


def test_the_same_state_lies_anywhere_in_the_world(squares: NativeStage) -> None:
    """No bend of the map is needed for large turns: energies are those under a bend, and those of
    the sheet turned by 70 degree."""
    bend = Bend(-0.01, 0.0)
    bent = squares.embedding.rest + bend.curvature * squares.bend_rate()
    cosine, sine = np.cos(np.radians(70.0)), np.sin(np.radians(70.0))
    turn = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
    under_bend = squares.bent(bend).evaluate(bent).parts
    assert under_bend.sum() > 0.01
    for rotation in (np.eye(3), turn):
        z = squares.uncurled(bent, bend, rotation)
        assert squares.bent(FLAT).evaluate(z).parts == pytest.approx(under_bend, rel=1e-9)


def test_derivatives_of_a_turned_state(squares: NativeStage) -> None:
    """Energy, gradient and Hessian of scales that have turned by 10 degree."""
    generator = np.random.default_rng(3)
    rate = squares.bend_rate()
    z = squares.arc(rate, 0.2, -1.0)
    z[squares.active] += 1e-4 * generator.standard_normal(len(squares.active))
    carried = squares.carried(0.2, 100.0)
    direction = generator.standard_normal(len(squares.active))
    step = np.zeros_like(z)
    step[squares.active] = 1e-6 * direction / np.linalg.norm(direction)
    ahead, behind = carried.evaluate(z + step), carried.evaluate(z - step)
    state = carried.evaluate(z)
    slope = float(state.gradient @ step[squares.active])
    assert 0.5 * (ahead.energy - behind.energy) == pytest.approx(slope, rel=1e-6)
    values = carried.hessian_values(state)
    indptr, indices = squares.pull_back.indptr, squares.pull_back.indices
    rows = np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))
    product = np.zeros(len(direction))
    along = step[squares.active]
    np.add.at(product, rows, values * along[indices])
    off = rows != indices
    np.add.at(product, indices[off], values[off] * along[rows[off]])
    change = 0.5 * (ahead.gradient - behind.gradient)
    assert change == pytest.approx(product, abs=1e-6 * np.abs(product).max())


def test_a_state_does_not_depend_on_the_way_to_it(squares: NativeStage) -> None:
    (once,) = follow_shortenings(squares, (0.1,), "opening", SolverOptions())
    *_, later = follow_shortenings(squares, (0.03, 0.07, 0.1), "opening", SolverOptions())
    assert later["force"] == pytest.approx(once["force"], rel=1e-6)


def test_hinges_hold(squares: NativeStage) -> None:
    """A strip's line stays where its hinge is, straight and level, and its frame right-angled."""
    (sample,) = follow_shortenings(squares, (0.1,), "closing", SolverOptions())
    starts = squares.embedding.world_map.starts
    for strip, x in zip(strips(squares.tiles), (0.0, 29.9), strict=True):
        unknowns = sample["state"][starts[strip] : starts[strip + 1]]
        assert unknowns[:3] == pytest.approx([x, 5.0, 0.0], abs=1e-6)
        frame = unknowns[3:12].reshape(3, 3)
        assert frame[1].tolist() == [0.0, 1.0, 0.0]
        assert frame @ frame.T == pytest.approx(np.eye(3), abs=1e-4)
        assert abs(frame[0, 2]) > 0.05


def test_strips_are_one_scale_each() -> None:
    pattern = fs.named_pattern("hexagon")
    tiles = clip_pattern(pattern, 40.0, 30.0, 17.0, glued=False)
    mesh = build_finite_mesh(pattern, tiles, COARSE)
    assert tiles.at_end.sum() > 2 + (tiles.at_end & ~tiles.at_far_end).any()
    assert mesh.n_scales == len(tiles.copies) - tiles.at_end.sum() + 2
    assert strips(tiles) == (0, 1)
    corners = mesh.scale_positions[mesh.base_triangles[:, :3], 0]
    for strip, x in ((0, 0.0), (1, 40.0)):
        apart = np.abs(corners[mesh.base_scale == strip] - x)
        assert apart.min() == pytest.approx(0.5 * pattern.gap)
    assert (mesh.tet_scale.max(), mesh.vertex_scale.max()) == (mesh.n_scales - 1,) * 2
    glued = clip_pattern(pattern, 40.0, 30.0, 17.0)
    assert glued.center.tolist() == tiles.center.tolist()
    assert glued.at_end.sum() == tiles.at_end.sum()


def test_dataset_goes_on_where_it_was_stopped(squares: NativeStage) -> None:
    class Kept(dict):
        def load(self, key: str, fits: object) -> list:
            return list(self.get(key, []))

        def append(self, key: str, sample: dict) -> None:
            self.setdefault(key, []).append(sample)

    model = fs.NativeModel("shell", mesh=COARSE)
    settings = {"length": 30.0, "width": 10.0, "sides": ["opening"], "model": model}
    pattern, kept = fs.named_pattern("square"), Kept()
    fs.simulate_native_stage(pattern, shortenings=[0.05], **settings, checkpoint=kept)
    events: list = []
    dataset = fs.simulate_native_stage(
        pattern, shortenings=[0.05, 0.1], **settings, checkpoint=kept, on_sample=events.append
    )
    check_dataset(dataset, "native_rig")
    assert [event.shortening for event in events] == [0.05, 0.1]
    assert [event.done for event in events] == [1, 2]
    assert len(kept["stage-opening"]) == 2
    *_, sample = follow_shortenings(squares, (0.05, 0.1), "opening", SolverOptions())
    found = dataset.sel(side="opening", shortening=0.1)
    assert float(found["stage_force"]) == pytest.approx(sample["force"], rel=1e-9)
    assert float(found["stage_energy"]) == pytest.approx(sample["energy"], rel=1e-9)
    assert float(found["stage_deflection"]) == pytest.approx(sample["deflection"], rel=1e-9)
    assert int(dataset["n_unknowns"]) == len(squares.active)
    assert dataset["stage_force"].attrs["units"] == "N"


@pytest.mark.parametrize(
    ("settings", "error", "word"),
    [
        ({"shortenings": [1.0, 0.5]}, BadInputError, "increase"),
        ({"shortenings": [0.0, 0.5]}, UnitRangeError, "positive"),
        ({"shortenings": [40.0]}, BadInputError, "stay below its length"),
        ({"sides": ["sideways"]}, UnknownNameError, "sideways"),
        ({"length": -1.0}, UnitRangeError, "strip length"),
        ({"width": 0.0}, UnitRangeError, "strip width is 0 mm, but must be positive"),
        ({"width": 1.0}, PatternError, "smaller than one cell"),
        ({"direction": np.nan}, UnitRangeError, "direction"),
    ],
)
def test_bad_strips_are_refused(settings: dict, error: type, word: str) -> None:
    model = fs.NativeModel("shell", mesh=COARSE)
    whole = {"length": 40.0, "width": 10.0, "shortenings": [1.0], "model": model, **settings}
    with pytest.raises(error, match=word):
        fs.simulate_native_stage(fs.named_pattern("square"), **whole)
