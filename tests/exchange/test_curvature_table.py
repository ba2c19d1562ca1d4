"""Tables over curvature tensors, read back by other libraries than those that write them."""

from __future__ import annotations

from pathlib import Path

import netCDF4
import numpy as np
import pandas as pd
import pytest

import flexscale as fs
from flexscale.homogenize.flat_contact import FlatContact
from flexscale.macro.gap_model import GapModel
from tests.exchange.exchange_samples import derivatives_of, model_of
from tests.macro.law_samples import IN_PLANE, TANGENT


def gap_model() -> GapModel:
    contact = FlatContact(np.array([0.1]), np.array([[-9.0, 0.0, 0.0]]), np.array([[0.01]]))
    return GapModel(TANGENT, IN_PLANE, contact, labels={"family": "IH01", "pattern": "x"})


@pytest.mark.parametrize("model", [model_of(), model_of("paper", in_plane=None), gap_model()])
def test_netcdf_holds_the_law(model: object, tmp_path: Path) -> None:
    path = fs.export(model, to="table-netcdf", path=tmp_path / "t.nc")
    with netCDF4.Dataset(path) as file:
        axes = [file[name][:].filled() for name in ("k_xx", "k_yy", "k_xy")]
        values = {name: file[name][:].filled() for name in ("W", "m_xx", "m_yy", "m_xy")}
        within = file["within_data"][:].filled()
        units = {name: file[name].units for name in (*values, "k_xx")}
        largest = file.largest_curvature
    assert units == {"W": "N mm-1", "m_xx": "N", "m_yy": "N", "m_xy": "N", "k_xx": "mm-1"}
    assert largest == model.largest_curvature  # type: ignore[attr-defined]
    k = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    energy, gradient, _ = derivatives_of(model, k)  # type: ignore[arg-type]
    assert values["W"].ravel() == pytest.approx(energy, rel=1e-14)
    moments = np.stack([values[name].ravel() for name in ("m_xx", "m_yy", "m_xy")], axis=-1)
    assert moments * [1.0, 1.0, 2.0] == pytest.approx(gradient, rel=1e-14, abs=1e-16)
    principal = np.abs(np.linalg.eigvalsh(k[:, [0, 2, 2, 1]].reshape(-1, 2, 2))).max(axis=1)
    assert (within.ravel() == (principal <= largest * (1.0 + 1e-9))).all()
    assert 0.1 < within.mean() < 0.9


def test_work_of_the_moments_is_the_energy(tmp_path: Path) -> None:
    """Along k_xy alone, where a factor of 2 is easily lost: dW = 2 m_xy dk_xy, by Simpson."""
    path = fs.export(model_of(), to="table-netcdf", path=tmp_path / "t.nc")
    with netCDF4.Dataset(path) as file:
        middle = len(file["k_xx"]) // 2
        k, w, m = (file[name][:].filled() for name in ("k_xy", "W", "m_xy"))
    w, m = w[middle, middle], m[middle, middle]
    found = np.diff(k)[::2] / 3.0 * (2.0 * m[:-2:2] + 8.0 * m[1:-1:2] + 2.0 * m[2::2])
    assert found == pytest.approx(np.diff(w[::2]), rel=0.02, abs=0.02 * np.abs(np.diff(w)).max())


def test_csv_holds_the_same(tmp_path: Path) -> None:
    first = fs.export(model_of(), to="table-csv", path=tmp_path / "t.csv")
    second = fs.export(model_of(), to="table-netcdf", path=tmp_path / "t.nc")
    frame = pd.read_csv(first, comment="#")
    with netCDF4.Dataset(second) as file:
        for column in frame.columns:
            name = column.split(" ")[0]
            values = file[name][:].filled()
            if values.ndim == 1:
                continue
            assert (frame[column].to_numpy() == values.ravel()).all(), name
    text = first.read_text()
    assert "fitted to principal curvatures from -0.02 to 0.02 1/mm" in text
    assert "k_xy the entry itself, not the engineering twist" in text


def test_a_side_without_data_is_flagged(tmp_path: Path) -> None:
    polar = model_of().polar
    one = type(polar)(("closing",), polar.a, polar.b[:1], polar.onset[:1], ("kappa_0",), 0.02)
    path = fs.export(model_of(polar=one), to="table-csv", path=tmp_path / "t.csv")
    frame = pd.read_csv(path, comment="#")
    k = frame.to_numpy()[:, [0, 2, 2, 1]].reshape(-1, 2, 2)
    assert (frame["within_data"] == (np.linalg.eigvalsh(k)[:, 0] >= -2e-11)).mean() > 0.5
    assert not frame["within_data"][np.linalg.eigvalsh(k)[:, 0] < -1e-6].any()
    assert "from 0 to 0.02 1/mm" in path.read_text()
