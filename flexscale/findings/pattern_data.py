"""The datasets of one pattern that findings are drawn from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from flexscale.errors import MissingDataError
from flexscale.findings.symmetry import DirectionSymmetry, direction_symmetry

if TYPE_CHECKING:
    from flexscale.datasets.registry import Registry

KINDS = ("sweep", "tangent", "cell")


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


def collect(registry: Registry) -> list[PatternData]:
    """All patterns with a sweep, a tangent and a cell, by name.

    Raises
    ------
    MissingDataError : a pattern has several datasets of a kind, or no pattern is complete.
    """
    found = []
    names = sorted({entry.row["pattern"] for entry in registry.find(kind="sweep")})
    for name in names:
        chosen = {}
        for kind in KINDS:
            entries = registry.find(kind=kind, pattern=name)
            # Several in one's own results: those of the shipped set are meant.
            shipped = [e for e in entries if e.folder.is_relative_to(registry.root / "reference")]
            if len(shipped) == 1 or len(entries) == 1:
                chosen[kind] = shipped[0] if shipped else entries[0]
            elif entries:
                ids = ", ".join(entry.id for entry in entries)
                raise MissingDataError(
                    f"{name} has several datasets of kind {kind} ({ids}), and findings are drawn "
                    "from one: give a results folder that holds one of each."
                )
        if len(chosen) == len(KINDS):
            data = {kind: registry.load(entry) for kind, entry in chosen.items()}
            found.append(PatternData(name, **data))
    if not found:
        raise MissingDataError(
            f"No pattern in {registry.root} has a sweep, a tangent and a cell; make them with: "
            "flexscale run workflows/named_patterns.yaml"
        )
    return found


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
        x, y = points[owner == scale].T
        area = 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
        # In the plane, scipy calls the area of the hull its volume.
        shares.append(area / float(ConvexHull(points[owner == scale]).volume))
    return min(shares)
