"""The macro model: energy and moment of uniaxial bending, and of any curvature [Eqs. 10 to 13]."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from flexscale.datasets.build import build_fit_dataset
from flexscale.datasets.fit_values import PARAMETERS, FloatArray
from flexscale.datasets.schema import SCALARS, SIDES, schema_of
from flexscale.errors import BadInputError, SchemaError, UnitRangeError, UnknownNameError, suggest
from flexscale.macro.assessment import FitErrors
from flexscale.macro.harmonics import Harmonics
from flexscale.macro.law_table import build_law_table
from flexscale.macro.polar import DirectionalLaws, PolarLaw, Variant
from flexscale.macro.summary import describe_errors, describe_laws, describe_sheet
from flexscale.macro.tensor_law import bending
from flexscale.macro.uniaxial import UniaxialLaw, Weighting

if TYPE_CHECKING:
    import xarray as xr

    from flexscale.datasets.identity import Recipe

_ERRORS = tuple(FitErrors.__dataclass_fields__)


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
    def one_sided(self) -> bool:
        """Whether one side was not sampled; a tensor that bends to it finds no contact there."""
        return len(self.sides) < len(SIDES)

    @property
    def largest_curvature(self) -> float:
        """mm-1, the largest of the sweep; the model extrapolates beyond."""
        return self.polar.largest_curvature

    def parameters(self, direction: ArrayLike, side: str = "closing") -> UniaxialLaw:
        """a, b [N mm], kappa_0 [mm-1] and softening [mm N-1] in directions (degree).

        b and kappa_0 are nan where no contact was seen up to the largest curvature of the sweep.
        Numbers for one direction, arrays for several.
        """
        law = self.polar.law(_directions(direction), self._side(side))
        if np.ndim(direction) == 0:
            return UniaxialLaw(float(law.a), float(law.b), float(law.kappa_0), law.softening)
        return law

    def moment(
        self, curvature: ArrayLike, direction: ArrayLike, side: str = "closing"
    ) -> FloatArray:
        """Bending moment per width [N]; curvature (mm-1, >= 0) and direction (degree) broadcast."""
        return self._law(direction, side).moment(_curvatures(curvature))

    def energy(
        self, curvature: ArrayLike, direction: ArrayLike, side: str = "closing"
    ) -> FloatArray:
        """Energy per area [N mm-1], the integral of `moment` over the curvature."""
        return self._law(direction, side).energy(_curvatures(curvature))

    def tensor_energy(self, curvature: ArrayLike) -> FloatArray:
        """Bending energy per area [N mm-1] of curvature tensors (…, 2, 2) in mm-1, closing > 0."""
        return self._evaluate(curvature)[0]

    def tensor_moment(self, curvature: ArrayLike) -> FloatArray:
        """Moments per width (…, 2, 2) in N: derivative of `tensor_energy` by the tensor.

        Where a principal curvature is at the onset, or with "paper" where both are equal, see
        `tensor_law`.
        """
        grad = self._evaluate(curvature)[1]
        xx, xy, yy = grad[..., 0], 0.5 * grad[..., 1], grad[..., 2]
        return np.stack([np.stack([xx, xy], axis=-1), np.stack([xy, yy], axis=-1)], axis=-2)

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

    def _table(self, in_plane: FloatArray | None) -> FloatArray:
        return build_law_table(
            self.polar,
            variant=self.variant,
            tangent=self.tangent,
            in_plane=in_plane,
            w_biaxial=self.w_biaxial,
        )

    def _evaluate(self, curvature: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Energies (…), and gradients (…, 3) by (b11, b12, b22)."""
        tensors = np.asarray(curvature, dtype=float)
        if tensors.shape[-2:] != (2, 2) or not np.isfinite(tensors).all():
            raise UnitRangeError(
                "A curvature tensor is a symmetric 2 by 2 matrix of finite numbers in mm-1, not "
                f"{curvature!r}."
            )
        if not np.array_equal(tensors, np.swapaxes(tensors, -1, -2)):
            raise UnitRangeError(f"Curvature tensors are symmetric, but {curvature!r} is not.")
        forms = np.ascontiguousarray(tensors.reshape(-1, 4)[:, [0, 1, 3]])
        energies, gradients = np.empty(len(forms)), np.empty((len(forms), 3))
        bending(forms, self._table(None), energies, gradients)
        return energies.reshape(tensors.shape[:-2]), gradients.reshape(*tensors.shape[:-2], 3)

    def _law(self, direction: ArrayLike, side: str) -> UniaxialLaw:
        # Contact beyond the samples stays in, or the energy would jump with the direction there.
        return self.polar.law(_directions(direction), self._side(side), within=False)

    def _side(self, side: str) -> int:
        if side not in self.sides:
            raise UnknownNameError(f"The model has no side {side!r}. {suggest(side, self.sides)}")
        return self.sides.index(side)

    def to_dataset(self, recipe: Recipe | None = None) -> xr.Dataset:
        """Dataset of kind fit; all of the model is in it."""
        sampled, fitted = [], []
        for side in range(len(self.sides)):
            law, smooth = self.laws.law(side), self.polar.law(self.laws.directions, side)
            sampled.append([law.a, law.b, law.kappa_0])
            fitted.append([smooth.a, smooth.b, smooth.kappa_0])
        arrays: dict[str, Any] = {name: getattr(self.errors, name) for name in _ERRORS}
        arrays |= {
            "cos_coefficient": self._coefficients("cosine"),
            "sin_coefficient": self._coefficients("sine"),
            "order": [self.polar.a.order, self.polar.b[0].order, self.polar.onset[0].order],
            "onset_quantity": list(self.polar.onset_quantity),
            "directional_value": np.array(sampled),
            "fitted_value": np.array(fitted),
            "samples_before": self.laws.n_before,
            "samples_beyond": self.laws.n_beyond,
            "largest_curvature": self.largest_curvature,
            "n_parameters": self.n_parameters,
            "n_ignored": self.n_ignored,
            "weighting": self.weighting,
            "variant": self.variant,
            "tangent": _or_nan(self.tangent),
            "in_plane": _or_nan(self.in_plane),
            "w_biaxial": self.w_biaxial,
            "softening": self.polar.softening,
        }
        return build_fit_dataset(
            self.sides,
            self.laws.directions,
            arrays,
            scalars=self.labels,
            config=self.config,
            recipe=recipe,
        )

    def _coefficients(self, part: str) -> FloatArray:
        """(s, 3, 4) cosine or sine coefficients; orders a parameter does not have are 0."""
        rows = []
        for b, onset in zip(self.polar.b, self.polar.onset, strict=True):
            found = [getattr(item, part) for item in (self.polar.a, b, onset)]
            longest = max(len(row) for row in found)
            rows.append([np.pad(row, (0, longest - len(row))) for row in found])
        return np.array(rows)

    @classmethod
    def from_dataset(cls, dataset: xr.Dataset) -> MacroModel:
        """Inverse of `to_dataset`.

        Raises
        ------
        SchemaError : not a fit.
        """
        missing = [item.name for item in schema_of("fit").variables if item.name not in dataset]
        if missing:
            raise SchemaError(f"A macro model is a dataset of kind fit; no {', '.join(missing)}.")
        sides = tuple(str(side) for side in dataset["side"].values)
        values = {name: dataset[name].values for name in dataset.variables}
        directional = values["directional_value"]
        a = directional[:, 0]
        laws = DirectionalLaws(
            values["direction"],
            np.where(np.isnan(a[0]), a[-1], a[0]),
            directional[:, 1],
            directional[:, 2],
            values["samples_before"],
            values["samples_beyond"],
            float(values["softening"]),
        )
        labels = {item.name: values[item.name].item() for item in SCALARS if item.name in values}
        return cls(
            polar=_polar_of(dataset, sides),
            laws=laws,
            errors=FitErrors(**{name: values[name] for name in _ERRORS}),
            weighting=values["weighting"].item(),
            variant=values["variant"].item(),
            tangent=_or_none(values["tangent"]),
            in_plane=_or_none(values["in_plane"]),
            w_biaxial=float(values["w_biaxial"]),
            n_ignored=int(values["n_ignored"]),
            labels=labels,
            config=json.loads(dataset.attrs["flexscale_config"]),
        )

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


def _polar_of(dataset: xr.Dataset, sides: tuple[str, ...]) -> PolarLaw:
    orders = {
        name: int(order) for name, order in zip(PARAMETERS, dataset["order"].values, strict=True)
    }
    found: dict[str, list[Harmonics]] = {name: [] for name in PARAMETERS}
    for side in sides:
        for name in PARAMETERS:
            one = dataset.sel(side=side, parameter=name)
            cut = slice(0, orders[name] + 1)
            found[name].append(
                Harmonics(one["cos_coefficient"].values[cut], one["sin_coefficient"].values[cut])
            )
    return PolarLaw(
        sides,
        found["a"][0],
        tuple(found["b"]),
        tuple(found["kappa_0"]),
        tuple(str(item) for item in dataset["onset_quantity"].values),
        float(dataset["largest_curvature"]),
        float(dataset["softening"]),
    )


def _or_nan(matrix: FloatArray | None) -> FloatArray:
    return np.full((3, 3), np.nan) if matrix is None else matrix


def _or_none(matrix: FloatArray) -> FloatArray | None:
    return None if np.isnan(matrix).all() else matrix


def _directions(direction: ArrayLike) -> FloatArray:
    values = np.asarray(direction, dtype=float)
    if not np.isfinite(values).all():
        raise UnitRangeError(f"Directions must be finite, in degree, not {direction!r}.")
    return values


def _curvatures(curvature: ArrayLike) -> FloatArray:
    values = np.asarray(curvature, dtype=float)
    if not (np.isfinite(values) & (values >= 0.0)).all():
        raise UnitRangeError(
            f"Curvatures must be finite and not negative, in mm-1, not {curvature!r}; "
            "the side says to which side the sheet is bent."
        )
    return values
