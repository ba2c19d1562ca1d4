"""What kinds that hold a mesh share: its variables, and whether its indices can be."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from flexscale.datasets.variables import Variable
from flexscale.errors import SchemaError


def array(
    name: str, dims: str, dtype: str, long_name: str, units: str = "1", *, optional: bool = False
) -> Variable:
    """Variable whose dimensions are the words of a text."""
    return Variable(name, tuple(dims.split()), dtype, units, long_name, optional)


def check_mesh(indices: dict[str, str]) -> Callable[[xr.Dataset], None]:
    """Check of a mesh with these index arrays, each with the dimension it points into."""

    def check(dataset: xr.Dataset) -> None:
        for name, variable in dataset.data_vars.items():
            if variable.dtype.kind == "f" and not _is_whole(variable):
                raise SchemaError(f"{name} holds values that are not finite.")
        for name, target in indices.items():
            values = dataset[name].values
            size = dataset.sizes[target]
            if values.size and (values.min() < 0 or values.max() >= size):
                raise SchemaError(f"{name} points outside the {size} entries of {target}.")
        (a, b), (c, d) = dataset["lattice"].values
        if not a * d - b * c > 0.0:
            raise SchemaError("The lattice vectors must be right-handed and independent.")

    return check


def _is_whole(variable: xr.DataArray) -> bool:
    """All finite; a deformed state that did not converge is missing as a whole."""
    finite = np.isfinite(variable.values)
    if variable.dims[:1] != ("sample",):
        return bool(finite.all())
    per_sample = finite.reshape(finite.shape[0], -1)
    return bool((per_sample.all(axis=1) == per_sample.any(axis=1)).all())
