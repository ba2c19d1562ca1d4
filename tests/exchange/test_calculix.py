"""Sections for CalculiX: their layers by lamination theory, and plates of them in the solver."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import numpy as np
import pytest

import flexscale as fs
from benchmarks.ccx_plates import cantilever, twisted_plate
from flexscale.exchange.equivalent_layers import find_layers
from flexscale.homogenize.tangent import TangentStiffness
from tests.macro.law_samples import stiffness

needs_ccx = pytest.mark.skipif(
    shutil.which("ccx") is None, reason="no CalculiX (ccx; Debian's calculix-ccx) on this machine"
)
PATTERNS = ("square", "hexagon", "arrowhead")


def tangent_of(results: Path, pattern: str) -> TangentStiffness:
    dataset = next(iter(fs.open_registry(results).find(kind="tangent", pattern=pattern)))
    stored = fs.open_registry(results).load(dataset)
    return TangentStiffness(stored["matrix"].values, stored["in_plane"].values)


def laminate_of_file(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A, B and D of a composite section, by lamination theory from its file."""
    text = path.read_text()
    planes = {}
    for name, card in re.findall(r"NAME=(\w+)\n\*ELASTIC, TYPE=ANISO\n((?:[^*].*\n)+)", text):
        entries = iter(float(word) for word in card.replace("\n", ",").split(",") if word.strip())
        solid = np.zeros((6, 6))
        for column in range(6):
            for row in range(column + 1):
                solid[row, column] = solid[column, row] = next(entries)
        assert next(entries, None) is None
        assert np.linalg.eigvalsh(solid).min() > 0.0
        inside, outside = [0, 1, 3], [2, 4, 5]
        across = solid[np.ix_(outside, inside)]  # plane stress
        planes[name] = solid[np.ix_(inside, inside)] - across.T @ np.linalg.solve(
            solid[np.ix_(outside, outside)], across
        )
    layers = [
        (float(words[0]), planes[words[2].strip()])
        for words in (line.split(",") for line in text.split("*SHELL SECTION")[1].splitlines()[1:])
    ]
    z = np.cumsum([0.0, *(t for t, _ in layers)]) - 0.5 * sum(t for t, _ in layers)
    a, b, d = np.zeros((3, 3, 3))
    for (_, q), low, high in zip(layers, z[:-1], z[1:], strict=True):
        a += q * (high - low)
        b += q * (high**2 - low**2) / 2.0
        d += q * (high**3 - low**3) / 3.0
    return a, b, d


@pytest.mark.parametrize("seed", range(8))
def test_layers_have_any_a_and_d(seed: int, tmp_path: Path) -> None:
    """Also where bending is a thousand times stiffer against one curvature than against another."""
    turn = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))[0]
    d, a = turn @ np.diag([1.0, 30.0, 1000.0]) @ turn.T, stiffness(seed + 50, 100.0)
    path = fs.export(TangentStiffness(d, a), to="calculix", path=tmp_path / "s.inp")
    found = laminate_of_file(path)
    assert found[0] == pytest.approx(a, abs=1e-9 * np.abs(a).max())
    assert found[1] == pytest.approx(np.zeros((3, 3)), abs=1e-9 * np.abs(a).max())
    assert found[2] == pytest.approx(d, abs=1e-9 * np.abs(d).max())
    layers = find_layers(a, d)
    assert np.linalg.eigvalsh(layers.face_stiffness).min() > 0.0
    assert np.linalg.eigvalsh(layers.core_stiffness).min() > 0.0


def test_numbers_are_short_enough(tmp_path: Path) -> None:
    """CalculiX reads 20 characters of a number: of −1.23456789012345e+01 it would lose the 1."""
    tangent = TangentStiffness(stiffness(1, 60.0), stiffness(2, 100.0))
    text = fs.export(tangent, to="calculix", path=tmp_path / "s.inp").read_text()
    numbers = [w.strip() for line in text.splitlines() if line[0] in "-0123456789"
               for w in line.split(",")]  # fmt: skip
    assert any(word.startswith("-") for word in numbers)
    assert max(len(word) for word in numbers if "e" in word) <= 20


@needs_ccx
@pytest.mark.parametrize("pattern", PATTERNS)
def test_twisted_plate(pattern: str, shipped_results: Path, tmp_path: Path) -> None:
    """Within 1 % of Kirchhoff's plate, everywhere."""
    found, expected = twisted_plate(tangent_of(shipped_results, pattern), tmp_path)
    assert np.abs(found - expected).max() < 0.01 * np.abs(expected).max()


@needs_ccx
@pytest.mark.parametrize(
    "pattern",
    ["hexagon", *(pytest.param(name, marks=pytest.mark.slow) for name in ("square", "arrowhead"))],
)
def test_cantilever(pattern: str, shipped_results: Path, tmp_path: Path) -> None:
    """Within 1 % of our own sheet."""
    found, ours = cantilever(tangent_of(shipped_results, pattern), tmp_path)
    assert found == pytest.approx(ours, rel=0.01)
