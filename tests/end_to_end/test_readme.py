"""Every command and code block of README runs, among a user's own datasets.

How each is covered: the commands of `flexscale` run here, on the shipped datasets, with
`run FILE` as a dry run; `make quickstart` and `make test`, and with them `run FILE` for real, run
in .ci/run; the Python block runs here on a coarser mesh, and as it stands with `make test-slow`,
as do all figures; of what takes hours or the network, all that it needs is there.
"""

from __future__ import annotations

import inspect
import re
import shlex
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

import flexscale as fs
from flexscale.cli import main
from tests.shipped import ROOT

README = (ROOT / "README.md").read_text(encoding="utf-8")
INDENTED = re.findall(r"(?<=\n\n)(?:    \S.*\n)+", README)
FENCED = re.findall(r"```(\w*)\n(.*?)```", README, re.DOTALL)
INLINE = re.findall(r"`([^`\n]+)`", re.sub(r"```.*?```", "", README, flags=re.DOTALL))
#: What somebody would type: lines of indented blocks without what is said beside them, and inline.
COMMANDS = [
    re.split(r"\s{2,}", line.strip())[0]
    for block in INDENTED
    for line in block.splitlines()
] + [text for text in INLINE if re.match(r"(\.venv/bin/|make |flexscale )", text)]  # fmt: skip
FLEXSCALE = list(
    dict.fromkeys(
        text.removeprefix(".venv/bin/").removeprefix("flexscale ")
        for text in COMMANDS
        if re.match(r"(\.venv/bin/)?flexscale ", text)
    )
)
MAKE = [text.removeprefix("make ") for text in COMMANDS if text.startswith("make ")]
#: In place of what takes minutes; the rest runs as it stands.
QUICK = {
    "run workflows/quickstart.yaml": "run workflows/quickstart.yaml --dry-run",
    "run FILE --dry-run": "run workflows/paper.yaml --dry-run",
    "figures": "figures fig13",
}


@pytest.fixture
def folder(
    tmp_path: Path, crowded_results: Path, shipped_results: Path, monkeypatch: pytest.MonkeyPatch
) -> Path:
    """Like a checkout in which somebody has worked, and the present folder."""
    (tmp_path / "workflows").symlink_to(ROOT / "workflows", target_is_directory=True)
    (tmp_path / "results").symlink_to(crowded_results, target_is_directory=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def flexscale(monkeypatch: pytest.MonkeyPatch, command: str) -> int:
    """Exit code of a command, run in this process."""
    monkeypatch.setattr(sys, "argv", ["flexscale", *shlex.split(command)])
    with pytest.raises(SystemExit) as caught:
        main.main()
    return int(caught.value.code or 0)


def test_readme_is_read_as_people_read_it() -> None:
    """Or the tests below would find nothing to run, and pass."""
    assert [language for language, _ in FENCED] == ["python"]
    assert {"quickstart", "test", "test-slow", "validate"} <= set(MAKE)
    assert {"doctor", "figures", "data list", "run --fields", *QUICK} <= set(FLEXSCALE)
    others = [text for text in COMMANDS if not re.match(r"make |(\.venv/bin/)?flexscale ", text)]
    assert others == [".venv/bin/uvx jupytext --to notebook notebooks/*.py"]
    assert (Path(sys.prefix) / "bin" / "uvx").exists()
    assert (Path(sys.prefix) / "bin" / "flexscale").exists()


@pytest.mark.parametrize("command", FLEXSCALE)
def test_command_runs(
    command: str,
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    code = flexscale(monkeypatch, QUICK.get(command, command))
    said = capsys.readouterr()
    assert code == 0, said.err
    assert said.out.strip()
    for line in said.out.splitlines():  # pictures and solids that the command names are there
        if re.fullmatch(r"[\w./-]+\.(png|pdf|stl|3mf|html)", line):
            assert (folder / line).stat().st_size > 500


@pytest.mark.slow
def test_all_figures_are_drawn(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert flexscale(monkeypatch, "figures") == 0, capsys.readouterr().err
    assert len(list((folder / "results/local/figures").glob("fig*.pdf"))) == 12


@pytest.mark.parametrize("target", sorted(set(MAKE)))
def test_make_knows_the_target(target: str) -> None:
    done = subprocess.run(["make", "-n", target], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    for script in re.findall(r"\S+/python (\S+\.py)", done.stdout):
        assert (ROOT / script).is_file()


def test_ci_runs_what_is_too_long_for_a_test() -> None:
    """In the order in which a user types it; the last one must find nothing to do."""
    text = (ROOT / ".ci" / "run").read_text()
    assert re.findall(r"make ([a-z ]+)", text) == ["quickstart", "lint test", "quickstart"]


@pytest.mark.parametrize("mesh", ["coarse", pytest.param("default", marks=pytest.mark.slow)])
def test_python_block_runs(
    mesh: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    if mesh == "coarse":
        coarsen(monkeypatch)
    plt.switch_backend("agg")
    names: dict[str, object] = {}
    exec(compile(FENCED[0][1], "README.md", "exec"), names)
    plt.close("all")
    model = names["model"]
    assert isinstance(model, fs.MacroModel)
    assert model.n_parameters == int(re.findall(r"macro model: (\d+) numbers", README)[0])
    assert names["sheet"].status.name == "converged"  # type: ignore[attr-defined]
    assert "contact" in capsys.readouterr().out
    for name in ("hexagon.png", "hexagon.obj", "sheet.png"):
        assert (folder / name).stat().st_size > 3000


def coarsen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Coarser defaults for cells, sheets and devices: other numbers, by the same code."""
    changes = {
        fs.MeshOptions: {"scale_layers": 2, "scale_size": 6.0, "scale_strips": 1, "across": 2},
        fs.SheetOptions: {"size": 12.5},
        fs.RigOptions: {"size": 12.5},
    }
    for options, values in changes.items():
        make = inspect.unwrap(options.__init__)
        parameters = list(inspect.signature(make).parameters.values())[1:]
        defaults = tuple(values.get(item.name, item.default) for item in parameters)
        monkeypatch.setattr(make, "__defaults__", defaults)


def test_datasets_files_and_pages_that_readme_names_exist(shipped_results: Path) -> None:
    registry = fs.open_registry(shipped_results)
    for identifier in re.findall(r"\b[a-z_]+:[0-9a-f]{12}\b", README):
        assert registry.get(identifier).id == identifier
    pages = {path.name for path in (ROOT / "results/reference/benchmarks").iterdir()}
    links = re.findall(r"\]\(([^)]+)\)", README)
    for text in {*INLINE, *links}:
        if re.fullmatch(r"[\w-]+\.md", text):
            assert text in pages
        elif re.fullmatch(r"[\w./-]+/[\w./*-]*", text) and not text.startswith("results/local"):
            assert list(ROOT.glob(text)), f"README names {text}"
