"""How one equilibrium solve ended: the status stored with every sample of a sweep."""

from __future__ import annotations

from enum import IntEnum


class SolveStatus(IntEnum):
    """End of a solve. Values are numbers in datasets; only `converged` samples carry numbers."""

    converged = 0
    stalled = 1
    max_iterations = 2
    line_search_failed = 3
    infeasible_start = 4
    not_run = 5
    time_limit = 6

    @property
    def sentence(self) -> str:
        """What happened, as one sentence for people."""
        return _SENTENCES[self]


_SENTENCES: dict[SolveStatus, str] = {
    SolveStatus.converged: "The equilibrium was found to the requested accuracy.",
    SolveStatus.stalled: "Newton stopped making progress before it reached the accuracy.",
    SolveStatus.max_iterations: "The number of Newton iterations ran out.",
    SolveStatus.line_search_failed: "No step along the Newton direction lowered the energy.",
    SolveStatus.infeasible_start: "The start was not admissible (inverted elements or overlap).",
    SolveStatus.not_run: "This sample was not computed.",
    SolveStatus.time_limit: "The processor time that a sample may take ran out.",
}

#: CF attribute `flag_meanings`: the names in the order of their values.
FLAG_MEANINGS: str = " ".join(status.name for status in SolveStatus)
