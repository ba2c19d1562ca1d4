"""A stored dataset computed again from its recipe: does the same come out?"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexscale.datasets.identity import content_digest
from flexscale.steps.catalog import STEPS
from flexscale.steps.native_inputs import inputs_by_step
from flexscale.steps.step import Resources

if TYPE_CHECKING:
    import xarray as xr

    from flexscale.datasets.registry import Entry, Registry

#: Of a variable's largest value. Equilibria are accepted at a Newton decrement of 1e-9 to 1e-8 of
#: the energy, which leaves states, moments and stretches uncertain by its root.
TOLERANCE = 1e-4
#: What is left of zero, or counts steps: different at every rounding.
ROUNDING = ("residual_norm", "mean_offset", "newton_iterations", "contact_pairs", "saddles_left")
#: The other half of a quantity's numbers: all sines of a symmetric pattern are left of zero.
OTHER_PART = {"sin_coefficient": "cos_coefficient"}


@dataclass(frozen=True)
class Recomputed:
    """What came out.

    same : the content digest is that of the stored dataset.
    differences : largest difference of each variable that differs, over its largest stored value;
    infinite where values are missing or added, text differs, or a sample ended otherwise.
    stored_version, version : of the step, then and now.
    seconds : this took.
    """

    same: bool
    differences: dict[str, float]
    stored_version: int
    version: int
    seconds: float

    @property
    def close(self) -> bool:
        """Whether all differences are those that the solver's tolerance allows."""
        return all(
            off <= TOLERANCE for name, off in self.differences.items() if name not in ROUNDING
        )


def recompute(entry: Entry, registry: Registry, workers: int = 1) -> Recomputed:
    """Run the step of a stored dataset again, with its parameters and inputs; nothing is stored.

    On the machine and with the code and libraries that made it, and one thread as in a job (see
    `single_threaded`), the content is the same to the last bit; else sums are rounded otherwise,
    which may decide between two states that lie close together.

    Raises
    ------
    MissingDataError : an input is not among the results.
    """
    record = registry.record(entry)
    step, recipe = STEPS[record["recipe"]["step"]], record["recipe"]
    sources = [item["id"] for item in record["inputs"]]
    inputs = inputs_by_step((source.split(":")[0], registry.load(source)) for source in sources)
    task = step.task(recipe["parameters"])
    started = time.monotonic()
    dataset = step.compute(task, inputs, Resources(workers=workers if step.parallel else 1))
    seconds = time.monotonic() - started
    same = content_digest(dataset) == entry.content_digest
    differences = {} if same else relative_differences(dataset, registry.load(entry))
    return Recomputed(same, differences, recipe["version"], step.version, seconds)


def relative_differences(new: xr.Dataset, stored: xr.Dataset) -> dict[str, float]:
    """`Recomputed.differences` of two datasets."""
    found = {}
    for name in sorted({*map(str, new.variables), *map(str, stored.variables)}):
        if name not in new.variables or name not in stored.variables:
            found[name] = np.inf
        elif not new.variables[name].equals(stored.variables[name]):
            other = stored.variables.get(OTHER_PART.get(name, name))
            found[name] = _difference(new.variables[name], stored.variables[name], other)
    return found


def _difference(new: xr.Variable, stored: xr.Variable, other: xr.Variable | None) -> float:
    """Largest difference over the largest stored value, that of the quantity's other part too."""
    a, b = new.values, stored.values
    numbers = a.dtype.kind in "fi" and b.dtype.kind in "fi"
    if not numbers or a.shape != b.shape or new.attrs.get("flag_values") is not None:
        return np.inf
    if (np.isnan(a) != np.isnan(b)).any():
        return np.inf
    parts = [b] if other is None else [b, other.values]
    largest = max(float(np.nanmax(np.abs(part), initial=0.0)) for part in parts)
    return float(np.nanmax(np.abs(a - b), initial=0.0)) / largest if largest > 0.0 else np.inf
