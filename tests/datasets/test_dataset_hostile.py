"""A results folder from somebody else: nothing outside of its files is reached, nothing hangs."""

from __future__ import annotations

import dataclasses
import os
import shutil
import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import h5py
import numpy as np
import pytest

from flexscale.datasets.audit import check_results
from flexscale.datasets.entry import Entry
from flexscale.datasets.export import export
from flexscale.datasets.registry import open_registry
from flexscale.datasets.store import Store
from flexscale.errors import DatasetError, IntegrityError, SchemaError
from tests.datasets.dataset_samples import recipe
from tests.datasets.results_samples import forget_catalog, one_sweep, sign

SECRET = 7.25


@pytest.fixture(scope="module")
def sample(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results folder to copy."""
    root = tmp_path_factory.mktemp("sample")
    one_sweep(root)
    return root


@pytest.fixture
def entry(sample: Path, tmp_path: Path) -> Entry:
    shutil.copytree(sample, tmp_path / "results")
    return open_registry(tmp_path / "results").find().one()


@pytest.fixture
def secret(tmp_path: Path) -> Path:
    """File of somebody's that a dataset has no business to read."""
    path = tmp_path / "secret.h5"
    with h5py.File(path, "w") as file:
        file["moment"] = np.full((2, 3, 3), SECRET)
    return path


@pytest.fixture(autouse=True)
def no_hang() -> Iterator[None]:
    """Whoever waits for a pipe or an endless device gets an alarm that ends the process."""
    signal.alarm(60)
    yield
    signal.alarm(0)


def external_storage(file: h5py.File, other: Path) -> None:
    del file["moment"]
    file.create_dataset("moment", (2, 3, 3), "f8", external=[(str(other), 0, 144)])


def external_link(file: h5py.File, other: Path) -> None:
    del file["moment"]
    file["moment"] = h5py.ExternalLink(str(other), "/moment")


def virtual_dataset(file: h5py.File, other: Path) -> None:
    del file["moment"]
    layout = h5py.VirtualLayout((2, 3, 3), "f8")
    layout[...] = h5py.VirtualSource(str(other), "moment", (2, 3, 3))
    file.create_virtual_dataset("moment", layout)


def growing_virtual_dataset(file: h5py.File, other: Path) -> None:
    """Opening one without end has HDF5 open its sources at once."""
    del file["moment"]
    layout = h5py.VirtualLayout((2, 3, 3), "f8", maxshape=(None, 3, 3))
    source = h5py.VirtualSource(str(other), "moment", (2, 3, 3), maxshape=(None, 3, 3))
    layout[: h5py.h5s.UNLIMITED] = source[: h5py.h5s.UNLIMITED]
    file.create_virtual_dataset("moment", layout)


WAYS_OUT = {
    external_storage: "keeps its values in another file",
    external_link: "is a link to somewhere else",
    virtual_dataset: "virtual dataset",
    growing_virtual_dataset: "virtual dataset",
}


def refusals(entry: Entry, folder: Path) -> list[str]:
    """What each way to use a dataset says of it, the audit last."""
    store = Store(folder)
    told = []
    for use in (
        lambda: open_registry(folder).load(entry),
        lambda: store.load(entry),
        lambda: export(entry, folder, "csv"),
    ):
        with pytest.raises(DatasetError) as caught:
            use()
        told.append(str(caught.value))
    problems = [item.message for item in check_results(folder) if item.level == "problem"]
    assert len(problems) == 1
    return [*told, *problems]


def change(entry: Entry, how: Callable[[h5py.File], object]) -> None:
    with h5py.File(entry.folder / "data.nc", "r+") as file:
        how(file)
    sign(entry.folder)


@pytest.mark.parametrize("way", WAYS_OUT)
def test_no_other_file_is_read_into_a_dataset(entry: Entry, secret: Path, way) -> None:
    change(entry, lambda file: way(file, secret))
    for sentence in refusals(entry, secret.parent / "results"):
        assert WAYS_OUT[way] in sentence
        assert str(entry.folder / "data.nc") in sentence


@pytest.mark.parametrize("way", WAYS_OUT)
@pytest.mark.parametrize("other", ["/dev/zero", "pipe"])
def test_what_never_ends_is_never_begun(entry: Entry, tmp_path: Path, way, other: str) -> None:
    os.mkfifo(tmp_path / "pipe")
    change(entry, lambda file: way(file, tmp_path / other))
    for sentence in refusals(entry, tmp_path / "results"):
        assert WAYS_OUT[way] in sentence


def circle(file: h5py.File) -> None:
    file["one"], file["two"] = h5py.SoftLink("/two"), h5py.SoftLink("/one")


def own_loop(file: h5py.File) -> None:
    file["loop"] = file["/"]


def foreign_filter(file: h5py.File) -> None:
    file.create_dataset("more", data=np.zeros(1000), compression="lzf")


def endless(file: h5py.File) -> None:
    file.create_dataset("more", (10**15,), "f8", chunks=(1024,), fillvalue=1.0)


def endless_axis(file: h5py.File) -> None:
    file.create_dataset("more", (10**9, 10**9, 10**9), "i1", chunks=(1, 1, 1024))


def large_chunk(file: h5py.File) -> None:
    file.create_dataset("more", (1,), "f8", maxshape=(None,), chunks=(400_000_000,))


def many_texts(file: h5py.File) -> None:
    file.create_dataset("more", (10**7,), h5py.string_dtype(), chunks=(1024,))


def long_attribute(file: h5py.File) -> None:
    file["moment"].attrs.create("more", ["x"] * 40, dtype=h5py.string_dtype())


def group(file: h5py.File) -> None:
    file.create_group("more")


def compound(file: h5py.File) -> None:
    file["more"] = np.zeros(2, dtype=[("a", "f8"), ("b", "i4")])


def lists(file: h5py.File) -> None:
    file.create_dataset("more", (2,), h5py.vlen_dtype("f8"))


@pytest.mark.parametrize(
    ("way", "reason"),
    [
        (circle, "is a link to somewhere else"),
        (own_loop, "is a group"),
        (foreign_filter, "needs the filter 32000"),
        (endless, "declare 8e+15 bytes"),
        (endless_axis, "declare 1e+27 bytes"),
        (large_chunk, "declare 3.2e+09 bytes"),
        (many_texts, "declare"),
        (long_attribute, "the attribute 'more' of 'moment' has 40 values"),
        (group, "is a group"),
        (compound, "neither numbers nor text"),
        (lists, "neither numbers nor text"),
    ],
)
def test_what_no_dataset_needs_is_refused(entry: Entry, tmp_path: Path, way, reason: str) -> None:
    change(entry, way)
    for sentence in refusals(entry, tmp_path / "results"):
        assert reason in sentence


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("DIMENSION_LIST", "text"),
        ("DIMENSION_LIST", np.zeros(3)),
        ("REFERENCE_LIST", np.zeros(3, dtype=[("dataset", "i8"), ("dimension", "i4")])),
        ("CLASS", 1.5),
        ("NAME", "text of no fixed length"),
        ("_Netcdf4Coordinates", np.array([0, 1, 99], dtype="i4")),
        ("_Netcdf4Coordinates", np.array([0, 1], dtype="i4")),
        ("_Netcdf4Dimid", np.int32(-1)),
        ("_NCProperties", 3),
        ("_FillValue", "text"),
        ("_nc3_strict", 1),
    ],
)
def test_what_netcdf_says_to_itself_is_what_it_writes(
    entry: Entry, tmp_path: Path, name: str, value: object
) -> None:
    """The first of these crashes the netCDF library."""

    def way(file: h5py.File) -> None:
        file["moment"].attrs.pop(name, None)
        file["moment"].attrs[name] = value

    change(entry, way)
    for sentence in refusals(entry, tmp_path / "results"):
        assert f"the attribute '{name}' of 'moment' is not what netCDF writes" in sentence


def linked(path: Path, secret: Path) -> None:
    path.unlink()
    path.symlink_to(secret)


def piped(path: Path, secret: Path) -> None:
    path.unlink()
    os.mkfifo(path)


def without_end(path: Path, secret: Path) -> None:
    path.unlink()
    path.symlink_to("/dev/zero")


def sparse(path: Path, secret: Path) -> None:
    os.truncate(path, 2**40)


@pytest.mark.parametrize("name", ["data.nc", "record.json"])
@pytest.mark.parametrize(
    ("way", "reason"),
    [
        (linked, "is a symbolic link"),
        (without_end, "is a symbolic link"),
        (piped, "is no ordinary file"),
        (sparse, "are the most"),
    ],
)
def test_only_ordinary_files_are_read(
    entry: Entry, secret: Path, name: str, way, reason: str
) -> None:
    way(entry.folder / name, secret)
    forget_catalog(entry.folder)
    for sentence in refusals(entry, secret.parent / "results"):
        assert reason in sentence
        assert name in sentence


def test_a_catalog_that_is_a_pipe_is_left_alone(entry: Entry, tmp_path: Path) -> None:
    forget_catalog(entry.folder)
    os.mkfifo(tmp_path / "results" / "local" / "catalog.csv")
    assert open_registry(tmp_path / "results").find().one().id == entry.id


def test_folders_that_are_links_are_not_followed(entry: Entry, tmp_path: Path) -> None:
    kind = tmp_path / "results" / "local" / "sweep"
    kind.rename(tmp_path / "elsewhere")
    kind.symlink_to(tmp_path / "elsewhere")
    assert len(open_registry(tmp_path / "results")) == 0
    problems = [f for f in check_results(tmp_path / "results") if f.level == "problem"]
    assert [p.subject for p in problems] == ["sweep"]
    assert "is a symbolic link" in problems[0].message
    with pytest.raises(IntegrityError, match="symbolic link"):
        one_sweep(tmp_path / "results")
    assert not Store(tmp_path / "results").lookup("sweep", recipe())


@pytest.mark.parametrize("column", ["family", "pattern"])
@pytest.mark.parametrize(
    "name", ["../../x", "..", ".", "", "a/b", "a\\b", "-x", "\x1b[2J", "x" * 101]
)
def test_names_that_are_no_names_do_not_become_files(
    entry: Entry, tmp_path: Path, column: str, name: str
) -> None:
    """Even where an entry got around the checks of records and catalogs."""
    hostile = dataclasses.replace(entry, row={**entry.row, column: name})
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(SchemaError, match="use letters, digits") as caught:
        export(hostile, tmp_path)
    assert "\x1b" not in str(caught.value)
    assert sorted(tmp_path.rglob("*")) == before


def test_the_shipped_datasets_open(shipped_results: Path) -> None:
    """The inspection refuses nothing that netCDF writes for us, of any kind."""
    registry = open_registry(shipped_results)
    for kind in {entry.kind for entry in registry.find(source="reference")}:
        entry = registry.find(kind=kind, source="reference")[0]
        assert registry.load(entry).attrs["flexscale_recipe_digest"] == entry.recipe_digest
