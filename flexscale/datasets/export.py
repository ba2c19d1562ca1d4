"""Datasets as text for people, and as files to give away."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import xarray as xr

from flexscale.datasets.entry import Entry
from flexscale.datasets.files import load_entry, verified_content
from flexscale.datasets.record import read_record
from flexscale.datasets.staging import require_free, write_atomically
from flexscale.errors import ConfigError, suggest
from flexscale.names import require_name

FORMATS = ("nc", "csv")


def describe(entry: Entry) -> dict[str, Any]:
    """Everything known of a dataset, JSON-able: catalog row, folder and record.json."""
    return {**entry.row, "folder": str(entry.folder), "record": read_record(entry.folder)}


def describe_text(entry: Entry) -> str:
    """What a dataset is, where it came from and what it holds, as lines for people."""
    record, dataset = read_record(entry.folder), load_entry(entry)
    recipe, code = record["recipe"], record["code"]
    commit = (code["commit"][:12] or "no commit") + (" with changes" if code["dirty"] else "")
    lines = [
        f"{entry.id}  {entry.row['family']}/{entry.row['pattern']}  {entry.row['status']}",
        f"  folder   {entry.folder}",
        f"  step     {recipe['step']}, version {recipe['version']}",
        f"  code     flexscale {code['version']}, {commit}",
        f"  created  {record['environment']['created']}",
        f"  inputs   {', '.join(item['id'] for item in record['inputs']) or 'none'}",
        f"  content  {entry.content_digest}",
    ]
    if record["samples"]:
        lines.append(f"  samples  {record['samples']}, {record['failed']} not converged")
    for title, variables in (("axes", dataset.coords), ("variables", dataset.data_vars)):
        lines.append(f"  {title}")
        lines += [f"    {_variable_text(str(name), item)}" for name, item in variables.items()]
    return "\n".join(lines)


def _variable_text(name: str, array: xr.DataArray) -> str:
    sizes = ", ".join(f"{dim} {size}" for dim, size in array.sizes.items())
    unit = f" [{array.attrs['units']}]" if array.attrs.get("units", "1") != "1" else ""
    value = "" if array.dims else f" = {array.item()}"
    return f"{name}{unit}{value}  {f'({sizes})  ' if sizes else ''}{array.attrs['long_name']}"


def file_stem(entry: Entry) -> str:
    """Name of a file made of a dataset, without ending: sheet_IH64_chevron_bfc5e4a27ae8."""
    parts = (entry.kind, entry.row["family"], entry.row["pattern"], entry.folder.name)
    return "_".join(
        require_name(part, "dataset's kind, family, pattern or folder") for part in parts
    )


def export(
    entry: Entry, destination: str | Path, file_format: str = "nc", *, replace: bool = False
) -> Path:
    """Verified copy of a dataset as one file, complete or not there.

    Parameters
    ----------
    entry : what to export.
    destination : an existing folder; the file is named after the dataset.
    file_format : "nc", or "csv" (one row a sample or direction, units in the header, components of
        tensors in columns of their own; for sweeps and tangents).
    replace : whether a file of this name that is there may be written over.

    Returns
    -------
    Path of the file.
    """
    folder = Path(destination)
    if not folder.is_dir():
        raise ConfigError(f"There is no folder {folder}: create it, or name another one.")
    if file_format not in FORMATS:
        raise ConfigError(f"There is no format {file_format!r}. {suggest(file_format, FORMATS)}")
    path = folder / f"{file_stem(entry)}.{file_format}"
    require_free([path], replace)
    dataset = load_entry(entry)
    if file_format == "nc":
        content = verified_content(entry.folder, read_record(entry.folder))
        write_atomically(path, lambda file: file.write_bytes(content))
        return path
    if entry.kind not in ("sweep", "tangent"):
        raise ConfigError(f"A {entry.kind} does not fit into one table: export it as nc.")
    flat = _one_row_a_sample(dataset)
    frame = flat.to_dataframe().reset_index()
    units = {name: item.attrs.get("units", "1") for name, item in flat.variables.items()}
    header = {
        name: f"{name} [{units[name]}]" for name in frame.columns if units[name] not in ("1", "")
    }
    write_atomically(path, lambda file: frame.rename(columns=header).to_csv(file, index=False))
    return path


def _one_row_a_sample(dataset: xr.Dataset) -> xr.Dataset:
    """Components of tensors as variables of their own, `matrix_xx_xy`; nothing is left out but
    labels and what follows from the axes."""
    flat = dataset.drop_vars(
        [name for name, item in dataset.coords.items() if item.dims != (name,)]
    )
    for name, variable in dataset.data_vars.items():
        axes = [axis for axis in variable.dims if axis in ("component", "other_component")]
        if not axes:
            continue
        flat = flat.drop_vars([name])
        for place in itertools.product(*(dataset[axis].values for axis in axes)):
            part = variable.sel(dict(zip(axes, place, strict=True))).reset_coords(drop=True)
            flat["_".join([str(name), *place])] = part
    return flat.drop_vars(["component", "other_component"], errors="ignore")
