"""What the workflow layer lends to a step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from flexscale.homogenize.checkpoint import Checkpoint


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
