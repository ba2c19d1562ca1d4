"""The macro model of any bending: gaps of the flat cell, fitted to a tensor sweep, and corrected.

# PAPER: a law of single directions, put together for two. WE: a law of the curvature tensor, fitted
# to samples of it. WHY: sheets bend in two directions at a time wherever they have free sides or
# are pressed, and scales then meet long before either curvature would bring them together alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike

from flexscale.arrays import FloatArray
from flexscale.checks import DATASET, checked, instance
from flexscale.datasets.checks import check_dataset
from flexscale.datasets.given import read_labels, require_variables
from flexscale.datasets.kinds.tensor_model import RAY_AXES, build_tensor_model_dataset
from flexscale.errors import BadInputError
from flexscale.homogenize.flat_contact import FlatContact
from flexscale.macro import corrected_gap_law, gap_law
from flexscale.macro.bending_model import BendingModel
from flexscale.macro.gap_correction import fit_correction
from flexscale.macro.gap_fit import ClosingGaps, fit_gaps
from flexscale.macro.gap_model import GapModel
from flexscale.macro.law_table import build_rest_table
from flexscale.macro.tensor_samples import TensorSamples, read_tensor_samples
from flexscale.macro.tensors import evaluate_tensors, require_tensors
from flexscale.mechanics.extrapolation import warn_beyond
from flexscale.mechanics.sheet_law import SheetLaw

if TYPE_CHECKING:
    import xarray as xr

_FEW_GAPS = 6  # of which there are two of each, the second closing later: scales meet further on
_LATER = 1.3  # times its distance
_SOFTER = 3.0  # times its compliance
_SAME_TANGENT = 1e-3  # share of stiffness by which sweep and gap model of one cell may differ


@dataclass(frozen=True, eq=False, repr=False)
class TensorModel(BendingModel):
    """Bending response of a scaled sheet to any curvature tensor, fitted to a tensor sweep.

    Attributes
    ----------
    tangent : (3, 3) N mm, stiffness C of the flat cell.
    in_plane : (3, 3) N mm-1, energy density ½ EᵀAE for Green strain E = (E_xx, E_yy, 2 E_xy).
    gaps : with turns, and softenings.
    correction : (n, n, n) coefficients of c of `corrected_gap_law`.
    largest_curvature : mm-1, root of the sum of squares of the principal curvatures up to which
        the sweep goes.
    held_out_error : (2, 2, 3) of rays that a fit to the others had not seen: of energies and of
        moments, before and in contact; median, 95 % and worst of absolute relative errors.
    rays : directions and shapes [degree] and curvatures [mm-1] of the sweep.
    energy_error : relative errors of energies on these axes; nan at rest and where the sweep has no
        sample.
    n_ignored : samples of the sweep that did not converge.
    labels : pattern, family, sizes, materials.
    """

    tangent: FloatArray
    in_plane: FloatArray
    gaps: ClosingGaps
    correction: FloatArray
    largest_curvature: float
    held_out_error: FloatArray
    rays: tuple[FloatArray, FloatArray, FloatArray]
    energy_error: FloatArray
    n_ignored: int = 0
    labels: Mapping[str, float | str] = field(default_factory=dict)

    def warn_beyond(self, curvature: ArrayLike) -> None:
        """One warning if a tensor is longer than `largest_curvature`; see `BendingModel`."""
        lengths = np.linalg.norm(require_tensors(curvature), axis=(-2, -1))
        warn_beyond("Curvature tensors are asked for up", lengths, self.largest_curvature)

    def sheet_law(self) -> SheetLaw:
        """The law of this model's energy, for sheets of it."""
        table = _gap_table(self.tangent, self.in_plane, self.gaps)
        return _law(table, self.in_plane, self.largest_curvature, self.correction)

    @checked(sweep=DATASET)
    def errors(self, sweep: xr.Dataset) -> tuple[FloatArray, FloatArray]:
        """Relative errors of energies (p,) and of moments (p,), the latter as lengths of tensors,
        at the converged samples of a tensor sweep.

        Raises
        ------
        SchemaError, BadInputError : not a tensor sweep, or too small a one.
        """
        return _errors(self.sheet_law(), read_tensor_samples(sweep))

    def to_dataset(self, *, config: Mapping[str, Any] | None = None) -> xr.Dataset:
        """Dataset of kind tensor_model; all of the model is in it.

        Parameters
        ----------
        config : how the model was made, for the dataset's recipe.
        """
        contact = self.gaps.contact
        arrays: dict[str, Any] = {
            "tangent": self.tangent,
            "in_plane": self.in_plane,
            "distances": contact.distances,
            "slopes": contact.slopes,
            "compliance": contact.compliance,
            "turns": self.gaps.turns,
            "softening": self.gaps.softening,
            "contact_softening": self.gaps.contact_softening,
            "correction": self.correction,
            "largest_curvature": self.largest_curvature,
            "held_out_error": self.held_out_error,
            **dict(zip(RAY_AXES, self.rays, strict=True)),
            "energy_error": self.energy_error,
            "n_ignored": self.n_ignored,
        }
        labels = {"family": "custom", "pattern": "custom", **self.labels}
        return build_tensor_model_dataset(arrays, scalars=labels, config=config or {})

    @classmethod
    @checked(dataset=DATASET)
    def from_dataset(cls, dataset: xr.Dataset) -> TensorModel:
        """The model that a dataset of kind tensor_model holds.

        Raises
        ------
        SchemaError : a dataset of another kind, or values that no model has.
        """
        require_variables(dataset, ("correction", "turns"), "A tensor model", "tensor_model")
        check_dataset(dataset, "tensor_model")
        contact = FlatContact(*(dataset[n].values for n in ("distances", "slopes", "compliance")))
        softenings = (float(dataset[name]) for name in ("softening", "contact_softening"))
        return cls(
            dataset["tangent"].values,
            dataset["in_plane"].values,
            ClosingGaps(contact, dataset["turns"].values, *softenings),
            dataset["correction"].values,
            float(dataset["largest_curvature"]),
            dataset["held_out_error"].values,
            _rays(dataset),
            dataset["energy_error"].values,
            int(dataset["n_ignored"]),
            read_labels(dataset),
        )

    def __repr__(self) -> str:
        who = " ".join(str(self.labels.get(name, "")) for name in ("family", "pattern")).strip()
        lines = [f"TensorModel {who}: {len(self.gaps.contact)} gaps and a correction"]
        for when, told in zip(
            ("before contact", "in contact"), self.held_out_error[0], strict=True
        ):
            median, most, worst = (f"{100.0 * value:.2g} %" for value in told)
            shown = f"median {median}, 95 % below {most}, worst {worst}"
            lines.append(f"  energies {when:<14} of rays held out: {shown}")
        lines.append(f"  curvatures up to {self.largest_curvature:g} mm-1")
        return "\n".join(lines)


@checked(
    sweep=DATASET, gaps=instance("flexscale.macro.gap_model:GapModel", "fs.gap_model makes it")
)
def tensor_model(sweep: xr.Dataset, gaps: GapModel) -> TensorModel:
    """The macro model of any bending, fitted to a tensor sweep, in seconds.

    Parameters
    ----------
    sweep : dataset of kind tensor_sweep of a pattern that is free in its plane.
    gaps : the gap model of the same pattern, `fs.gap_model(pattern)`: which scales meet, and the
        stiffness of the flat cell.

    Raises
    ------
    SchemaError, BadInputError : not such a sweep, too few samples, or a gap model of another cell.

    Examples
    --------
    >>> import flexscale as fs
    >>> pattern = fs.named_pattern("hexagon")
    >>> rays = {"directions": [0, 10, 20], "shapes": [-90, -45, 0, 45]}
    >>> sweep = fs.tensor_sweep(pattern, **rays, curvatures=[0.002 * k for k in range(16)])
    >>> model = fs.tensor_model(sweep, fs.gap_model(pattern))
    >>> bool(0.0 < model.energy(0.01, 0.0) < model.energy(0.02, 0.0))
    True
    """
    samples = read_tensor_samples(sweep)
    _require_same_cell(sweep, gaps)
    reach = float(np.linalg.norm(samples.places, axis=1).max())
    out = samples.held_out()
    held_out = np.full((2, 2, 3), np.nan)
    if out.any() and not out.all():
        law, _, _ = _fit(samples.where(~out), gaps, reach)
        held_out = _statistics(law, samples.where(out))
    law, fitted, correction = _fit(samples, gaps, reach)
    rays = _rays(sweep)
    error = np.full([len(axis) for axis in rays], np.nan)
    error.flat[samples.cells] = _errors(law, samples)[0]
    ignored = int((sweep["status"] != 0).sum())
    return TensorModel(
        gaps.tangent, gaps.in_plane, fitted, correction, reach, held_out, rays, error, ignored,
        read_labels(sweep),
    )  # fmt: skip


def _require_same_cell(sweep: xr.Dataset, gaps: GapModel) -> None:
    off = np.abs(sweep["tangent"].values - gaps.tangent).max() / np.abs(gaps.tangent).max()
    if off > _SAME_TANGENT:
        raise BadInputError(
            f"The stiffness of the flat cell of this tensor sweep is {100.0 * off:.2g} % from that "
            "of the gap model: take fs.gap_model of the pattern and native model that was swept."
        )


def _rays(dataset: xr.Dataset) -> tuple[FloatArray, FloatArray, FloatArray]:
    direction, shape, curvature = (dataset[axis].values for axis in RAY_AXES)
    return direction, shape, curvature


def _fit(
    samples: TensorSamples, gaps: GapModel, reach: float
) -> tuple[SheetLaw, ClosingGaps, FloatArray]:
    """The law, its gaps, and the coefficients of the correction."""
    fitted = fit_gaps(_doubled(gaps.contact), gaps.tangent, samples)
    table = _gap_table(gaps.tangent, gaps.in_plane, fitted)
    law = SheetLaw(gap_law.energy, gap_law.law, table, stiffness=0.0)
    correction = fit_correction(samples, *_evaluate(law, samples), reach)
    return _law(table, gaps.in_plane, reach, correction), fitted, correction


def _doubled(contact: FlatContact) -> FlatContact:
    """Two of each gap where there are few, so that stiffness may grow as scales slide on."""
    if not 0 < len(contact) <= _FEW_GAPS:
        return contact
    return FlatContact(
        np.concatenate([contact.distances, _LATER * contact.distances]),
        np.concatenate([contact.slopes, contact.slopes]),
        scipy.linalg.block_diag(contact.compliance, _SOFTER * contact.compliance),
    )


def _gap_table(tangent: FloatArray, in_plane: FloatArray, gaps: ClosingGaps) -> FloatArray:
    rest = build_rest_table(tangent, in_plane, 0.0, gaps.softening)
    contact = gaps.contact
    return gap_law.build_gap_table(
        rest, contact.distances, contact.slopes, contact.compliance, gaps.contact_softening,
        gaps.turns,
    )  # fmt: skip


def _law(
    gap_table: FloatArray, in_plane: FloatArray, reach: float, correction: FloatArray
) -> SheetLaw:
    table = corrected_gap_law.build_corrected_table(gap_table, reach, correction)
    largest = float(np.linalg.eigvalsh(in_plane).max())
    return SheetLaw(corrected_gap_law.energy, corrected_gap_law.law, table, largest)


def _evaluate(law: SheetLaw, samples: TensorSamples) -> tuple[FloatArray, FloatArray]:
    """Energies (p,) and moments (p, 3) by the samples' places."""
    energies, moments = evaluate_tensors(samples.tensors, law)
    root = np.sqrt(2.0)
    return energies, np.stack([moments[:, 0, 0], moments[:, 1, 1], root * moments[:, 0, 1]], axis=1)


def _errors(law: SheetLaw, samples: TensorSamples) -> tuple[FloatArray, FloatArray]:
    energies, moments = _evaluate(law, samples)
    missed = np.linalg.norm(moments - samples.moments, axis=1)
    return energies / samples.energies - 1.0, missed / samples.moment_lengths()


def _statistics(law: SheetLaw, samples: TensorSamples) -> FloatArray:
    """(2, 2, 3) of energies and moments, before and in contact; nan for none."""
    found = np.full((2, 2, 3), np.nan)
    for i, errors in enumerate(_errors(law, samples)):
        for j, chosen in enumerate((~samples.touches, samples.touches)):
            if chosen.any():
                off = np.abs(errors[chosen])
                found[i, j] = np.median(off), np.quantile(off, 0.95), off.max()
    return found
