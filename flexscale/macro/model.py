"""The macro model: energy and moment of uniaxial bending, and of any curvature [Eqs. 10 to 13]."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from flexscale.arrays import FloatArray
from flexscale.checks import DATASET, checked, require_choice
from flexscale.datasets.variables import Variant, Weighting
from flexscale.errors import BadInputError
from flexscale.macro import tensor_law
from flexscale.macro.assessment import FitErrors
from flexscale.macro.law_table import build_law_table
from flexscale.macro.polar import DirectionalLaws, PolarLaw
from flexscale.macro.storage import read_model, write_model
from flexscale.macro.summary import describe_errors, describe_laws, describe_sheet
from flexscale.macro.tensors import (
    evaluate_tensors,
    require_curvatures,
    require_directions,
    require_same_shape,
    warn_beyond_tensors,
)
from flexscale.macro.uniaxial import UniaxialLaw
from flexscale.mechanics.extrapolation import warn_beyond
from flexscale.mechanics.sheet_law import SheetLaw
from flexscale.sides import SIDES

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, eq=False, repr=False)
class MacroModel:
    """Bending response of a scaled sheet, fitted to a sweep.

    Attributes
    ----------
    polar : harmonics of the parameters.
    laws : parameters in the sampled directions, as fitted there.
    errors : how far the fit is from its samples, and from samples held out.
    weighting : "relative" or "absolute".
    variant : energy of a curvature tensor, "tangent" or "paper", see `tensor_law`.
    tangent : (3, 3) N mm, stiffness C of the flat cell; "tangent" has one.
    in_plane : (3, 3) N mm-1, energy density ½ EᵀAE for Green strain E = (E_xx, E_yy, 2 E_xy).
    w_biaxial : N mm3, resistance to double curvature.
    n_ignored : samples of the sweep that did not converge and were ignored.
    labels : scalar coordinates of the sweep: pattern, family, sizes, materials.
    config : how the fit was made, JSON-able.
    """

    polar: PolarLaw
    laws: DirectionalLaws
    errors: FitErrors
    weighting: Weighting
    variant: Variant = "paper"
    tangent: FloatArray | None = None
    in_plane: FloatArray | None = None
    w_biaxial: float = 0.0
    n_ignored: int = 0
    labels: Mapping[str, float | str] = field(default_factory=dict)
    config: Mapping[str, Any] = field(default_factory=dict)

    @property
    def sides(self) -> tuple[str, ...]:
        """Sides fitted, of "closing" and "opening"."""
        return self.polar.sides

    @property
    def n_parameters(self) -> int:
        """Numbers that define the law: 5 for a, or 6 for C and one softening, and 14 a side."""
        per_side = zip(self.polar.b, self.polar.onset, strict=True)
        before = 7 if self.variant == "tangent" else self.polar.a.n_parameters
        return before + sum(b.n_parameters + k.n_parameters for b, k in per_side)

    @property
    def largest_curvature(self) -> float:
        """mm-1, the largest of the sweep; the model extrapolates beyond."""
        return self.polar.largest_curvature

    def parameters(self, direction: ArrayLike, side: str = "closing") -> UniaxialLaw:
        """a, b [N mm], kappa_0 [mm-1] and softening [mm N-1] in directions (degree).

        b and kappa_0 are nan where no contact was seen up to the largest curvature of the sweep.
        Numbers for one direction, arrays for several.
        """
        law = self.polar.law(require_directions(direction), self._side(side))
        if np.ndim(direction) == 0:
            return UniaxialLaw(float(law.a), float(law.b), float(law.kappa_0), law.softening)
        return law

    def moment(
        self, curvature: ArrayLike, direction: ArrayLike, side: str = "closing"
    ) -> FloatArray:
        """Bending moment per width, N mm per mm of the sheet's width and so in N.

        Parameters
        ----------
        curvature : mm-1, >= 0; beyond `largest_curvature` the model extrapolates, and one warning
            says so.
        direction : degree, along which the sheet curves; broadcast with the curvature.
        side : "closing" or "opening".
        """
        law, kappa = self._law(direction, side, curvature)
        warn_beyond("A moment is asked for up", kappa, self.largest_curvature)
        return law.moment(kappa)

    def energy(
        self, curvature: ArrayLike, direction: ArrayLike, side: str = "closing"
    ) -> FloatArray:
        """Energy per area [N mm-1], the integral of `moment` over the curvature; as there."""
        law, kappa = self._law(direction, side, curvature)
        warn_beyond("An energy is asked for up", kappa, self.largest_curvature)
        return law.energy(kappa)

    def tensor_energy(self, curvature: ArrayLike) -> FloatArray:
        """Bending energy per area [N mm-1] of curvature tensors (…, 2, 2) in mm-1, closing > 0."""
        return self._evaluate(curvature)[0]

    def tensor_moment(self, curvature: ArrayLike) -> FloatArray:
        """Moments per width (…, 2, 2) in N: derivative of `tensor_energy` by the tensor.

        Where a principal curvature is at the onset, or with "paper" where both are equal, see
        `tensor_law`.
        """
        return self._evaluate(curvature)[1]

    def law_parameters(self) -> FloatArray:
        """Numbers of this model for `energy` and `law` of `flexscale.macro.tensor_law`.

        Raises
        ------
        BadInputError : the in-plane stiffness is not known.
        """
        if self.in_plane is None:
            raise BadInputError(
                "A sheet needs the in-plane stiffness of the cell, which this model does not know: "
                "fit it again with fit(sweep, tangent=fs.tangent_stiffness(pattern))."
            )
        return self._table(self.in_plane)

    def sheet_law(self) -> SheetLaw:
        """The law of this model's energy, for sheets of it.

        Raises
        ------
        BadInputError : the in-plane stiffness is not known.
        """
        parameters = self.law_parameters()
        assert self.in_plane is not None  # or there would be no parameters
        largest = float(np.linalg.eigvalsh(self.in_plane).max())
        return SheetLaw(tensor_law.energy, tensor_law.law, parameters, largest)

    def _table(self, in_plane: FloatArray | None) -> FloatArray:
        return build_law_table(
            self.polar,
            variant=self.variant,
            tangent=self.tangent,
            in_plane=in_plane,
            w_biaxial=self.w_biaxial,
        )

    def _evaluate(self, curvature: ArrayLike) -> tuple[FloatArray, FloatArray]:
        warn_beyond_tensors(curvature, self.largest_curvature)
        law = SheetLaw(tensor_law.energy, tensor_law.law, self._table(None), stiffness=0.0)
        return evaluate_tensors(curvature, law)

    def _law(
        self, direction: ArrayLike, side: str, curvature: ArrayLike
    ) -> tuple[UniaxialLaw, FloatArray]:
        angles, kappa = require_directions(direction), require_curvatures(curvature)
        require_same_shape(kappa, angles)
        # Contact beyond the samples stays in, or the energy would jump with the direction there.
        return self.polar.law(angles, self._side(side), within=False), kappa

    def _side(self, side: str) -> int:
        return self.sides.index(require_choice(side, "side of the model", self.sides))

    def to_dataset(self) -> xr.Dataset:
        """Dataset of kind fit; all of the model is in it."""
        return write_model(self)

    @classmethod
    @checked(dataset=DATASET)
    def from_dataset(cls, dataset: xr.Dataset) -> MacroModel:
        """Inverse of `to_dataset`.

        Raises
        ------
        SchemaError : not a fit.
        """
        return cls(**read_model(dataset))

    def __repr__(self) -> str:
        who = " ".join(str(self.labels.get(name, "")) for name in ("family", "pattern")).strip()
        head = f"MacroModel {who}: energy {self.variant!r}, {self.n_parameters} variables, "
        head += f"{self.weighting} weighting"
        lines = [
            head,
            *describe_laws(self.laws, self.polar),
            *describe_sheet(self.in_plane, self.w_biaxial),
            *describe_errors(self.errors, self.sides),
        ]
        for side in set(SIDES) - set(self.sides):
            lines.append(f"  one-sided: {side} was not sampled, and counts as free of contact")
        if self.n_ignored:
            lines.append(f"  {self.n_ignored} samples that did not converge were ignored")
        return "\n".join(lines)
