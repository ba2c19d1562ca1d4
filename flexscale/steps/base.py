"""What the workflow layer lends to a step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol


class Checkpoint(Protocol):
    """Where a step keeps finished samples, so that a kill loses only the one in work."""

    def load(self, line_key: str) -> list[dict[str, Any]]:
        """Finished samples of a line, in order."""

    def append(self, line_key: str, sample: dict[str, Any]) -> None:
        """Keep one more sample of a line."""


@dataclass(frozen=True)
class Resources:
    """What the workflow layer lends to a step; none of it may change the result.

    Attributes
    ----------
    workers : number of processes the step may use.
    checkpoint : keeps finished samples; None where nothing is kept.
    on_sample : called with an event (done, total, n_failed, …) as samples finish.
    """

    workers: int = 1
    checkpoint: Checkpoint | None = None
    on_sample: Callable[[Any], None] | None = None
