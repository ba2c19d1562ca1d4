"""Isohedral tilings: families of tiles that cover the plane, each in one size-free form."""

from flexscale.tilings.families import families
from flexscale.tilings.tiling import Tiling

__all__ = ["Tiling", "families"]
