"""FlexScale: bending of flexible scaled sheets, from a scale pattern to its bending dataset.

Public names load on first use (PEP 562), so `import flexscale` costs nothing and reading datasets
needs neither gmsh nor numba.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

from flexscale.kernel_cache import provide_kernel_cache

if TYPE_CHECKING:
    from flexscale import plotting as plot
    from flexscale.datasets.onset import contact_onset
    from flexscale.datasets.registry import between, open_registry
    from flexscale.exchange.export import export
    from flexscale.finite.deformed_scales import deform_native_sheet
    from flexscale.finite.native_rigs import simulate_native_mandrel, simulate_native_stage
    from flexscale.finite.native_sheet_dataset import simulate_native_sheet
    from flexscale.homogenize.native_model import NativeModel
    from flexscale.homogenize.sweep import sweep
    from flexscale.homogenize.tangent import tangent_stiffness
    from flexscale.homogenize.tensor_sweep import tensor_sweep
    from flexscale.joints.library import joint_law
    from flexscale.macro.fit import fit
    from flexscale.macro.gap_model import GapModel, gap_model
    from flexscale.macro.model import MacroModel
    from flexscale.macro.tensor_model import TensorModel, tensor_model
    from flexscale.mechanics.contact_options import ContactOptions
    from flexscale.mechanics.joint_law import JointLaw
    from flexscale.mechanics.scale_options import ScaleOptions
    from flexscale.mechanics.substrate_options import SubstrateOptions
    from flexscale.mesh.options import MeshOptions
    from flexscale.mesh.solid_options import SolidOptions
    from flexscale.patterns.material import PETG, RIGID, TPU, TPU_MEASURED, NeoHookean
    from flexscale.patterns.named import named_pattern, named_patterns
    from flexscale.patterns.pattern import Pattern
    from flexscale.sheets.bent_sheet import SheetOptions
    from flexscale.sheets.mandrel import simulate_mandrel
    from flexscale.sheets.rigs import RigOptions
    from flexscale.sheets.simulate import simulate_sheet
    from flexscale.sheets.stage import simulate_stage
    from flexscale.solve.solver_options import SolverOptions
    from flexscale.synthesis.scaled_sheet import ScaledSheet, synthesize_scales
    from flexscale.tilings import Tiling, families

__version__ = "0.1.0"

provide_kernel_cache()

__all__ = [
    "PETG",
    "RIGID",
    "TPU",
    "TPU_MEASURED",
    "ContactOptions",
    "GapModel",
    "JointLaw",
    "MacroModel",
    "MeshOptions",
    "NativeModel",
    "NeoHookean",
    "Pattern",
    "RigOptions",
    "ScaleOptions",
    "ScaledSheet",
    "SheetOptions",
    "SolidOptions",
    "SolverOptions",
    "SubstrateOptions",
    "TensorModel",
    "Tiling",
    "between",
    "contact_onset",
    "deform_native_sheet",
    "export",
    "families",
    "fit",
    "gap_model",
    "joint_law",
    "named_pattern",
    "named_patterns",
    "open_registry",
    "plot",
    "simulate_mandrel",
    "simulate_native_mandrel",
    "simulate_native_sheet",
    "simulate_native_stage",
    "simulate_sheet",
    "simulate_stage",
    "sweep",
    "synthesize_scales",
    "tangent_stiffness",
    "tensor_model",
    "tensor_sweep",
]

#: Public name -> module that holds it; a module itself where the two are the same thing.
PUBLIC_HOMES = {
    "PETG": "flexscale.patterns.material",
    "RIGID": "flexscale.patterns.material",
    "TPU": "flexscale.patterns.material",
    "TPU_MEASURED": "flexscale.patterns.material",
    "JointLaw": "flexscale.mechanics.joint_law",
    "GapModel": "flexscale.macro.gap_model",
    "MacroModel": "flexscale.macro.model",
    "MeshOptions": "flexscale.mesh.options",
    "NativeModel": "flexscale.homogenize.native_model",
    "NeoHookean": "flexscale.patterns.material",
    "Pattern": "flexscale.patterns.pattern",
    "ContactOptions": "flexscale.mechanics.contact_options",
    "RigOptions": "flexscale.sheets.rigs",
    "SheetOptions": "flexscale.sheets.bent_sheet",
    "SolidOptions": "flexscale.mesh.solid_options",
    "ScaledSheet": "flexscale.synthesis.scaled_sheet",
    "ScaleOptions": "flexscale.mechanics.scale_options",
    "SolverOptions": "flexscale.solve.solver_options",
    "SubstrateOptions": "flexscale.mechanics.substrate_options",
    "TensorModel": "flexscale.macro.tensor_model",
    "Tiling": "flexscale.tilings",
    "between": "flexscale.datasets.registry",
    "contact_onset": "flexscale.datasets.onset",
    "deform_native_sheet": "flexscale.finite.deformed_scales",
    "export": "flexscale.exchange.export",
    "families": "flexscale.tilings",
    "fit": "flexscale.macro.fit",
    "joint_law": "flexscale.joints.library",
    "gap_model": "flexscale.macro.gap_model",
    "named_pattern": "flexscale.patterns.named",
    "named_patterns": "flexscale.patterns.named",
    "open_registry": "flexscale.datasets.registry",
    "simulate_mandrel": "flexscale.sheets.mandrel",
    "simulate_native_sheet": "flexscale.finite.native_sheet_dataset",
    "simulate_native_mandrel": "flexscale.finite.native_rigs",
    "simulate_native_stage": "flexscale.finite.native_rigs",
    "simulate_sheet": "flexscale.sheets.simulate",
    "simulate_stage": "flexscale.sheets.stage",
    "sweep": "flexscale.homogenize.sweep",
    "synthesize_scales": "flexscale.synthesis.scaled_sheet",
    "tangent_stiffness": "flexscale.homogenize.tangent",
    "tensor_model": "flexscale.macro.tensor_model",
    "tensor_sweep": "flexscale.homogenize.tensor_sweep",
}


def __getattr__(name: str) -> object:
    if name == "plot":
        value: object = importlib.import_module("flexscale.plotting")
    elif name in PUBLIC_HOMES:
        value = getattr(importlib.import_module(PUBLIC_HOMES[name]), name)
    else:
        raise AttributeError(f"module 'flexscale' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
