"""A finding: what the paper says, what each pattern's data say, and the verdict."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

AGREES, DISAGREES, NOT_SEEN, NO_DATA = "agrees", "disagrees", "not seen", "no data"


@dataclass(frozen=True)
class Evidence:
    """Whether one pattern shows it, and the numbers that say so."""

    pattern: str
    holds: bool
    numbers: str


@dataclass(frozen=True)
class Finding:
    """A statement of the paper held against datasets.

    key : short name; paper_says : the statement; criterion : what counts as showing it;
    evidence : by pattern; of_all : True when the paper says it of every pattern of its kind,
    False when it says that there is one; why : how patterns can fall short of it, for verdicts
    other than AGREES.
    """

    key: str
    paper_says: str
    criterion: str
    evidence: tuple[Evidence, ...]
    of_all: bool = True
    why: str = ""

    @property
    def verdict(self) -> str:
        """AGREES; DISAGREES, one exception is enough; NOT_SEEN, no pattern is what the paper
        says that there is; NO_DATA.
        """
        if not self.evidence:
            return NO_DATA
        shown = [item.holds for item in self.evidence]
        if self.of_all:
            return AGREES if all(shown) else DISAGREES
        return AGREES if any(shown) else NOT_SEEN

    @property
    def count(self) -> str:
        """How many patterns show it, as in "3 of 4"."""
        return f"{sum(item.holds for item in self.evidence)} of {len(self.evidence)}"

    def to_dict(self) -> dict[str, Any]:
        """Everything, JSON-able."""
        return {
            "key": self.key,
            "paper_says": self.paper_says,
            "criterion": self.criterion,
            "of_all": self.of_all,
            "verdict": self.verdict,
            "count": self.count,
            "why": self.why if self.verdict in (DISAGREES, NOT_SEEN) else "",
            "evidence": [dict(vars(item)) for item in self.evidence],
        }
