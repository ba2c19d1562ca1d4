"""The 93 isohedral families: what the list of Grünbaum and Shephard says about each.

Twelve of the types can only be told apart from others by markings on the tiles: their edges are
all mirrors, which makes the bare tile more symmetric than its type asks for. Their bare tiles can
be built like the others.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from flexscale.errors import TilingError, shown, suggest
from flexscale.tilings.symbols import EdgeClass, IncidenceSymbol


@dataclass(frozen=True)
class Family:
    """One of the 93 isohedral types of tilings.

    Attributes
    ----------
    name : "IH01" to "IH93".
    net : degree of each vertex of the tile, counterclockwise.
    symbol : incidence symbol.
    group : wallpaper group of the marked tiling; the drawn one can be larger.
    stabiliser : symmetries of the marked tile, "c3" turns only, "d3" turns and mirrors.
    n_parameters : free shape parameters.
    edge_classes : class of every edge, counterclockwise; edge k runs from vertex k to the next.
    needs_marking : whether only markings on the tiles tell this type from a more symmetric one.
    """

    name: str
    net: tuple[int, ...]
    symbol: str
    group: str
    stabiliser: str
    n_parameters: int
    edge_classes: tuple[EdgeClass, ...]
    needs_marking: bool

    def curve_kinds(self) -> dict[str, str]:
        """Letter of every edge class -> its kind, "J", "U", "S" or "I"."""
        return {edge.letter: edge.kind for edge in self.edge_classes}

    def __repr__(self) -> str:
        edges = " ".join(f"{edge.letter}:{edge.kind}" for edge in self.edge_classes)
        net = ".".join(map(str, self.net))
        marking = ", needs marking" if self.needs_marking else ""
        return (
            f"<Family {self.name}: {self.group}, net {net}, edges {edges}, "
            f"{self.n_parameters} parameter(s){marking}>"
        )


@cache
def _table() -> dict[str, dict[str, Any]]:
    text = files("flexscale.tilings").joinpath("isohedral_types.json").read_text(encoding="utf-8")
    return dict(sorted(json.loads(text).items()))


@cache
def _family(name: str) -> Family:
    entry = _table()[name]
    return Family(
        name=name,
        net=tuple(entry["net"]),
        symbol=entry["symbol"],
        group=entry["group"],
        stabiliser=entry["stabiliser"],
        n_parameters=entry["parameters"],
        edge_classes=IncidenceSymbol(entry["symbol"]).edge_classes,
        needs_marking=not entry["unmarked"],
    )


def families() -> tuple[Family, ...]:
    """All 93 families, IH01 to IH93."""
    return tuple(_family(name) for name in _table())


def find_family(name: str) -> Family:
    """The family called `name`.

    Raises
    ------
    TilingError : there is none.
    """
    if isinstance(name, str) and name in _table():
        return _family(name)
    asked = name[:20] if isinstance(name, str) else shown(name)
    number = re.fullmatch(r"\s*(?:IH)?\s*0*(\d{1,2})\s*", asked, re.IGNORECASE)
    meant = f"IH{int(number[1]):02d}" if number else ""
    hint = f"Did you mean {meant!r}?" if meant in _table() else suggest(name, _table())
    raise TilingError(
        f"Tiling family {shown(name)} does not exist: the 93 families are called IH01 to "
        f"IH93. {hint}"
    )
