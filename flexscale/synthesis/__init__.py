"""Scale-level geometry of a deformed macro sheet: rigid scales placed on it, kept apart, written.

The paper places scales so and notes that they may overlap; here overlap is measured and removed.
"""

from flexscale.synthesis.scaled_sheet import ScaledSheet, synthesize_scales

__all__ = ["ScaledSheet", "synthesize_scales"]
