"""Results folders with the datasets that come with the code, alone or among a user's own.

Tests take their datasets from here, never from the checkout's results folder: what somebody has
computed there is nothing they may depend on.
"""

from __future__ import annotations

from pathlib import Path

from flexscale.datasets.identity import Recipe
from flexscale.datasets.registry import open_registry
from flexscale.datasets.store import Store

ROOT = Path(__file__).parents[1]
#: What a user has as well: the kinds the quickstart makes, of the patterns README asks for.
TWINS = tuple(
    (kind, pattern)
    for pattern in ("hexagon", "brick")
    for kind in ("cell", "tangent", "sweep", "fit")
)


def link_shipped(results: Path) -> Path:
    """Make `results` a results folder with the shipped datasets alone."""
    results.mkdir(parents=True, exist_ok=True)
    (results / "reference").symlink_to(ROOT / "results" / "reference", target_is_directory=True)
    return results


def add_twins(results: Path) -> None:
    """Give `results` datasets of its own, each like a shipped one but of another recipe."""
    registry, store = open_registry(results), Store(results)
    for kind, pattern in TWINS:
        entry = registry.find(kind=kind, pattern=pattern, source="reference").one()
        record = registry.record(entry)
        recipe = Recipe.from_dict(record["recipe"])
        mine = Recipe(recipe.step, recipe.version, {**recipe.parameters, "mine": True})
        inputs = [registry.get(item["id"]) for item in record["inputs"]]
        store.publish(registry.load(entry), kind, mine, inputs)
