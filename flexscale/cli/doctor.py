"""`flexscale doctor`: what is missing on this machine, and the command that fixes it."""

from __future__ import annotations

import ctypes
import importlib.metadata
import json
import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass

import psutil
from packaging.requirements import Requirement

from flexscale.errors import MissingSystemPartError

#: System libraries that gmsh's wheel loads but does not carry -> Debian package.
GMSH_LIBRARIES = {
    "libGLU.so.1": "libglu1-mesa",
    "libGL.so.1": "libgl1",
    "libXrender.so.1": "libxrender1",
    "libXcursor.so.1": "libxcursor1",
    "libXft.so.2": "libxft2",
    "libXinerama.so.1": "libxinerama1",
    "libgomp.so.1": "libgomp1",
}
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
    """Print what was found; install missing system libraries first when asked to.

    Parameters
    ----------
    as_json : print JSON.
    quiet : print only what is missing.
    fix : run the fix for missing system libraries if this process may (root, apt-get).

    Returns
    -------
    0, or 4 when something needed is missing.
    """
    findings = _findings()
    command = next((item.fix for item in findings if item.subject == "system libraries"), "")
    if fix and command and _may_install():
        print(f"doctor: {command}", file=sys.stderr)
        _install(command)
        findings = _findings()
    missing = [item for item in findings if item.level == "missing"]
    if as_json:
        sys.stdout.write(json.dumps([asdict(item) for item in findings], indent=1) + "\n")
    else:
        for item in missing if quiet else findings:
            remedy = f"\n{'':10}fix: {item.fix}" if item.fix else ""
            sys.stdout.write(f"{item.level:<9} {item.subject}: {item.message}{remedy}\n")
    return MissingSystemPartError.exit_code if missing else 0


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
    """Which Python this is; the package does not install on one that is too old."""
    return Finding("ok", "Python", platform.python_version())


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
    """Shared libraries that gmsh needs from the system (Linux only)."""
    if platform.system() != "Linux":
        return Finding("ok", "system libraries", "part of gmsh on this system")
    absent = {name: package for name, package in GMSH_LIBRARIES.items() if not _loads(name)}
    if not absent:
        return Finding("ok", "system libraries", "all that gmsh needs are there")
    return Finding(
        "missing", "system libraries", ", ".join(absent), install_command(absent.values())
    )


def check_gmsh() -> Finding:
    """The mesh generator starts; tried in another process, since loading it is slow."""
    done = subprocess.run(
        [sys.executable, "-c", "import gmsh; print(gmsh.__version__)"],
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


def install_command(packages: Iterable[str]) -> str:
    """The exact line that installs packages on Debian or Ubuntu."""
    names = " ".join(packages)
    return f"apt-get update && apt-get install -y --no-install-recommends {names}"


def _install(command: str) -> None:
    environment = dict(os.environ) | {"DEBIAN_FRONTEND": "noninteractive"}
    done = subprocess.run(
        ["sh", "-c", command], env=environment, capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        tail = "\n".join((done.stdout + done.stderr).strip().splitlines()[-5:])
        raise MissingSystemPartError(f"Installing system libraries failed: {command}\n{tail}")


def _may_install() -> bool:
    return os.geteuid() == 0 and shutil.which("apt-get") is not None


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


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
