"""`fit`: from a sweep to the macro model [Eqs. 10 to 13]."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from flexscale.arrays import FloatArray
from flexscale.checks import DATASET, checked, choice, number
from flexscale.datasets.given import read_config, read_labels
from flexscale.datasets.variables import VARIANTS, WEIGHTINGS, Variant, Weighting
from flexscale.errors import BadInputError
from flexscale.macro.assessment import assess
from flexscale.macro.biaxial import MOST_W_BIAXIAL, choose_w_biaxial
from flexscale.macro.flat_response import FlatResponse, fit_softening
from flexscale.macro.harmonics import stiffness_harmonics
from flexscale.macro.model import MacroModel
from flexscale.macro.polar import fit_directions, require_visible_onset
from flexscale.macro.refine import fit_refined
from flexscale.macro.rest_stiffness import read_rest_stiffness, require_same_cell, tangent_of_sweep
from flexscale.macro.samples import read_samples

if TYPE_CHECKING:
    import xarray as xr

    from flexscale.homogenize.tangent import TangentStiffness

log = logging.getLogger(__name__)


@checked(
    sweep=DATASET,
    variant=choice("variant", VARIANTS),
    weighting=choice("weighting", WEIGHTINGS),
    w_biaxial=number("N mm3", 0.0, MOST_W_BIAXIAL, name="w_biaxial"),
)
def fit(
    sweep: xr.Dataset,
    tangent: TangentStiffness | xr.Dataset | None = None,
    *,
    variant: Variant = "tangent",
    weighting: Weighting = "relative",
    w_biaxial: float | None = None,
) -> MacroModel:
    """Fit the two-regime law in every direction, and harmonics of its parameters.

    Parameters
    ----------
    sweep : dataset of kind sweep. Samples that did not converge are ignored; the model's
        `n_ignored` and a warning in the log say how many. Directions filled by symmetry count.
    tangent : stiffness of the sweep's flat cell, from `tangent_stiffness` or a dataset of kind
        tangent. If not given it is computed from the sweep's recipe, in seconds.
    variant : energy of a curvature tensor, see `tensor_law`. "tangent" takes a from the flat cell,
        C : nnnn, and fits b, κ0 and one softening. "paper" [Eq. 12] fits a, b and κ0; it needs no
        tangent, but without one a sheet has no in-plane stiffness.
    weighting : "relative" weighs every sample by its own size, so that small curvatures and soft
        directions count as much as large ones; "absolute", as in the paper, by the largest.
    w_biaxial : N mm3, resistance to double curvature [Eq. 13]; see `biaxial` for its default.

    Returns
    -------
    MacroModel, with the errors of the fit, also at held-out curvatures and directions.

    Raises
    ------
    UnknownNameError : a weighting or variant there is not.
    SchemaError : not a sweep, or not a tangent.
    BadInputError : too few or too unevenly spread curvatures or directions, too coarse a sweep to
        see the onset of contact, or no or a wrong tangent; with the numbers.
    """
    samples = read_samples(sweep)
    if samples.n_ignored:
        log.warning(
            "fit ignores %d of %d samples, which did not converge",
            samples.n_ignored,
            samples.energy.size,
        )
    matrix, in_plane = _rest_stiffness(sweep, tangent, variant)
    flat = None
    if matrix is not None:
        stiffness = stiffness_harmonics(matrix)
        require_same_cell(stiffness, samples)
        if variant == "tangent":
            first = fit_directions(samples, weighting, FlatResponse(stiffness))
            flat = fit_softening(samples, stiffness, first.kappa_0)
    laws = fit_directions(samples, weighting, flat)
    require_visible_onset(laws, samples)
    polar = fit_refined(laws, samples, weighting, flat)
    assert polar is not None  # read_samples saw to it that the directions suffice
    labels = read_labels(sweep)
    return MacroModel(
        polar=polar,
        laws=laws,
        errors=assess(samples, laws, polar, weighting, flat),
        weighting=weighting,
        variant=variant,
        tangent=matrix,
        in_plane=in_plane,
        w_biaxial=choose_w_biaxial(w_biaxial, in_plane, labels.get("tile_area")),
        n_ignored=samples.n_ignored,
        labels=labels,
        config={"weighting": weighting, "variant": variant, "sweep": read_config(sweep)},
    )


def _rest_stiffness(
    sweep: xr.Dataset, tangent: TangentStiffness | xr.Dataset | None, variant: Variant
) -> tuple[FloatArray, FloatArray] | tuple[None, None]:
    known = tangent_of_sweep(sweep) if tangent is None else tangent
    if known is not None:
        return read_rest_stiffness(known)
    if variant == "tangent":
        raise BadInputError(
            "The energy 'tangent' is built on the stiffness of the flat cell, but this sweep does "
            "not say which pattern it is of: give fit(sweep, tangent=fs.tangent_stiffness(pattern))"
            ", or choose variant='paper', which needs none."
        )
    return None, None
