"""From an experiment to jobs: which step runs with which parameters on which inputs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from flexscale.datasets.identity import SHORT_DIGEST, Recipe
from flexscale.patterns.pattern import Pattern
from flexscale.steps.catalog import STEPS
from flexscale.steps.experiment import Experiment, TangentBlock
from flexscale.steps.figures import FIGURE, FIGURES, figure_recipe

if TYPE_CHECKING:
    from flexscale.datasets.store import Entry, Store


@dataclass(frozen=True)
class Job:
    """One piece of work: a step, which makes a dataset, or a figure, drawn from some.

    Attributes
    ----------
    id : unique and file-safe, "sweep-squares-3f9c2e71b0aa"; the digits change with anything the
        result depends on.
    step : name of the step, or "figure".
    title : for people, "sweep".
    pattern, family : of the scale pattern.
    recipe : its identity apart from its inputs.
    inputs : ids of the jobs whose results it takes.
    n_samples : number of equilibria it solves; 0 for what has no samples.
    """

    id: str
    step: str
    title: str
    pattern: str
    family: str
    recipe: Recipe
    inputs: tuple[str, ...]
    n_samples: int = 0

    @property
    def label(self) -> str:
        """For people: "sweep        IH20/hexagon"."""
        figure = f" {self.title}" if self.step == FIGURE else ""
        return f"{self.step:<12} {self.family}/{self.pattern}{figure}"


@dataclass(frozen=True)
class Plan:
    """All jobs of an experiment; every job comes after its inputs."""

    jobs: tuple[Job, ...]

    def __iter__(self) -> Iterator[Job]:
        return iter(self.jobs)

    def __getitem__(self, job_id: str) -> Job:
        return next(job for job in self.jobs if job.id == job_id)

    def needed_for(self, job: Job) -> Plan:
        """The jobs that `job` takes results from, directly or not, in order."""
        wanted = set(job.inputs)
        for candidate in reversed(self.jobs):
            if candidate.id in wanted:
                wanted.update(candidate.inputs)
        return Plan(tuple(candidate for candidate in self.jobs if candidate.id in wanted))

    def stored(self, store: Store) -> dict[str, Entry]:
        """Job id -> dataset, for the jobs whose dataset is stored and sound.

        Raises
        ------
        IntegrityError : a dataset is there but damaged.
        """
        found: dict[str, Entry] = {}
        for job in self.jobs:
            if job.step == FIGURE or not all(needed in found for needed in job.inputs):
                continue
            entry = store.lookup(job.step, job.recipe, [found[needed] for needed in job.inputs])
            if entry is not None:
                found[job.id] = entry
        return found


def build_plan(experiment: Experiment) -> Plan:
    """Jobs of an experiment; builds every pattern, so all bad input is refused here.

    Raises
    ------
    BadInputError : a pattern cannot be used.
    """
    mesh = experiment.mesh.to_config()
    patterns = experiment.build_patterns().values()
    return Plan(tuple(job for pattern in patterns for job in _jobs_of(pattern, experiment, mesh)))


def _jobs_of(pattern: Pattern, experiment: Experiment, mesh: dict[str, object]) -> list[Job]:
    """Jobs of one pattern: the steps the experiment has blocks for, then its figures."""
    made: dict[str, Job] = {}
    for name, extra in _wanted_steps(experiment).items():
        step = STEPS[name]
        parameters = step.parameters.model_validate(
            {"pattern": pattern.to_config(), "mesh": mesh, **extra}
        )
        recipe, sources = step.recipe(parameters), [made[needed] for needed in step.inputs]
        made[name] = _job(name, name, pattern, recipe, sources, parameters.n_samples)
    figures = [
        _job(FIGURE, name, pattern, figure_recipe(name), [made[n] for n in FIGURES[name].needs])
        for name in experiment.figures
    ]
    return [*made.values(), *figures]


def _wanted_steps(experiment: Experiment) -> dict[str, dict[str, object]]:
    """Step name -> parameters besides pattern and mesh."""
    native: dict[str, object] = {
        "substrate": experiment.substrate.to_config(),
        "scales": experiment.scales.to_config(),
    }
    options: dict[str, object] = native | {
        "contact": experiment.contact.to_config(),
        "solver": experiment.solver.to_config(),
    }
    wanted: dict[str, dict[str, object]] = {"cell": {}}
    if experiment.tangent or experiment.fit or experiment.turned_sheet:
        block = experiment.tangent or TangentBlock()
        wanted["tangent"] = block.model_dump() | native
    if experiment.sweep is not None:
        wanted["sweep"] = experiment.sweep.model_dump() | options
    if experiment.fit is not None:
        wanted["fit"] = experiment.fit.model_dump()
    if experiment.sheet is not None:
        wanted["sheet"] = experiment.sheet.model_dump()
    if experiment.turned_sheet is not None:
        wanted["turned_sheet"] = experiment.turned_sheet.model_dump()
    if experiment.native_sheet is not None:
        wanted["native_sheet"] = experiment.native_sheet.model_dump() | options
    if experiment.rigs is not None:
        wanted["rig"] = experiment.rigs.model_dump()
    if experiment.native_rig is not None:
        wanted["native_rig"] = experiment.native_rig.model_dump() | options
    if experiment.shapes:
        samples: object = [shape.model_dump() for shape in experiment.shapes]
        wanted["shape"] = {"samples": samples} | options
    return wanted


def _job(
    step: str, title: str, pattern: Pattern, recipe: Recipe, sources: list[Job], n_samples: int = 0
) -> Job:
    # Ids of inputs stand in for their content digests, which are known only once they exist.
    inputs = tuple(source.id for source in sources)
    prefix = title if step == title else f"{step}-{title}"
    job_id = f"{prefix}-{pattern.name}-{recipe.digest(inputs)[:SHORT_DIGEST]}"
    return Job(job_id, step, title, pattern.name, pattern.family, recipe, inputs, n_samples)
