"""The command line: exit codes, what goes to stdout and stderr, and a quick start."""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from flexscale.cli import doctor, main, system_libraries
from flexscale.cli.progress import Progress
from flexscale.datasets.identity import Recipe
from flexscale.datasets.store import Store
from flexscale.steps.events import EventReader, EventWriter
from flexscale.steps.experiment import parse_experiment
from flexscale.steps.plan import build_plan
from tests.datasets.dataset_samples import cell, sweep

ROOT = Path(__file__).parents[2]


def call(monkeypatch: pytest.MonkeyPatch, *arguments: object) -> int:
    """Exit code of a command run in this process."""
    monkeypatch.setattr(sys, "argv", ["flexscale", *map(str, arguments)])
    with pytest.raises(SystemExit) as caught:
        main.main()
    return int(caught.value.code or 0)


def test_help_is_instant() -> None:
    """Processor time: what else the machine does is no matter."""
    command = [sys.executable, "-m", "flexscale.cli", "--help"]
    times = []
    for _ in range(3):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        times.append(after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime)
    assert "Exit codes" in done.stdout
    # 0.3 s is the promise on a quiet machine; a busy one is up to twice as slow.
    assert min(times) < 0.6


def test_unknown_command_is_bad_input(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "rum") == 2
    assert capsys.readouterr().out == ""


def test_bad_experiment_leaves_nothing_behind(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    file = tmp_path / "bad.yaml"
    file.write_text("patterns: {a: {family: IH76, gpa: 0.4}}")
    results = tmp_path / "results"
    assert call(monkeypatch, "run", file, "--results", results) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert "Did you mean 'gap'" in said.err
    assert not results.exists()


def test_dry_run_says_what_there_is_to_do_and_does_nothing(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    results = tmp_path / "results"
    file = ROOT / "workflows" / "quickstart.yaml"
    assert call(monkeypatch, "run", file, "--dry-run", "--results", results) == 0
    said = capsys.readouterr()
    assert said.out.count("to do") == 24
    assert "24 of 24 jobs to do, with 310 samples; there is no earlier record of fit," in said.err
    assert not results.exists()


def test_run_without_a_file(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "run") == 2
    assert "workflows/quickstart.yaml" in capsys.readouterr().err


def test_fields_are_data(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "run", "--fields") == 0
    assert "patterns.NAME.gap" in capsys.readouterr().out


def test_version_is_that_of_the_package(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "--version") == 0
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert capsys.readouterr().out == f"flexscale {project['version']}\n"


def test_progress_never_counts_more_samples_than_there_are(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A sweep solves one more than its own, as a check of the pattern's symmetry."""
    content = {
        "patterns": {"square": {"family": "IH76"}},
        "sweep": {"directions": [0, 90], "curvatures": [0, 0.001]},
    }
    plan = build_plan(parse_experiment(content, "file.yaml"))
    job = next(job for job in plan if job.step == "sweep")
    progress = Progress(plan, {})
    monkeypatch.setattr("flexscale.cli.progress._INTERVAL", -1.0)
    sample = {"event": "sample", "job": job.id, "n_failed": 0, "side": "closing", "direction": 0.0}
    progress.show({**sample, "done": job.n_samples + 1, "curvature": 0.001})
    assert f"; {job.n_samples}/{job.n_samples} samples" in capsys.readouterr().err


def test_data_commands_on_an_empty_folder(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert call(monkeypatch, "data", "list", "--json", "--results", tmp_path) == 0
    assert json.loads(capsys.readouterr().out) == []
    assert call(monkeypatch, "data", "check", "--results", tmp_path) == 0
    assert call(monkeypatch, "data", "show", "sweep:123", "--results", tmp_path) == 4
    assert "no dataset 'sweep:123'" in capsys.readouterr().err
    assert call(monkeypatch, "data", "list", "gap", "--results", tmp_path) == 2
    assert call(monkeypatch, "figures", "--results", tmp_path) == 4
    assert "flexscale run workflows/named_patterns.yaml" in capsys.readouterr().err


def test_bug_is_reported_as_one(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def broken() -> list[object]:
        raise ZeroDivisionError("inside")

    monkeypatch.setattr(doctor, "_findings", broken)
    assert call(monkeypatch, "doctor") == 1
    said = capsys.readouterr().err
    assert "ZeroDivisionError: inside" in said
    assert "this is a bug" in said


def test_doctor_names_the_package_of_a_missing_library(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(system_libraries, "has_library", lambda name: name != "libGLU.so.1")
    monkeypatch.setattr(doctor.platform, "system", lambda: "Linux")
    assert call(monkeypatch, "doctor", "--json") == 4
    findings = {item["subject"]: item for item in json.loads(capsys.readouterr().out)}
    assert findings["system libraries"]["level"] == "missing"
    assert findings["system libraries"]["fix"].endswith("--no-install-recommends libglu1-mesa")


def test_doctor_fix_where_nothing_can_be_brought_prints_the_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(system_libraries, "has_library", lambda name: name != "libGL.so.1")
    monkeypatch.setattr(system_libraries, "may_install", lambda: False)
    monkeypatch.setattr(system_libraries, "may_unpack", lambda: False)
    monkeypatch.setattr(doctor.platform, "system", lambda: "Linux")
    assert call(monkeypatch, "doctor", "--fix", "--quiet") == 4
    assert "apt-get install -y --no-install-recommends libgl1" in capsys.readouterr().out


@pytest.mark.parametrize("way", ["install", "unpack"])
def test_doctor_fix_brings_what_is_absent_and_looks_again(
    way: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Root installs; others unpack."""
    absent = {"libXft.so.2"}
    brought = []

    def bring(packages: list[str]) -> None:
        brought.extend(packages)
        absent.clear()

    monkeypatch.setattr(system_libraries, "has_library", lambda name: name not in absent)
    monkeypatch.setattr(system_libraries, "may_install", lambda: way == "install")
    monkeypatch.setattr(system_libraries, "may_unpack", lambda: True)
    monkeypatch.setattr(system_libraries, way, bring)
    monkeypatch.setattr(doctor.platform, "system", lambda: "Linux")
    assert call(monkeypatch, "doctor", "--fix", "--json") in (0, 4)
    findings = {item["subject"]: item for item in json.loads(capsys.readouterr().out)}
    assert findings["system libraries"]["level"] == "ok"
    assert brought == ["libxft2"]


def test_events_come_whole_and_once(tmp_path: Path) -> None:
    path = tmp_path / "events.jsonl"
    reader, writer = EventReader(path), EventWriter(path)
    assert list(reader.read()) == []
    writer.write("start", "cell-1")
    writer.write("end", "cell-1", seconds=1.5)
    with path.open("a") as file:
        file.write('{"event": "sta')
    assert [event["event"] for event in reader.read()] == ["start", "end"]
    assert list(reader.read()) == []
    with path.open("a") as file:
        file.write('rt", "job": "x"}\n')
    assert list(reader.read()) == [{"event": "start", "job": "x"}]


def test_figures_use_refuses_what_has_no_effect(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """An input no figure has, a dataset of another kind or that is not there, an input twice."""
    store = Store(tmp_path)
    sweeps = [
        store.publish(sweep(factor=factor), "sweep", Recipe("sweep", 1, {"factor": factor}))
        for factor in (1.0, 2.0)
    ]
    flat = store.publish(cell(), "cell", Recipe("cell", 1, {}))
    refused = {
        "chevron_swep=x": (2, "no input 'chevron_swep' of fig08_moment_polar. Did you mean"),
        "chevron_sweep": (2, "write INPUT=ID"),
        f"chevron_sweep={flat.id}": (2, f"is a sweep, and {flat.id} is a cell"),
        "chevron_sweep=sweep:123456": (4, "no dataset 'sweep:123456'"),
    }
    for text, (code, said) in refused.items():
        assert call(monkeypatch, "figures", "fig08", "--use", text, "--results", tmp_path) == code
        assert said in capsys.readouterr().err
    twice = [word for entry in sweeps for word in ("--use", f"chevron_sweep={entry.id}")]
    assert call(monkeypatch, "figures", "fig08", *twice, "--results", tmp_path) == 2
    assert "chooses chevron_sweep twice" in capsys.readouterr().err
    assert not (tmp_path / "local" / "figures").exists()
