"""Locks on disks with and without `flock`: one holder at a time, and no claim lost."""

from __future__ import annotations

import errno
import fcntl
import os
import subprocess
import sys
import threading
from dataclasses import replace
from pathlib import Path

import pytest

from flexscale.datasets import locks
from flexscale.datasets.locks import LockedError, file_lock, layer_lock, working_folder
from flexscale.datasets.owner import Owner
from flexscale.datasets.registry import open_registry
from flexscale.datasets.store import Store
from tests.datasets.dataset_samples import recipe, sweep

NO_FLOCK = [errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP]


def tell(path: Path, owner: str) -> str:
    return f"{path} is held by {owner}"


@pytest.fixture(params=[None, *NO_FLOCK], ids=lambda code: errno.errorcode.get(code, "flock"))
def disk(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> int | None:
    """A disk with `flock`, and disks without, as NFS and Lustre may be."""
    if request.param is not None:
        take_flock_away(monkeypatch, request.param)
    return request.param


def take_flock_away(monkeypatch: pytest.MonkeyPatch, code: int) -> None:
    def refuse(handle: int, operation: int) -> None:
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(fcntl, "flock", refuse)


@pytest.fixture
def dead() -> Owner:
    """A process of this machine that has ended."""
    child = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
    owner = replace(Owner.of_this_process(), pid=child.pid, started=1)
    child.communicate()
    return owner


@pytest.mark.usefixtures("disk")
def test_publishing_needs_no_flock(tmp_path: Path) -> None:
    entry = Store(tmp_path).publish(sweep(), "sweep", recipe())
    assert [item.id for item in open_registry(tmp_path)] == [entry.id]
    assert list((tmp_path / "local" / ".staging").iterdir()) == []
    assert not list((tmp_path / "local").glob(".lock.owner*"))


@pytest.mark.usefixtures("disk")
def test_one_holder_at_a_time(tmp_path: Path) -> None:
    inside, most = 0, 0

    def work() -> None:
        nonlocal inside, most
        for _ in range(20):
            with layer_lock(tmp_path):
                inside += 1
                most = max(most, inside)
                (tmp_path / "shared").write_text(str(inside))
                inside -= 1

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert most == 1


@pytest.mark.usefixtures("disk")
def test_a_held_lock_names_process_and_host(tmp_path: Path) -> None:
    me = f"process {os.getpid()} on {os.uname().nodename}"
    with (
        file_lock(tmp_path / "lock", 0.0, tell),
        pytest.raises(LockedError, match=me),
        file_lock(tmp_path / "lock", 0.0, tell),
    ):
        pass
    with file_lock(tmp_path / "lock", 0.0, tell):  # given back
        pass


def test_a_claim_goes_only_with_the_process_that_made_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, dead: Owner
) -> None:
    take_flock_away(monkeypatch, errno.ENOLCK)
    folder = tmp_path / "lock.owner"
    folder.mkdir()
    claim = folder / dead.token
    elsewhere = replace(dead, place="0" * 12, host="elsewhere")
    for owner, sentence in (
        (elsewhere, f"process {dead.pid} on elsewhere"),
        (replace(Owner.of_this_process()), f"process {os.getpid()}"),
    ):
        claim = folder / owner.token
        claim.touch()
        with (
            pytest.raises(LockedError, match=sentence),
            file_lock(tmp_path / "lock", 0.05, tell),
        ):
            pass
        assert claim.exists()
        claim.unlink()
    claim = folder / "written by something else"
    claim.touch()
    with pytest.raises(LockedError, match="unknown"), file_lock(tmp_path / "lock", 0.0, tell):
        pass
    claim.unlink()
    (folder / dead.token).touch()
    with file_lock(tmp_path / "lock", 0.05, tell):
        assert [item.name for item in folder.iterdir()] == [Owner.of_this_process().token]
    assert not folder.exists()


def test_flock_heeds_those_that_have_none(tmp_path: Path, dead: Owner) -> None:
    """Machines may mount one disk with and without."""
    folder = tmp_path / "lock.owner"
    folder.mkdir()
    (folder / replace(dead, place="0" * 12, host="elsewhere").token).touch()
    with (
        pytest.raises(LockedError, match="on elsewhere"),
        file_lock(tmp_path / "lock", 0.0, tell),
    ):
        pass


def test_a_number_used_again_is_another_process() -> None:
    me = Owner.of_this_process()
    assert Owner.parse(me.token) == me
    assert not me.is_gone
    assert replace(me, started=me.started - 1).is_gone
    assert not replace(me, started=me.started - 1, place="0" * 12).is_gone


def test_processes_whose_start_is_hidden_are_not_gone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Clusters hide the processes of other accounts (hidepid)."""
    me = Owner.of_this_process()
    monkeypatch.setattr("flexscale.datasets.owner._start_time", lambda _: None)
    assert not me.is_gone
    assert not replace(me, started=0).is_gone


def test_what_a_killed_process_left_is_taken_over_at_once(
    tmp_path: Path, dead: Owner, monkeypatch: pytest.MonkeyPatch
) -> None:
    take_flock_away(monkeypatch, errno.ENOLCK)
    (tmp_path / "lock.owner").mkdir()
    (tmp_path / "lock.owner" / dead.token).touch()
    with file_lock(tmp_path / "lock", 0.0, tell):
        pass


@pytest.mark.usefixtures("disk")
def test_working_folders_of_others_stay(tmp_path: Path, dead: Owner) -> None:
    staging = tmp_path / ".staging"
    names = {
        "gone": f"write-{dead.token}~1",
        "elsewhere": f"write-{replace(dead, place='0' * 12, host='elsewhere').token}~1",
        "foreign": "write-something",
    }
    for name in names.values():
        (staging / name).mkdir(parents=True)
    with working_folder(tmp_path) as first, working_folder(tmp_path) as second:
        there = {path.name for path in staging.iterdir()}
        assert there == {first.name, second.name, names["elsewhere"], names["foreign"]}


def test_a_lock_left_by_a_stopped_process_is_told_in_the_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(locks, "_WAIT_SECONDS", 0.0)
    with (
        layer_lock(tmp_path),
        pytest.raises(LockedError, match=f"locked by process {os.getpid()} on .* end that process"),
        layer_lock(tmp_path),
    ):
        pass
