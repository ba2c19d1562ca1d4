"""Figures of an experiment, each redrawn when one of its datasets or the code changes."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexscale.datasets.identity import SHORT_DIGEST, Recipe
from flexscale.errors import BadInputError
from flexscale.steps.catalog import FIGURES

if TYPE_CHECKING:
    from flexscale.datasets.registry import Registry
    from flexscale.datasets.store import Entry, Store

#: Name of the jobs that draw; they make pictures, no datasets.
FIGURE = "figure"


def draw_dataset(entry: Entry, registry: Registry) -> Any:
    """Matplotlib figure of a dataset: the first of its kind; what else it shows are its inputs.

    Raises
    ------
    BadInputError : there is no figure of this kind.
    MissingDataError : an input is needed and not among the results.
    """
    from flexscale import plotting

    recipes = {recipe.needs[0]: recipe for recipe in reversed(FIGURES.values())}
    if entry.kind not in recipes:
        raise BadInputError(
            f"There is no figure of a {entry.kind}; there are some of {', '.join(sorted(recipes))}."
        )
    inputs = {item["id"].split(":")[0]: item["id"] for item in registry.record(entry)["inputs"]}
    recipe = recipes[entry.kind]
    others = [registry.load(inputs[kind]) for kind in recipe.needs[1:]]
    return recipe.draw(plotting, registry.load(entry), *others)


def figure_recipe(name: str) -> Recipe:
    """Identity of a figure apart from its input."""
    return Recipe(FIGURE, 1, {"figure": name})


def figure_path(name: str, pattern: str, sources: Sequence[Entry], store: Store) -> Path:
    """The figure's PNG; the PDF and the JSON that names its sources lie beside it.

    Its name ends with the digits of the first dataset's id, from whose inputs the others are:
    experiments that compute different things never draw over each other's pictures.
    """
    stem = f"{pattern}-{name}-{sources[0].recipe_digest[:SHORT_DIGEST]}"
    return figures_folder(store) / f"{stem}.png"


def figures_folder(store: Store) -> Path:
    """Where the pictures of experiments lie."""
    return store.local / "figures"


def figure_is_current(name: str, pattern: str, sources: Sequence[Entry], store: Store) -> bool:
    """Whether the figure is there and shows these datasets, drawn by this very code."""
    path = figure_path(name, pattern, sources, store)
    if not all(path.with_suffix(ending).is_file() for ending in (".png", ".pdf", ".json")):
        return False
    try:
        made_from = json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))["made_from"]
    except (ValueError, KeyError, TypeError):
        return False
    return bool(made_from == _made_from(sources))


def draw_figure(name: str, pattern: str, sources: Sequence[Entry], store: Store) -> Path:
    """Draw a figure as PNG and PDF, with a JSON file that names its sources.

    Returns
    -------
    Path of the PNG.
    """
    from flexscale import plotting

    recipe = FIGURES[name]
    path = figure_path(name, pattern, sources, store)
    plotting.save_figure(
        recipe.draw(plotting, *(store.load(source) for source in sources)),
        path.parent,
        path.stem,
        sources=[{"id": item.id, "content_digest": item.content_digest} for item in sources],
        facts={"caption": recipe.caption, "made_from": _made_from(sources)},
    )
    return path


def _made_from(sources: Sequence[Entry]) -> str:
    """Digest of all a figure depends on: its datasets and the code that draws it."""
    digest = hashlib.sha256("".join(source.content_digest for source in sources).encode())
    package = Path(__file__).parents[1]
    code = [*(package / "plotting").glob("*.py"), *(package / "plotting").glob("*.mplstyle")]
    kinds = sorted((package / "steps" / "kinds").glob("*.py"))
    for path in [*kinds, package / "datasets" / "fit_values.py", *sorted(code)]:
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()
