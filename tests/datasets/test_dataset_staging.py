"""Checkpoints: bit-exact, tolerant of damage, safe names."""

from __future__ import annotations

import os
import pickle
from pathlib import Path

import numpy as np
import pytest

from flexscale.datasets.staging import FileCheckpoint, write_atomically
from flexscale.errors import BadInputError


def samples(number: int) -> list[dict[str, object]]:
    rng = np.random.default_rng(3)
    return [
        {
            "curvature": 0.1 * index / 3.0,
            "status": index,
            "failed": None,
            "state": {"positions": rng.random((4, 3)), "tiny": np.array(5e-324)},
        }
        for index in range(number)
    ]


def test_samples_come_back_bit_for_bit(tmp_path: Path) -> None:
    written = samples(3)
    checkpoint = FileCheckpoint(tmp_path)
    for sample in written:
        checkpoint.append("closing 30.0", sample)
    for loaded, sample in zip(FileCheckpoint(tmp_path).load("closing 30.0"), written, strict=True):
        assert loaded.keys() == sample.keys()
        assert loaded["curvature"] == sample["curvature"]
        for name, array in sample["state"].items():  # type: ignore[attr-defined]
            assert loaded["state"][name].dtype == array.dtype
            assert loaded["state"][name].tobytes() == array.tobytes()


def test_lines_do_not_mix_and_no_key_leaves_the_folder(tmp_path: Path) -> None:
    folder = tmp_path / "inside"
    keys = ["closing 0", "opening 0", "../../escape", "..", "a/b", ""]
    checkpoint = FileCheckpoint(folder)
    for key in keys:
        checkpoint.append(key, {"key": key})
    for key in keys:
        assert FileCheckpoint(folder).load(key) == [{"key": key}]
    assert [path.name for path in tmp_path.iterdir()] == ["inside"]
    assert FileCheckpoint(folder).load("unknown") == []


@pytest.mark.parametrize("damaged", [0, 1, 2])
@pytest.mark.parametrize("cut", [0, 10, 200])
def test_damage_and_what_follows_is_ignored_and_overwritten(
    tmp_path: Path, damaged: int, cut: int
) -> None:
    checkpoint = FileCheckpoint(tmp_path)
    for index in range(3):
        checkpoint.append("line", {"index": index})
    path = sorted(tmp_path.rglob("*.npz"))[damaged]
    path.write_bytes(path.read_bytes()[:cut])
    fresh = FileCheckpoint(tmp_path)
    assert fresh.load("line") == [{"index": index} for index in range(damaged)]
    fresh.append("line", {"index": damaged, "again": True})
    # A kill here: what followed the damaged sample went on from it, and must not come back.
    assert len(FileCheckpoint(tmp_path).load("line")) == damaged + 1
    for index in range(damaged + 1, 3):
        fresh.append("line", {"index": index, "again": True})
    assert [item["index"] for item in FileCheckpoint(tmp_path).load("line")] == [0, 1, 2]


def test_a_flipped_bit_is_damage(tmp_path: Path) -> None:
    checkpoint = FileCheckpoint(tmp_path)
    checkpoint.append("line", {"state": np.arange(100.0)})
    path = next(tmp_path.rglob("*.npz"))
    data = bytearray(path.read_bytes())
    data[data.index(np.float64(50.0).tobytes())] ^= 1
    path.write_bytes(data)
    assert FileCheckpoint(tmp_path).load("line") == []


def test_any_flipped_bit_is_damage_or_changes_nothing(tmp_path: Path) -> None:
    """Zip files have flags (encrypted, compressed, a later version) that no checksum covers."""
    checkpoint = FileCheckpoint(tmp_path)
    sample = {"status": 0, "state": [1.0, 2.0]}
    checkpoint.append("line", sample)
    path = next(tmp_path.rglob("*.npz"))
    data = path.read_bytes()
    for place in range(len(data)):
        flipped = bytearray(data)
        flipped[place] ^= 1 << place % 8
        path.write_bytes(flipped)
        assert FileCheckpoint(tmp_path).load("line") in ([], [sample])


class Boom:
    """What unpickling would run."""

    def __reduce__(self) -> tuple[object, ...]:
        return (Path.touch, (Path("/tmp/flexscale-unpickled"),))


def pickled_array() -> dict[str, np.ndarray]:
    return {"structure": np.array([Boom()], dtype=object)}


def nothing() -> dict[str, np.ndarray]:
    return {"other": np.zeros(3)}


def deep() -> dict[str, np.ndarray]:
    return {"structure": np.frombuffer(b"[" * 100_000, np.uint8)}


def no_sample() -> dict[str, np.ndarray]:
    return {"structure": np.frombuffer(b"[1, 2]", np.uint8)}


def odd_structure() -> dict[str, np.ndarray]:
    return {"structure": np.frombuffer(b'{"dict": [[1, 2, 3]]}', np.uint8)}


def missing_array() -> dict[str, np.ndarray]:
    return {"structure": np.frombuffer(b'{"dict": [["a", {"array": "b"}]]}', np.uint8)}


@pytest.mark.parametrize(
    "content", [pickled_array, nothing, deep, no_sample, odd_structure, missing_array]
)
def test_an_archive_that_is_no_sample_is_named_and_ignored(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, content
) -> None:
    checkpoint = FileCheckpoint(tmp_path)
    checkpoint.append("line", {"index": 0})
    path = next(tmp_path.rglob("*.npz"))
    np.savez(path, **content())
    assert FileCheckpoint(tmp_path).load("line") == []
    assert f"{path} is damaged" in caplog.text
    assert "computed anew" in caplog.text
    assert not Path("/tmp/flexscale-unpickled").exists()


def test_archives_grow_no_larger_than_their_file_and_pipes_are_not_waited_for(
    tmp_path: Path,
) -> None:
    checkpoint = FileCheckpoint(tmp_path)
    checkpoint.append("line", {"index": 0})
    path = next(tmp_path.rglob("*.npz"))
    np.savez_compressed(path, structure=np.zeros(10**7, np.uint8))
    assert FileCheckpoint(tmp_path).load("line") == []
    assert not path.exists()
    os.mkfifo(path)
    assert FileCheckpoint(tmp_path).load("line") == []


def test_appending_without_loading_continues_the_line(tmp_path: Path) -> None:
    FileCheckpoint(tmp_path).append("line", {"index": 0})
    pickle.loads(pickle.dumps(FileCheckpoint(tmp_path))).append("line", {"index": 1})
    assert FileCheckpoint(tmp_path).load("line") == [{"index": 0}, {"index": 1}]


def test_clear_forgets_everything(tmp_path: Path) -> None:
    checkpoint = FileCheckpoint(tmp_path / "lines")
    checkpoint.append("line", {"index": 0})
    checkpoint.clear()
    assert checkpoint.load("line") == []
    checkpoint.append("line", {"index": 5})
    assert checkpoint.load("line") == [{"index": 5}]


def test_what_cannot_come_back_is_refused(tmp_path: Path) -> None:
    checkpoint = FileCheckpoint(tmp_path)
    for value in (object(), np.array([None]), {1, 2}):
        with pytest.raises(BadInputError, match="cannot hold"):
            checkpoint.append("line", {"value": value})
    assert not list(tmp_path.rglob("*.npz"))


def test_a_file_keeps_its_old_content_until_the_new_is_complete(tmp_path: Path) -> None:
    path = tmp_path / "catalog.csv"
    write_atomically(path, lambda file: file.write_text("old"))

    def fail_halfway(file: Path) -> None:
        file.write_text("ne")
        assert path.read_text() == "old"
        raise OSError("disk full")

    with pytest.raises(OSError, match="disk full"):
        write_atomically(path, fail_halfway)
    assert [item.name for item in tmp_path.iterdir()] == ["catalog.csv"]
    assert path.read_text() == "old"
