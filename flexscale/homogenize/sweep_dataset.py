"""From the samples of solved lines to the dataset of a sweep."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.datasets.kinds.sweep import ENERGY_PARTS, build_sweep_dataset
from flexscale.homogenize.sample import Sample
from flexscale.homogenize.symmetry import Source, turn_stretch
from flexscale.patterns import Pattern
from flexscale.status import SolveStatus

if TYPE_CHECKING:
    import xarray as xr


def build_dataset_of(
    pattern: Pattern,
    scalars: dict[str, float | str],
    options: dict[str, Any],
    samples: dict[tuple[str, float], list[Sample]],
    axes: tuple[Sequence[str], Sequence[float], Sequence[float]],
    sources: Sequence[Source],
) -> xr.Dataset:
    """Dataset of kind sweep/1.

    Parameters
    ----------
    scalars : numbers and names of the pattern, as `labels.pattern_scalars` gives them.
    options : resolved mesh, solver and contact options, for the recipe.
    samples : of every line solved, by side and direction, in the order of curvatures.
    axes : sides, directions (degree), curvatures (mm-1).
    sources : of every direction.
    """
    sides, directions, curvatures = axes
    shape = (len(sides), len(directions), len(curvatures))

    def array(
        name: str, missing: float, dtype: type = float, extra: tuple[int, ...] = ()
    ) -> FloatArray:
        out: FloatArray = np.full((*shape, *extra), missing, dtype=dtype)
        for i, side in enumerate(sides):
            for j, source in enumerate(sources):
                for k, sample in enumerate(samples[side, source.direction]):
                    value: Any = sample.get(name, missing)
                    out[i, j, k] = value
        return out

    reals: tuple[str, ...] = ("energy_density", "moment", "residual_norm", "mean_offset")
    counts: tuple[str, ...] = ("newton_iterations", "negative_eigenvalues", "saddles_left")
    if options["contact"]["enabled"]:
        reals += ("min_gap", "contact_force", "barrier_stiffness")
        counts += ("contact_pairs",)
    converged = (s for line in samples.values() for s in line if "energy_density" in s)
    parts = tuple(name for name in next(converged, {}) if name in ENERGY_PARTS)
    if any("outside_range" in s for line in samples.values() for s in line):
        counts += ("outside_range",)
    arrays: dict[str, Any] = {name: array(name, np.nan) for name in (*reals, *parts)}
    stretch = array("stretch", np.nan, extra=(3,))
    for j, source in enumerate(sources):
        stretch[:, j] = turn_stretch(stretch[:, j], source.turn)
    arrays["stretch"] = stretch
    for name in ("energy_density_returning", "moment_returning"):
        # Of the sample before the one that carries it: it was met on the way back from there.
        arrays[name] = np.full(shape, np.nan)
        arrays[name][..., :-1] = array(name, np.nan)[..., 1:]
    solved = [source.direction for source in sources]
    arrays["symmetry_source"] = np.broadcast_to(solved, shape[:2])
    for name in counts:  # what is beyond a range is not known of samples that did not converge
        arrays[name] = array(name, -1 if name == "outside_range" else 0, np.int32)
    arrays["status"] = array("status", int(SolveStatus.not_run), np.int8)
    config = {
        "pattern": pattern.to_config(),
        **options,
        "sides": list(sides),
        "directions": [float(d) for d in directions],
        "curvatures": list(curvatures),
    }
    return build_sweep_dataset(
        sides, directions, curvatures, arrays, scalars=scalars, config=config
    )
