"""Sheets of scales between end strips that are no rectangles."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import flexscale as fs
from flexscale.embedding.bends import Bend
from flexscale.errors import BadInputError, PatternError
from flexscale.finite.joint_sheet import JointSheet
from flexscale.finite.native_sheet import NativeSheet, bend_native_sheet, require_sheet
from flexscale.finite.sheet_scales import find_sheet_scales
from flexscale.patterns.laid import lay_pattern, rectangle
from flexscale.patterns.sheet_outline import sheet_border
from flexscale.solve.newton import solve_equilibrium
from flexscale.status import SolveStatus

SQUARE, CHEVRON = fs.named_pattern("square"), fs.named_pattern("chevron")
#: Two prongs, each a row of squares, from a column of three.
FORK = [(0, 0), (70, 0), (70, 10), (10, 10), (10, 20), (70, 20), (70, 30), (0, 30)]
#: Wide at both ends, narrow between.
WAIST = [(0, 0), (15, 0), (20, 8), (40, 8), (45, 0), (60, 0), (60, 30), (45, 30), (40, 22),
         (20, 22), (15, 30), (0, 30)]  # fmt: skip


def energies(sheet: NativeSheet, *curvatures: float) -> list[float]:
    samples = list(bend_native_sheet(sheet, curvatures))
    return [sample["energy_density"] * sheet.area for sample in samples]


def test_a_rectangle_given_by_its_corners_is_the_rectangle() -> None:
    usual = NativeSheet(CHEVRON, 50.0, 25.0, 20.0, (1.0, 2.0))
    clockwise = rectangle(50.0, 25.0)[::-1]
    given = NativeSheet(CHEVRON, 50.0, 25.0, 20.0, (1.0, 2.0), outline=[*clockwise, clockwise[0]])
    assert energies(given, 0.01, 0.02) == pytest.approx(energies(usual, 0.01, 0.02), rel=1e-9)


def test_two_prongs_hold_twice_the_energy_of_one() -> None:
    one, two = NativeSheet(SQUARE, 70.0, 10.0), NativeSheet(SQUARE, 70.0, 30.0, outline=FORK)
    assert len(two.sheet.laid.tiles) == 2 * 7 + 1
    assert two.area == 2 * 700.0 + 100.0
    (apart, pressed), (both, all_pressed) = (energies(s, 0.005, 0.02) for s in (one, two))
    assert both == pytest.approx(2.0 * apart, rel=1e-9)
    assert all_pressed == pytest.approx(2.0 * pressed, rel=1e-5)  # stiffer barriers, as always


def test_a_waist_takes_energy_from_a_sheet() -> None:
    """All of its scales lie within the outline, and the sheet is softer than the rectangle."""
    waist = NativeSheet(CHEVRON, 60.0, 30.0, outline=WAIST)
    corners = np.concatenate(waist.sheet.laid.outlines)
    middle = np.abs(corners[:, 0] - 30.0) < 9.0
    assert np.abs(corners[middle, 1] - 15.0).max() < 7.0
    (soft,), (stiff,) = energies(waist, 0.01), energies(NativeSheet(CHEVRON, 60.0, 30.0), 0.01)
    assert 0.3 * stiff < soft < 0.9 * stiff


def test_datasets_and_shapes_know_their_outline() -> None:
    given: dict[str, Any] = {"offset": (1.0, 2.0), "outline": WAIST}
    data = fs.simulate_native_sheet(CHEVRON, 60.0, 30.0, curvatures=[0.01], side="closing", **given)
    sheet = NativeSheet(CHEVRON, 60.0, 30.0, 0.0, (1.0, 2.0), outline=WAIST)
    assert data.energy.values == pytest.approx(energies(sheet, 0.01), rel=1e-9)
    assert "[15, 0]" in data.attrs["flexscale_config"]
    shape = fs.deform_native_sheet(CHEVRON, 60.0, 30.0, curvature=0.01, **given)
    assert shape.n_scales == int(data.n_scales)
    assert shape.energy.sum() == pytest.approx(float(data.energy[0]), rel=1e-9)


def test_a_sheet_that_nothing_holds_lies_flat_on_any_cylinder() -> None:
    """One scale stays where the cylinder has it, and all others come back into its plane."""
    laid = lay_pattern(CHEVRON, sheet_border(60.0, 30.0, WAIST))
    scales = find_sheet_scales(laid, [], touch=False)
    free = np.ones(6 * scales.scales.n_scales + 3, dtype=bool)
    free[:6] = free[-3:] = False
    sheet = JointSheet(scales, fs.NativeModel().without_contact, free, still=False)
    bend = Bend(0.002, 0.0)
    on_cylinder = sheet.bent(bend).evaluate(sheet.embedding.rest).energy
    found = solve_equilibrium(sheet.bent(bend), sheet.embedding.rest, fs.SolverOptions())
    assert found.status == SolveStatus.converged
    assert found.evaluation.energy < 1e-12 * on_cylinder
    turns = sheet.scales_at(found.evaluation, bend).turns
    assert np.abs(turns - turns[0]).max() < 1e-9


@pytest.mark.parametrize(
    ("corners", "words"),
    [
        ([(0, 0), (60, 30), (60, 0), (0, 30)], "does not go around a sheet once"),
        ([(0, 0), (60, 0), (60, 0)], "does not go around a sheet once"),
        ([(0, 0), (60, 0)], "must be a list of 3 to"),
        ([(0, 0), (60, 0), (60, np.nan)], "finite, in mm"),
        ([(0, 0), (60, 0, 1), (60, 30)], "finite, in mm"),
        ("WAIST", "must be a list of 3 to"),
        ([(0, 0), (60, 0), (60, 20), (0, 20)], "to (60, 20) mm, but a sheet of 60 x 30 mm"),
        ([(-5, 0), (60, 0), (60, 30), (0, 30)], "reaches from (-5, 0)"),
        ([(0, 0), (60, 15), (0, 30)], "no edge at x = 60 mm, where the far end"),
        ([(0, 15), (60, 0), (60, 30)], "no edge at x = 0 mm, where the near end"),
        ([(0, 0), (60, 0), (60, 30), (59.8, 0.2), (0.2, 0.2), (0, 30)], "slivers"),
        (
            [(0, 0), (20, 0), (20, 14.9), (40, 14.9), (40, 0), (60, 0), (60, 30), (40, 30),
             (40, 15.1), (20, 15.1), (20, 30), (0, 30)],
            "parts that no joint connects",
        ),
    ],
)  # fmt: skip
def test_outlines_that_cannot_be_are_refused_with_one_sentence(corners: Any, words: str) -> None:
    with pytest.raises(PatternError) as caught:
        require_sheet(SQUARE, 60.0, 30.0, 0.0, (0.0, 0.0), corners)
    assert words in str(caught.value)
    assert str(caught.value).count(". ") == 0
    with pytest.raises(PatternError):
        fs.simulate_native_sheet(SQUARE, 60.0, 30.0, curvatures=[0.01], outline=corners)


def test_pattern_places_far_away_or_nowhere_are_refused() -> None:
    for offset, words in (
        ((np.nan, 0.0), "must be finite"),
        ((0.0, 1e6), "10000 mm"),
        ((0.0,), "two lengths in mm"),
    ):
        with pytest.raises(BadInputError, match=words):
            fs.simulate_native_sheet(SQUARE, 60.0, 30.0, curvatures=[0.01], offset=offset)


def test_borders_go_around_counterclockwise_and_keep_their_corners() -> None:
    border = sheet_border(70.0, 30.0, FORK[::-1])
    assert {tuple(corner) for corner in border.tolist()} == set(FORK)
    x, y = border.T
    assert 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1)) == 1500.0
