"""Isohedral tilings: families of tiles that cover the plane, each in one size-free form."""

from flexscale.tilings.families import Family, families
from flexscale.tilings.fit import fit_parameters
from flexscale.tilings.isometry import Isometry
from flexscale.tilings.symbols import EdgeClass
from flexscale.tilings.tiling import Tiling, outline_of

__all__ = [
    "EdgeClass",
    "Family",
    "Isometry",
    "Tiling",
    "families",
    "fit_parameters",
    "outline_of",
]
