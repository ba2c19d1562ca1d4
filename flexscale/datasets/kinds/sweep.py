"""Kind `sweep`: energy and moment over side, direction and curvature."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from flexscale.datasets.build import build_dataset
from flexscale.datasets.sample_checks import (
    ROUNDING,
    check_axis,
    check_numbers,
    check_sides,
    check_status,
)
from flexscale.datasets.variables import (
    COMPONENTS,
    DIRECTION,
    SIDE,
    SIDE_SIGN,
    STATUS_ATTRS,
    Schema,
    Variable,
)
from flexscale.errors import SchemaError
from flexscale.sides import side_sign

NO_CONTACT_COMMENT = "contact between scales was not modeled"
_SAMPLE = ("side", "direction", "curvature")


def _sampled(
    name: str, units: str, long_name: str, *, optional: bool = False, **attrs: str
) -> Variable:
    return Variable(name, _SAMPLE, "float64", units, long_name, optional, attrs)


def _counted(name: str, long_name: str, *, optional: bool = False) -> Variable:
    return Variable(name, _SAMPLE, "int32", "1", long_name, optional=optional)


#: The parts of the energy density, of which a native model has some; they sum to it.
ENERGY_PARTS = tuple(
    f"energy_density_{part}"
    for part in ("membrane", "bending", "solid", "scales", "joints", "contact")
)

_RETURNING = {
    "comment": "of the equilibrium met on the way back from the next curvature, where the energy "
    "curved downward on the way there; another value than without `_returning` means that there "
    "is more than one branch; nan where the way was stable"
}


def _check_sweep(dataset: xr.Dataset) -> None:
    check_sides(dataset, "sweep")
    direction = dataset["direction"].values
    check_axis(direction, "direction", "degree")
    if direction[0] < 0.0 or direction[-1] >= 180.0:
        raise SchemaError("Directions of a sweep must lie in [0, 180) degree.")
    curvature = dataset["curvature"].values
    check_axis(curvature, "curvature", "mm-1")
    if curvature[0] < 0.0:
        raise SchemaError("Curvatures of a sweep must not be negative: the side carries the sign.")
    status = dataset["status"]
    check_status(status, "sweep")
    for name, variable in dataset.data_vars.items():
        if variable.dims[:3] == status.dims and variable.dtype.kind == "f":
            check_numbers(variable, status, partial=SWEEP.all[str(name)].partial)
    _check_energy(dataset)


def _check_energy(dataset: xr.Dataset) -> None:
    energy = dataset["energy_density"].values
    parts = np.stack([dataset[name].values for name in ENERGY_PARTS if name in dataset])
    if not np.isfinite(energy).any():
        return
    scale = float(np.nanmax(np.abs(parts)))
    off = float(np.nanmax(np.abs(parts.sum(axis=0) - energy)))
    if off > ROUNDING * scale:
        raise SchemaError(f"The parts of energy_density miss its value by {off:.3g} N mm-1.")
    at_rest = energy[:, :, dataset["curvature"].values == 0.0]
    at_rest = at_rest[np.isfinite(at_rest)]
    if at_rest.size and np.abs(at_rest).max() > ROUNDING * max(scale, 1e-3):
        raise SchemaError(
            f"energy_density is {np.abs(at_rest).max():.3g} N mm-1 at curvature 0, not 0."
        )


SWEEP = Schema(
    "sweep",
    1,
    "Bending of a periodic scaled sheet in many directions",
    coordinates=(
        SIDE,
        DIRECTION,
        Variable("curvature", ("curvature",), "float64", "mm-1", "magnitude of the curvature"),
        Variable("component", ("component",), "text", "", "component of a symmetric 2x2 tensor"),
        SIDE_SIGN,
        Variable("direction_rad", ("direction",), "float64", "rad", "bending direction"),
        Variable(
            "signed_curvature", ("side", "curvature"), "float64", "mm-1", "curvature, closing > 0"
        ),
    ),
    variables=(
        _sampled("energy_density", "N mm-1", "energy per rest area of the midsurface"),
        *(
            _sampled(f"energy_density_{part}", "N mm-1", meaning, optional=True)
            for part, meaning in (
                ("membrane", "stretching energy of the substrate"),
                ("bending", "bending energy of the substrate"),
                ("solid", "elastic energy of a solid substrate"),
                ("scales", "elastic energy of the scales"),
                ("joints", "energy of the joints between scales"),
            )
        ),
        _sampled("energy_density_contact", "N mm-1", "contact energy of the scales"),
        _sampled(
            "moment",
            "N",
            "bending moment per width",
            method="derivative of the energy density by the curvature at fixed unknowns",
        ),
        *(
            Variable(name, _SAMPLE, "float64", units, long_name, True, _RETURNING, partial=True)
            for name, units, long_name in (
                ("energy_density_returning", "N mm-1", "energy per rest area, bent back"),
                ("moment_returning", "N", "bending moment per width, bent back"),
            )
        ),
        Variable(
            "stretch",
            (*_SAMPLE, "component"),
            "float64",
            "1",
            "symmetric stretch F of the lattice",
        ),
        _sampled("min_gap", "mm", "smallest distance between scales"),
        _counted("contact_pairs", "active contact pairs"),
        _sampled("contact_force", "N", "sum of the contact forces on the scales of a cell"),
        Variable(
            "barrier_stiffness",
            _SAMPLE,
            "float64",
            "N mm-3",
            "stiffness of the barrier between scales",
            optional=True,
            attrs={"comment": "raised where scales press so hard that they nearly meet"},
        ),
        _counted("newton_iterations", "Newton iterations"),
        _counted("negative_eigenvalues", "negative eigenvalues of the constrained Hessian"),
        _counted("saddles_left", "saddles met and left on the way to the sample", optional=True),
        Variable(
            "outside_range",
            _SAMPLE,
            "int32",
            "1",
            "stations of joints beyond the range in which their law was sampled",
            optional=True,
            attrs={"comment": "above 0, numbers are extrapolated; -1 where not converged"},
        ),
        _sampled("residual_norm", "N", "norm of the remaining force"),
        _sampled("mean_offset", "mm", "mean normal displacement of the substrate"),
        Variable("status", _SAMPLE, "int8", "1", "end of the solve", attrs=STATUS_ATTRS),
        Variable(
            "symmetry_source",
            ("side", "direction"),
            "float64",
            "degree",
            "direction that was computed; others follow by the pattern's symmetry",
        ),
    ),
    check=_check_sweep,
)


def build_sweep_dataset(
    sides: Sequence[str],
    directions: ArrayLike,
    curvatures: ArrayLike,
    arrays: Mapping[str, ArrayLike],
    *,
    scalars: Mapping[str, float | str],
    config: Mapping[str, Any],
) -> xr.Dataset:
    """Dataset of kind sweep/1.

    Parameters
    ----------
    sides : of "closing", "opening".
    directions : (n_directions,) degree in [0, 180); sorted here, with the arrays.
    curvatures : (n_curvatures,) mm-1, non-negative; sorted here, with the arrays.
    arrays : values by the names of the schema, (n_sides, n_directions, n_curvatures), `stretch`
        with 3 components (xx, yy, xy) behind, `symmetry_source` (n_sides, n_directions) degree.
        Without contact leave out `energy_density_contact`, `contact_pairs`, `contact_force` and
        `min_gap`; they become 0, 0, 0 and nan. Without `symmetry_source` every direction was
        computed itself.
        Real values are set to nan wherever `status` is not 0.
    scalars : "family", "pattern" and what is known of `variables.SCALARS`.
    config : resolved configuration, JSON-able, enough to compute the sweep again.
    """
    sides = [str(side) for side in sides]
    angles = np.asarray(directions, dtype=float)
    kappa = np.asarray(curvatures, dtype=float)
    shape = (len(sides), angles.size, kappa.size)
    signs = np.array([side_sign(side) for side in sides], dtype=np.int8)
    values: dict[str, Any] = dict(arrays)
    no_contact = "min_gap" not in values
    values.setdefault("energy_density_contact", np.zeros(shape))
    values.setdefault("contact_pairs", np.zeros(shape, dtype=np.int32))
    values.setdefault("contact_force", np.zeros(shape))
    values.setdefault("min_gap", np.full(shape, np.nan))
    values.setdefault("symmetry_source", np.broadcast_to(angles, shape[:2]))
    values.update(
        side=sides,
        direction=angles,
        curvature=kappa,
        component=list(COMPONENTS),
        side_sign=signs,
        direction_rad=np.deg2rad(angles),
        signed_curvature=signs[:, None] * kappa,
    )
    dataset = build_dataset(SWEEP, values, scalars=scalars, config=config)
    if no_contact:
        dataset["min_gap"].attrs["comment"] = NO_CONTACT_COMMENT
    return dataset.sortby(["side", "direction", "curvature"])
