"""Which datasets are the paper's: those that are shipped, or come of its experiment files."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from flexscale.datasets.entry import REFERENCE

if TYPE_CHECKING:
    from flexscale.datasets.registry import Registry

#: Experiment files of a checkout whose datasets the paper's figures and findings show.
EXPERIMENTS = (
    *("named_patterns", "paper", "paper_shapes", "rigs", "turned_sheets"),
    *("native_sheets", "native_rigs"),
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
        made = set(_made_by_experiments(registry.root))
        chosen += [entry for entry in others if entry.id in made]
    return registry.only(chosen)


def _made_by_experiments(root: Path) -> Iterator[str]:
    """Ids of the datasets of EXPERIMENTS that are stored below `root`."""
    # Patterns are built for it, which takes seconds; with everything shipped none is needed.
    from flexscale.datasets.store import Store
    from flexscale.steps.experiment import load_experiment
    from flexscale.steps.plan import build_plan

    for name in EXPERIMENTS:
        file = _WORKFLOWS / f"{name}.yaml"
        if file.is_file():
            plan = build_plan(load_experiment(file))
            yield from (entry.id for entry in plan.stored(Store(root)).values())
