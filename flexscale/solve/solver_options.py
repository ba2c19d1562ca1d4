"""How an equilibrium is sought: what a user may choose, and how long a sample may take."""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from flexscale.checks import checked, choice, number, whole
from flexscale.solve.linear import LINEAR_SOLVERS

TIME_LIMIT = 1800.0  # s, processor time; samples of cells take seconds, of large sheets minutes
NOT_IN_EXPERIMENTS = {"experiment": False}  # of a field: the machine's and the solver's own


@checked(
    tolerance=number("1", 1e-15, 1.0, above=0.0, name="solver tolerance"),
    max_iterations=whole(1, 100_000, "solver option max_iterations"),
    linear_solver=choice("linear solver", LINEAR_SOLVERS),
    time_limit=number("s", 1e-3, 1e9, above=0.0, name="solver option time_limit"),
)
@dataclass(frozen=True)
class SolverOptions:
    """How an equilibrium is sought.

    Attributes
    ----------
    tolerance : Newton decrement at which a state is accepted, relative to its energy.
    max_iterations : factorizations per equilibrium.
    linear_solver : "auto", "pardiso" or "superlu".
    time_limit : s, processor time that one sample may take until it is given up.
    deadline : s, of the clock of processor time, at which the present sample is given up, and of a
        clock that is faster to read, before which it cannot be.
    """

    tolerance: float = 1e-9
    max_iterations: int = 60
    linear_solver: str = field(default="auto", metadata=NOT_IN_EXPERIMENTS)
    time_limit: float = TIME_LIMIT
    deadline: tuple[float, float] = field(
        default=(np.inf, np.inf), repr=False, compare=False, metadata=NOT_IN_EXPERIMENTS
    )

    def to_config(self) -> dict[str, Any]:
        """Plain numbers and text, what results depend on: the usual time limit is left out, since
        a sample that it ends says so, and the linear solver."""
        config = asdict(self)
        del config["linear_solver"], config["deadline"]
        if self.time_limit == TIME_LIMIT:
            del config["time_limit"]
        return config

    def for_a_sample(self) -> SolverOptions:
        """The same, with the time of a sample running from now."""
        clocks = (time.process_time(), time.monotonic())
        return replace(self, deadline=(clocks[0] + self.time_limit, clocks[1] + self.time_limit))

    @property
    def out_of_time(self) -> bool:
        """Whether the time of the present sample is over."""
        soonest = time.monotonic() > self.deadline[1]  # a solver runs on one thread
        return soonest and time.process_time() > self.deadline[0]
