"""`fs.export`: stiffness and laws of sheets as files that other simulators read."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from flexscale import checks
from flexscale.checks import checked, choice
from flexscale.datasets.staging import require_free, write_atomically
from flexscale.errors import ConfigError
from flexscale.exchange.formats import FORMATS
from flexscale.exchange.subject import read_subject


@checked(to=choice("format to export to", FORMATS), path=checks.path, replace=checks.flag)
def export(what: Any, *, to: str, path: str | Path, replace: bool = False) -> Path:
    """Write a sheet's stiffness or law for another simulator; docs/export.md describes the files.

    Parameters
    ----------
    what : dataset of kind fit, gap_model, tensor_model or tangent, or what `fs.fit`,
        `fs.gap_model`, `fs.tensor_model` or `fs.tangent_stiffness` returns.
    to : the format: laminate-json, laminate-csv, table-netcdf, table-csv, hylc, abaqus, calculix,
        c-header or python-function.
    path : of the file to write, complete or not there at all.
    replace : whether a file that is there may be written over.

    Returns
    -------
    Path of the file.

    Raises
    ------
    UnknownNameError : a format there is not.
    BadInputError : `what` lacks what the format needs, or the file is there already.

    Examples
    --------
    >>> import tempfile
    >>> import flexscale as fs
    >>> tangent = fs.tangent_stiffness(fs.Pattern(fs.Tiling("IH76")))
    >>> fs.export(tangent, to="abaqus", path=f"{tempfile.mkdtemp()}/square.inp").name
    'square.inp'
    """
    target = Path(path)
    if not target.parent.is_dir():
        raise ConfigError(f"There is no folder {target.parent}: create it, or name another one.")
    if target.is_dir():
        raise ConfigError(f"{target} is a folder: name the file to write in it.")
    require_free([target], replace)
    subject = read_subject(what)
    write_atomically(target, lambda file: FORMATS[to].write(subject, file))
    return target
