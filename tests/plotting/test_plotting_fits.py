"""Figures of fits: what is drawn is what was fitted, and native dots are the samples."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

import flexscale as fs
from flexscale.errors import BadInputError, SchemaError
from flexscale.plotting.figure_scripts import find_scripts
from flexscale.plotting.style import MACRO_COLOR, NATIVE_COLOR
from tests.macro.fit_samples import (
    CURVATURES,
    DIRECTIONS,
    a_of,
    b_of,
    fit_law,
    kappa_0_of,
    law_sweep,
    no_contact,
    tangent,
    without,
)
from tests.plotting.plotting_data import flat_cell

PAPER_FIGURES = Path(__file__).resolve().parents[2] / "paper_figures"


@pytest.fixture(scope="module")
def sweep() -> xr.Dataset:
    return law_sweep()


@pytest.fixture(scope="module")
def model(sweep: xr.Dataset) -> xr.Dataset:
    return fit_law(sweep).to_dataset()


def lines(axes: object, color: str, *, label: str | None = None) -> list[np.ndarray]:
    """Points (n, 2) of the lines of a color in axes, nan left out, empty ones dropped."""
    found = []
    for line in axes.lines:  # type: ignore[attr-defined]
        if to_hex(line.get_color()).upper() == color and label in (None, line.get_label()):
            points = np.asarray(line.get_xydata(), dtype=float)
            points = points[np.isfinite(points).all(axis=1)]
            if len(points):
                found.append(points)
    return found


def legend_texts(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_polar_panels_show_the_parameters(sweep: xr.Dataset, model: xr.Dataset) -> None:
    figure = fs.plot.fit(model, sweep)
    for axes, known in zip(figure.axes[:3], (a_of, b_of, kappa_0_of), strict=True):
        fitted = lines(axes, MACRO_COLOR)[0]
        np.testing.assert_allclose(fitted[:, 1], known(np.rad2deg(fitted[:, 0])), rtol=1e-4)
        dots = [points for points in lines(axes, NATIVE_COLOR) if len(points) == len(DIRECTIONS)]
        np.testing.assert_allclose(dots[0][:, 1], known(DIRECTIONS), rtol=1e-4)


def test_curves_below_show_samples_and_law(sweep: xr.Dataset, model: xr.Dataset) -> None:
    figure = fs.plot.fit(model, sweep, direction=30.0)
    energy, moment = figure.axes[3:]
    for axes, name in ((energy, "energy_density"), (moment, "moment")):
        samples = lines(axes, NATIVE_COLOR, label="native closing")[0]
        np.testing.assert_array_equal(samples[:, 1], sweep[name].values[0, 2])
        for label in ("law closing", "harmonics closing"):
            curve = lines(axes, MACRO_COLOR, label=label)[0]
            at_samples = np.interp(CURVATURES, curve[:, 0], curve[:, 1])
            scale = samples[:, 1].max()
            np.testing.assert_allclose(at_samples, samples[:, 1], atol=1e-4 * scale)
        assert "30°" in axes.get_title()
    assert "N" in moment.get_ylabel()


def test_direction_of_first_contact_by_default(sweep: xr.Dataset, model: xr.Dataset) -> None:
    figure = fs.plot.fit(model, sweep)
    first = DIRECTIONS[np.argmin(kappa_0_of(DIRECTIONS))]
    assert figure.axes[3].get_title() == f"at {first:g}°"


def test_without_a_sweep_only_parameters(model: xr.Dataset) -> None:
    assert len(fs.plot.fit(model).axes) == 3


def test_no_contact_is_said() -> None:
    model = fit_law(law_sweep(closing=no_contact)).to_dataset()
    titles = [axes.get_title() for axes in fs.plot.fit(model).axes]
    assert "no contact" not in titles[0]
    assert all("no contact" in title for title in titles[1:])


def test_failed_sample_is_not_drawn(model: xr.Dataset, sweep: xr.Dataset) -> None:
    figure = fs.plot.fit(model, without(sweep, side=0, direction=2, curvature=8), direction=30.0)
    assert len(lines(figure.axes[4], NATIVE_COLOR, label="native closing")[0]) == 10


def test_b_of_a_single_sample_is_left_out(model: xr.Dataset) -> None:
    unsure = model.copy(deep=True)
    unsure["samples_beyond"].values[0, 3] = 1
    figure = fs.plot.fit(unsure)
    assert len(lines(figure.axes[1], NATIVE_COLOR, label="_samples")[0]) == 11
    assert "single sample" in figure.get_supxlabel()
    assert "single sample" not in fs.plot.fit(model).get_supxlabel()


def test_refusals(model: xr.Dataset, sweep: xr.Dataset) -> None:
    with pytest.raises(SchemaError, match="figure of a fit needs cos_coefficient"):
        fs.plot.fit(sweep)
    with pytest.raises(BadInputError, match="no sample at direction 175"):
        fs.plot.fit(model, sweep, direction=175.0)
    with pytest.raises(BadInputError, match="predicts moment and energy_density, not min_gap"):
        fs.plot.curves(sweep, variable="min_gap", fit=model)


@pytest.mark.parametrize("variable", ["moment", "energy_density"])
def test_curves_carry_the_fit(sweep: xr.Dataset, model: xr.Dataset, variable: str) -> None:
    figure = fs.plot.curves(sweep, [0, 30], variable=variable, fit=model)
    by_label = {line.get_label(): line for line in figure.axes[0].lines}
    assert by_label["closing 30"].get_linestyle() == "None"
    np.testing.assert_array_equal(by_label["opening 30"].get_ydata(), sweep[variable].values[1, 2])
    assert by_label["opening 30"].get_markerfacecolor() == "white"
    fitted = by_label["fit closing 30"]
    assert fitted.get_linestyle() == "-"
    at_samples = np.interp(CURVATURES, fitted.get_xdata(), fitted.get_ydata())
    native = sweep[variable].values[0, 2]
    np.testing.assert_allclose(at_samples, native, atol=1e-4 * native.max())
    assert {"closing, fit", "opening, native"} <= set(legend_texts(figure))


def test_curves_without_a_fit_stay_lines(sweep: xr.Dataset) -> None:
    figure = fs.plot.curves(sweep, [0, 30])
    assert {line.get_label() for line in figure.axes[0].lines} == {
        f"{side} {direction}" for side in ("closing", "opening") for direction in (0, 30)
    }
    assert "closing" in legend_texts(figure)


def test_macro_polar_shows_native_and_macro_moments(sweep: xr.Dataset, model: xr.Dataset) -> None:
    figure = fs.plot.macro_polar(model, sweep, curvatures=[0.006, 0.02])
    assert len(figure.axes) == 4  # two sides by two curvatures
    for axes, curvature, side in zip(figure.axes, (3, 10, 3, 10), (0, 0, 1, 1), strict=True):
        native = sweep["moment"].values[side, :, curvature]
        macro = lines(axes, MACRO_COLOR)[0]
        angles = np.rad2deg(macro[:, 0])
        at_samples = np.interp(DIRECTIONS, angles, macro[:, 1])
        np.testing.assert_allclose(at_samples, native, rtol=1e-4)
        shown = lines(axes, NATIVE_COLOR)[0]
        np.testing.assert_allclose(shown[: len(DIRECTIONS), 1], native)
    assert "moment per width [N], native and macro" in figure.get_suptitle()
    assert legend_texts(figure) == ["native", "macro"]


def test_softening_is_drawn() -> None:
    softened = law_sweep(softening=6.0)
    model = fs.fit(softened, tangent()).to_dataset()
    figure = fs.plot.macro_polar(model, softened, "opening", 0.02)
    drawn = lines(figure.axes[0], MACRO_COLOR)[0]
    native = softened["moment"].values[1, :, 10]
    at_samples = np.interp(DIRECTIONS, np.rad2deg(drawn[:, 0]), drawn[:, 1])
    np.testing.assert_allclose(at_samples, native, rtol=1e-3)
    # Without it the moment would be more than a tenth larger.
    assert (0.02 * a_of(DIRECTIONS) / native - 1.0).max() > 0.1


def test_paper_figures_draw_from_datasets(sweep: xr.Dataset, model: xr.Dataset) -> None:
    (parameters, macro) = find_scripts(PAPER_FIGURES, ["fig04", "fig12"])
    figure = parameters.module.draw({"fit": model, "sweep": sweep})
    assert len(figure.axes) == 5
    inputs = {}
    for pattern in macro.module.PATTERNS:
        parts = {"cell": flat_cell(6), "sweep": sweep, "fit": model}
        inputs |= {f"{pattern}_{kind}": dataset for kind, dataset in parts.items()}
    assert set(inputs) == set(macro.needs)
    figure = macro.module.draw(inputs)
    assert len(figure.axes) == 5 * len(macro.module.PATTERNS)
    drawn = lines(figure.axes[-1], MACRO_COLOR)[0]
    at_samples = np.interp(DIRECTIONS, np.rad2deg(drawn[:, 0]), drawn[:, 1])
    np.testing.assert_allclose(at_samples, sweep["moment"].values[0, :, -1], rtol=1e-4)
    assert f"{int(model['n_parameters'])} parameters" in macro.module.findings(inputs)[0]
    assert parameters.module.findings({"fit": model})[0].startswith("a, closing: ")
