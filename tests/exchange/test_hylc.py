"""HYLC's spline materials, read back by a reader of their own."""

from __future__ import annotations

import json
import logging
from pathlib import Path

import numpy as np
import pytest

import flexscale as fs
from flexscale.errors import BadInputError
from flexscale.exchange.hylc import hermite
from tests.exchange.exchange_samples import derivatives_of, model_of
from tests.exchange.hylc_reader import Material, cubic
from tests.macro.law_samples import IN_PLANE

pytestmark = pytest.mark.filterwarnings("error")


@pytest.fixture
def material(tmp_path: Path) -> Material:
    return Material(fs.export(model_of(), to="hylc", path=tmp_path / "m.json"))


@pytest.mark.parametrize("axis", [0, 1])
def test_bending_along_x_and_y_is_that_of_the_law(material: Material, axis: int) -> None:
    """1 N/mm is 1000 J/m2, 1/mm is 1000 1/m; the splines are made to 1e-6 of the largest energy."""
    curvatures = np.linspace(-0.02, 0.02, 173)
    k = np.zeros((len(curvatures), 3))
    k[:, axis] = curvatures
    expected = derivatives_of(model_of(), k)[0]
    states = np.zeros((len(curvatures), 6))
    states[:, 3 + 2 * axis] = 1e3 * curvatures
    found = 1e-3 * np.array([material.psi(state) for state in states])
    assert np.abs(found - expected).max() < 2e-6 * expected.max()
    touching = np.abs(curvatures) > 0.015  # beyond the onset on both sides: not only before it
    free = 0.5 * expected[len(curvatures) // 2 + 1] / curvatures[len(curvatures) // 2 + 1] ** 2
    assert (expected[touching] > 1.2 * free * curvatures[touching] ** 2).any()


def test_strain_is_linear_elastic(material: Material) -> None:
    """½ s·A s of (s_x, s_y, s_a), exactly, in J/m2."""
    rng = np.random.default_rng(1)
    for s_x, s_a, s_y in rng.uniform(-0.5, 0.5, (50, 3)):
        s = np.array([s_x, s_y, s_a])
        expected = 0.5 * 1e3 * s @ IN_PLANE @ s
        assert material.psi(np.array([s_x, s_a, s_y, 0.0, 0.0, 0.0])) == pytest.approx(
            expected, rel=1e-12
        )


def test_the_file_says_what_it_loses(
    material: Material, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """The departure that it tells is that of what a reader finds at those curvatures."""
    with caplog.at_level(logging.WARNING):
        path = fs.export(model_of(), to="hylc", path=tmp_path / "again.json")
    assert "single curvatures in other directions are off" in caplog.text
    told = json.loads(path.read_text())["flexscale"]["departure from the law"]
    off = []
    for end in (-0.02, 0.02):
        for size in (0.25, 0.5, 1.0):
            for angle in np.arange(36) * np.pi / 36:
                c, s = np.cos(angle), np.sin(angle)
                k = size * end * np.array([[c * c, s * s, c * s]])
                form = material.psi(1e3 * np.array([0.0, 0.0, 0.0, k[0, 0], k[0, 2], k[0, 1]]))
                off.append(abs(1e-3 * form / derivatives_of(model_of(), k)[0][0] - 1.0))
    assert told["median"] == pytest.approx(np.median(off), rel=1e-4)
    assert told["largest"] == pytest.approx(np.max(off), rel=1e-4)


def test_a_side_without_data_goes_on(tmp_path: Path) -> None:
    """Fitted to closing alone, the spline still has an opening branch, and no more knots there."""
    model = model_of()
    polar = model.polar
    one = model_of(
        polar=type(polar)(
            ("closing",), polar.a, polar.b[:1], polar.onset[:1], ("kappa_0",), 0.02, 0.0
        )
    )
    path = fs.export(one, to="hylc", path=tmp_path / "m.json")
    spline = json.loads(path.read_text())["coeffs"]["1D"][3]
    assert spline["t"][0] < 0.0 < spline["t"][-1]
    k = np.array([[-0.005, 0.0, 0.0]])
    found = Material(path).psi(np.array([0.0, 0.0, 0.0, -5.0, 0.0, 0.0]))
    assert 1e-3 * found == pytest.approx(derivatives_of(one, k)[0][0], rel=1e-3)


def test_in_plane_stiffness_is_needed(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="needs the in-plane stiffness"):
        fs.export(model_of("paper", in_plane=None), to="hylc", path=tmp_path / "m.json")
    assert not list(tmp_path.iterdir())


def test_both_cubics_are_the_same() -> None:
    """Ours, of whole arrays, and the reader's."""
    rng = np.random.default_rng(3)
    t = np.sort(rng.standard_normal(6))
    p, m = rng.standard_normal((2, 6))
    for share in (0.1, 0.7):
        ours = hermite(share, np.diff(t), (p[:-1], p[1:]), (m[:-1], m[1:]))
        theirs = [cubic(t, p, m, x) for x in t[:-1] + share * np.diff(t)]
        assert ours == pytest.approx(theirs, rel=1e-12)
