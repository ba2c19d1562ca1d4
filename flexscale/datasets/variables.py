"""What a variable and a table of a dataset are, and the names that several kinds share."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

from flexscale.status import FLAG_MEANINGS, SolveStatus

if TYPE_CHECKING:
    import xarray as xr

COMPONENTS = ("xx", "yy", "xy")
#: Energies of a curvature tensor by name; a fit is for one of them.
Variant = Literal["tangent", "paper"]
VARIANTS: tuple[Variant, ...] = ("tangent", "paper")
#: How a fit weighs its samples.
Weighting = Literal["relative", "absolute"]
WEIGHTINGS: tuple[Weighting, ...] = ("relative", "absolute")
#: What the errors of a fit were measured on, and how they were summed up.
ASSESSMENTS = ("law", "model", "held_out_curvature", "held_out_direction")
STATISTICS = ("median", "percentile_95", "worst")

#: Shapes [degree] of curvature tensors that are domes: the ends of their range.
OPENING_DOME, CLOSING_DOME = -135.0, 45.0
#: What becomes of a bent lattice in its plane: it stretches as it likes, or not at all.
IN_PLANE = ("free", "held")

#: Attributes of every status: its values and what they mean.
STATUS_ATTRS: dict[str, Any] = {
    "flag_values": [int(status) for status in SolveStatus],
    "flag_meanings": FLAG_MEANINGS,
}


@dataclass(frozen=True)
class Variable:
    """One variable: `dtype` is "float64", "int32", "int8" or "text".

    `units` is "" for text, and for values whose units differ along a dimension; their `comment`
    then names the coordinate that holds the units. A `partial` variable of samples may be nan where
    the sample converged.
    """

    name: str
    dims: tuple[str, ...]
    dtype: str
    units: str
    long_name: str
    optional: bool = False
    attrs: Mapping[str, Any] = field(default_factory=dict)
    partial: bool = False


@dataclass(frozen=True)
class Schema:
    """One kind of dataset: its coordinates, data variables and scalar coordinates.

    `check` raises SchemaError for a dataset whose values cannot be; names, types and units have
    been checked before.
    """

    kind: str
    version: int
    title: str
    coordinates: tuple[Variable, ...]
    variables: tuple[Variable, ...]
    check: Callable[[xr.Dataset], None]

    @property
    def name(self) -> str:
        """For instance "sweep/1"."""
        return f"{self.kind}/{self.version}"

    @property
    def all(self) -> dict[str, Variable]:
        """Every variable by name, the scalar coordinates common to all kinds included."""
        return {item.name: item for item in (*SCALARS, *self.coordinates, *self.variables)}


def statuses(dataset: xr.Dataset) -> dict[str, xr.DataArray]:
    """Statuses of a dataset by what they are of: "" for its only one, "mandrel" for
    `mandrel_status`; {} for datasets without samples."""
    return {
        str(name).removesuffix("status").removesuffix("_"): variable
        for name, variable in dataset.data_vars.items()
        if name == "status" or str(name).endswith("_status")
    }


def _scalar(name: str, units: str, long_name: str) -> Variable:
    return Variable(name, (), "float64", units, long_name, optional=True)


#: Scalar coordinates, so that stacked data stay labelled; they are columns of the catalog.
SCALARS: tuple[Variable, ...] = (
    Variable("family", (), "text", "", "isohedral family, or custom"),
    Variable("pattern", (), "text", "", "name of the scale pattern"),
    _scalar("gap", "mm", "width of the gap between scales"),
    _scalar("tile_area", "mm2", "area of a tile"),
    _scalar("scale_height", "mm", "height of the scales"),
    _scalar("substrate_thickness", "mm", "thickness of the substrate"),
    _scalar("scale_young_modulus", "MPa", "Young's modulus of the scales"),
    _scalar("scale_poisson_ratio", "1", "Poisson's ratio of the scales"),
    _scalar("substrate_young_modulus", "MPa", "Young's modulus of the substrate"),
    _scalar("substrate_poisson_ratio", "1", "Poisson's ratio of the substrate"),
    _scalar("mesh_size", "mm", "element size across the gap"),
)

#: Coordinate of all kinds that are sampled in directions.
DIRECTION = Variable("direction", ("direction",), "float64", "degree", "bending direction")
#: Coordinates of all kinds that are bent to sides.
SIDE = Variable("side", ("side",), "text", "", "side to which the sheet is bent")
SIDE_SIGN = Variable("side_sign", ("side",), "int8", "1", "sign of the curvature, scales on +n")
