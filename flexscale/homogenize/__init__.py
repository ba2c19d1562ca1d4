"""From a pattern to its bending response: cell problem, tangent at rest, sweeps of curvature."""
