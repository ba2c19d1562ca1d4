"""What every energy promises: derivatives, a rest state without stress, the same after a motion.

`CASES` lists all energies of elements; one that is added to `mechanics` has to be added here. The
contact between scales has pairs that change with the state, and the same tests in
`physics/test_contact.py` and `test_prism_contact.py`.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from flexscale import mechanics
from tests.derivatives import directional_difference, full_hessian, relative_error
from tests.mechanics import test_edge_angles as linear
from tests.mechanics import test_energies as native
from tests.mechanics import test_sheet_elements as sheets
from tests.mechanics import test_wedges as wedges

ALL = None  # all rows
C1_POSITIONS = (0, 3, 6, 12, 15, 18)


@dataclass(frozen=True)
class Case:
    """An energy on a few elements.

    Attributes
    ----------
    build : makes it, and its rest state (n, 3).
    positions : rows that a translation moves; others are gradients, or angles.
    turning : rows that a rotation turns.
    sizes : of random displacements at which derivatives are compared.
    accuracy : of derivatives against differences.
    """

    build: Callable[[], tuple[Any, np.ndarray]]
    positions: tuple[int, ...] | None = ALL
    turning: tuple[int, ...] | None = ALL
    sizes: tuple[float, ...] = (0.01, 0.05)
    accuracy: float = 1e-8

    @property
    def rows(self) -> tuple[tuple[int, ...] | None, tuple[int, ...] | None]:
        """Rows that turn, and rows that move."""
        return self.turning, self.positions


SIX = tuple(range(6))
CASES = {
    "substrate, layers": Case(native.build_shell, C1_POSITIONS),
    "substrate, turn": Case(lambda: native.build_shell("turn"), C1_POSITIONS),
    "tets": Case(native.build_tets),
    "quadratic tet": Case(native.build_quadratic_tet),
    "wedges": Case(wedges.build_wedges, accuracy=1e-7),
    "edge angles": Case(linear.build_bending, SIX, SIX, (0.01, 0.1, 0.4)),
    "an edge that does not turn": Case(
        lambda: linear.build_bending((0.5, 0.0, 1.0)), SIX, SIX, (0.01, 0.1, 0.4)
    ),
    "membrane": Case(linear.build_membrane, SIX, SIX, (0.01, 0.1, 0.4)),
    "C1 sheet of a law, flat": Case(sheets.build_shell, C1_POSITIONS, accuracy=1e-6),
    "C1 sheet of a law, curved": Case(
        lambda: sheets.build_shell(True), C1_POSITIONS, accuracy=1e-6
    ),
    "triangles of a law": Case(sheets.build_triangle, SIX, SIX, (0.01, 0.1), accuracy=1e-6),
}


@pytest.fixture(params=CASES)
def case(request: pytest.FixtureRequest) -> Case:
    return CASES[request.param]


def test_every_energy_is_here() -> None:
    found = set()
    for module in pkgutil.iter_modules(mechanics.__path__):
        home = importlib.import_module(f"flexscale.mechanics.{module.name}")
        for name, item in inspect.getmembers(home, inspect.isclass):
            if item.__module__ == home.__name__ and hasattr(item, "energy_parts"):
                found.add(name)
    built = {type(case.build()[0]).__name__ for case in CASES.values()}
    # Elements of any shape: those of a joint's section have their own test.
    assert found - {"Energy", "PrismContact", "ScaleContact", "NeoHookeanElements"} == built


def test_derivatives_match_differences(case: Case) -> None:
    """Gradient and Hessian at random deformed states, folds of a radian among them."""
    energy, rest = case.build()
    for size in case.sizes:
        generator = np.random.default_rng(3)
        y = rest + size * generator.normal(size=rest.shape)
        direction = generator.normal(size=rest.shape)

        def gradient(s: float, y: np.ndarray = y, along: np.ndarray = direction) -> np.ndarray:
            out = np.zeros_like(y)
            energy.add_gradient(y + s * along, out)
            return out.ravel()

        slope = directional_difference(
            lambda s, y=y, along=direction: energy.energy_parts(y + s * along).sum(), 1e-4
        )
        assert relative_error(gradient(0.0) @ direction.ravel(), slope) < case.accuracy
        curve = directional_difference(gradient, 1e-4)
        product = full_hessian(energy, y) @ direction.ravel()
        assert relative_error(product, curve) < case.accuracy


def test_rest_is_free_of_stress(case: Case) -> None:
    energy, rest = case.build()
    gradient = np.zeros_like(rest)
    energy.add_gradient(rest, gradient)
    assert energy.energy_parts(rest).sum() < 1e-25
    assert np.abs(gradient).max() < 1e-11


def test_rigid_motion_changes_nothing(case: Case) -> None:
    """Energy is invariant, forces turn along; gradients do not translate, couples stay."""
    energy, rest = case.build()
    y = rest + 0.05 * np.random.default_rng(5).normal(size=rest.shape)
    turn = Rotation.random(random_state=1).as_matrix()
    moved = y.copy()
    turning, positions = (slice(None) if rows is ALL else list(rows) for rows in case.rows)
    moved[turning] = y[turning] @ turn.T
    moved[positions] += [3.0, -2.0, 7.0]
    before, after = np.zeros_like(y), np.zeros_like(y)
    energy.add_gradient(y, before)
    energy.add_gradient(moved, after)
    before[turning] = before[turning] @ turn.T
    assert relative_error(energy.energy_parts(moved), energy.energy_parts(y)) < 1e-10
    assert relative_error(after, before) < 1e-10
