"""Finished samples that are kept on the way, and whether those found there can be gone on from."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from flexscale.status import SolveStatus

#: Of a converged sample: what the next one starts from, and nobody else reads.
STATE = ("state", "rate", "second_rate")
_STATUSES = {int(status) for status in SolveStatus}


class Checkpoint(Protocol):
    """Keeps finished samples, so that a kill loses only those in work.

    Called in the process of the sweep, by one thread at a time.
    """

    def load(
        self, line_key: str, fits: Callable[[int, dict[str, Any]], bool]
    ) -> list[dict[str, Any]]:
        """Finished samples of a line, in order, up to the first that does not fit its number."""

    def append(self, line_key: str, sample: Mapping[str, Any]) -> None:
        """Keep one more sample of a line, after those that `load` gave."""


def load_finished(
    checkpoint: Checkpoint | None,
    line_key: str,
    axis: tuple[str, Sequence[float]],
    n_unknowns: int,
    needed: Collection[str],
) -> list[dict[str, Any]]:
    """Finished samples of a line that are what its computation can go on from.

    A file of somebody else may hold anything: samples of another line, states of another mesh.

    Parameters
    ----------
    axis : name and values of what samples are numbered by.
    n_unknowns : of a state.
    needed : names of numbers that every converged sample holds.
    """
    if checkpoint is None:
        return []
    name, values = axis

    def fits(index: int, sample: dict[str, Any]) -> bool:
        if index >= len(values):
            return True
        status = sample.get("status")
        if sample.get(name) != values[index] or type(status) is not int or status not in _STATUSES:
            return False
        if status != SolveStatus.converged:
            return all(_is_number(value) for value in sample.values())
        rest = {key: value for key, value in sample.items() if key not in STATE}
        return (
            all(_is_state(sample.get(key), n_unknowns) for key in STATE)
            and all(_is_number(value) for key, value in rest.items() if key != "stretch")
            and _is_state(rest.get("stretch", np.zeros(3)), 3)
            and set(needed) <= set(rest)
        )

    return checkpoint.load(line_key, fits)[: len(values)]


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_state(value: Any, size: int) -> bool:
    return (
        isinstance(value, np.ndarray)
        and value.dtype == np.float64
        and value.shape == (size,)
        and bool(np.isfinite(value).all())
    )
