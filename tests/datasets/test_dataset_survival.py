"""Killed at any moment, raced by others: a dataset is there whole, or not at all."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from flexscale.datasets.audit import check_results
from flexscale.datasets.registry import open_registry
from flexscale.datasets.staging import FileCheckpoint
from flexscale.datasets.store import Store
from flexscale.errors import NonReproducibleError
from tests.datasets.dataset_samples import recipe, sweep

#: audit events that change, or open for changing, something on the disk
_EVENTS = ("open", "os.rename", "os.remove", "os.rmdir", "os.mkdir", "fcntl.flock", "shutil.rmtree")


# Python 3.12 warns of forking beside threads; the children use none of the libraries that have any.
pytestmark = pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")

#: forked children have the libraries loaded already: some hundred of them take seconds
processes = multiprocessing.get_context("fork")


@pytest.fixture
def folder() -> Iterator[Path]:
    """Scratch folder in memory where there is one: these tests sync to disk hundreds of times."""
    memory = Path("/dev/shm")
    with tempfile.TemporaryDirectory(dir=memory if memory.is_dir() else None) as name:
        yield Path(name)


def kill_at_event(number: int, root: str) -> None:
    """End this process by SIGKILL just before its `number`-th file operation below `root`."""
    seen = 0

    def hook(event: str, arguments: tuple[object, ...]) -> None:
        nonlocal seen
        if event not in _EVENTS:
            return
        if event != "fcntl.flock" and not str(arguments[0]).startswith(root):
            return
        seen += 1
        if seen == number:
            os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(hook)


def publish_until_killed(root: str, number: int) -> None:
    dataset = sweep()
    kill_at_event(number, root)
    Store(root).publish(dataset, "sweep", recipe())


@pytest.mark.parametrize(
    "step", [3, pytest.param(1, marks=pytest.mark.slow)], ids=["every third", "every"]
)
def test_killed_before_any_file_operation(folder: Path, step: int) -> None:
    """Kill at the 1st, 2nd, … operation until a run gets through; look at the results each time.

    Afterwards the same publication must succeed and leave no garbage.
    """
    outcomes = []
    for number in range(1, 200, step):
        root = folder / f"results{number}"
        child = processes.Process(target=publish_until_killed, args=(str(root), number))
        child.start()
        child.join()
        registry = open_registry(root)
        assert registry.damaged == ()
        assert [item for item in check_results(root) if item.level == "problem"] == []
        outcomes.append((child.exitcode, len(registry)))
        store = Store(root)
        entry = store.publish(sweep(), "sweep", recipe())
        assert [item.id for item in open_registry(root)] == [entry.id]
        assert list((store.local / ".staging").iterdir()) == []
        assert not list(store.local.rglob("*.part*"))
        if child.exitcode == 0:
            break
    assert outcomes[-1] == (0, 1)
    killed = outcomes[:-1]
    assert all(code == -signal.SIGKILL for code, _ in killed)
    assert len(killed) > 12 // step, "the hook must have seen the real operations"
    assert {count for _, count in killed} == {0, 1}, "kills before and after the rename"


def publish_when_all_are_ready(root: str, factor: float, barrier, results) -> None:
    dataset = sweep(factor=factor)
    barrier.wait()
    try:
        results.put(Store(root).publish(dataset, "sweep", recipe()).content_digest)
    except NonReproducibleError:
        results.put("refused")


@pytest.mark.parametrize("factors", [(1.0, 1.0, 1.0, 1.0), (1.0, 2.0, 1.0, 2.0)])
def test_racing_writers_publish_one_dataset(folder: Path, factors) -> None:
    barrier, results = processes.Barrier(len(factors)), processes.Queue()
    children = [
        processes.Process(
            target=publish_when_all_are_ready, args=(str(folder), factor, barrier, results)
        )
        for factor in factors
    ]
    for child in children:
        child.start()
    answers = [results.get(timeout=60) for _ in children]
    for child in children:
        child.join()
    registry = open_registry(folder)
    assert len(registry) == 1
    winner = next(iter(registry)).content_digest
    expected = factors.count(1.0) if len(set(factors)) == 1 else 2
    assert answers.count(winner) == expected
    assert answers.count("refused") == len(factors) - expected
    assert [item.level for item in check_results(folder) if item.level == "problem"] == []
    assert list((folder / "local" / ".staging").iterdir()) == []


def append_until_killed(folder: str, number: int) -> None:
    kill_at_event(number, folder)
    checkpoint = FileCheckpoint(folder)
    for index in range(3):
        checkpoint.append("closing 0", {"index": index})


def test_a_killed_checkpoint_resumes_where_it_was(folder: Path) -> None:
    lengths = []
    for number in range(1, 100):
        lines = folder / str(number) / "lines"
        child = processes.Process(target=append_until_killed, args=(str(lines), number))
        child.start()
        child.join()
        checkpoint = FileCheckpoint(lines)
        samples = checkpoint.load("closing 0")
        assert samples == [{"index": index} for index in range(len(samples))]
        lengths.append(len(samples))
        for index in range(len(samples), 3):
            checkpoint.append("closing 0", {"index": index})
        assert [item["index"] for item in FileCheckpoint(lines).load("closing 0")] == [0, 1, 2]
        if child.exitcode == 0:
            break
    assert lengths == sorted(lengths)
    assert set(lengths) == {0, 1, 2, 3}
