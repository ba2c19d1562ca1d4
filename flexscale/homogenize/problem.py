"""What a native model is to the rest of the package: a cell that can be bent.

The door for native models: whoever follows curvatures, measures the flat cell's stiffness or finds
out when scales meet asks for this and no more. `build.build_problem` makes one of a name.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from flexscale.arrays import FloatArray, IntArray
from flexscale.mechanics.contact_gaps import LinearGaps
from flexscale.solve.negative_modes import System
from flexscale.solve.newton import Objective


class Contact(Protocol):
    """What keeps scales apart: a `mechanics.barrier.Barrier` between things with positions."""

    activation_distance: float
    stiffness: float

    def positions(self, y: FloatArray) -> FloatArray:
        """(n, 3) of what can touch, mm; linear in y (n_rows, 3)."""

    def gaps(self, y: FloatArray, reach: float) -> LinearGaps:
        """Distances below `reach` [mm], linear around y."""

    def spread(self, forces: FloatArray, n_rows: int) -> FloatArray:
        """(n_rows, 3) forces on rows of y for those (n, 3) on what can touch."""

    def push(self, distance: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Force at a distance, and how it grows: `Barrier.push`."""

    def distance_at(self, force: FloatArray) -> FloatArray:
        """Distance at a force: `Barrier.distance_at`."""

    def free_share(self, start: FloatArray, end: FloatArray) -> float:
        """Share of the straight way between two y on which nothing passes through."""

    def intersects(self, y: FloatArray) -> bool:
        """Whether things have passed through one another."""

    def smallest_distance(self, y: FloatArray, reach: float) -> float:
        """Smallest distance, mm; infinite beyond `reach`."""

    def active_pairs(self, y: FloatArray) -> int:
        """How many pairs of features are nearer than d_hat."""

    def force(self, y: FloatArray) -> float:
        """Sum of forces, as lengths of vectors, N."""


class Bent(Objective, Protocol):
    """A cell under one bend."""

    def gradient_rate(self, state: Any) -> FloatArray:
        """(n_active,) d(dE/dz)/dkappa at fixed z."""

    def moment(self, state: Any) -> float:
        """M = (1/A) dE/dkappa at fixed z [N]."""

    def steady(self, state: Any) -> bool:
        """Whether `keep_apart` can start from a state, having factorized there what it needs."""


@dataclass(frozen=True)
class FlatBends:
    """How the flat cell answers to unit kappa_xx, kappa_yy and 2 kappa_xy.

    Attributes
    ----------
    state : at rest.
    rates : three (n_rows, 3) dy/dk of a cell that only bends.
    fixed : (3, 3) second derivatives of the energy by k with all unknowns held, N mm3.
    loads : three (n_active,) second derivatives by k and the unknowns.
    relaxed : three (n_active,) rates of the unknowns that free the cell of these.
    """

    state: Any
    rates: list[FloatArray]
    fixed: FloatArray
    loads: list[FloatArray]
    relaxed: list[FloatArray]


class Bendable(Protocol):
    """Whatever can be followed along a line of bends: a cell, or a sheet between end strips.

    Attributes
    ----------
    embedding : unknowns (`rest`, `mean_offset`) and where they place world vectors (`world_map`).
    active : unknowns that are sought; S, the in-plane strain, comes last.
    contact : None without scales or if switched off.
    barrier_stiffness : N mm-3, with which every line of samples begins.
    part_names : names of the energy parts.
    largest_step : mm-1, of the curvature from one equilibrium to the next.
    area : rest area, mm2; gap : mm, between scales at rest.
    """

    embedding: Any
    active: IntArray
    barrier_stiffness: float
    part_names: tuple[str, ...]
    largest_step: float
    area: float

    @property
    def contact(self) -> Contact | None:
        """What keeps scales apart."""

    @property
    def gap(self) -> float:
        """mm, the narrowest between scales at rest."""

    @property
    def widest_gap(self) -> float:
        """mm, the widest between scales at rest."""

    @property
    def system(self) -> System:
        """Linear systems on the present pattern of nonzeros."""

    def bent(self, bend: Any) -> Bent:
        """The energy as a function of z under a bend."""

    def fit_room(self, z: FloatArray, bend: Any) -> None:
        """Forget what earlier states left: results depend on z alone."""

    def facts_of(self, state: Any) -> dict[str, Any]:
        """What a sample of a sweep tells of a state beyond what all models tell."""


class Problem(Bendable, Protocol):
    """A pattern's cell in one native model."""

    @property
    def n_scales(self) -> int:
        """In the cell."""

    @property
    def facts(self) -> dict[str, Any]:
        """What results depend on beyond pattern and options, for their configuration."""

    @property
    def doubts(self) -> tuple[str, ...]:
        """Sentences on what of the pattern the model was not compared with solids for."""

    @property
    def parts(self) -> tuple[Callable[..., Problem], tuple[Any, ...]]:
        """What makes it again in another process, picklable."""

    def flat_bends(self) -> FlatBends:
        """Answers of the flat cell; its system is left factorized at rest."""

    def display(self) -> Any:
        """What places everything that one can see of a cell: `embedding.display.Display`."""
