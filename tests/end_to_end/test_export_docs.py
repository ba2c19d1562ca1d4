"""Every command and code block of docs/export.md runs, one after the other."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from flexscale.cli import main
from flexscale.exchange.formats import FORMATS
from tests.shipped import ROOT

PAGE = (ROOT / "docs" / "export.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```(\w+)\n(.*?)```", PAGE, re.DOTALL)
COMMANDS = re.findall(r"^    \.venv/bin/flexscale (.*)$", PAGE, re.MULTILINE)


@pytest.fixture
def folder(tmp_path: Path, shipped_results: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "results").symlink_to(shipped_results, target_is_directory=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    return tmp_path


def test_the_page_has_all_formats() -> None:
    rows = [line.split("|")[1] for line in PAGE.splitlines() if line.startswith("| `")]
    assert set(re.findall(r"`([\w-]+)`", " ".join(rows))) == set(FORMATS)
    assert [language for language, _ in BLOCKS] == ["python", "python", "c", "python"]
    assert len(COMMANDS) == 3


def test_commands_and_code_run(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for command in COMMANDS:
        monkeypatch.setattr(sys, "argv", ["flexscale", *shlex.split(command)])
        with pytest.raises(SystemExit) as caught:
            main.main()
        assert not caught.value.code
    named = re.findall(r"`(fit_IH17_\S+)`", PAGE)
    assert [(folder / name).is_file() for name in named] == [True]
    names: dict[str, object] = {}
    for language, code in BLOCKS:
        if language == "python":
            exec(compile(code, "export.md", "exec"), names)
            continue
        if shutil.which("cc") is None:
            continue
        (folder / "main.c").write_text(code)
        subprocess.run(["cc", "-std=c99", "-Wall", "-Werror", "main.c", "-o", "main", "-lm"],
                       check=True)  # fmt: skip
        said = subprocess.run([folder / "main"], capture_output=True, text=True, check=True).stdout
        assert re.fullmatch(r"\S+ N/mm, \S+ N, data reach here: 1\n", said)
    names["table"].close()  # type: ignore[attr-defined]
    sys.modules.pop("brick_law", None)
    assert float(names["moment"]) > 0.0  # type: ignore[arg-type]
    assert names["hessian"].shape == (5, 3, 3)  # type: ignore[attr-defined]
    assert names["inside"].all()  # type: ignore[attr-defined]
