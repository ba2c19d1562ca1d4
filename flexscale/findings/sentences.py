"""Sentences on datasets, for the page of figures."""

from __future__ import annotations

import numpy as np
import xarray as xr

from flexscale.findings.measures import (
    largest_curvature,
    lobes,
    moments,
    smallest_curvature,
    spread,
)


def variation_sentence(name: str, sweep: xr.Dataset, side: str) -> str:
    """How moments vary over directions, and where their lobes are, at both ends of a sweep."""
    directions = np.asarray(sweep["direction"].values, dtype=float)
    parts = []
    for curvature in (smallest_curvature(sweep, side), largest_curvature(sweep, side)):
        values = moments(sweep, side, curvature)
        found = ", ".join(f"{place:g}°" for place in lobes(directions, values))
        parts.append(
            f"at {curvature:g} mm-1 moments vary by {100 * spread(values):.3g} % of their mean, "
            + (f"largest around {found}" if found else "without lobes")
        )
    return f"{name}: {'; '.join(parts)}."
