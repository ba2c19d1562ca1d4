"""From a pattern to its bending response: one cell problem, its tangent at rest, sweeps over curvature."""
