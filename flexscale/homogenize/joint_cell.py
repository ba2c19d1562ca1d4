"""The native model `joints`: rigid scales on line joints, bent as a periodic cell."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from typing import Any

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.embedding.bends import UNIT_CURVATURES, Bend, TensorBend
from flexscale.embedding.joint_kernels import all_openings
from flexscale.embedding.rigid_cell import RigidCell, find_rigid_scales
from flexscale.errors import PatternError
from flexscale.homogenize.joint_display import JointDisplay
from flexscale.homogenize.joint_problem import JointProblem, place_stations
from flexscale.homogenize.joint_validity import doubts
from flexscale.homogenize.native_model import NativeModel
from flexscale.homogenize.problem import FlatBends
from flexscale.joints.library import joint_laws
from flexscale.mechanics.joint_law import JointLaw
from flexscale.patterns.joint_lines import find_joints, joint_gaps
from flexscale.patterns.pattern import Pattern

log = logging.getLogger(__name__)


def laws_of(pattern: Pattern, native: NativeModel) -> tuple[JointLaw, ...]:
    """The laws that a model names, or those of the pattern's gaps, sheet and materials.

    Raises
    ------
    PatternError : joints cannot be computed, or the laws named are of another sheet, or too few.
    """
    laws, sheet = native.laws or joint_laws(pattern), pattern.substrate_material
    known = (pattern.substrate_thickness, sheet.young_modulus)
    for law in laws:
        if not np.allclose((law.thickness, law.modulus), known, rtol=1e-9):
            raise PatternError(
                f"The law given is of a sheet of {law.thickness:g} mm and {law.modulus:g} MPa, the "
                f"pattern's of {pattern.substrate_thickness:g} mm, {sheet.young_modulus:g} MPa: "
                "take the law of this pattern."
            )
    gaps = joint_gaps(pattern)
    if len(laws) != len(gaps):
        raise PatternError(
            f"The laws given are {len(laws)}, but the pattern's joints have gaps of "
            f"{', '.join(f'{gap:g}' for gap in gaps)} mm: give the law of each, the narrowest "
            "first, or leave law out."
        )
    return laws


class JointCell(JointProblem):
    """Rigid scales of one lattice cell on joints, to be bent: a `Problem`.

    Parameters
    ----------
    pattern : the scale pattern.
    laws : of its joints, of the narrowest gap first; one if there is one gap.
    native : contact and linear solver.
    stretches : whether the lattice stretches as it likes; else it is held, and so are in-plane
        strains on average.
    """

    def __init__(
        self,
        pattern: Pattern,
        laws: JointLaw | Sequence[JointLaw],
        native: NativeModel,
        stretches: bool = True,
    ) -> None:
        self.pattern, self.stretches = pattern, stretches
        joints = find_joints(pattern)
        scales = find_rigid_scales(pattern, joints, native.contact.enabled)
        stations = place_stations(joints, scales, joint_gaps(pattern))
        embedding = RigidCell(scales, stretches=stretches)
        gaps = (pattern.gap, max(pattern.gaps))
        super().__init__(embedding, stations, laws, native, gaps, pattern.cell_area)

    @classmethod
    def from_pattern(
        cls, pattern: Pattern, native: NativeModel, stretches: bool = True
    ) -> JointCell:
        """The cell of a pattern on the joints that its gap, sheet and materials make.

        Raises
        ------
        PatternError : joints cannot be computed, do not hold the scales together, or are those of
            another sheet.
        """
        cell = cls(pattern, laws_of(pattern, native), native, stretches)
        rest = cell.bent(Bend(0.0, 0.0))
        if cell.system.factorize(rest.hessian_values(rest.evaluate(cell.embedding.rest))) > 0:
            raise PatternError(
                f"Joints do not hold the scales of this pattern together: at a gap of "
                f"{max(pattern.gaps):g} mm too few of their walls face one another. Narrow the gap."
            )
        for doubt in cell.doubts:
            log.warning("%s: %s.", pattern.name, doubt)
        return cell

    @property
    def doubts(self) -> tuple[str, ...]:
        """Sentences on what of the pattern joints were not compared with solids for."""
        return doubts(self.pattern)

    @property
    def parts(self) -> tuple[type[JointCell], tuple[Any, ...]]:
        """What makes it again in another process."""
        return JointCell, (self.pattern, self.laws, self.native, self.stretches)

    def flat_bends(self) -> FlatBends:
        """Answers of the flat cell to small bends; its system is left factorized at rest."""
        cell = self.embedding
        # Of energies quadratic in k: those of kappa_xx, kappa_yy, 2 kappa_xy, and of two at a time.
        units = UNIT_CURVATURES
        rates, loads = [], []
        fixed = np.empty((3, 3))
        state = self.bent(TensorBend(0.0, units[0])).evaluate(cell.rest)
        for i, j in ((0, 1), (0, 2), (1, 2), (0, 0), (1, 1), (2, 2)):
            tensor = units[i] + units[j] if i != j else units[i]
            bent = self.bent(TensorBend(0.0, tensor))
            second = bent.second_derivatives(bent.evaluate(cell.rest))
            fixed[i, j] = fixed[j, i] = second[-1]
            if i == j:
                loads.append(second[self.active].copy())
                rates.append(cell.curvature_rates(bent.bend))
        for i, j in ((0, 1), (0, 2), (1, 2)):
            fixed[i, j] = fixed[j, i] = 0.5 * (fixed[i, j] - fixed[i, i] - fixed[j, j])
        self.system.factorize(self.bent(TensorBend(0.0, units[0])).hessian_values(state))
        relaxed = [self.system.solve(-load)[0] for load in loads]
        return FlatBends(state, rates, fixed, loads, relaxed)

    def display(self) -> JointDisplay:
        """What places scales and sheet for pictures."""
        return JointDisplay(self.pattern, self.embedding, self.contact)

    def openings(self, z: FloatArray, bend: Bend) -> FloatArray:
        """(n_stations, 4) of all joints' stations u, w, s in mm and phi in radian."""
        return all_openings(self.embedding.place(z, bend).poses, self.stations)
