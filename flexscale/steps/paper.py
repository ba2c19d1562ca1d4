"""Which datasets are the paper's: those that are shipped, or come of its experiment files."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from flexscale.datasets.entry import REFERENCE

if TYPE_CHECKING:
    from flexscale.datasets.registry import Registry

#: Experiment files of a checkout whose datasets the paper's figures and findings show.
EXPERIMENTS = (
    "paper",
    "paper_shapes",
    "turned_sheets",
    "printed",
    "printed_rigs",
    "printed_turned_sheets",
)
_WORKFLOWS = Path(__file__).resolve().parents[2] / "workflows"


def paper_datasets(registry: Registry) -> Registry:
    """The registry without all that is not the paper's.

    These are the shipped datasets. Of kinds and patterns of which none is shipped, those count
    whose recipe is one of the paper's experiment files: what else a user has run is not meant.
    """
    chosen = list(registry.find(source=REFERENCE))
    have = {(entry.kind, entry.row["pattern"]) for entry in chosen}
    known = {pattern for _, pattern in have}
    others = [
        entry
        for entry in registry
        if (entry.kind, entry.row["pattern"]) not in have
        and (not known or entry.row["pattern"] in known)
    ]
    if others:
        patterns = {entry.row["pattern"] for entry in others}
        made = set(_made_by_experiments(registry.root, patterns))
        chosen += [entry for entry in others if entry.id in made]
    return registry.only(chosen)


def _made_by_experiments(root: Path, patterns: Collection[str]) -> Iterator[str]:
    """Ids of the datasets of EXPERIMENTS that are stored below `root`, of these patterns."""
    # Patterns are built for it, which takes seconds; with everything shipped none is needed.
    from flexscale.datasets.store import Store
    from flexscale.steps.experiment import load_experiment
    from flexscale.steps.plan import build_plan

    for name in EXPERIMENTS:
        file = _WORKFLOWS / f"{name}.yaml"
        experiment = load_experiment(file) if file.is_file() else None
        asked = {} if experiment is None else dict(experiment.patterns)
        asked = {pattern: block for pattern, block in asked.items() if pattern in patterns}
        if experiment is not None and asked:
            plan = build_plan(experiment.model_copy(update={"patterns": asked}))
            yield from (entry.id for entry in plan.stored(Store(root)).values())
