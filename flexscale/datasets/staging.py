"""Unfinished work on disk: sample-by-sample checkpoints that survive a kill."""

from __future__ import annotations

from pathlib import Path
from typing import Any


class FileCheckpoint:
    """Finished samples of a sweep, one file each, below `folder/<line>/`.

    Picklable (holds only the folder). A line is one (side, direction); its samples are numbered
    in the order in which they were appended. Get one from `Store.checkpoint`.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = Path(folder)

    def load(self, line_key: str) -> list[dict[str, Any]]:
        """Samples of the line in their order, bit for bit as appended; [] when there are none.

        What a kill left half written, and all that follows it, is ignored.
        """
        raise NotImplementedError

    def append(self, line_key: str, sample: dict[str, Any]) -> None:
        """Store one more sample of the line, atomically.

        `sample` may hold numbers, text, bool, None, numpy arrays, and lists or dicts of them.
        """
        raise NotImplementedError

    def clear(self) -> None:
        """Forget every sample (called when the finished dataset is published)."""
        raise NotImplementedError
