"""Samples of a tensor sweep as fits use them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.datasets.checks import check_dataset
from flexscale.datasets.given import require_variables
from flexscale.datasets.variables import COMPONENTS
from flexscale.errors import BadInputError

_SAMPLE = ("direction", "shape", "curvature")
_FEWEST = 100  # samples beyond the flat state, so that three curvatures are told apart
_FOLDS = 4  # one ray in so many is held out


@dataclass(frozen=True, eq=False)
class TensorSamples:
    """Converged samples beyond the flat state.

    Attributes
    ----------
    places : (p, 3) kappa_xx, kappa_yy, sqrt(2) kappa_xy, mm-1: as long as the tensor.
    energies : (p,) N mm-1.
    moments : (p, 3) N, derivatives of the energy by the places.
    touches : (p,) whether scales touch.
    rays : (p,) number of the ray that was computed; those that symmetry fills share it.
    steps : (p,) number of the curvature on the ray.
    cells : (p,) place in the sweep's samples (direction, shape, curvature), counted through.
    """

    places: FloatArray
    energies: FloatArray
    moments: FloatArray
    touches: BoolArray
    rays: IntArray
    steps: IntArray
    cells: IntArray

    def __len__(self) -> int:
        return len(self.energies)

    @property
    def voigt(self) -> FloatArray:
        """(p, 3) kappa_xx, kappa_yy, 2 kappa_xy, mm-1."""
        voigt: FloatArray = self.places * [1.0, 1.0, np.sqrt(2.0)]
        return voigt

    @property
    def tensors(self) -> FloatArray:
        """(p, 2, 2) mm-1."""
        xy = self.places[:, 2] / np.sqrt(2.0)
        entries = [self.places[:, 0], xy, xy, self.places[:, 1]]
        return np.stack(entries, axis=1).reshape(-1, 2, 2)

    def moment_lengths(self) -> FloatArray:
        """(p,) N."""
        lengths: FloatArray = np.linalg.norm(self.moments, axis=1)
        return lengths

    def where(self, chosen: BoolArray) -> TensorSamples:
        """Those chosen (p,)."""
        return TensorSamples(*(getattr(self, name)[chosen] for name in self.__dataclass_fields__))

    def thinned(self, most: int) -> TensorSamples:
        """At most so many of each ray, evenly, the last one included."""
        last = int(self.steps.max())
        return self.where((last - self.steps) % max(1, -(-last // most)) == 0)

    def held_out(self) -> BoolArray:
        """(p,) samples of every fourth ray, by which a fit to the others may be judged."""
        chosen: BoolArray = self.rays % _FOLDS == _FOLDS - 1
        return chosen


def read_tensor_samples(sweep: xr.Dataset) -> TensorSamples:
    """Samples of a dataset of kind tensor_sweep, of a sheet that is free in its plane.

    Raises
    ------
    SchemaError, BadInputError : not such a dataset, or too few samples for a fit.
    """
    needed = ("energy_density", *(f"moment_{name}" for name in COMPONENTS), "symmetry_source")
    require_variables(sweep, needed, "A fit to curvature tensors", "tensor_sweep")
    check_dataset(sweep, "tensor_sweep")
    if str(sweep["in_plane"].values) != "free":
        raise BadInputError(
            "A law of bending is fitted to sheets that are free in their plane, and this tensor "
            "sweep held them: compute it with in_plane='free'."
        )
    curvatures, moments = (
        np.stack([_values(sweep, f"{what}_{name}") for name in COMPONENTS], axis=-1)
        for what in ("curvature", "moment")
    )
    energies = _values(sweep, "energy_density")
    used = np.isfinite(energies) & (energies > 0.0) & np.any(curvatures != 0.0, axis=-1)
    if used.sum() < _FEWEST:
        raise BadInputError(
            f"A law of any curvature needs {_FEWEST} converged samples beyond the flat state, and "
            f"this tensor sweep has {used.sum()}: add directions, shapes or curvatures."
        )
    touches = _values(sweep, "contact_pairs") > 0 if "contact_pairs" in sweep else False & used
    rays = np.broadcast_to(_rays(sweep)[:, :, None], energies.shape)
    steps = np.broadcast_to(np.arange(energies.shape[-1]), energies.shape)
    root = np.sqrt(2.0)
    return TensorSamples(
        (curvatures * [1.0, 1.0, root])[used],
        energies[used],
        (moments * [1.0, 1.0, root])[used],
        touches[used],
        rays[used],
        steps[used],
        np.flatnonzero(used),
    )


def _values(sweep: xr.Dataset, name: str) -> FloatArray:
    values: FloatArray = sweep[name].transpose(*_SAMPLE).values
    return values


def _rays(sweep: xr.Dataset) -> IntArray:
    """(n_directions, n_shapes) numbers of the rays that were computed, so that neighbors differ."""
    source = sweep["symmetry_source"].transpose("direction", "shape").values
    _, of_direction = np.unique(np.round(source, 9), return_inverse=True)
    return of_direction.reshape(source.shape) + 2 * np.arange(source.shape[1])
