"""Named patterns: a catalog of twelve that examples, experiments and comparisons share.

They span symmetries from one reflection to six-fold, shapes from convex to concave, and response
from isotropic to strongly anisotropic. `named_patterns.yaml` holds them.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from typing import Any

import yaml

from flexscale.checks import require_choice
from flexscale.errors import PatternError, suggest
from flexscale.patterns.pattern import Pattern
from flexscale.patterns.pattern_config import MATERIALS, SIZES


@dataclass(frozen=True)
class NamedPattern:
    """Entry of the catalog.

    Attributes
    ----------
    name : as `named_pattern` takes it.
    family : tiling family, "IH01" to "IH93".
    what : one sentence.
    shape : "parameters" and "edges" of the tiling, as `Tiling` takes them, where there are any.
    """

    name: str
    family: str
    what: str
    shape: dict[str, Any] = field(repr=False, hash=False)


@cache
def named_patterns() -> tuple[NamedPattern, ...]:
    """All entries of the catalog."""
    text = files("flexscale.patterns").joinpath("named_patterns.yaml").read_text(encoding="utf-8")
    return tuple(
        NamedPattern(name, entry.pop("family"), entry.pop("is"), entry)
        for name, entry in yaml.safe_load(text).items()
    )


def find_named_pattern(name: str) -> NamedPattern:
    """The catalog's entry called `name`.

    Raises
    ------
    UnknownNameError : there is none.
    """
    known = {entry.name: entry for entry in named_patterns()}
    return known[require_choice(name, "pattern named", known)]


def named_pattern(name: str, **sizes: Any) -> Pattern:
    """A pattern of the catalog, called by its name there.

    Parameters
    ----------
    sizes : tile_area, gap, scale_height, materials, …: those of `Pattern`.

    Raises
    ------
    UnknownNameError : there is no such pattern.
    PatternError : there is no such size, or the gap is too wide.
    """
    entry = find_named_pattern(name)
    known = ("tile_area", *SIZES, *MATERIALS)
    for key in sizes:
        if key not in known:
            raise PatternError(f"A named pattern has no size {key!r}. {suggest(key, known)}")
    return Pattern.from_config({"name": name, "family": entry.family, **entry.shape, **sizes})
