"""Native sheets with free sides between two strips, against the periodic cell."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import flexscale as fs
from flexscale.errors import BadInputError, ConfigError, PatternError, UnitRangeError
from flexscale.finite.native_sheet import NativeSheet, bend_native_sheet
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import Line, follow_line
from flexscale.mesh.finite import build_finite_mesh
from flexscale.patterns.clipped import SLIVER, clip_pattern
from flexscale.solve.solver_options import SolverOptions

COARSE = fs.MeshOptions().finer(0.5)


@pytest.fixture(scope="module")
def squares() -> NativeSheet:
    """Two whole squares in a row."""
    pattern = fs.named_pattern("square")
    return NativeSheet(pattern, 20.0, 10.0, native=fs.NativeModel("shell", mesh=COARSE))


def test_soft_direction_is_that_of_the_cell(squares: NativeSheet) -> None:
    """Hinges between squares do not notice the free sides but for the strip's Poisson effect."""
    curvatures = (0.0, 0.002, 0.004)
    cell = CellProblem.from_pattern(
        fs.named_pattern("square"), fs.NativeModel("shell", mesh=COARSE)
    )
    native = [s["moment"] for s in bend_native_sheet(squares, curvatures)][1:]
    line = Line("closing", 0.0, curvatures)
    periodic = [s["moment"] for s in follow_line(cell, line, SolverOptions())][1:]
    # Free ends of a hinge lose the plate's 1 / (1 - nu^2) over about the gap: 0.4 of 10 mm.
    assert np.array(native) / periodic == pytest.approx(1.0, abs=0.02)


def test_moment_is_the_derivative_of_the_energy(squares: NativeSheet) -> None:
    curvatures = (0.0, 0.00498, 0.005, 0.00502)
    samples = list(bend_native_sheet(squares, curvatures, "opening"))
    slope = (samples[3]["energy_density"] - samples[1]["energy_density"]) / 4e-5
    assert samples[2]["moment"] == pytest.approx(slope, rel=1e-5)
    assert all(sample["status"] == 0 for sample in samples)


def test_ends_lie_on_the_cylinder(squares: NativeSheet) -> None:
    """The near end stays where it was; the far one is held by the same rows."""
    *_, sample = bend_native_sheet(squares, (0.0, 0.004))
    held = np.setdiff1d(np.arange(len(sample["state"])), squares.active)
    assert np.array_equal(sample["state"][held], squares.embedding.rest[held])
    assert len(held) > 2 + 9 * 3
    assert sample["slide"] == pytest.approx(20.0 * sample["state"][-3])


@pytest.mark.parametrize(
    ("name", "direction"), [("arrowhead", 0.0), ("hexagon", 17.0), ("brick", 30.0)]
)
def test_sheet_is_covered_by_pieces_of_tiles(name: str, direction: float) -> None:
    pattern = fs.named_pattern(name)
    tiles = clip_pattern(pattern, 40.0, 30.0, direction)
    mesh = build_finite_mesh(pattern, tiles, COARSE)  # checks that it closes
    assert mesh.n_scales == len(tiles.copies)
    areas = np.bincount(mesh.base_scale, mesh.base_areas())
    assert areas.min() > SLIVER * pattern.tile_area
    whole = areas > areas.max() * (1.0 - 1e-9)
    outline = pattern.outlines()[0]
    area = 0.5 * abs(sum(a[0] * b[1] - a[1] * b[0] for a, b in pairwise([*outline, outline[0]])))
    assert areas.max() == pytest.approx(area)
    assert whole.sum() >= 2


@pytest.mark.parametrize(
    ("arguments", "error", "word"),
    [
        ((9.0, 9.0), PatternError, "smaller than one cell"),
        ((-5.0, 9.0), UnitRangeError, "length"),
        ((40.0, 20.0, np.nan), UnitRangeError, "direction"),
    ],
)
def test_bad_sheets_are_refused(arguments: tuple, error: type, word: str) -> None:
    with pytest.raises(error, match=word):
        clip_pattern(fs.named_pattern("square"), *arguments)


def test_dataset_keeps_every_number(squares: NativeSheet) -> None:
    dataset = fs.simulate_native_sheet(
        fs.named_pattern("square"),
        length=20.0,
        width=10.0,
        curvatures=[0.0, 0.002],
        sides=["closing"],
        model=fs.NativeModel("shell", mesh=COARSE),
    )
    *_, sample = bend_native_sheet(squares, (0.0, 0.002))
    found = dataset.sel(side="closing", curvature=0.002)
    assert float(found["moment"]) == pytest.approx(sample["moment"], rel=1e-9)
    assert float(found["energy"]) == pytest.approx(200.0 * sample["energy_density"], rel=1e-9)
    assert float(found["slide"]) == pytest.approx(sample["slide"], rel=1e-6)
    assert dataset["energy"].attrs["units"] == "N mm"
    assert int(dataset["n_unknowns"]) == len(squares.active)


def test_bad_bends_are_refused(squares: NativeSheet) -> None:
    with pytest.raises(BadInputError, match="its own end"):
        next(bend_native_sheet(squares, (0.0, 0.4)))
    with pytest.raises(BadInputError, match="no side"):
        next(bend_native_sheet(squares, (0.0,), "sideways"))
    with pytest.raises(BadInputError, match=r"must increase, but 0\.001"):
        next(bend_native_sheet(squares, (0.002, 0.001)))
    with pytest.raises(ConfigError, match="modes"):
        NativeSheet(
            fs.named_pattern("square"),
            20.0,
            10.0,
            native=fs.NativeModel("shell", scales=fs.ScaleOptions(model="tets")),
        )
    with pytest.raises(ConfigError, match="smooth triangles"):
        NativeSheet(
            fs.named_pattern("square"),
            20.0,
            10.0,
            native=fs.NativeModel("shell", substrate=fs.SubstrateOptions("edge_angle")),
        )


def test_the_bending_measure_is_that_of_the_sheet(squares: NativeSheet) -> None:
    """Far bent, turn and layers have energies that differ (see shell_law)."""
    options = fs.SubstrateOptions(bending_measure="turn")
    by_turn = NativeSheet(
        fs.named_pattern("square"),
        20.0,
        10.0,
        native=fs.NativeModel("shell", mesh=COARSE, substrate=options),
    )
    energies = [
        sample["energy_density"]
        for sheet in (squares, by_turn)
        for sample in bend_native_sheet(sheet, (0.02,), "opening")
    ]
    assert energies[1] != pytest.approx(energies[0], rel=1e-3)
