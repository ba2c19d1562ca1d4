"""Kind `tensor_sweep`: energy and moments under any curvature tensor, along rays from flat.

A tensor is k = R(direction) diag(k1, k2) R(direction)^T with k1 >= k2, k1 = curvature cos(shape)
and k2 = curvature sin(shape): the shape runs from -135 degree, a dome that opens, over -90
(cylinder), -45 (saddle) and 0 (cylinder) to 45, a dome that closes.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from flexscale.datasets.build import build_dataset
from flexscale.datasets.sample_checks import ROUNDING, check_axis, check_numbers, check_status
from flexscale.datasets.stiffness import VOIGT, check_stiffness, matrix
from flexscale.datasets.variables import (
    CLOSING_DOME,
    COMPONENTS,
    IN_PLANE,
    OPENING_DOME,
    STATUS_ATTRS,
    Schema,
    Variable,
)
from flexscale.errors import SchemaError

_SAMPLE = ("direction", "shape", "curvature")
_MOMENT_METHOD = "derivative of the energy density by the curvature component at fixed unknowns"
#: Shares of a moment by which the mean over a step may miss those of its ends, and of steps that
#: may do so: where scales snap, the energy jumps.
_OFF, _MOST_OFF, _FEW = 0.05, 1.0 / 3.0, 20


def unit_tensors(direction: ArrayLike, shape: ArrayLike) -> np.ndarray:
    """(..., 3) xx, yy, xy of tensors of curvature 1 in directions and of shapes [degree]."""
    angle, psi = np.broadcast_arrays(np.deg2rad(direction), np.deg2rad(shape))
    c, s, first, second = np.cos(angle), np.sin(angle), np.cos(psi), np.sin(psi)
    return np.stack(
        [first * c * c + second * s * s, first * s * s + second * c * c, (first - second) * c * s],
        axis=-1,
    )


def ray_moments(dataset: xr.Dataset) -> np.ndarray:
    """(n_directions, n_shapes, n_curvatures) N, derivative of the energy along every ray."""
    units = unit_tensors(dataset["direction"].values[:, None], dataset["shape"].values)
    moments = np.stack([_values(dataset, f"moment_{name}") for name in COMPONENTS], axis=-1)
    along: np.ndarray = np.einsum("dskc,dsc->dsk", moments, units * [1.0, 1.0, 2.0])
    return along


def _values(dataset: xr.Dataset, name: str) -> np.ndarray:
    values: np.ndarray = dataset[name].transpose(*_SAMPLE).values
    return values


def _check_tensor_sweep(dataset: xr.Dataset) -> None:
    for axis, unit in zip(_SAMPLE, ("degree", "degree", "mm-1"), strict=True):
        check_axis(dataset[axis].values, axis, unit)
    directions, shapes = dataset["direction"].values, dataset["shape"].values
    if directions[0] < 0.0 or directions[-1] >= 180.0:
        raise SchemaError("Directions of a tensor sweep must lie in [0, 180) degree.")
    if shapes[0] < OPENING_DOME or shapes[-1] > CLOSING_DOME:
        raise SchemaError("Shapes of a tensor sweep must lie in [-135, 45] degree.")
    if dataset["curvature"].values[0] < 0.0:
        raise SchemaError("Curvatures of a tensor sweep must not be negative: the shape has signs.")
    status = dataset["status"]
    check_status(status, "tensor sweep")
    for name, variable in dataset.data_vars.items():
        if variable.dims == status.dims and variable.dtype.kind == "f":
            check_numbers(variable, status, partial=TENSOR_SWEEP.all[str(name)].partial)
    check_stiffness(dataset["tangent"].values, "tangent")
    _check_response(dataset)
    _check_energy(dataset)


def _check_response(dataset: xr.Dataset) -> None:
    """Stretches where the lattice is free, and forces where it is held."""
    in_plane = str(dataset["in_plane"].values)
    if in_plane not in IN_PLANE:
        raise SchemaError(f"In its plane a sheet is free or held, not {in_plane!r}.")
    told = "stretch" if in_plane == "free" else "membrane_force"
    for name in COMPONENTS:
        if f"{told}_{name}" not in dataset:
            raise SchemaError(
                f"A tensor sweep of a sheet that is {in_plane} in its plane needs {told}_{name}."
            )


def _check_energy(dataset: xr.Dataset) -> None:
    """Energies that are not negative, 0 at rest, and grow at the rate that the moments tell."""
    energy, kappa = _values(dataset, "energy_density"), dataset["curvature"].values
    if not np.isfinite(energy).any():
        return
    scale = max(float(np.nanmax(np.abs(energy))), 1e-3)
    lowest = float(np.nanmin(energy))
    if lowest < -ROUNDING * scale:
        raise SchemaError(f"energy_density is {lowest:.3g} N mm-1 somewhere, below that at rest.")
    at_rest = float(np.nanmax(energy[..., kappa == 0.0], initial=0.0))
    if at_rest > ROUNDING * scale:
        raise SchemaError(f"energy_density is {at_rest:.3g} N mm-1 at curvature 0, not 0.")
    moment = ray_moments(dataset)
    before, after = moment[..., :-1], moment[..., 1:]
    rate = np.diff(energy, axis=-1) / np.diff(kappa)
    allowed = 0.5 * np.abs(after - before) + _OFF * np.maximum(np.abs(before), np.abs(after))
    # Moments that only grow or only fall along a step have their mean between those of its ends.
    known = np.isfinite(rate)
    off = np.abs(rate - 0.5 * (before + after)) > allowed + ROUNDING * scale
    if known.sum() >= _FEW and off[known].mean() > _MOST_OFF:
        raise SchemaError(
            f"energy_density grows at another rate than the moments tell in {off[known].sum()} of "
            f"{known.sum()} steps of the curvature."
        )


def _sampled(name: str, units: str, long_name: str, **more: Any) -> Variable:
    return Variable(name, _SAMPLE, "float64", units, long_name, **more)


def _counted(name: str, long_name: str, **more: Any) -> Variable:
    return Variable(name, _SAMPLE, "int32", "1", long_name, **more)


TENSOR_SWEEP = Schema(
    "tensor_sweep",
    1,
    "Bending of a periodic scaled sheet by curvature tensors",
    coordinates=(
        Variable("direction", ("direction",), "float64", "degree", "direction of the first, larger "
                 "principal curvature; without meaning for domes"),
        Variable("shape", ("shape",), "float64", "degree", "angle of the principal curvatures: "
                 "curvature times its cosine and its sine; -135 opening dome, -90 opening "
                 "cylinder, -45 saddle, 0 closing cylinder, 45 closing dome"),
        Variable("curvature", ("curvature",), "float64", "mm-1", "root of the sum of squares of "
                 "the principal curvatures"),
        *(_sampled(f"curvature_{name}", "mm-1", f"component {name} of the curvature tensor, "
                   "closing > 0") for name in COMPONENTS),
        *VOIGT,
    ),
    variables=(
        _sampled("energy_density", "N mm-1", "energy per rest area of the midsurface"),
        *(_sampled(f"moment_{name}", "N", f"bending moment per width, component {name}",
                   attrs={"method": _MOMENT_METHOD + (
                       "; by 2 curvature_xy" if name == "xy" else "")}) for name in COMPONENTS),
        *(_sampled(f"stretch_{name}", "1", f"stretch F of the lattice, component {name}",
                   optional=True) for name in COMPONENTS),
        *(_sampled(f"membrane_force_{name}", "N mm-1", f"force per width that holds the lattice, "
                   f"component {name}", optional=True) for name in COMPONENTS),
        _sampled("min_gap", "mm", "smallest distance between scales", optional=True, partial=True,
                 attrs={"comment": "nan where scales are farther apart than twice the gap"}),
        _counted("contact_pairs", "active contact pairs", optional=True),
        _sampled("contact_force", "N", "sum of the contact forces on the scales of a cell",
                 optional=True),
        _counted("newton_iterations", "Newton iterations"),
        _counted("negative_eigenvalues", "negative eigenvalues of the constrained Hessian"),
        _counted("outside_range", "stations of joints beyond the range in which their law was "
                 "sampled", attrs={"comment": "above 0, numbers are extrapolated; -1 where not "
                                   "converged"}),
        _sampled("residual_norm", "N", "norm of the remaining force"),
        Variable("status", _SAMPLE, "int8", "1", "end of the solve", attrs=STATUS_ATTRS),
        Variable("symmetry_source", ("direction", "shape"), "float64", "degree",
                 "direction that was computed; others follow by the pattern's symmetry"),
        matrix("tangent", "N mm", "stiffness at rest: energy density 1/2 k C k with k = (kxx, kyy, "
               "2 kxy), the lattice as in the samples"),
        Variable("in_plane", (), "text", "", "the lattice in its plane: free or held"),
    ),
    check=_check_tensor_sweep,
)  # fmt: skip


def build_tensor_sweep_dataset(
    axes: tuple[ArrayLike, ArrayLike, ArrayLike],
    arrays: Mapping[str, ArrayLike],
    *,
    in_plane: str,
    scalars: Mapping[str, float | str],
    config: Mapping[str, Any],
) -> xr.Dataset:
    """Dataset of kind tensor_sweep.

    Parameters
    ----------
    axes : directions in [0, 180) and shapes in [-135, 45], degree, and curvatures, mm-1, not
        negative; each sorted here, with the arrays.
    arrays : values by the names of the schema, (n_directions, n_shapes, n_curvatures), with
        `symmetry_source` (n_directions, n_shapes) degree and `tangent` (3, 3) N mm. Real values of
        samples are set to nan wherever `status` is not 0.
    in_plane : "free" or "held".
    scalars, config : as in `build_sweep_dataset`.
    """
    directions, shapes, kappa = (np.asarray(axis, dtype=float) for axis in axes)
    tensors = unit_tensors(directions[:, None], shapes)[:, :, None] * kappa[:, None]
    values: dict[str, Any] = {
        **arrays,
        **{f"curvature_{name}": tensors[..., k] for k, name in enumerate(COMPONENTS)},
        "direction": directions,
        "shape": shapes,
        "curvature": kappa,
        "component": list(COMPONENTS),
        "other_component": list(COMPONENTS),
        "in_plane": in_plane,
    }
    dataset = build_dataset(TENSOR_SWEEP, values, scalars=scalars, config=config)
    return dataset.sortby(list(_SAMPLE))
