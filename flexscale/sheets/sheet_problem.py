"""A held and loaded sheet as a problem for `solve.newton`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding import pull_kernels as kernels
from flexscale.embedding.pair_pattern import element_pattern, find_slots, number_pairs
from flexscale.errors import BadInputError
from flexscale.mechanics.energy import ALL, CONTACT, NOTHING, block_pairs, project_blocks
from flexscale.sheets.conditions import Conditions
from flexscale.sheets.grips import Grip
from flexscale.solve.linear import build_factorization
from flexscale.solve.unconstrained import UnconstrainedSystem


@dataclass(frozen=True)
class SheetState:
    """Energy and forces of a sheet at a state z.

    Attributes
    ----------
    z : (n_z,) rows and unknowns of grips.
    y : (n_rows, 3).
    strain_energy : N mm.
    energy : N mm, with the potential of the loads.
    forces : (n_rows, 3) derivatives of the strain energy.
    full_gradient : (n_z,) of the energy; where z is held, the reactions.
    gradient : (n_active,).
    """

    z: FloatArray
    y: FloatArray
    strain_energy: float
    energy: float
    forces: FloatArray
    full_gradient: FloatArray
    gradient: FloatArray


class SheetProblem:
    """Potential energy of a sheet under conditions at one load factor: an `Objective`.

    Parameters
    ----------
    conditions : what holds and loads the sheet.
    linear_solver : "auto", "pardiso" or "superlu".

    Raises
    ------
    BadInputError : all is held, or a load acts on what a grip carries.

    Attributes
    ----------
    factor : load factor; change it with `start`, which also moves what is held.
    """

    def __init__(self, conditions: Conditions, linear_solver: str = "auto") -> None:
        self.conditions, self.sheet = conditions, conditions.sheet
        self.factor = 1.0
        self.n_rows = len(self.sheet.rest)
        self.rest = np.zeros_like(conditions.target)
        self.rest[: 3 * self.n_rows] = self.sheet.rest.ravel()
        self.active = np.flatnonzero(~conditions.held)
        if not len(self.active):
            raise BadInputError("All of the sheet is held: leave something free to move.")
        carried = [grip.rows for grip in conditions.grips]
        if carried and conditions.row_loads[np.concatenate(carried)].any():
            raise BadInputError(
                "A load acts on a part of the sheet that a grip carries: load the grip instead, by "
                "a force or a moment on its unknowns."
            )
        self.shift_mode = np.zeros(len(self.active))
        # Energies below this are rounding: strains of 1e-12.
        self.energy_floor = 1e-24 * self.sheet.area * self.sheet.energy.law.stiffness
        self._analyze(linear_solver)

    def _analyze(self, linear_solver: str) -> None:
        position = np.full(len(self.rest), -1, dtype=np.int64)
        position[self.active] = np.arange(len(self.active))
        self._number_columns(position)
        energy = self.sheet.energy
        keys, element_pairs, flips = number_pairs([energy], self.n_rows)
        self._pairs = np.stack(np.divmod(keys, self.n_rows), axis=1)
        self._element_pairs, self._flips = element_pairs[0], flips[0]
        i, j = block_pairs(energy.vectors.shape[1])
        # A row that an element names twice meets itself in block (i, j) and in (j, i).
        self._doubled = (energy.vectors[:, i] == energy.vectors[:, j]) & (i != j)
        indptr, indices = element_pattern(
            self._row_indptr, self._columns, self._pairs, len(self.active)
        )
        self._pair_indptr, self._slots = find_slots(
            self._pairs, self._row_indptr, self._columns, indptr, indices
        )
        self._n_values = len(indices)
        self._grip_slots = [self._slots_of(q, indptr, indices) for q in self._grip_positions]
        self.system = UnconstrainedSystem(
            build_factorization(indptr, indices, linear_solver), indptr[:-1]
        )
        self._kept: tuple[SheetState | None, FloatArray] = (None, np.zeros(0))

    def _number_columns(self, position: IntArray) -> None:
        """Unknowns that each row depends on, and their constant derivatives."""
        widths = np.full(self.n_rows, 3)
        for grip in self.conditions.grips:
            widths[grip.rows] = grip.motion.n_unknowns
        self._row_indptr = np.concatenate([[0], np.cumsum(widths)])
        places = np.full(self._row_indptr[-1], -1, dtype=np.int64)
        self._jacobian = np.zeros((self._row_indptr[-1], 3))
        gripped = np.zeros(self.n_rows, dtype=bool)
        self._grip_columns, self._grip_positions = [], []
        for grip, start in zip(self.conditions.grips, self.conditions.grip_start, strict=True):
            gripped[grip.rows] = True
            q = start + np.arange(grip.motion.n_unknowns)
            columns = self._row_indptr[grip.rows][:, None] + np.arange(len(q))
            places[columns] = q
            self._grip_columns.append(columns)
            self._grip_positions.append(position[q])
        own = np.flatnonzero(~gripped)
        for c in range(3):
            places[self._row_indptr[own] + c] = 3 * own + c
            self._jacobian[self._row_indptr[own] + c, c] = 1.0
        self._columns = position[places]

    @staticmethod
    def _slots_of(q: IntArray, indptr: IntArray, indices: IntArray) -> IntArray:
        """(k, k) slots of pairs of a grip's unknowns; past the end below the diagonal."""
        slots = np.full((len(q), len(q)), len(indices), dtype=np.int64)
        for i, row in enumerate(q):
            for j, column in enumerate(q):
                if 0 <= row <= column:
                    part = indices[indptr[row] : indptr[row + 1]]
                    slots[i, j] = indptr[row] + np.searchsorted(part, column)
        return slots

    def _grips(self, z: FloatArray) -> Iterator[tuple[Grip, FloatArray, int]]:
        """Grips, their unknowns, and where these begin in z."""
        for grip, start in zip(self.conditions.grips, self.conditions.grip_start, strict=True):
            yield grip, z[start : start + grip.motion.n_unknowns], start

    def start(self, factor: float, z: FloatArray | None = None) -> FloatArray:
        """Set the load factor; returns z (rest without) with all that is held in its place."""
        self.factor = factor
        z = self.rest.copy() if z is None else z.copy()
        held = self.conditions.held
        z[held] = self.rest[held] + factor * (self.conditions.target - self.rest)[held]
        for grip, q, _ in self._grips(z):
            z[: 3 * self.n_rows].reshape(-1, 3)[grip.rows] = grip.place(q)
        return z

    def evaluate(self, z: FloatArray) -> SheetState:
        """Energy and gradient at z; energy is infinite where the sheet is degenerate."""
        z = z.copy()
        y = z[: 3 * self.n_rows].reshape(-1, 3)
        for grip, q, _ in self._grips(z):
            y[grip.rows] = grip.place(q)
        strain_energy = float(self.sheet.energy.energy_parts(y).sum())
        forces, gradient = np.zeros_like(y), np.zeros_like(z)
        work = self.factor * float(self.conditions.load @ (z - self.rest))
        if np.isfinite(strain_energy):
            self.sheet.energy.add_gradient(y, forces)
            gradient[: forces.size] = forces.ravel()
            for grip, q, first in self._grips(z):
                pulled = np.einsum("mkc,mc->k", grip.jacobian(q), forces[grip.rows])
                gradient[first : first + len(q)] = pulled
            gradient -= self.factor * self.conditions.load
        energy = strain_energy - work
        return SheetState(z, y, strain_energy, energy, forces, gradient, gradient[self.active])

    def hessian_values(self, state: SheetState, project: str = NOTHING) -> FloatArray:
        """(nnz,) upper triangle of d2E/dz2, or with elements' positive parts; no contact here."""
        if project == CONTACT:
            project = NOTHING
        if project == NOTHING and self._kept[0] is state:
            return self._kept[1]
        energy = self.sheet.energy
        paired = np.zeros((len(self._pairs), 3, 3))
        for part, blocks in energy.hessian_chunks(state.y):
            if project == ALL:
                blocks = project_blocks(blocks, energy.vectors.shape[1])
            doubled = np.nonzero(self._doubled[part])
            blocks[doubled] += np.swapaxes(blocks[doubled], -1, -2)
            kernels.gather(blocks, self._element_pairs[part], self._flips[part], paired)
        jacobian = self._jacobian.copy()
        for (grip, q, _), columns in zip(self._grips(state.z), self._grip_columns, strict=True):
            jacobian[columns] = grip.jacobian(q)
        values = np.zeros(self._n_values + 1)  # the last slot swallows entries that are not kept
        kernels.pull_pairs(
            self._pairs, paired, self._row_indptr, self._columns, jacobian,
            self._pair_indptr, self._slots, values,
        )  # fmt: skip
        for (grip, q, _), slots in zip(self._grips(state.z), self._grip_slots, strict=True):
            np.add.at(values, slots, grip.second_order(q, state.forces[grip.rows]))
        if project == NOTHING:
            self._kept = (state, values[:-1])
        return values[:-1]

    def free_share(self, state: SheetState, trial: SheetState) -> float:
        """All of a step: a macro sheet meets nothing."""
        return 1.0

    def keep_apart(self, state: SheetState, wanted: FloatArray) -> FloatArray:
        """What is wanted: a macro sheet meets nothing."""
        return wanted
