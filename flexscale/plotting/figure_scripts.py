"""Figure scripts, `paper_figures/figNN_<topic>.py`: what each defines, and how it is loaded.

NEEDS : dict from input name to `Need`, the datasets it draws and the command that makes each;
CAPTION : one or two sentences for the page that lists all figures;
PAPER_SAYS : what the paper says of the figure;
draw(inputs) : gets the datasets by input name, returns a matplotlib Figure;
findings(inputs) : sentences on what the datasets show of that, with numbers computed from them.
"""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType

from flexscale.errors import BadInputError, UnknownNameError, suggest

NAMES = ("NEEDS", "CAPTION", "PAPER_SAYS", "draw", "findings")


@dataclass(frozen=True)
class Need:
    """One dataset a figure draws.

    Parameters
    ----------
    kind : dataset kind, for instance "sweep".
    command : what the user types to make it.
    where : values its catalog row must have, for instance {"pattern": "hexagon"}.
    native : the native model that it is of; "" for any.
    optional : whether the figure is drawn without it where it is not there.
    """

    kind: str
    command: str
    where: Mapping[str, str] = field(default_factory=dict)
    native: str = ""
    optional: bool = False

    def __str__(self) -> str:
        of = [f"of the {self.native}"] if self.native else []
        return " ".join([self.kind, *self.where.values(), *of])


@dataclass(frozen=True)
class FigureScript:
    """A loaded figure script; `stem` is its file name without ending."""

    stem: str
    path: Path
    module: ModuleType

    @property
    def needs(self) -> dict[str, Need]:
        return dict(self.module.NEEDS)

    @property
    def caption(self) -> str:
        return str(self.module.CAPTION)

    @property
    def paper_says(self) -> str:
        return str(self.module.PAPER_SAYS)


def find_scripts(folder: Path, names: Sequence[str] = ()) -> list[FigureScript]:
    """Figure scripts of a folder by name, sorted; all when no name is given.

    Parameters
    ----------
    names : file stems, or the part before the first underscore, "fig07" or "fig7".

    Raises
    ------
    UnknownNameError : no script has that name.
    BadInputError : a script lacks one of NAMES.
    """
    paths = sorted(path for path in folder.glob("fig*.py"))
    chosen = []
    for name in names:
        number = re.fullmatch(r"fig0*(\d{1,2})", name, re.IGNORECASE)
        meant = f"fig{int(number[1]):02d}" if number else name
        fitting = [path for path in paths if meant in (path.stem, path.stem.split("_")[0])]
        if not fitting:
            known = [path.stem for path in paths]
            raise UnknownNameError(f"There is no figure '{name}'. {suggest(name, known)}")
        chosen += fitting
    return [_load(path) for path in dict.fromkeys(chosen if names else paths)]


def _load(path: Path) -> FigureScript:
    spec = importlib.util.spec_from_file_location(f"flexscale_figure_{path.stem}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    missing = [name for name in NAMES if not hasattr(module, name)]
    if missing:
        raise BadInputError(f"The figure script {path.name} does not define {', '.join(missing)}.")
    return FigureScript(path.stem, path, module)
