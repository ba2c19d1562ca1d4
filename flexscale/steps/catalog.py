"""All steps: names, versions, typed parameters and inputs; their functions load when called.

The command line and the workflow engine need only these declarations, and start quickly.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from pydantic import BaseModel, ConfigDict

from flexscale.datasets.identity import Recipe
from flexscale.mechanics.scale_options import ScaleOptions
from flexscale.mechanics.substrate_options import SubstrateOptions
from flexscale.mesh.options import MeshOptions
from flexscale.patterns.pattern import Pattern

if TYPE_CHECKING:
    import xarray as xr

    from flexscale.steps.base import Resources


class Parameters(BaseModel):
    """Parameters common to all steps; everything the result depends on, in mm, MPa, degree.

    Attributes
    ----------
    pattern : `Pattern.to_config()`.
    mesh : `MeshOptions.to_config()`.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    pattern: dict[str, Any]
    mesh: dict[str, Any]

    def build_pattern(self) -> Pattern:
        """The pattern the parameters describe."""
        return Pattern.from_config(self.pattern)

    def build_mesh_options(self) -> MeshOptions:
        """The mesh options the parameters describe."""
        return MeshOptions(**self.mesh)

    @property
    def n_samples(self) -> int:
        """Number of equilibria to solve; 0 for what has no samples."""
        return 0

    def identity(self) -> dict[str, Any]:
        """What the recipe holds of the parameters."""
        return self.model_dump(mode="json")


class CellParameters(Parameters):
    """A pattern and its mesh options, nothing else."""


class NativeParameters(Parameters):
    """Also substrate and scale options: parameters of what the native model computes."""

    substrate: dict[str, Any] = SubstrateOptions().to_config()
    scales: dict[str, Any] = ScaleOptions().to_config()

    def build_substrate_options(self) -> SubstrateOptions:
        """The substrate options the parameters describe."""
        return SubstrateOptions(**self.substrate)

    def build_scale_options(self) -> ScaleOptions:
        """The scale options the parameters describe."""
        return ScaleOptions(**self.scales)


class TangentParameters(NativeParameters):
    """Also the directions (degree) at which the stiffness is tabulated."""

    directions: tuple[float, ...]


class SweepParameters(NativeParameters):
    """Also sides ("closing", "opening"), directions (degree), curvatures (mm-1), options.

    `symmetry` tells whether directions that the pattern makes equivalent are solved once.
    """

    sides: tuple[str, ...]
    directions: tuple[float, ...]
    curvatures: tuple[float, ...]
    symmetry: bool
    contact: dict[str, Any]
    solver: dict[str, Any]

    @property
    def n_samples(self) -> int:
        """Those of directions that symmetry does not fill."""
        from flexscale.homogenize.symmetry import find_sources

        sources = find_sources(self.build_pattern(), self.directions, self.symmetry)
        solved = {source.direction for source in sources}
        return len(self.sides) * len(solved) * len(self.curvatures)


class ShapeSample(BaseModel):
    """One deformed state: side, direction in degree, curvature in mm-1."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    side: str
    direction: float
    curvature: float


class ShapeParameters(NativeParameters):
    """Also the states to show, contact and solver options."""

    samples: tuple[ShapeSample, ...]
    contact: dict[str, Any]
    solver: dict[str, Any]

    @property
    def n_samples(self) -> int:
        """One for each state."""
        return len(self.samples)


class FitParameters(Parameters):
    """Also how samples are weighed, the energy by name, and w_biaxial (N mm3, None: default)."""

    weighting: Literal["relative", "absolute"]
    variant: Literal["tangent", "paper"]
    w_biaxial: float | None


class SheetParameters(Parameters):
    """Also sides, curvatures (mm-1), direction (degree) and sizes (mm) of a sheet between strips.

    `size` is that of its triangles.
    """

    length: float
    width: float
    curvatures: tuple[float, ...]
    direction: float
    sides: tuple[str, ...]
    size: float

    @property
    def n_samples(self) -> int:
        """One for each side and curvature."""
        return len(self.sides) * len(self.curvatures)


class TurnedSheetParameters(Parameters):
    """Also energies by name, sides, directions (degree), curvature (mm-1) and sizes (mm)."""

    length: float
    width: float
    curvature: float
    directions: tuple[float, ...]
    sides: tuple[str, ...]
    variants: tuple[Literal["tangent", "paper"], ...]
    size: float

    @property
    def n_samples(self) -> int:
        """One for each energy, side and direction."""
        return len(self.variants) * len(self.sides) * len(self.directions)


class NativeSheetParameters(NativeParameters):
    """Also sides, curvatures (mm-1), direction (degree) and sizes (mm), contact, solver options."""

    length: float
    width: float
    curvatures: tuple[float, ...]
    direction: float
    sides: tuple[str, ...]
    contact: dict[str, Any]
    solver: dict[str, Any]

    @property
    def n_samples(self) -> int:
        """One for each side and curvature."""
        return len(self.sides) * len(self.curvatures)


class NativeRigParameters(NativeParameters):
    """Also sides, shortenings and sizes (mm), direction (degree), contact, solver options."""

    length: float
    width: float
    shortenings: tuple[float, ...]
    direction: float
    sides: tuple[str, ...]
    contact: dict[str, Any]
    solver: dict[str, Any]

    @property
    def n_samples(self) -> int:
        """One for each side and shortening."""
        return len(self.sides) * len(self.shortenings)


class MandrelParameters(BaseModel):
    """A disc on the mandrel: mm, and angles in degree."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    radius: float
    hub: float
    indentation: float
    angles: tuple[float, ...]


class StageParameters(BaseModel):
    """A strip on the stage: mm, and its direction in degree."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    length: float
    width: float
    direction: float
    shortenings: tuple[float, ...]


class RigParameters(Parameters):
    """Also the devices to use, the sides to bend to, and the size of triangles (mm)."""

    sides: tuple[str, ...]
    size: float
    mandrel: MandrelParameters | None
    stage: StageParameters | None

    @property
    def n_samples(self) -> int:
        """One for each side and angle, or shortening."""
        angles = len(self.mandrel.angles) if self.mandrel else 0
        shortenings = len(self.stage.shortenings) if self.stage else 0
        return len(self.sides) * (angles + shortenings)


@dataclass(frozen=True)
class Step:
    """One kind of work.

    Attributes
    ----------
    name : also the kind of the dataset it makes, and the module that holds its function.
    version : raised whenever its numbers change.
    parameters : class of its parameters.
    inputs : names of the steps whose datasets it takes.
    parallel : whether it can use several processes.
    resumable : whether it tells of every sample that it finishes, and goes on from those kept.
    """

    name: str
    version: int
    parameters: type[Parameters]
    inputs: tuple[str, ...] = ()
    parallel: bool = False
    resumable: bool = False

    def recipe(self, parameters: Parameters) -> Recipe:
        """Identity of this step with these parameters, apart from its inputs."""
        return Recipe(self.name, self.version, parameters.identity())

    @property
    def compute(self) -> Callable[[Any, Mapping[str, xr.Dataset], Resources], xr.Dataset]:
        """Parameters, input datasets by step name, resources -> dataset of kind `name`.

        Pure: no paths, environment or clocks.
        """
        module = importlib.import_module(f"flexscale.steps.{self.name}")
        function: Callable[[Any, Mapping[str, xr.Dataset], Resources], xr.Dataset] = module.compute
        return function


STEPS: dict[str, Step] = {
    step.name: step
    for step in (
        Step("cell", 1, CellParameters),
        Step("tangent", 4, TangentParameters, inputs=("cell",)),
        Step("sweep", 3, SweepParameters, inputs=("cell",), parallel=True, resumable=True),
        Step("shape", 3, ShapeParameters, inputs=("cell",)),
        Step("fit", 2, FitParameters, inputs=("sweep", "tangent")),
        Step("sheet", 1, SheetParameters, inputs=("fit",)),
        Step("turned_sheet", 1, TurnedSheetParameters, inputs=("sweep", "tangent")),
        Step("native_sheet", 1, NativeSheetParameters, resumable=True),
        Step("rig", 1, RigParameters, inputs=("fit",)),
        Step("native_rig", 1, NativeRigParameters, resumable=True),
    )
}
