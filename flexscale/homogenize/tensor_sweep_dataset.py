"""From the samples of solved rays to the dataset of a tensor sweep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.datasets.kinds.tensor_sweep import build_tensor_sweep_dataset
from flexscale.datasets.variables import COMPONENTS
from flexscale.homogenize.sample import Sample
from flexscale.homogenize.symmetry import Source, turn_stretch
from flexscale.homogenize.tensor_line import TensorLine
from flexscale.status import SolveStatus

if TYPE_CHECKING:
    import xarray as xr

_REALS = ("energy_density", "residual_norm")
_COUNTS = ("newton_iterations", "negative_eigenvalues")
_CONTACT = ("min_gap", "contact_force", "contact_pairs")


@dataclass(frozen=True)
class Rays:
    """Directions and shapes, and which of them are solved.

    Attributes
    ----------
    directions, shapes : degree; curvatures : mm-1.
    sources : of every direction and shape.
    """

    directions: tuple[float, ...]
    shapes: tuple[float, ...]
    curvatures: tuple[float, ...]
    sources: tuple[tuple[Source, ...], ...]

    @cached_property
    def lines(self) -> list[TensorLine]:
        """Those that are solved, each once."""
        return list(dict.fromkeys(line for row in self.lines_of for line in row))

    @cached_property
    def lines_of(self) -> list[list[TensorLine]]:
        """The one from which the numbers of each direction and shape come."""
        return [
            [
                TensorLine(source.direction, shape, self.curvatures)
                for source, shape in zip(row, self.shapes, strict=True)
            ]
            for row in self.sources
        ]


def build_dataset_of(
    rays: Rays,
    samples: Mapping[TensorLine, Sequence[Sample]],
    tangent: FloatArray,
    *,
    in_plane: str,
    scalars: dict[str, float | str],
    config: dict[str, Any],
) -> xr.Dataset:
    """Dataset of kind tensor_sweep/1.

    Parameters
    ----------
    samples : of every ray that was solved, in the order of curvatures.
    tangent : (3, 3) N mm.
    in_plane : "free" or "held".
    scalars : numbers and names of the pattern, as `labels.pattern_scalars` gives them.
    config : pattern and options, for the recipe.
    """
    rows = [[samples[line] for line in row] for row in rays.lines_of]

    def table(name: str, missing: Any) -> np.ndarray:
        return np.array([[[s.get(name, missing) for s in ray] for ray in row] for row in rows])

    contact = [name for name in _CONTACT if any(name in s for ray in samples.values() for s in ray)]
    arrays: dict[str, Any] = {name: table(name, np.nan) for name in (*_REALS, *contact)}
    if contact:
        arrays["min_gap"][np.isinf(arrays["min_gap"])] = np.nan
        arrays["contact_pairs"] = table("contact_pairs", 0)
    arrays |= {name: table(name, 0) for name in _COUNTS}
    arrays["outside_range"] = table("outside_range", -1)
    arrays["status"] = table("status", int(SolveStatus.not_run))
    arrays |= _turned("moment", _components(table, "moment"), rays)
    if in_plane == "free":
        arrays |= _turned("stretch", table("stretch", np.full(3, np.nan)), rays)
    else:
        arrays |= _turned("membrane_force", _components(table, "membrane_force"), rays)
    arrays["symmetry_source"] = [[line.direction for line in row] for row in rays.lines_of]
    arrays["tangent"] = tangent
    axes = {name: list(getattr(rays, name)) for name in ("directions", "shapes", "curvatures")}
    return build_tensor_sweep_dataset(
        (rays.directions, rays.shapes, rays.curvatures),
        arrays,
        in_plane=in_plane,
        scalars=scalars,
        config=config | axes,
    )


def _components(table: Any, name: str) -> FloatArray:
    """(..., 3) of numbers that samples hold by component."""
    return np.stack([table(f"{name}_{part}", np.nan) for part in COMPONENTS], axis=-1)


def _turned(name: str, values: FloatArray, rays: Rays) -> dict[str, FloatArray]:
    """By component, (n_directions, n_shapes, n_curvatures, 3) carried from sources to images."""
    for j, row in enumerate(rays.sources):
        for s, source in enumerate(row):
            values[j, s] = turn_stretch(values[j, s], source.turn)
    return {f"{name}_{part}": values[..., k] for k, part in enumerate(COMPONENTS)}
