"""Scale patterns: polygons on a lattice, gap, sizes and materials."""

from flexscale.patterns.material import PETG, RIGID, TPU, TPU_MEASURED, NeoHookean
from flexscale.patterns.named import NamedPattern, named_pattern, named_patterns
from flexscale.patterns.pattern import Pattern
from flexscale.patterns.prototiles import Prototile, TileCopy
from flexscale.patterns.symmetry import Isometry

__all__ = [
    "PETG",
    "RIGID",
    "TPU",
    "TPU_MEASURED",
    "Isometry",
    "NamedPattern",
    "NeoHookean",
    "Pattern",
    "Prototile",
    "TileCopy",
    "named_pattern",
    "named_patterns",
]
