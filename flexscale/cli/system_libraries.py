"""System libraries of the mesh generator: which are absent, and where they come from.

Root installs the packages of Debian or Ubuntu that hold them. Everybody else may download the same
packages, with lists of their own, and unpack them beside the environment.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path

from flexscale.errors import MissingSystemPartError
from flexscale.gmsh_library import UNPACKED, has_library

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
_PLANNED = re.compile(r"^'\S+' ([^_\s]+)_\S+\.deb (\d+)", re.MULTILINE)
#: Drivers of screens and what they need: nine tenths of the room, and nothing is shown on any.
_SCREEN = re.compile(r"libgl1-mesa-dri|libglx-mesa|libllvm|libz3|libicu|libxml2")
_INSTALLED = "/var/lib/dpkg/status"
_LINES_KEPT = 5  # of what a program said that failed


def absent_libraries() -> dict[str, str]:
    """Library -> package, for those that are neither in the system nor unpacked."""
    return {name: package for name, package in GMSH_LIBRARIES.items() if not has_library(name)}


def install_command(packages: Iterable[str]) -> str:
    """The exact line that installs packages on Debian or Ubuntu."""
    names = " ".join(packages)
    return f"apt-get update && apt-get install -y --no-install-recommends {names}"


def may_install() -> bool:
    """Whether this process may install packages: root, on Debian or Ubuntu."""
    return os.geteuid() == 0 and shutil.which("apt-get") is not None


def may_unpack() -> bool:
    """Whether packages can be downloaded and unpacked here."""
    return shutil.which("apt-get") is not None and shutil.which("dpkg-deb") is not None


def install(packages: Iterable[str]) -> None:
    """Install packages into the system.

    Raises
    ------
    MissingSystemPartError : the installation failed; with the end of what it said.
    """
    command = install_command(packages)
    _tell(command)
    _run(["sh", "-c", command], os.environ | {"DEBIAN_FRONTEND": "noninteractive"})


def unpack(packages: Sequence[str]) -> None:
    """Download packages and what they need, and unpack them into `UNPACKED`, whole or not at all.

    Raises
    ------
    MissingSystemPartError : a download failed; the message has the line for root.
    """
    with tempfile.TemporaryDirectory(prefix="flexscale-") as folder:
        work = Path(folder)
        for name in ("lists/lists/partial", "cache/archives/partial", "debs", "tree"):
            (work / name).mkdir(parents=True)
        settings = {
            "Dir::State": work / "lists",
            "Dir::Cache": work / "cache",
            "Debug::NoLocking": "1",
            "APT::Sandbox::User": "",
        }
        apt = ["apt-get", "-qq", *(w for k, v in settings.items() for w in ("-o", f"{k}={v}"))]
        _tell(f"without root: asking for {', '.join(packages)} and what they need")
        try:
            _run([*apt, "update"])
            planned = _plan(apt, packages, work / "nothing-installed")
            wanted = sorted({*planned, *packages})
            size = sum(planned.values()) / 1e6
            _tell(f"downloading {len(wanted)} packages, {size:.0f} MB, to unpack in {UNPACKED}")
            _run([*apt, "download", *wanted], folder=work / "debs")
            for file in sorted((work / "debs").glob("*.deb")):
                _run(["dpkg-deb", "-x", str(file), str(work / "tree")])
        except MissingSystemPartError as error:
            line = install_command(packages)
            raise MissingSystemPartError(f"{error}\nAs root, this installs them: {line}") from error
        shutil.copytree(work / "tree", UNPACKED, symlinks=True, dirs_exist_ok=True)


def _plan(apt: list[str], packages: Sequence[str], nothing: Path) -> dict[str, int]:
    """Packages and what they need that is not installed -> bytes to download.

    Where what is installed does not fit together, as if nothing were; `nothing` is made for it.
    """
    nothing.touch()
    install = ["--print-uris", "--no-install-recommends", "install", *packages]
    try:
        wished = _run([*apt, "-o", f"Dir::State::status={_INSTALLED}", *install])
    except MissingSystemPartError:
        wished = _run([*apt, "-o", f"Dir::State::status={nothing}", *install])
    planned = {name: int(size) for name, size in _PLANNED.findall(wished)}
    return {name: size for name, size in planned.items() if not _SCREEN.match(name)}


def _tell(text: str) -> None:
    print(f"doctor: {text}", file=sys.stderr, flush=True)


def _run(
    command: list[str], environment: dict[str, str] | None = None, folder: Path | None = None
) -> str:
    done = subprocess.run(
        command, env=environment, cwd=folder, capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        tail = "\n".join((done.stdout + done.stderr).strip().splitlines()[-_LINES_KEPT:])
        shown = " ".join(word for word in command if word != "-o" and "=" not in word)
        raise MissingSystemPartError(f"System libraries could not be had: {shown}\n{tail}")
    return done.stdout
