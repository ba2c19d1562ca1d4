"""A, B and D as JSON, CSV and Abaqus' card, read back by readers of their own."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

import flexscale as fs
from flexscale.errors import BadInputError
from flexscale.homogenize.tangent import TangentStiffness
from tests.exchange.exchange_samples import model_of
from tests.macro.law_samples import IN_PLANE, TANGENT

COUPLING = np.random.default_rng(5).standard_normal((3, 3)) * 8.0
ORDER = ["xx", "yy", "xy"]


@pytest.fixture
def tangent() -> TangentStiffness:
    return TangentStiffness(TANGENT, IN_PLANE, COUPLING)


def read_card(path: Path) -> np.ndarray:
    """(6, 6) of *SHELL GENERAL SECTION: 21 entries, eight a line, D11, D12, D22, D13, …"""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("**")]
    assert all(len(line) <= 256 for line in lines)
    at = next(i for i, line in enumerate(lines) if line.startswith("*SHELL GENERAL SECTION"))
    rows = [[float(word) for word in line.split(",")] for line in lines[at + 1 : at + 4]]
    assert [len(row) for row in rows] == [8, 8, 5]
    entries = iter([value for row in rows for value in row])
    matrix = np.zeros((6, 6))
    for column in range(6):
        for row in range(column + 1):
            matrix[row, column] = matrix[column, row] = next(entries)
    return matrix


def read_csv(path: Path) -> dict[str, np.ndarray]:
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    found: dict[str, np.ndarray] = {}
    for row in csv.DictReader(lines):
        matrix = found.setdefault(row["matrix"], np.full((3, 3), np.nan))
        matrix[ORDER.index(row["row"]), ORDER.index(row["column"])] = float(row["value"])
        assert row["unit"] == {"A": "N/mm", "B": "N", "D": "N mm"}[row["matrix"]]
    return found


def test_energies_are_those_of_the_tangent(tangent: TangentStiffness, tmp_path: Path) -> None:
    """½ (E, κ)·[A B; Bᵀ D](E, κ) with κ = −k is the energy of strain E and curvature k."""
    path = fs.export(tangent, to="laminate-json", path=tmp_path / "l.json")
    content = json.loads(path.read_text())
    a, b, d = (np.array(content[name]) for name in "ABD")
    assert content["order"] == ORDER
    assert content["thickness"] is None
    assert content["transverse_shear"] is None
    assert tangent.held is not None
    for strain, k in np.random.default_rng(2).standard_normal((20, 2, 3)):
        kappa = -k
        laminate = 0.5 * strain @ a @ strain + strain @ b @ kappa + 0.5 * kappa @ d @ kappa
        ours = 0.5 * strain @ IN_PLANE @ strain + strain @ COUPLING @ k + 0.5 * k @ tangent.held @ k
        assert laminate == pytest.approx(ours, rel=1e-12)
    # Free of in-plane force it bends as the tangent does.
    free = d - b.T @ np.linalg.solve(a, b)
    assert free == pytest.approx(TANGENT, rel=1e-10)


def test_strain_of_the_side_of_the_scales_tells_the_sign() -> None:
    """A sheet whose stiffness lies at the height z has A = S, B = z S, D = z² S. Closing k (concave
    towards +z) shortens what lies there, so that ours is B = −z S; written it is z S again."""
    from flexscale.exchange.subject import read_subject

    height = 0.7
    tangent = TangentStiffness(1e-3 * np.eye(3), IN_PLANE, -height * IN_PLANE)
    laminate = read_subject(tangent).laminate
    assert laminate is not None
    assert laminate.b == pytest.approx(height * IN_PLANE)
    assert laminate.d == pytest.approx(height**2 * IN_PLANE + 1e-3 * np.eye(3))


def test_csv_and_card_hold_the_same(tangent: TangentStiffness, tmp_path: Path) -> None:
    content = json.loads(fs.export(tangent, to="laminate-json", path=tmp_path / "l").read_text())
    matrices = read_csv(fs.export(tangent, to="laminate-csv", path=tmp_path / "l.csv"))
    assert {name: matrix.tolist() for name, matrix in matrices.items()} == {
        name: content[name] for name in "ABD"
    }
    card = read_card(fs.export(tangent, to="abaqus", path=tmp_path / "l.inp"))
    size = np.abs(card).max()
    assert card[:3, :3] == pytest.approx(np.array(content["A"]), abs=1e-11 * size)
    assert card[:3, 3:] == pytest.approx(np.array(content["B"]), abs=1e-11 * size)
    assert card[3:, 3:] == pytest.approx(np.array(content["D"]), abs=1e-11 * size)


def test_what_is_not_known_is_said(tmp_path: Path) -> None:
    path = fs.export(model_of(), to="laminate-json", path=tmp_path / "l.json")
    content = json.loads(path.read_text())
    assert content["B"] is None
    assert content["thickness"] == 0.4
    assert np.array(content["D"]) == pytest.approx(TANGENT)
    assert "B is not known" in content["conventions"][-1]
    table = fs.export(model_of(), to="laminate-csv", path=tmp_path / "l.csv")
    assert set(read_csv(table)) == {"A", "D"}
    assert "transverse shear stiffness: not computed" in table.read_text()
    with pytest.raises(BadInputError, match="needs the stiffness of the flat cell"):
        fs.export(model_of("paper", tangent=None), to="abaqus", path=tmp_path / "l.inp")


def test_datasets_and_their_models_give_the_same(shipped_results: Path, tmp_path: Path) -> None:
    registry = fs.open_registry(shipped_results)
    stored = next(iter(registry.find(kind="tangent", pattern="brick")))
    dataset = registry.load(stored)
    path = fs.export(dataset, to="laminate-json", path=tmp_path / "l.json")
    content = json.loads(path.read_text())
    assert content["source"] == stored.id
    assert content["sheet"]["pattern"] == "brick"
    assert np.array(content["A"]).tolist() == dataset["in_plane"].values.tolist()
    assert np.array(content["D"]).tolist() == dataset["matrix"].values.tolist()
