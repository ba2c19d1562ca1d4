"""What `fs.export` takes, and what it refuses: one sentence, and nothing written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexscale as fs
from flexscale.errors import BadInputError, ConfigError, UnknownNameError
from flexscale.exchange.formats import FORMATS
from flexscale.homogenize.tangent import TangentStiffness
from tests.datasets.dataset_samples import sweep
from tests.exchange.exchange_samples import model_of
from tests.macro.law_samples import IN_PLANE, TANGENT

LAWS = ("table-netcdf", "table-csv", "hylc", "c-header", "python-function")


@pytest.mark.parametrize("to", FORMATS)
def test_a_fit_has_all_formats(to: str, tmp_path: Path) -> None:
    path = fs.export(model_of(), to=to, path=str(tmp_path / "file"))
    assert path == tmp_path / "file"
    assert path.stat().st_size > 500
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("to", FORMATS)
def test_files_come_out_the_same_again(to: str, tmp_path: Path) -> None:
    """No date and no name of a folder or machine is in them."""
    first, second = (fs.export(model_of(), to=to, path=tmp_path / name) for name in "ab")
    if to != "table-netcdf":  # HDF5 does not promise it
        assert first.read_bytes() == second.read_bytes()
    assert b"/tmp" not in first.read_bytes()


@pytest.mark.parametrize("to", LAWS)
def test_a_tangent_has_no_law(to: str, tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match=r"needs a law .* stiffness at rest alone: give a fit"):
        fs.export(TangentStiffness(TANGENT, IN_PLANE), to=to, path=tmp_path / "file")
    assert not list(tmp_path.iterdir())


def test_an_unknown_format_has_a_suggestion(tmp_path: Path) -> None:
    with pytest.raises(UnknownNameError, match="Did you mean 'c-header'"):
        fs.export(model_of(), to="c_header", path=tmp_path / "file")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (sweep(), "kind sweep has neither stiffness nor law to export: fit the sweep first"),
        (np.eye(3), "cannot be exported: give a dataset of kind fit, gap_model, tensor_model or"),
        (None, "None .* cannot be exported"),
        ("fit:69208323d680", "cannot be exported"),
    ],
)
def test_what_is_neither_stiffness_nor_law_is_refused(
    given: Any, said: str, tmp_path: Path
) -> None:
    with pytest.raises(BadInputError, match=said):
        fs.export(given, to="abaqus", path=tmp_path / "file")
    assert not list(tmp_path.iterdir())


def test_a_stiffness_that_is_none_is_refused(tmp_path: Path) -> None:
    soft = TangentStiffness(np.diag([1.0, -2.0, 1.0]), IN_PLANE)
    with pytest.raises(BadInputError, match=r"bending stiffness .* is not positive \(least .* -2"):
        fs.export(soft, to="calculix", path=tmp_path / "file")
    assert not list(tmp_path.iterdir())


def test_files_that_are_there_stay(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text("mine")
    with pytest.raises(BadInputError, match="is there already"):
        fs.export(model_of(), to="abaqus", path=path)
    assert path.read_text() == "mine"
    assert fs.export(model_of(), to="abaqus", path=path, replace=True).read_text() != "mine"


def test_places_that_are_none_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="is a folder: name the file"):
        fs.export(model_of(), to="abaqus", path=tmp_path)
    with pytest.raises(ConfigError, match="There is no folder"):
        fs.export(model_of(), to="abaqus", path=tmp_path / "none" / "file")
    with pytest.raises(BadInputError, match="path must be the path of a file"):
        fs.export(model_of(), to="abaqus", path=3)  # type: ignore[arg-type]


def test_a_refusal_in_the_middle_leaves_what_was_there(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text("mine")
    with pytest.raises(BadInputError):
        fs.export(model_of("paper", in_plane=None), to="hylc", path=path, replace=True)
    assert path.read_text() == "mine"
    assert list(tmp_path.iterdir()) == [path]
