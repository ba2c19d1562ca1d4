"""What a step is: a block of an experiment file, and how it becomes a dataset and figures.

The block is the step's parameters; with the pattern and the native model it makes a `Task`, which
is all that the result depends on besides its inputs.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Generic, Self, TypeVar

from flexscale.datasets.identity import Recipe
from flexscale.homogenize.checkpoint import Checkpoint
from flexscale.homogenize.native_model import NAME, NativeModel
from flexscale.patterns.pattern import Pattern
from flexscale.steps.blocks import Block

if TYPE_CHECKING:
    import xarray as xr

    from flexscale.steps.experiment import Experiment

#: Options of the native model that a step depends on: of a mesh, of a flat cell, of a bent one.
MESH = ("mesh", "solid")
FLAT = (*MESH, "substrate", "scales")
BENT = (*FLAT, "contact", "solver")


class StepBlock(Block):
    """Block of an experiment file that asks for a step.

    Class attributes
    ----------------
    takes : steps whose datasets the step takes, whatever the block says.
    silent : fields that recipes leave out where they have their default: those that came later,
        so that what was computed before keeps its identity.
    """

    takes: ClassVar[tuple[str, ...]] = ()
    silent: ClassVar[tuple[str, ...]] = ()

    @property
    def inputs(self) -> tuple[str, ...]:
        """Steps whose datasets the step takes."""
        return self.takes

    def to_config(self) -> dict[str, Any]:
        """Plain data for a recipe; the class validates it again."""
        config = self.model_dump(mode="json")
        for name in self.silent:
            if getattr(self, name) == type(self).model_fields[name].default:
                del config[name]
        return config

    def one_by_one(self, pattern: Pattern) -> tuple[Self, ...]:
        """Blocks of the jobs that it takes for a pattern, each of which makes a dataset."""
        return (self,)

    def n_samples(self, pattern: Pattern) -> int:
        """Number of equilibria to solve; 0 for what has no samples."""
        return 0

    def refuse_in(self, experiment: Experiment) -> None:
        """Refuse what does not go together with the other blocks of an experiment.

        Raises
        ------
        BadInputError, PydanticCustomError : as one sentence.
        """

    def refuse_of(self, pattern: Pattern, native: NativeModel) -> None:
        """Refuse what cannot be computed of a pattern, before anything is.

        Raises
        ------
        BadInputError : as one sentence.
        """


B = TypeVar("B", bound=StepBlock)


@dataclass(frozen=True)
class Task(Generic[B]):
    """What one step has to do: all that its result depends on besides its inputs.

    Attributes
    ----------
    pattern : the scale pattern.
    native : the native model; of its options, those that the step does not name are the default.
    block : the step's own parameters.
    config : all of these as plain data: the parameters of the recipe.
    """

    pattern: Pattern
    native: NativeModel
    block: B
    config: Mapping[str, Any]


@dataclass(frozen=True)
class Resources:
    """What the workflow layer lends to a step; none of it may change the result.

    Attributes
    ----------
    workers : number of processes the step may use.
    checkpoint : keeps finished samples; None where nothing is kept.
    on_sample : called with an event (done, total, n_failed, …) as samples finish.
    """

    workers: int = 1
    checkpoint: Checkpoint | None = None
    on_sample: Callable[[Any], None] | None = None


@dataclass(frozen=True)
class Figure:
    """One figure of an experiment: the steps whose datasets it shows, how, and its caption.

    `draw` is handed the plotting package, which loads only where something is drawn, and the
    datasets in the order of `needs`.
    """

    name: str
    needs: tuple[str, ...]
    draw: Callable[..., Any]
    caption: str


@dataclass(frozen=True)
class Step:
    """One kind of work.

    Attributes
    ----------
    name : also the kind of the dataset it makes, and the key of its block.
    version : raised whenever its numbers change.
    block : class of its block.
    meaning : of the block, a few words; shown by `flexscale run --fields`.
    compute : task, input datasets by step name (see `inputs_by_step`), resources -> dataset of kind
        `name`. Pure: no paths, environment or clocks. It loads what it computes with when called.
    native : options of the native model that the result depends on.
    figures : of its dataset.
    implied : whether it is done, with its default block, wherever another step takes its dataset.
    parallel : whether it can use several processes.
    resumable : whether it tells of every sample that it finishes, and goes on from those kept.
    """

    name: str
    version: int
    block: type[StepBlock]
    meaning: str
    compute: Callable[[Task[Any], Mapping[str, xr.Dataset], Resources], xr.Dataset]
    native: tuple[str, ...] = MESH
    figures: tuple[Figure, ...] = ()
    implied: bool = False
    parallel: bool = False
    resumable: bool = False

    def parameters(self, pattern: Pattern, native: NativeModel, block: StepBlock) -> dict[str, Any]:
        """What the recipe holds: mm, MPa, degree."""
        options = native.to_config(self.native) if self.native else {}
        own = {"pattern": pattern.to_config(), **options}
        return own | block.to_config()

    def recipe(self, parameters: Mapping[str, Any]) -> Recipe:
        """Identity of this step with these parameters, apart from its inputs."""
        return Recipe(self.name, self.version, parameters)

    def task(self, parameters: Mapping[str, Any]) -> Task[Any]:
        """The task that the parameters of a recipe describe.

        Raises
        ------
        ValidationError, BadInputError : they are of another version of the step.
        """
        model = (NAME, *BENT)
        own = {key: value for key, value in parameters.items() if key not in (*model, "pattern")}
        return Task(
            Pattern.from_config(parameters["pattern"]),
            NativeModel.from_config({key: parameters[key] for key in model if key in parameters}),
            self.block.model_validate(own),
            dict(parameters),
        )
