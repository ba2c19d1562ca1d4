"""Experiment files: read, checked completely, and resolved before anything is computed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import ValidationError, create_model, field_validator, model_validator
from pydantic_core import PydanticCustomError

from flexscale.checks import choice
from flexscale.errors import BadInputError, ConfigError, SchemaError, shown
from flexscale.homogenize.native_model import NATIVE_MODELS, NativeModel
from flexscale.mechanics.contact_options import ContactOptions
from flexscale.mechanics.scale_options import ScaleOptions
from flexscale.mechanics.substrate_options import SubstrateOptions
from flexscale.mesh.options import MeshOptions
from flexscale.mesh.solid_options import SolidOptions
from flexscale.names import require_name
from flexscale.patterns.pattern import Pattern
from flexscale.solve.solver_options import SolverOptions
from flexscale.steps.blocks import Block, PatternBlock
from flexscale.steps.catalog import FIGURES, STEPS
from flexscale.steps.option_blocks import Contact, Mesh, Scales, Solid, Solver, Substrate
from flexscale.steps.quantities import declared, several, within
from flexscale.steps.step import Step, StepBlock
from flexscale.steps.yaml_file import read_yaml

FigureName = Annotated[str, within(choice("figure", FIGURES), "figure")]
NativeName = Annotated[str, within(choice("native model", NATIVE_MODELS), "native model")]
_MOST_MISTAKES = 20  # of a file, told at once


class Experiment(Block):
    """An experiment: patterns, options and figures; `ExperimentFile` adds the blocks of steps."""

    patterns: dict[str, PatternBlock] = declared(..., "name and description of each pattern")
    native: NativeName = declared(
        NATIVE_MODELS[0],
        "joints, of what is printed; shell, the paper's; solid, to compare with",
    )
    mesh: Mesh = declared(MeshOptions(), "mesh sizes")
    contact: Contact = declared(ContactOptions(), "how scales touch")
    substrate: Substrate = declared(SubstrateOptions(), "elements of the substrate")
    scales: Scales = declared(ScaleOptions(), "how scales are modeled")
    solid: Solid = declared(SolidOptions(), "how a solid substrate is graded")
    solver: Solver = declared(SolverOptions(), "how equilibria are sought")
    figures: Annotated[tuple[FigureName, ...], several] = declared(
        (), "figures to draw for each pattern"
    )

    @field_validator("patterns")
    @classmethod
    def _some_pattern_with_a_name(
        cls, patterns: dict[str, PatternBlock]
    ) -> dict[str, PatternBlock]:
        if not patterns:
            raise PydanticCustomError("empty", "an experiment needs at least one pattern", {})
        named: dict[str, PatternBlock] = {}
        for given, block in patterns.items():
            try:
                name = require_name(given, "pattern")
            except SchemaError as error:
                raise PydanticCustomError("name", "{said}", {"said": str(error)}) from error
            for other in named:
                if other.casefold() == name.casefold():
                    raise PydanticCustomError(
                        "name",
                        "the patterns {first} and {second} would share their files where file "
                        "systems do not tell cases apart: call one of them otherwise",
                        {"first": repr(other), "second": repr(name)},
                    )
            named[name] = block
        return named

    @model_validator(mode="after")
    def _all_goes_together(self) -> Self:
        _ = self.model  # refuses options that it does not have
        for figure in self.figures:
            self._require(FIGURES[figure].needs[0], f"the figure {figure!r}")
        for step, block in self.asked():
            for needed in self.inputs(block):
                if not STEPS[needed].implied:
                    self._require(needed, f"`{step.name}`")
            block.refuse_in(self)
        return self

    def _require(self, step: str, who: str) -> None:
        if getattr(self, step) is None:
            raise PydanticCustomError(
                "block",
                "{who} needs the block `{block}`, which is missing",
                {"who": who, "block": step},
            )

    @property
    def model(self) -> NativeModel:
        """The native model, with all its options."""
        return NativeModel(
            self.native,
            mesh=self.mesh,
            substrate=self.substrate,
            scales=self.scales,
            contact=self.contact,
            solver=self.solver,
            solid=self.solid,
        )

    def block(self, step: str) -> Any:
        """What the file says of a step; None where it says nothing."""
        return getattr(self, step)

    def inputs(self, block: StepBlock) -> tuple[str, ...]:
        """Steps whose datasets a block's step takes; `cell` is what the native model is made of."""
        of_model = self.model.input
        return tuple(of_model if name == "cell" else name for name in block.inputs)

    def asked(self) -> Iterator[tuple[Step, StepBlock]]:
        """Steps that have a block, with it, in the order of the catalog."""
        for name, step in STEPS.items():
            block = getattr(self, name)
            if block is not None:
                yield step, block

    def wanted(self) -> Iterator[tuple[Step, StepBlock]]:
        """As `asked`, with the steps that others imply, and the cell of every pattern."""
        asked = {step.name: block for step, block in self.asked()}
        needed = {self.model.input}.union(*(self.inputs(block) for block in asked.values()))
        for name, step in STEPS.items():
            if name in asked:
                yield step, asked[name]
            elif name in needed:
                yield step, step.block()

    def build_patterns(self) -> dict[str, Pattern]:
        """Every pattern, built, and checked for all that is to be computed of it.

        Raises
        ------
        BadInputError : polygons, sizes or a family are not usable, a curvature folds the sheet, a
            mesh would be too large; names the pattern.
        """
        built = {}
        for name, description in self.patterns.items():
            try:
                built[name] = description.build(name)
                for _, block in self.wanted():
                    block.refuse_of(built[name], self.model)
            except BadInputError as error:
                raise type(error)(f"patterns.{name}: {error}") from error
        return built


#: An experiment with the blocks of all steps: what a file may say.
ExperimentFile: type[Experiment] = create_model(
    "ExperimentFile",
    __base__=Experiment,
    __module__=__name__,
    **{step.name: (step.block | None, declared(None, step.meaning)) for step in STEPS.values()},  # type: ignore[call-overload]
)


def parse_experiment(content: Any, where: str) -> Experiment:
    """Experiment from plain data.

    Parameters
    ----------
    content : what the file held.
    where : name of the file, for messages.

    Raises
    ------
    ConfigError : one line per mistake: place, mistake and what is allowed.
    BadInputError : mesh, contact or solver options contradict each other, or the sweep is too
        small for a fit.
    """
    if not isinstance(content, dict):
        raise ConfigError(f"{where} holds no experiment: it needs at least the key 'patterns'.")
    try:
        return ExperimentFile.model_validate(content)
    except ValidationError as error:
        mistakes = error.errors(include_url=False)
        lines = [f"{where}: {_sentence(dict(item))}" for item in mistakes[:_MOST_MISTAKES]]
        if len(mistakes) > _MOST_MISTAKES:
            lines.append(f"{where}: and {len(mistakes) - _MOST_MISTAKES} more mistakes.")
        raise ConfigError("\n".join(lines)) from error
    except BadInputError as error:  # options and fits check themselves
        raise type(error)(f"{where}: {error}") from error


def load_experiment(path: Path) -> Experiment:
    """Experiment file, read and checked.

    Raises
    ------
    ConfigError : the file cannot be read, is no YAML, or says something that is not allowed.
    """
    return parse_experiment(read_yaml(path), str(path))


def _sentence(item: dict[str, Any]) -> str:
    # Blocks of options are one value to pydantic: which of them is meant is told beside it.
    option = item.get("ctx", {}).get("option")
    loc = (*item["loc"], *([option] if option else []))
    parts = (str(part) if isinstance(part, int) else shown(part)[1:-1] for part in loc)
    place = ".".join(parts) or "top level"
    message = str(item["msg"])
    given = item.get("input")
    said = isinstance(given, int | float | str) and shown(given) not in message
    # Where the message holds the value or the key already, it is not told again.
    if said and item["type"] not in ("missing", "unknown_key", "bounds"):
        message += f", not {shown(given)}"
    return f"{place}: {message.rstrip('.')}."
