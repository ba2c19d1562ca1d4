"""Which code made a result, and on what kind of machine."""

from __future__ import annotations

import functools
import importlib.metadata
import os
import platform
import subprocess
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

_PACKAGE = Path(__file__).resolve().parent.parent
_LIBRARIES = (
    "numpy",
    "scipy",
    "numba",
    "gmsh",
    "pypardiso",
    "cvxopt",
    "shapely",
    "xarray",
    "netCDF4",
)


@dataclass(frozen=True)
class CodeVersion:
    """Version of the package, its commit ("" outside a checkout), and uncommitted changes."""

    version: str
    commit: str
    dirty: bool


@functools.cache
def code_version() -> CodeVersion:
    """Version of the running code; asked from git once a process."""
    try:
        version = importlib.metadata.version("flexscale")
    except importlib.metadata.PackageNotFoundError:
        version = "unknown"
    # An installed package may lie inside someone else's repository: count only tracked files.
    if _git("ls-files", "--error-unmatch", "errors.py") is None:
        return CodeVersion(version, "", False)
    commit = _git("rev-parse", "HEAD")
    changes = _git("status", "--porcelain", "--untracked-files=no", "--", ".")
    return CodeVersion(version, commit or "", bool(changes))


def _git(*arguments: str) -> str | None:
    """Output of a git command in the package's folder, None when it fails."""
    try:
        done = subprocess.run(
            ["git", "-C", str(_PACKAGE), *arguments],
            capture_output=True,
            text=True,
            timeout=20,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.stdout.strip() if done.returncode == 0 else None


def environment() -> dict[str, Any]:
    """Facts for record.json that are no part of a result: time, platform, library versions."""
    return {
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "python": platform.python_version(),
        "system": platform.system(),
        "machine": platform.machine(),
        "cpu_count": os.cpu_count(),
        "libraries": {name: _version(name) for name in _LIBRARIES if _version(name)},
    }


@functools.cache
def _version(library: str) -> str:
    try:
        return importlib.metadata.version(library)
    except importlib.metadata.PackageNotFoundError:
        return ""
