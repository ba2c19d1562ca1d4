"""Set-up by the Makefile, on machines that lack something, and after it was interrupted."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from flexscale.cli import doctor
from tests.shipped import ROOT

#: A Python that makes environments of stubs, and tells the Makefile what it asks about itself.
PYTHON = r"""#!/bin/sh
case "$*" in
*"< (3, 11)"*) exit ${TOO_OLD:-0} ;;
*">= (3, 14)"*) exit ${TOO_NEW:-0} ;;
*"-m venv"*)
  echo "venv" >> log; rm -rf .venv; mkdir -p .venv/bin
  for name in python uv flexscale; do
    printf '#!/bin/sh\necho "%s $*" >> log\ntest ! -e broken\n' $name > .venv/bin/$name
    chmod +x .venv/bin/$name
  done
  sed -i 's/test ! -e broken/true/' .venv/bin/python ;;
esac
"""


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """The files that set-up reads, and a Python."""
    for name in ("Makefile", "requirements.lock", "pyproject.toml"):
        shutil.copy(ROOT / name, tmp_path)
    (tmp_path / "bin").mkdir()
    program(tmp_path / "bin" / "fake-python", PYTHON)
    return tmp_path


def program(path: Path, text: str) -> None:
    path.write_text(text)
    path.chmod(0o755)


def set_up(checkout: Path, **environment: str) -> tuple[int, str]:
    """Exit code and what was said."""
    done = subprocess.run(
        ["make", "setup", f"PYTHON={checkout / 'bin' / 'fake-python'}"],
        cwd=checkout,
        env=os.environ | {"PATH": f"{checkout / 'bin'}:{os.environ['PATH']}"} | environment,
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, done.stderr


def log(checkout: Path) -> list[str]:
    return (checkout / "log").read_text().splitlines()


def test_set_up_is_done_once_and_says_how_large_it_is(checkout: Path) -> None:
    code, said = set_up(checkout)
    assert code == 0, said
    lines = (ROOT / "requirements.lock").read_text().splitlines()
    n_packages = sum(line[:1].islower() for line in lines)
    assert "2 GB" in said
    assert "0.6 GB to download" in said
    assert f"installing {n_packages} locked packages" in said
    before = log(checkout)
    assert set_up(checkout) == (0, "")
    assert log(checkout) == before


def test_an_interrupted_set_up_begins_anew(checkout: Path) -> None:
    """What was partly installed then, no package manager can tell from what is whole."""
    (checkout / "broken").touch()
    assert set_up(checkout)[0] != 0
    (checkout / ".venv" / "left-behind").touch()
    (checkout / "broken").unlink()
    code, said = set_up(checkout)
    assert code == 0, said
    assert "the last one was interrupted" in said
    assert log(checkout).count("venv") == 2
    assert not (checkout / ".venv" / "left-behind").exists()
    assert set_up(checkout) == (0, "")


@pytest.mark.parametrize(
    ("lacking", "environment", "said"),
    [
        ("", {"TOO_OLD": "1"}, "needs Python 3.11 or newer"),
        ("#!/bin/sh\ntest $1 = -s && echo Linux || echo aarch64\n", {}, "this machine is aarch64"),
    ],
)
def test_what_cannot_work_is_refused_before_anything_is_made(
    checkout: Path, lacking: str, environment: dict[str, str], said: str
) -> None:
    if lacking:
        program(checkout / "bin" / "uname", lacking)
    code, message = set_up(checkout, **environment)
    assert code != 0
    assert said in message
    assert not (checkout / ".venv").exists()


def test_a_new_python_needs_a_compiler(checkout: Path) -> None:
    """With one it goes on; without one, as here on a path with few programs, it says so."""
    few = checkout / "few"
    few.mkdir()
    for name in ("sh", "make", "uname", "awk", "df", "test", "grep", "sed"):
        place = shutil.which(name)
        if place is not None:
            (few / name).symlink_to(place)
    code, said = set_up(checkout, PATH=f"{checkout / 'bin'}:{few}", TOO_NEW="1")
    assert code != 0
    assert "no C compiler" in said
    assert "PYTHON=/path/to/python3.13" in said


def test_doctor_names_packages_that_do_not_come_for_a_machine(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(doctor.platform, "system", lambda: "Linux")
    monkeypatch.setattr(doctor.platform, "machine", lambda: "aarch64")
    found = doctor.check_python()
    assert found.level == "missing"
    assert "gmsh and ipctk" in found.message
