"""What a cell is made of, and how it is solved."""

from __future__ import annotations

from dataclasses import dataclass, field

from flexscale.homogenize.native_model import NativeModel
from flexscale.homogenize.scale_loads import SheetSupport
from flexscale.mechanics.contact_options import ContactOptions
from flexscale.mechanics.scale_options import ScaleOptions
from flexscale.mechanics.substrate_options import SubstrateOptions
from flexscale.mesh.solid_options import SolidOptions
from flexscale.patterns import NeoHookean, Pattern

#: Young's moduli of rigid scales, relative to the substrate's. They strain evenly alone, so that
#: stiffnesses are some 3e-6 short of the limit; more would be hard on Newton's method.
RIGID = 1e3


def plate_stiffness(material: NeoHookean, thickness: float) -> float:
    """D = E t^3 / 12 (1 - nu^2) [N mm]."""
    return material.young_modulus * thickness**3 / (12.0 * (1.0 - material.poisson_ratio**2))


@dataclass(frozen=True)
class CellModel:
    """What a cell is made of, and how it is solved; with a mesh it makes a `CellProblem`.

    Attributes
    ----------
    substrate_material, scale_material : Neo-Hookean solids.
    substrate_thickness : mm.
    gap : mm, the narrowest between scales at rest; sets the length scale of contact.
    bond_radius : mm, around a point of a scale's outline, over which the sheet follows the base.
    contact : how scales touch.
    linear_solver : "auto", "pardiso" or "superlu".
    substrate : the elements of the sheet.
    scales : how scales are modeled.
    solid : how the substrate is graded if it is a solid; None if it is a shell.
    widest_gap : mm, between scales at rest, where it is wider than `gap`.
    """

    substrate_material: NeoHookean
    scale_material: NeoHookean
    substrate_thickness: float
    gap: float
    bond_radius: float = 0.0
    contact: ContactOptions = field(default_factory=ContactOptions)
    linear_solver: str = "auto"
    substrate: SubstrateOptions = field(default_factory=SubstrateOptions)
    scales: ScaleOptions = field(default_factory=ScaleOptions)
    solid: SolidOptions | None = None
    widest_gap: float = 0.0

    @property
    def plate_stiffness(self) -> float:
        """D of the substrate, N mm."""
        return plate_stiffness(self.substrate_material, self.substrate_thickness)

    @property
    def rigid_stiffness(self) -> float:
        """What a rigid scale's stiffness is multiplied by."""
        return RIGID * self.substrate_material.young_modulus / self.scale_material.young_modulus

    @property
    def sheet_support(self) -> SheetSupport:
        """What hangs on a scale."""
        modulus = self.substrate_material.young_modulus
        thickness = self.substrate_thickness
        return SheetSupport.of_strip(modulus, thickness, self.plate_stiffness, self.gap)

    @classmethod
    def of_pattern(
        cls,
        pattern: Pattern,
        native: NativeModel | None = None,
    ) -> CellModel:
        """Materials and sizes of a pattern, modeled so; by default if not told."""
        native = native or NativeModel("shell")
        return cls(
            pattern.substrate_material,
            pattern.scale_material,
            pattern.substrate_thickness,
            pattern.gap,
            pattern.bond_radius,
            native.contact,
            native.solver.linear_solver,
            native.substrate,
            native.scales,
            native.solid_options,
            max(pattern.gaps),
        )
