"""All formats of `fs.export`: to add one, add its file to this room and a line to this list.

The command line needs only these declarations, and starts quickly: what writes a format is imported
when it is asked for.
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flexscale.exchange.subject import Subject


@dataclass(frozen=True)
class Format:
    """One way to write a sheet for others.

    Attributes
    ----------
    name : as users call it.
    suffix : ending of its files, with the dot.
    home : "module:function" of this room; the function takes a subject and a path to write to.
    """

    name: str
    suffix: str
    home: str

    def write(self, subject: Subject, path: Path) -> None:
        """Write a subject to a new file.

        Raises
        ------
        BadInputError : the subject lacks what the format needs.
        """
        module, _, name = self.home.partition(":")
        getattr(importlib.import_module(f"flexscale.exchange.{module}"), name)(subject, path)


FORMATS: dict[str, Format] = {
    item.name: item
    for item in (
        Format("laminate-json", ".json", "laminate_files:write_json"),
        Format("laminate-csv", ".csv", "laminate_files:write_csv"),
        Format("table-netcdf", ".nc", "curvature_table:write_netcdf"),
        Format("table-csv", ".csv", "curvature_table:write_csv"),
        Format("hylc", ".json", "hylc:write_hylc"),
        Format("abaqus", ".inp", "abaqus:write_abaqus"),
        Format("calculix", ".inp", "calculix:write_calculix"),
        Format("c-header", ".h", "c_header:write_c_header"),
        Format("python-function", ".py", "python_function:write_python_function"),
    )
}
