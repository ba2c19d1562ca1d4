"""What makes two results the same: canonical JSON, recipe digests and content digests.

A *recipe* says how a dataset is made (step, its version, its parameters, the content of its
inputs); its digest names the dataset. A *content digest* says what came out. File bytes are not
identity: netCDF libraries write equal content differently.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from flexscale.errors import ConfigError

if TYPE_CHECKING:
    import xarray as xr

#: hex digits of a recipe digest that name a folder and appear in an id ("sweep:3f9c2e71b0aa")
SHORT_DIGEST = 12


@dataclass(frozen=True)
class Recipe:
    """How a dataset is made, apart from its inputs.

    Parameters
    ----------
    step : name of the step, for instance "sweep".
    version : the step's version; raised whenever its numbers change.
    parameters : everything the result depends on, as JSON-able data (text, numbers, bool, None,
        lists, dicts with text keys; numpy numbers and arrays are welcome), in mm, N, MPa, degree.
    """

    step: str
    version: int
    parameters: Mapping[str, Any]

    def digest(self, input_digests: Iterable[str] = ()) -> str:
        """Sha256 (64 hex digits) of the recipe and the content digests of its inputs.

        The order of the inputs does not matter.
        """
        content = {"recipe": self.to_dict(), "inputs": sorted(input_digests)}
        return hashlib.sha256(canonical_json(content).encode()).hexdigest()

    def to_dict(self) -> dict[str, Any]:
        """Recipe as plain JSON-able data."""
        return {
            "step": self.step,
            "version": self.version,
            "parameters": plain(self.parameters, "parameters"),
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Recipe:
        """Inverse of `to_dict`."""
        return cls(str(data["step"]), int(data["version"]), dict(data["parameters"]))


def canonical_json(value: Any) -> str:
    """JSON text that is equal for equal data: sorted keys, shortest exact numbers, no spaces.

    Equal numbers give equal text, whatever their type: 10, 10.0 and numpy's 10.0 are the same.

    Raises
    ------
    ConfigError : something is not JSON-able, or a number is not finite.
    """
    return json.dumps(plain(value, "value"), sort_keys=True, separators=(",", ":"))


def plain(value: Any, where: str, *, null_for_nan: bool = False) -> Any:
    """Copy of `value` made of dict, list, text, int, float, bool and None only.

    Parameters
    ----------
    value : nested data, numpy numbers and arrays included.
    where : its name, for the message when something in it cannot be stored.
    null_for_nan : turn numbers that are not finite into None instead of refusing them.
    """
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, str):
        return str(value)
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                raise ConfigError(f"{where} has the key {key!r}: keys must be text.")
        return {
            str(key): plain(item, f"{where}.{key}", null_for_nan=null_for_nan)
            for key, item in value.items()
        }
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist(), where, null_for_nan=null_for_nan)
    if isinstance(value, list | tuple):
        return [
            plain(item, f"{where}[{index}]", null_for_nan=null_for_nan)
            for index, item in enumerate(value)
        ]
    if isinstance(value, int):
        return int(value)
    if isinstance(value, float):
        return _plain_float(float(value), where, null_for_nan)
    raise ConfigError(
        f"{where} is a {type(value).__name__} ({value!r}): "
        "only text, numbers, true/false, null, lists and dicts can be stored."
    )


def _plain_float(number: float, where: str, null_for_nan: bool) -> int | float | None:
    if not math.isfinite(number):
        if null_for_nan:
            return None
        raise ConfigError(f"{where} is {number}: numbers in a recipe must be finite.")
    # Beyond 2**53 not every integer is a float, so 1e300 stays a float.
    if number.is_integer() and abs(number) < 2**53:
        return int(number)
    return number


def content_digest(dataset: xr.Dataset) -> str:
    """Sha256 (64 hex digits) of all variables: name, dims, type, shape, values and units.

    Attributes other than `units` do not count (they hold versions and commits). All nan are one
    value, and so are 0.0 and -0.0, as they are for comparison.
    """
    total = hashlib.sha256()
    for name in sorted(str(name) for name in dataset.variables):
        variable = dataset.variables[name]
        kind, data = _canonical_bytes(np.asarray(variable.values))
        header = [name, list(variable.dims), kind, list(variable.shape)]
        header.append(str(variable.attrs.get("units", "")))
        total.update(json.dumps(header).encode())
        total.update(hashlib.sha256(data).digest())
    return total.hexdigest()


def _canonical_bytes(values: np.ndarray) -> tuple[str, bytes]:
    """Type name and little-endian bytes; text counts as text, however numpy keeps it."""
    if values.dtype.kind in "UOTS":
        return "text", json.dumps([str(item) for item in values.ravel().tolist()]).encode()
    if values.dtype.kind == "f":
        values = np.where(np.isnan(values), np.array(np.nan, values.dtype), values) + 0.0
    little = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<"))
    return little.dtype.str.lstrip("<|"), little.tobytes()
