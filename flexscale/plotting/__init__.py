"""Figures from labelled datasets alone: no solver, no mesh generator, no network."""

from flexscale.plotting.curves import curves
from flexscale.plotting.fits import fit
from flexscale.plotting.gap_models import gap_model
from flexscale.plotting.joints import joint
from flexscale.plotting.macro_polar import macro_polar
from flexscale.plotting.polar import polar, stiffness
from flexscale.plotting.rigs import rig
from flexscale.plotting.saving import save_figure
from flexscale.plotting.scaled_sheet import scaled_sheet
from flexscale.plotting.scene import cell
from flexscale.plotting.sheets import sheet
from flexscale.plotting.style import flexscale_style
from flexscale.plotting.tensor_models import tensor_model
from flexscale.plotting.tensor_sweeps import tensor_sweep
from flexscale.plotting.turned_sheets import native_turned_sheet, turned_sheet

__all__ = [
    "cell",
    "curves",
    "fit",
    "flexscale_style",
    "gap_model",
    "joint",
    "macro_polar",
    "native_turned_sheet",
    "polar",
    "rig",
    "save_figure",
    "scaled_sheet",
    "sheet",
    "stiffness",
    "tensor_model",
    "tensor_sweep",
    "turned_sheet",
]
