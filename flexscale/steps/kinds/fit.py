"""Step `fit`: the macro model, from a sweep and the stiffness of the flat sheet."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from flexscale.datasets.variables import Variant, Weighting
from flexscale.steps.blocks import DoubleBending
from flexscale.steps.quantities import declared
from flexscale.steps.step import Figure, Resources, Step, StepBlock, Task

if TYPE_CHECKING:
    import xarray as xr

    from flexscale.steps.experiment import Experiment


def require_sweep_to_fit(experiment: Experiment) -> None:
    """Refuse a sweep that is too small for a fit."""
    import numpy as np

    from flexscale.macro.samples import require_axes

    sweep = experiment.block("sweep")
    require_axes(np.array(sweep.directions), np.array(sweep.curvatures))


class FitBlock(StepBlock):
    """Macro model: two-regime law in every direction, fitted to the sweep."""

    takes: ClassVar[tuple[str, ...]] = ("sweep", "tangent")

    weighting: Weighting = declared(
        "relative", "errors relative to each sample, or absolute as in the paper"
    )
    variant: Variant = declared(
        "tangent", "energy of a curvature tensor: on the tangent of the flat sheet, or the paper's"
    )
    w_biaxial: DoubleBending | None = declared(
        None, "resistance to double curvature, from the tile's size if left out", ge=0.0
    )

    def refuse_in(self, experiment: Experiment) -> None:
        """A sweep that is too small."""
        require_sweep_to_fit(experiment)


def compute(
    task: Task[FitBlock], inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind fit; samples of the sweep that did not converge are left out."""
    from flexscale.macro.fit import fit

    model = fit(
        inputs["sweep"],
        inputs["tangent"],
        variant=task.block.variant,
        weighting=task.block.weighting,
        w_biaxial=task.block.w_biaxial,
    )
    return dataclasses.replace(model, config=task.config).to_dataset()


FIT = Step(
    "fit",
    2,
    FitBlock,
    "two-regime law of the sweep; {} for defaults",
    compute,
    figures=(
        Figure(
            "fit",
            ("fit", "sweep"),
            lambda plot, fit, sweep: plot.fit(fit, sweep),
            "Stiffness before and after contact and contact curvature against direction, with "
            "their harmonics, and the fit in the direction of first contact.",
        ),
        Figure(
            "fitted_curves",
            ("fit", "sweep"),
            lambda plot, fit, sweep: plot.curves(sweep, fit=fit),
            "Bending moment against curvature: samples, and the fit on top.",
        ),
        Figure(
            "macro_polar",
            ("fit", "sweep"),
            lambda plot, fit, sweep: plot.macro_polar(fit, sweep),
            "Bending moment against bending direction: native samples and the macro model.",
        ),
    ),
)
