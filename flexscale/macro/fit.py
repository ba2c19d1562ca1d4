"""`fit`: from a sweep to the macro model of uniaxial bending [Eqs. 10, 11]."""

from __future__ import annotations

import json
import logging
from typing import TYPE_CHECKING, Any

from flexscale.datasets.schema import SCALARS
from flexscale.errors import UnknownNameError, suggest
from flexscale.macro.assessment import assess
from flexscale.macro.model import MacroModel
from flexscale.macro.polar import fit_directions, fit_polar, require_visible_onset
from flexscale.macro.samples import read_samples
from flexscale.macro.uniaxial import WEIGHTINGS, Weighting

if TYPE_CHECKING:
    import xarray as xr

log = logging.getLogger(__name__)


def fit(sweep: xr.Dataset, *, weighting: Weighting = "relative") -> MacroModel:
    """Fit the two-regime law in every direction, and harmonics through its parameters.

    Parameters
    ----------
    sweep : dataset of kind sweep/1. Samples that did not converge are ignored; the model's
        `n_ignored` and a warning in the log say how many. Directions filled by symmetry count.
    weighting : "relative" weighs every sample by its own size, so that small curvatures and soft
        directions count as much as large ones; "absolute", as in the paper, by the largest.

    Returns
    -------
    MacroModel, with the errors of the fit, also at held-out curvatures and directions.

    Raises
    ------
    UnknownNameError : a weighting there is not.
    SchemaError : not a sweep.
    BadInputError : too few or too unevenly spread curvatures or directions, or too coarse a sweep
        to see the onset of contact; with the numbers.
    """
    if weighting not in WEIGHTINGS:
        raise UnknownNameError(
            f"There is no weighting {weighting!r}. {suggest(weighting, WEIGHTINGS)}"
        )
    samples = read_samples(sweep)
    if samples.n_ignored:
        log.warning(
            "fit ignores %d of %d samples, which did not converge",
            samples.n_ignored,
            samples.energy.size,
        )
    laws = fit_directions(samples, weighting)
    require_visible_onset(laws, samples)
    polar = fit_polar(laws, samples, weighting)
    assert polar is not None  # read_samples saw to it that the directions suffice
    return MacroModel(
        polar=polar,
        laws=laws,
        errors=assess(samples, laws, polar, weighting),
        weighting=weighting,
        n_ignored=samples.n_ignored,
        labels=_labels(sweep),
        config={"weighting": weighting, "sweep": _config(sweep)},
    )


def _labels(sweep: xr.Dataset) -> dict[str, float | str]:
    """What the sweep is labelled with: pattern, family, sizes, materials."""
    labels: dict[str, float | str] = {"family": "custom", "pattern": "custom"}
    for scalar in SCALARS:
        if scalar.name in sweep.variables and sweep[scalar.name].ndim == 0:
            labels[scalar.name] = sweep[scalar.name].item()
    return labels


def _config(sweep: xr.Dataset) -> dict[str, Any]:
    config: dict[str, Any] = json.loads(sweep.attrs.get("flexscale_config", "{}"))
    return config
