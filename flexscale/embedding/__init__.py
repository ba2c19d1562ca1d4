"""From unknowns to world vectors: curvature map, periodic cell, pull-back."""
