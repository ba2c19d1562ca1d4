"""Libraries that gmsh needs of the system: found where unpacked, and brought without root."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

import pytest

from flexscale import gmsh_library
from flexscale.cli import system_libraries
from flexscale.errors import MissingSystemPartError
from flexscale.gmsh_library import has_library, load_gmsh

#: Library -> those it needs; gmsh is no library here, but asks for some.
NEEDS = {
    "libGLU.so.1": ["libGL.so.1"],
    "libGL.so.1": ["libX11.so.6", "libGLX.so.0"],
    "libGLX.so.0": ["libX11.so.6"],
    "libX11.so.6": [],
    "libA.so.1": ["libB.so.1"],
    "libB.so.1": ["libA.so.1"],
}


@pytest.fixture
def loaded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Libraries that the loader has taken in; it finds those of NEEDS where they are unpacked."""
    folder = tmp_path / "usr" / "lib" / "machine"
    folder.mkdir(parents=True)
    for name in NEEDS:
        (folder / name).touch()
    taken: list[str] = []

    def load(path: str, mode: int = 0) -> Any:
        name = Path(path).name
        wanted = [name, *NEEDS.get(name, [])] if "/" not in path else NEEDS[name]
        for item in wanted:
            if item not in taken:
                raise OSError(f"{item}: cannot open shared object file: No such file or directory")
        taken.extend([name] * (name not in taken))

    monkeypatch.setattr(ctypes, "CDLL", load)
    monkeypatch.setattr(gmsh_library, "UNPACKED", tmp_path)
    return taken


def test_a_library_comes_with_all_that_it_needs(loaded: list[str]) -> None:
    assert has_library("libGLU.so.1")
    assert loaded == ["libX11.so.6", "libGLX.so.0", "libGL.so.1", "libGLU.so.1"]


def test_what_is_nowhere_is_told(loaded: list[str], tmp_path: Path) -> None:
    assert not has_library("libXft.so.2")
    assert not has_library("libA.so.1"), "two that need each other end in no endless loop"
    (tmp_path / "usr/lib/machine/libX11.so.6").unlink()
    assert not has_library("libGLU.so.1")
    assert loaded == []


def test_gmsh_is_asked_again_once_its_library_is_there(
    loaded: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def ask() -> Any:
        ctypes.CDLL("libGL.so.1")
        return "gmsh"

    monkeypatch.setattr(gmsh_library, "_import_gmsh", ask)
    assert load_gmsh() == "gmsh"
    monkeypatch.setattr(gmsh_library, "_import_gmsh", lambda: ctypes.CDLL("libXft.so.2"))
    with pytest.raises(MissingSystemPartError, match=r"libXft\.so\.2.*flexscale doctor --fix"):
        load_gmsh()


@pytest.fixture
def programs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """apt-get and dpkg-deb of a machine where libglu1-mesa needs one more package."""
    scripts = {
        "apt-get": """case "$*" in
*update*) test ! -e "$0.offline" || { echo "E: no network" >&2; exit 100; } ;;
*status=/var/lib/dpkg/status*) test ! -e "$0.unfit" || exit 100
    for name in libglu1-mesa libx11-6 libllvm15; do
    echo "'http://x/$name_1_all.deb' ${name}_1_all.deb 1500000 SHA256:0"; done ;;
*--print-uris*) for name in libglu1-mesa libx11-6 libllvm15; do
    echo "'http://x/$name_1_all.deb' ${name}_1_all.deb 1500000 SHA256:0"; done ;;
*download*) shift $(($# - 2)); for name in "$@"; do
    test $name = download || touch ${name}_1_all.deb; done ;;
esac""",
        "dpkg-deb": 'mkdir -p "$3/usr/lib"; touch "$3/usr/lib/$(basename "$2" .deb).so"',
    }
    for name, text in scripts.items():
        (tmp_path / name).write_text(f"#!/bin/sh\n{text}\n")
        (tmp_path / name).chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    monkeypatch.setattr(system_libraries, "UNPACKED", tmp_path / "unpacked")
    return tmp_path


@pytest.mark.parametrize("unfit", [False, True])
def test_packages_are_unpacked_with_all_that_they_need(
    unfit: bool, programs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Also where the packages that are installed do not fit together."""
    if unfit:
        (programs / "apt-get.unfit").touch()
    system_libraries.unpack(["libglu1-mesa"])
    found = sorted(path.name for path in (programs / "unpacked/usr/lib").iterdir())
    assert found == ["libglu1-mesa_1_all.so", "libx11-6_1_all.so"]
    assert "downloading 2 packages, 3 MB" in capsys.readouterr().err


def test_a_failed_download_leaves_nothing_and_names_the_line_for_root(programs: Path) -> None:
    (programs / "apt-get.offline").touch()
    with pytest.raises(MissingSystemPartError, match=r"(?s)no network.*apt-get install -y"):
        system_libraries.unpack(["libglu1-mesa"])
    assert not (programs / "unpacked").exists()
