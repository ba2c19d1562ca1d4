"""From an experiment to jobs: which step runs with which parameters on which inputs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from flexscale.datasets.identity import SHORT_DIGEST, Recipe
from flexscale.patterns.pattern import Pattern
from flexscale.steps.catalog import FIGURES
from flexscale.steps.experiment import Experiment
from flexscale.steps.figures import FIGURE, figure_recipe

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
    patterns = experiment.build_patterns().values()
    return Plan(tuple(job for pattern in patterns for job in _jobs_of(pattern, experiment)))


def _jobs_of(pattern: Pattern, experiment: Experiment) -> list[Job]:
    """Jobs of one pattern: the steps the experiment wants, then its figures."""
    made: dict[str, list[Job]] = {}
    for step, block in experiment.wanted():
        sources = [job for needed in experiment.inputs(block) for job in made[needed]]
        made[step.name] = [
            _job(
                step.name,
                step.name,
                pattern,
                step.recipe(step.parameters(pattern, experiment.model, own)),
                sources,
                own.n_samples(pattern),
            )
            for own in block.one_by_one(pattern)
        ]
    figures = []
    for name in experiment.figures:
        first, *others = FIGURES[name].needs
        rest = [job for needed in others for job in made[needed]]
        figures += [
            _job(FIGURE, name, pattern, figure_recipe(name), [job, *rest]) for job in made[first]
        ]
    return [*(job for jobs in made.values() for job in jobs), *figures]


def _job(
    step: str, title: str, pattern: Pattern, recipe: Recipe, sources: list[Job], n_samples: int = 0
) -> Job:
    # Ids of inputs stand in for their content digests, which are known only once they exist.
    inputs = tuple(source.id for source in sources)
    prefix = title if step == title else f"{step}-{title}"
    job_id = f"{prefix}-{pattern.name}-{recipe.digest(inputs)[:SHORT_DIGEST]}"
    return Job(job_id, step, title, pattern.name, pattern.family, recipe, inputs, n_samples)
