"""From unknowns to world vectors: the curvature map, the periodic cell, and the pull-back of forces and stiffness."""
