"""The datasets of one pattern that findings are drawn from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from flexscale.datasets.recipe_values import native_of
from flexscale.errors import MissingDataError
from flexscale.findings.symmetry import DirectionSymmetry, direction_symmetry
from flexscale.sides import SIDES

if TYPE_CHECKING:
    from flexscale.datasets.registry import Registry

KINDS = ("sweep", "tangent", "cell")
LEAST_DIRECTIONS = 6


@dataclass(frozen=True)
class PatternData:
    """name : of the pattern; sweep, tangent, cell : its datasets."""

    name: str
    sweep: xr.Dataset
    tangent: xr.Dataset
    cell: xr.Dataset

    @property
    def symmetry(self) -> DirectionSymmetry:
        """Of its directions, as the sweep made use of it."""
        return direction_symmetry(self.sweep)


def collect(registry: Registry, native: str = "shell") -> list[PatternData]:
    """All patterns with a sweep and a tangent of a native model, and a cell, by name.

    Where datasets are shipped, only these count: findings are on the paper's patterns.

    Raises
    ------
    MissingDataError : a pattern has several datasets of a kind, a sweep that does not suffice, or
        no pattern is complete.
    """
    shipped = registry.find(source="reference")
    stored = shipped if shipped.find(kind="sweep") else registry.find()
    found = []
    for name in sorted({entry.row["pattern"] for entry in stored.find(kind="sweep")}):
        chosen = {}
        for kind in KINDS:
            entries = [
                entry
                for entry in stored.find(kind=kind, pattern=name)
                if kind == "cell" or native_of(entry.folder) == native
            ]
            if len(entries) > 1:
                ids = ", ".join(entry.id for entry in entries)
                raise MissingDataError(
                    f"{name} has several datasets of kind {kind} ({ids}), and findings are drawn "
                    "from one: give a results folder that holds one of each."
                )
            if entries:
                chosen[kind] = entries[0]
        if len(chosen) == len(KINDS):
            data = {kind: registry.load(entry) for kind, entry in chosen.items()}
            _require_all_around(data["sweep"], chosen["sweep"].id)
            found.append(PatternData(name, **data))
    if not found:
        raise MissingDataError(
            f"No pattern in {registry.root} has a sweep and a tangent of the {native}, and a cell; "
            "make them with: flexscale run workflows/named_patterns.yaml (the shell), or "
            "workflows/printed.yaml (joints)"
        )
    return found


def _require_all_around(sweep: xr.Dataset, name: str) -> None:
    """MissingDataError unless findings can be drawn from a sweep."""
    direction = sweep["direction"].values
    even = direction[0] + 180.0 * np.arange(len(direction)) / len(direction)
    lacks = ""
    if len(direction) < LEAST_DIRECTIONS or not np.allclose(direction, even):
        lacks = f"{LEAST_DIRECTIONS} or more directions at even steps of the half circle"
    elif set(sweep["side"].values) != set(SIDES):
        lacks = "both sides"
    elif not all(_bent(sweep, side) for side in SIDES):
        lacks = "a curvature above 0 with results in all directions"
    if lacks:
        raise MissingDataError(
            f"Findings need {lacks}, which {name} ({sweep['pattern'].item()}) does not have: give "
            "a results folder without it, or one with the shipped datasets."
        )


def _bent(sweep: xr.Dataset, side: str) -> bool:
    done = sweep["moment"].sel(side=side).notnull().all("direction").values
    return bool((done & (sweep["curvature"].values > 0.0)).any())


def convexity(cell: xr.Dataset) -> float:
    """Area of a scale over that of its convex hull, of the least convex scale; 1 is convex.

    Parameters
    ----------
    cell : dataset of kind cell with scale outlines.
    """
    from scipy.spatial import ConvexHull

    points, owner = cell["outline_points"].values, cell["outline_of_point"].values
    shares = []
    for scale in np.unique(owner):
        x, y = (points[owner == scale] - points[owner == scale][0]).T
        area = 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
        # In the plane, scipy calls the area of the hull its volume.
        shares.append(area / float(ConvexHull(points[owner == scale]).volume))
    return min(shares)
