"""The macro model of the flat cell: its stiffness, and gaps that close. No sweep is needed.

# PAPER: contact is fitted to native bending in single directions. WE: gaps of the flat cell, two
# softenings at most from a sweep. WHY: where a sheet bends in two directions at a time, as free
# sides make it do, scales meet long before either curvature would bring them together alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares

from flexscale import checks
from flexscale.arrays import FloatArray
from flexscale.checks import checked, number, series
from flexscale.datasets.checks import check_dataset
from flexscale.datasets.given import read_labels, require_variables
from flexscale.datasets.kinds.gap_model import build_gap_model_dataset
from flexscale.homogenize.native_model import NativeModel, native_model
from flexscale.macro import gap_law
from flexscale.macro.bending_model import BendingModel
from flexscale.macro.biaxial import MOST_W_BIAXIAL, choose_w_biaxial
from flexscale.macro.harmonics import stiffness_harmonics
from flexscale.macro.law_table import build_rest_table
from flexscale.macro.rest_stiffness import read_rest_stiffness, require_same_cell
from flexscale.macro.samples import Samples, read_samples
from flexscale.macro.tensors import require_tensors, uniaxial_tensors, warn_beyond_tensors
from flexscale.mechanics.sheet_law import SheetLaw
from flexscale.sides import SIDES

if TYPE_CHECKING:
    import xarray as xr

    from flexscale.homogenize.flat_contact import FlatContact
    from flexscale.homogenize.problem import Problem
    from flexscale.patterns import Pattern

#: mm-1, up to which the model was compared with native cells (benchmarks/gap_models.py).
LARGEST_CURVATURE = 0.03
DIRECTIONS = tuple(5.0 * index for index in range(36))  # degree, of a dataset's onsets
#: Of a dataset: what is the model's own, and what its gaps'.
_STORED = (
    "tangent",
    "in_plane",
    "softening",
    "contact_softening",
    "w_biaxial",
    "largest_curvature",
)
_GAPS = ("distances", "slopes", "compliance")


@dataclass(frozen=True, eq=False, repr=False)
class GapModel(BendingModel):
    """Bending response of a scaled sheet to any curvature tensor, from its flat cell.

    Attributes
    ----------
    tangent : (3, 3) N mm, stiffness C of the flat cell.
    in_plane : (3, 3) N mm-1, energy density ½ EᵀAE for Green strain E = (E_xx, E_yy, 2 E_xy).
    contact : gaps of the flat cell.
    softening, contact_softening : s and s_c of `gap_law`, mm N-1; 0 unless fitted to a sweep.
    w_biaxial : N mm3, resistance to double curvature.
    labels : what the model is labelled with: pattern, family, sizes, materials.
    largest_curvature : mm-1, up to which the model is known to hold.
    """

    tangent: FloatArray
    in_plane: FloatArray
    contact: FlatContact
    softening: float = 0.0
    contact_softening: float = 0.0
    w_biaxial: float = 0.0
    labels: Mapping[str, float | str] = field(default_factory=dict)
    largest_curvature: float = LARGEST_CURVATURE

    def warn_beyond(self, curvature: ArrayLike) -> None:
        """One warning if a principal curvature is beyond `largest_curvature`."""
        warn_beyond_tensors(curvature, self.largest_curvature)

    def onset(self, direction: ArrayLike, side: str = "closing") -> FloatArray:
        """Curvature [mm-1] at which scales meet, bent in a direction (degree); inf for never.

        To first order, also beyond `largest_curvature`.
        """
        return self.tensor_onset(uniaxial_tensors(1.0, direction, side))

    def tensor_onset(self, curvature: ArrayLike) -> FloatArray:
        """By how much curvature tensors (…, 2, 2) may be multiplied until scales meet; or inf."""
        k = require_tensors(curvature)
        return self.contact.onset(
            np.stack([k[..., 0, 0], k[..., 1, 1], k[..., 0, 1] + k[..., 1, 0]], axis=-1)
        )

    def sheet_law(self) -> SheetLaw:
        """The law of this model's energy, for sheets of it."""
        rest = build_rest_table(self.tangent, self.in_plane, self.w_biaxial, self.softening)
        gaps = self.contact
        table = gap_law.build_gap_table(
            rest, gaps.distances, gaps.slopes, gaps.compliance, self.contact_softening
        )
        largest = float(np.linalg.eigvalsh(self.in_plane).max())
        return SheetLaw(gap_law.energy, gap_law.law, table, largest)

    @checked(sweep=checks.DATASET)
    def fitted(self, sweep: xr.Dataset) -> GapModel:
        """The model with softenings fitted to a sweep of the same cell.

        Least squares of the relative errors of energies and moments, all directions and both sides
        alike. A sweep in which no gap closes says nothing of contact, whose softening stays.

        Raises
        ------
        SchemaError, BadInputError : not a sweep, too small a one, or one of another cell.
        """
        samples = self._samples(sweep)
        touches = any(
            bool((self.onset(samples.directions, side) < samples.curvatures[-1]).any())
            for side in samples.sides
        )
        names = ["softening", "contact_softening"][: 1 + touches]

        def with_values(values: FloatArray) -> GapModel:
            changes: dict[str, Any] = dict(zip(names, map(float, values), strict=True))
            return replace(self, largest_curvature=float(samples.curvatures[-1]), **changes)

        def off(values: FloatArray) -> FloatArray:
            # A native moment behind a snap may be negative; that sample does not count.
            ratios = np.concatenate(_ratios(with_values(values), samples))
            return np.log(ratios[ratios > 0.0])

        start = np.ones(len(names))
        return with_values(least_squares(off, start, bounds=(0.0, np.inf), diff_step=1e-3).x)

    @checked(sweep=checks.DATASET)
    def errors(self, sweep: xr.Dataset) -> tuple[FloatArray, FloatArray]:
        """Relative errors of energies and of moments at the converged samples of a sweep, (n,).

        Raises
        ------
        SchemaError, BadInputError : not a sweep, too small a one, or one of another cell.
        """
        energy, moment = _ratios(self, self._samples(sweep))
        return energy - 1.0, moment - 1.0

    def _samples(self, sweep: xr.Dataset) -> Samples:
        samples = read_samples(sweep)
        require_same_cell(stiffness_harmonics(self.tangent), samples)
        return samples

    @checked(directions=series("degree"))
    def to_dataset(
        self, directions: Sequence[float] = DIRECTIONS, *, config: Mapping[str, Any] | None = None
    ) -> xr.Dataset:
        """Dataset of kind gap_model; all of the model is in it.

        Parameters
        ----------
        directions : degree, increasing, at which onsets of contact are tabulated.
        config : how the model was made, for the dataset's recipe.
        """
        arrays: dict[str, Any] = {name: getattr(self, name) for name in _STORED}
        arrays |= {name: getattr(self.contact, name) for name in _GAPS}
        arrays["onset"] = np.stack([self.onset(directions, side) for side in SIDES])
        labels = {"family": "custom", "pattern": "custom", **self.labels}
        return build_gap_model_dataset(
            SIDES, directions, arrays, scalars=labels, config=config or {}
        )

    @classmethod
    def from_dataset(cls, dataset: xr.Dataset) -> GapModel:
        """The model that a dataset of kind gap_model holds.

        Raises
        ------
        SchemaError : a dataset of another kind, or values that no model has.
        """
        from flexscale.homogenize.flat_contact import FlatContact

        require_variables(dataset, (*_STORED, *_GAPS), "A gap model", "gap_model")
        check_dataset(dataset, "gap_model")
        own: dict[str, Any] = {name: dataset[name].values for name in _STORED}
        own |= {name: value.item() for name, value in own.items() if value.ndim == 0}
        gaps = FlatContact(*(dataset[name].values for name in _GAPS))
        return cls(**own, contact=gaps, labels=read_labels(dataset))

    def __repr__(self) -> str:
        who = " ".join(str(self.labels.get(name, "")) for name in ("family", "pattern")).strip()
        lines = [f"GapModel {who}: {len(self.contact)} gaps of the flat cell"]
        softenings = {"before contact": self.softening, "of contact": self.contact_softening}
        for name, value in softenings.items():
            if value > 0.0:
                half = f"halved at an energy of {1.0 / value:.3g} N mm-1"
                lines.append(f"  moment {name:<14} {half}")
        for side in ("closing", "opening"):
            onset = self.onset(np.arange(0.0, 180.0, 5.0), side)
            least = float(np.min(onset))
            if np.isinf(least):
                lines.append(f"  {side:<8} no contact")
                continue
            # Of directions alike by symmetry, rounding must not choose.
            first = 5.0 * int(np.argmax(onset <= least * (1.0 + 1e-6)))
            where = f"from {least:.3g} mm-1 on, at {first:g} degree"
            known = self.largest_curvature
            beyond = f"; beyond {known:g} mm-1, up to which it is tried" if least > known else ""
            lines.append(f"  {side:<8} contact {where}{beyond}")
        return "\n".join(lines)


def _ratios(model: GapModel, samples: Samples) -> tuple[FloatArray, FloatArray]:
    """Model over native energies and moments at the used samples."""
    energies, moments = [], []
    for index, side in enumerate(samples.sides):
        arguments = samples.curvatures, samples.directions[:, None], side
        used = samples.used[index]
        energies.append((model.energy(*arguments) / samples.energy[index])[used])
        moments.append((model.moment(*arguments) / samples.moment[index])[used])
    return np.concatenate(energies), np.concatenate(moments)


@checked(
    pattern=checks.PATTERN,
    sweep=checks.DATASET,
    model=native_model,
    w_biaxial=number("N mm3", 0.0, MOST_W_BIAXIAL, name="w_biaxial"),
)
def gap_model(
    pattern: Pattern,
    sweep: xr.Dataset | None = None,
    *,
    model: NativeModel | str = "joints",
    w_biaxial: float | None = None,
) -> GapModel:
    """The macro model of a pattern's flat cell, in seconds.

    Parameters
    ----------
    pattern : the scale pattern.
    sweep : dataset of kind sweep of the same cell, to which two softenings are fitted; without one
        there are none, and the model is too stiff by what benchmarks/gap_models.py tells.
    model : the native model, or the name of one with its default options.
    w_biaxial : N mm3, resistance to double curvature [Eq. 13]; see `biaxial` for its default.

    Raises
    ------
    PatternError, MeshError : the pattern cannot be meshed.
    UnitRangeError : w_biaxial out of range.
    SchemaError, BadInputError : not a sweep of this cell.

    Examples
    --------
    >>> import flexscale as fs
    >>> model = fs.gap_model(fs.named_pattern("square"))
    >>> bool(0.009 < model.onset(0.0) < 0.011)
    True
    """
    # Meshing needs system libraries, which models that are there already can do without.
    from flexscale.homogenize.build import build_problem
    from flexscale.homogenize.labels import pattern_scalars

    native = native_model(model)
    found = model_of_cell(build_problem(pattern, native))
    labels = pattern_scalars(pattern, native)
    w = choose_w_biaxial(w_biaxial, found.in_plane, pattern.tile_area)
    found = replace(found, w_biaxial=w, labels=labels)
    return found if sweep is None else found.fitted(sweep)


def model_of_cell(problem: Problem) -> GapModel:
    """Stiffness and gaps of a cell problem, in the time of a few factorizations."""
    from flexscale.homogenize.flat_contact import solve_flat_contact
    from flexscale.homogenize.tangent import solve_tangent

    tangent, in_plane = read_rest_stiffness(solve_tangent(problem))
    return GapModel(tangent, in_plane, solve_flat_contact(problem))
