"""The mesh generator's Python module, and the shared libraries that it needs of the system.

Its wheel does not carry them. Where nobody may install them, `flexscale doctor --fix` unpacks them
into a folder of the environment; from there they are loaded before gmsh asks for them, since a
process that runs cannot be given other paths to search.
"""

from __future__ import annotations

import ctypes
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from flexscale.errors import MissingSystemPartError

#: Packages of Debian and Ubuntu are unpacked below it.
UNPACKED = Path(sys.prefix) / "system-libraries"
_MOST = 100  # libraries that one may need
_MISSING = re.compile(r"(\S+\.so[.\d]*): cannot open shared object file")
Loaded = TypeVar("Loaded")


def load_gmsh() -> Any:
    """The module gmsh.

    Raises
    ------
    MissingSystemPartError : a library it needs is nowhere; the message names the remedy.
    """
    try:
        return _with_unpacked(_import_gmsh)
    except OSError as error:
        raise MissingSystemPartError(
            f"gmsh cannot be loaded ({error}): `flexscale doctor --fix` brings the system "
            "libraries it needs, or says how."
        ) from error


def _import_gmsh() -> Any:
    import gmsh

    return gmsh


def has_library(name: str) -> bool:
    """Whether a shared library can be loaded, from the system or from what is unpacked."""
    try:
        _with_unpacked(lambda: ctypes.CDLL(name))
    except OSError:
        return False
    return True


def _with_unpacked(load: Callable[[], Loaded], above: tuple[str, ...] = ()) -> Loaded:
    """What `load` returns, once each library that it misses has been loaded from `UNPACKED`.

    One that is loaded is found by its name when another one asks for it. `above` are those that
    are waiting for this one.
    """
    for _ in range(_MOST):
        try:
            return load()
        except OSError as error:
            missing = _MISSING.search(str(error))
            places = sorted(UNPACKED.rglob(missing[1])) if missing else []
            if missing is None or not places or missing[1] in above:
                raise
            place = str(places[0])
            _with_unpacked(
                lambda place=place: ctypes.CDLL(place, mode=ctypes.RTLD_GLOBAL),  # type: ignore[misc]
                (*above, missing[1]),
            )
    return load()
