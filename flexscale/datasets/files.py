"""The two files of a dataset's folder: written and read back, verified, compared."""

from __future__ import annotations

import hashlib
import json
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr

import flexscale.datasets.accessor  # noqa: F401  (registers `dataset.fs`)
from flexscale.datasets.checks import check_dataset
from flexscale.datasets.containers import FOREIGN, require_self_contained
from flexscale.datasets.entry import DATA_FILE, Entry, row_of_record
from flexscale.datasets.identity import SHORT_DIGEST, content_digest
from flexscale.datasets.labels import require_same_labels
from flexscale.datasets.record import RECORD_FILE, read_record
from flexscale.datasets.staging import sync
from flexscale.datasets.untrusted import read_regular
from flexscale.errors import IntegrityError, SchemaError

LARGEST_FILE = 4 * 2**30  # bytes


_PROBE = bytes(2**20)


def load_entry(entry: Entry) -> xr.Dataset:
    """The dataset of an entry in memory, its file verified.

    Raises
    ------
    DatasetError : it is damaged, reaches outside of its file, or is not what its record says.
    """
    record = read_record(entry.folder)
    dataset = read_netcdf(entry.folder / DATA_FILE, verified_content(entry.folder, record))
    require_same_labels(dataset, record, entry.folder)
    try:
        check_dataset(dataset, entry.kind)
    except SchemaError as error:
        raise SchemaError(f"{entry.folder / DATA_FILE}: {error}") from error
    return dataset


def entry_of_folder(folder: Path, layer: Path) -> Entry:
    """Entry read from a folder's record.json."""
    path = folder.relative_to(layer).as_posix()
    return Entry.from_row(row_of_record(read_record(folder), path), layer)


def verified_content(folder: Path, record: Mapping[str, Any]) -> bytes:
    """Bytes of data.nc, if they have their recorded sha256.

    Compared before the netCDF library sees them: damaged HDF5 can crash the process.
    """
    path = folder / DATA_FILE
    advice = f"Remove the folder {folder} and run the step again."
    try:
        content = read_regular(path, LARGEST_FILE)
    except FileNotFoundError as error:
        raise IntegrityError(f"{path} is missing. {advice}") from error
    found = hashlib.sha256(content).hexdigest()
    if found != record["file_sha256"]:
        raise IntegrityError(
            f"{path} is damaged: its sha256 starts with {found[:SHORT_DIGEST]}, "
            f"recorded is {record['file_sha256'][:SHORT_DIGEST]}. {advice}"
        )
    return content


def write_payload(folder: Path, dataset: xr.Dataset, kind: str, facts: dict[str, Any]) -> None:
    """Write data.nc and record.json, and read the data back to be sure of them."""
    path = folder / DATA_FILE
    encoding = {
        name: {"zlib": True, "complevel": 4, "shuffle": True}
        for name, variable in dataset.variables.items()
        if variable.size > 256 and variable.dtype.kind in "fi"
    }
    try:
        dataset.to_netcdf(path, engine="netcdf4", format="NETCDF4", encoding=encoding)
    except (RuntimeError, OSError) as error:
        # The netCDF library reports a full disk as "HDF error" or "Permission denied".
        (folder / "probe").write_bytes(_PROBE)
        raise OSError(getattr(error, "strerror", None) or str(error)) from error
    content = read_regular(path, LARGEST_FILE)
    stored = read_netcdf(path, content)
    check_dataset(stored, kind)
    if content_digest(stored) != facts["content_digest"] or not stored.identical(dataset):
        raise IntegrityError(
            f"The {kind} dataset does not survive writing: {first_difference(dataset, stored)}."
        )
    sync(path)
    facts["file_sha256"] = hashlib.sha256(content).hexdigest()
    facts["file_bytes"] = len(content)
    record = folder / RECORD_FILE
    record.write_text(json.dumps(facts, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    sync(record)
    sync(folder)


def read_netcdf(path: Path, content: bytes) -> xr.Dataset:
    """Dataset in `content`, the bytes of the file `path`; no file is opened for it.

    Raises
    ------
    IntegrityError : it is not readable, or not complete in itself.
    """
    require_self_contained(content, path)
    try:
        file = netCDF4.Dataset(path.name, memory=content)
        with warnings.catch_warnings():
            # What xarray only warns of (attributes that ask for odd conversions) we never write.
            warnings.simplefilter("error", RuntimeWarning)
            return xr.load_dataset(xr.backends.NetCDF4DataStore(file), decode_times=False)
    except (*FOREIGN, AttributeError, RuntimeWarning) as error:
        raise IntegrityError(f"{path} is not readable as netCDF: {error!s:.200}.") from error


def first_difference(new: xr.Dataset, old: xr.Dataset) -> str:
    """The first variable that differs, and by how much at most."""
    for name in sorted({*map(str, new.variables), *map(str, old.variables)}):
        if name not in new.variables or name not in old.variables:
            return f"{name} is in only one of them"
        a, b = new.variables[name], old.variables[name]
        if a.identical(b):
            continue
        if a.shape != b.shape or a.dims != b.dims:
            return f"{name} has shape {a.shape}, stored is {b.shape}"
        if a.dtype.kind in "fi" and b.dtype.kind in "fi" and not a.equals(b):
            missing = int(np.count_nonzero(np.isnan(a.values) != np.isnan(b.values)))
            largest = float(np.nanmax(np.abs(a.values - b.values), initial=0.0))
            text = f"{name} differs by at most {largest:.3g} {a.attrs.get('units', '')}".rstrip()
            return text + (f" and in {missing} missing values" if missing else "")
        return f"{name} differs"
    return "global attributes differ"
