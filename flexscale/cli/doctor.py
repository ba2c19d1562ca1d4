"""`flexscale doctor`: what is missing on this machine, and the command that fixes it."""

from __future__ import annotations

import importlib.metadata
import json
import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass

import psutil
from packaging.requirements import Requirement

from flexscale.cli import system_libraries
from flexscale.errors import MissingSystemPartError

_START_GMSH = "from flexscale.gmsh_library import load_gmsh; print(load_gmsh().__version__)"
_GIB = 2.0**30
_MIN_MEMORY = 2.0  # GiB
_MIN_DISK = 1.0  # GiB


@dataclass(frozen=True)
class Finding:
    """One thing looked at: `level` is "ok", "note" or "missing"; `fix` is a command or ""."""

    level: str
    subject: str
    message: str
    fix: str = ""


def examine(*, as_json: bool = False, quiet: bool = False, fix: bool = False) -> int:
    """Print what was found; bring missing system libraries first when asked to.

    Parameters
    ----------
    as_json : print JSON.
    quiet : print only what is missing.
    fix : install missing system libraries, or without root unpack them beside the environment.

    Returns
    -------
    0, or 4 when something needed is missing.
    """
    if fix:
        _bring_libraries()
    findings = _findings()
    missing = [item for item in findings if item.level == "missing"]
    if as_json:
        sys.stdout.write(json.dumps([asdict(item) for item in findings], indent=1) + "\n")
    else:
        for item in missing if quiet else findings:
            remedy = f"\n{'':10}fix: {item.fix}" if item.fix else ""
            sys.stdout.write(f"{item.level:<9} {item.subject}: {item.message}{remedy}\n")
    return MissingSystemPartError.exit_code if missing else 0


def _bring_libraries() -> None:
    """Bring the system libraries that are absent, where this process can."""
    packages = list(_absent_libraries().values())
    if packages and system_libraries.may_install():
        system_libraries.install(packages)
    elif packages and system_libraries.may_unpack():
        system_libraries.unpack(packages)


def _absent_libraries() -> dict[str, str]:
    """Library -> package; Linux only: elsewhere they are part of gmsh."""
    return system_libraries.absent_libraries() if platform.system() == "Linux" else {}


def _findings() -> list[Finding]:
    checks: tuple[Callable[[], Finding], ...] = (
        check_python,
        check_packages,
        check_system_libraries,
        check_gmsh,
        check_linear_solver,
        check_memory,
        check_disk,
    )
    return [check() for check in checks]


def check_python() -> Finding:
    """Which Python this is, and for which machine; not all packages come for all of them."""
    machine = platform.machine()
    message = f"{platform.python_version()} on {machine}"
    if platform.system() == "Linux" and machine not in ("x86_64", "AMD64"):
        message += ", but for Linux the packages gmsh and ipctk come for x86_64 only"
        return Finding("missing", "Python", message)
    return Finding("ok", "Python", message)


def check_packages() -> Finding:
    """Every required package is installed."""
    try:
        listed = importlib.metadata.requires("flexscale") or []
    except importlib.metadata.PackageNotFoundError:
        return Finding("missing", "packages", "flexscale itself is not installed", "make setup")
    required = [Requirement(text) for text in listed]
    needed = [item for item in required if not item.marker or item.marker.evaluate({"extra": ""})]
    absent = [str(item) for item in needed if not _fulfilled(item)]
    if absent:
        return Finding("missing", "packages", ", ".join(absent), "make setup")
    return Finding("ok", "packages", f"{len(needed)} required packages are installed")


def check_system_libraries() -> Finding:
    """Shared libraries that gmsh needs from the system."""
    absent = _absent_libraries()
    if not absent:
        return Finding("ok", "system libraries", "all that gmsh needs are there")
    message = ", ".join(absent)
    if system_libraries.may_unpack() and not system_libraries.may_install():
        message += "; without root, `flexscale doctor --fix` unpacks them beside the environment"
    remedy = system_libraries.install_command(absent.values())
    return Finding("missing", "system libraries", message, remedy)


def check_gmsh() -> Finding:
    """The mesh generator starts; tried in another process, since loading it is slow."""
    done = subprocess.run(
        [sys.executable, "-c", _START_GMSH],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode == 0:
        return Finding("ok", "gmsh", done.stdout.strip())
    reason = (done.stderr.strip().splitlines() or ["no message"])[-1]
    return Finding("missing", "gmsh", f"cannot be loaded ({reason}); see the system libraries")


def check_linear_solver() -> Finding:
    """PARDISO is fastest; without it the fallback gives the same numbers more slowly."""
    if _installed("pypardiso"):
        return Finding("ok", "linear solver", "PARDISO")
    return Finding("note", "linear solver", "no PARDISO here; the slower fallback is used")


def check_memory() -> Finding:
    """Enough main memory."""
    available = psutil.virtual_memory().available / _GIB
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    message = f"{available:.1f} GiB memory free, {cores} cores"
    if available < _MIN_MEMORY:
        return Finding("note", "machine", f"{message}; {_MIN_MEMORY:g} GiB are advisable")
    return Finding("ok", "machine", message)


def check_disk() -> Finding:
    """Room for results in the current folder."""
    free = shutil.disk_usage(".").free / _GIB
    writable = os.access(".", os.W_OK)
    if not writable or free < _MIN_DISK:
        reason = f"{free:.1f} GiB free" if writable else "the current folder cannot be written"
        return Finding("note", "disk", f"{reason}; choose a place with --results DIR")
    return Finding("ok", "disk", f"{free:.0f} GiB free here")


def _fulfilled(requirement: Requirement) -> bool:
    return _installed(requirement.name) and requirement.specifier.contains(
        importlib.metadata.version(requirement.name), prereleases=True
    )


def _installed(name: str) -> bool:
    try:
        importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return False
    return True
