"""Polar plots and curves: what is drawn, compared with the datasets they come from."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from flexscale.errors import BadInputError, SchemaError, UnknownNameError
from flexscale.plotting import curves, polar, stiffness
from flexscale.plotting.style import curvature_colors, unit_text
from tests.plotting.plotting_data import tangent_dataset, two_regime_sweep, with_failures


def lines(figure: Figure, label: str, axes: int = 0) -> list[Line2D]:
    return [line for line in figure.axes[axes].get_lines() if line.get_label() == label]


def note(figure: Figure) -> str:
    return figure.get_supxlabel()


@pytest.mark.parametrize("fold", [2, 4, 6])
def test_polar_draws_the_moments_and_closes_the_curve(fold: int) -> None:
    sweep = two_regime_sweep(fold)
    figure = polar(sweep, curvatures=[0.02])
    (line,) = lines(figure, "0.02")
    expected = sweep["moment"].sel(side="closing").sel(curvature=0.02, method="nearest").values
    np.testing.assert_allclose(line.get_xdata()[:-1], np.deg2rad(sweep["direction"].values))
    np.testing.assert_allclose(line.get_ydata()[:-1], expected)
    assert line.get_xdata()[-1] == pytest.approx(np.pi)
    assert line.get_ydata()[-1] == expected[0]


def test_mirrored_half_is_thinner_turned_by_180_degrees_and_explained() -> None:
    figure = polar(two_regime_sweep(4), curvatures=0.025)
    (line,), (mirror,) = lines(figure, "0.025"), lines(figure, "_mirrored")
    np.testing.assert_allclose(mirror.get_xdata(), line.get_xdata() + np.pi)
    np.testing.assert_array_equal(mirror.get_ydata(), line.get_ydata())
    assert mirror.get_linewidth() < line.get_linewidth()
    assert "180°" in note(figure)


def test_radius_starts_at_zero_and_is_common_to_both_sides() -> None:
    sweep = two_regime_sweep(6)
    figure = polar(sweep, side=("closing", "opening"))
    limits = [axes.get_ylim() for axes in figure.axes]
    assert limits[0] == limits[1]
    assert limits[0][0] == 0.0
    assert limits[0][1] >= float(sweep["moment"].max())
    assert [
        line.get_linestyle() for line in (*lines(figure, "0.025"), *lines(figure, "0.025", 1))
    ] == [
        "-",
        "--",
    ]
    assert all("moment per width [N]" in axes.get_title() for axes in figure.axes)


def test_unconverged_samples_are_gaps_with_crosses_at_the_rim() -> None:
    sweep = with_failures(two_regime_sweep(4), [("closing", 3, 10), ("closing", 7, 10)])
    figure = polar(sweep, curvatures=[0.025])
    (line,) = lines(figure, "0.025")
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(line.get_ydata())), [3, 7])
    cross, mirrored = lines(figure, "_unconverged")
    np.testing.assert_allclose(cross.get_xdata(), np.deg2rad([22.5, 52.5]))
    np.testing.assert_allclose(mirrored.get_xdata(), np.deg2rad([202.5, 232.5]))
    rim = figure.axes[0].get_ylim()[1]
    assert np.all(cross.get_ydata() > 0.95 * rim)
    assert "not converged" in note(figure)
    assert "not converged" not in note(polar(two_regime_sweep(4)))


def test_directions_far_apart_are_not_joined() -> None:
    sweep = two_regime_sweep(2, directions=np.array([0.0, 45.0, 90.0]))
    (line,) = lines(polar(sweep, curvatures=0.025), "0.025")
    # From 90 to 180 degree nothing is known: the line ends instead of cutting across.
    np.testing.assert_allclose(line.get_xdata(), np.deg2rad([0.0, 45.0, 90.0]))
    sparse = two_regime_sweep(2, directions=np.array([0.0, 10.0, 20.0, 90.0, 100.0, 110.0]))
    (line,) = lines(polar(sparse, curvatures=0.025), "0.025")
    assert np.isnan(line.get_ydata()[3])


def test_a_sample_between_failures_stays_visible() -> None:
    directions = np.arange(0.0, 180.0, 1.5)  # too many for dots
    sweep = two_regime_sweep(4, directions=directions)
    sweep = with_failures(sweep, [("closing", 10, 10), ("closing", 12, 10)])
    dots = lines(polar(sweep, curvatures=0.025), "_samples")[0].get_ydata()
    np.testing.assert_array_equal(np.flatnonzero(np.isfinite(dots)), [11])


def test_dots_mark_computed_directions_only() -> None:
    sweep = two_regime_sweep(4)
    sweep["symmetry_source"][:] = sweep["direction"].values % 90.0
    figure = polar(sweep, curvatures=0.025)
    dots = lines(figure, "_samples")[0].get_ydata()
    np.testing.assert_array_equal(np.isfinite(dots), sweep["direction"].values < 90.0)
    assert "computed" in note(figure)


def test_negative_moments_are_left_out_and_counted() -> None:
    sweep = two_regime_sweep(4)
    sweep["moment"][0, 5, 10] = -1.0
    figure = polar(sweep, curvatures=0.025)
    (line,) = lines(figure, "0.025")
    assert np.isnan(line.get_ydata()[5])
    assert "negative values are not drawn: 1" in note(figure)


def test_a_sweep_without_any_result_still_draws() -> None:
    sweep = two_regime_sweep(4, directions=np.array([0.0, 45.0, 90.0, 135.0]))
    failures = [("closing", d, 10) for d in range(4)]
    figure = polar(with_failures(sweep, failures), curvatures=0.025)
    assert len(lines(figure, "_unconverged")[0].get_xdata()) == 4


def test_default_curvatures_leave_out_zero_and_keep_the_largest() -> None:
    figure = polar(two_regime_sweep(4))
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[0] == "0.025"
    assert "0" not in labels


def test_wrong_names_and_values_are_refused_with_the_choices() -> None:
    sweep = two_regime_sweep(4)
    with pytest.raises(UnknownNameError, match="closing"):
        polar(sweep, side="closed")
    with pytest.raises(BadInputError, match=r"choose among 0, 0\.0025, .*0\.025"):
        polar(sweep, curvatures=[0.03])
    with pytest.raises(BadInputError, match=r"22\.5"):
        curves(sweep, directions=[-20.0])
    with pytest.raises(SchemaError, match="moment"):
        polar(sweep.drop_vars("moment"))
    with pytest.raises(BadInputError, match="at least one"):
        stiffness([])


def test_stiffness_draws_every_dataset_with_its_range() -> None:
    soft = tangent_dataset(np.diag([60.0, 60.0, 30.0]), "hexagons", "IH20")
    ortho = tangent_dataset(np.array([[80.0, 20.0, 0], [20.0, 40.0, 0], [0, 0, 15.0]]), "bricks")
    figure = stiffness([soft, ortho])
    drawn = [line for line in figure.axes[0].get_lines() if "hexagons" in str(line.get_label())]
    np.testing.assert_array_equal(drawn[0].get_ydata()[:-1], soft["stiffness"].values)
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert legend == ["IH20 hexagons\n60", "custom bricks\n40 – 80"]
    assert "[N mm]" in figure.axes[0].get_title()
    again = stiffness({"a": soft, "b": soft})
    assert [t.get_text()[0] for t in again.legends[0].get_texts()] == ["a", "b"]


def test_curves_draw_both_sides_with_labelled_axes() -> None:
    sweep = two_regime_sweep(2)
    figure = curves(sweep, directions=[0.0, 90.0])
    axes = figure.axes[0]
    assert axes.get_xlabel() == "curvature [mm⁻¹]"
    assert axes.get_ylabel() == "bending moment per unit width [N]"
    (closing,), (opening,) = lines(figure, "closing 90"), lines(figure, "opening 90")
    expected = sweep["moment"].sel(direction=90.0)
    np.testing.assert_array_equal(closing.get_ydata(), expected.sel(side="closing").values)
    np.testing.assert_array_equal(opening.get_ydata(), expected.sel(side="opening").values)
    assert closing.get_linestyle() == "-"
    assert opening.get_linestyle() == "--"
    energy = curves(sweep, variable="energy_density", sides="closing")
    assert energy.axes[0].get_ylabel() == "energy density [N mm⁻¹]"
    assert not lines(energy, "opening 0")


def test_curves_show_failures_as_gaps_with_crosses_on_top() -> None:
    sweep = with_failures(two_regime_sweep(2), [("opening", 0, 4)])
    figure = curves(sweep, directions=0.0)
    (opening,) = lines(figure, "opening 0")
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(opening.get_ydata())), [4])
    (cross,) = lines(figure, "_unconverged")
    np.testing.assert_allclose(cross.get_xdata(), [0.010])
    assert "not converged" in note(figure)


def test_default_curves_are_computed_directions() -> None:
    sweep = two_regime_sweep(4)
    sweep["symmetry_source"][:] = sweep["direction"].values % 90.0
    labels = [t.get_text() for t in curves(sweep).legends[0].get_texts()]
    assert labels == ["0°", "15°", "30°", "45°", "60°", "75°", "closing", "opening"]


def test_units_and_colors() -> None:
    assert unit_text("N mm-1") == "N mm⁻¹"
    assert unit_text("mm2") == "mm²"
    assert unit_text("degree") == "°"
    assert unit_text("1") == ""
    # cividis by rank: brightness grows with curvature, whatever the order given.
    colors = np.array(curvature_colors([0.02, 0.001, 0.0011]))
    assert np.all(colors[0] - colors[1] > 0.0) or colors[0].sum() > colors[2].sum()
    assert colors[2].sum() > colors[1].sum()
