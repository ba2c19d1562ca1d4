"""What averaged normals make of a single straight hinge."""

from __future__ import annotations

import numpy as np

GAP = 0.4  # mm


def hinge_share(n: int, size: float, triangles: bool) -> float:
    """Share of the hinge energy D Theta^2 / 2 g that averaged normals give to a straight gap.

    The gap has n elements across, between flat neighbors `size` mm wide. Faces turn by a_0 = 0, a_1
    ... a_n, a_n+1 = Theta, edge normals lie halfway, and an element of width h bends by phi, phi'
    at its two edges: D (phi + phi')^2 / 2 h as one piece, D (phi^2 + phi'^2) / h if two triangles
    with one edge each make it up.
    """
    widths = np.array([size, *[GAP / n] * n, size])
    faces = np.eye(n + 2)
    normals = 0.5 * (faces[1:] + faces[:-1])
    left = np.vstack([np.zeros(n + 2), faces[1:] - normals])
    right = np.vstack([normals - faces[:-1], np.zeros(n + 2)])
    if triangles:
        energy = 2.0 * sum(side.T @ (side / widths[:, None]) for side in (left, right))
    else:
        energy = (left + right).T @ ((left + right) / widths[:, None])
    free, end = slice(1, n + 1), n + 1
    relaxed = np.linalg.lstsq(energy[free, free], -energy[free, end], rcond=1e-12)[0]
    return float(GAP * (energy[end, end] + energy[end, free] @ relaxed))


def hinge_tables() -> list[str]:
    """Shares of a single hinge, as pieces and as triangles."""
    lines = ["## A single hinge with averaged normals", ""]
    for triangles, title in ((False, "one piece a width"), (True, "two triangles a width")):
        lines += [f"Share of the true energy, {title}:", "", "| s [mm] | n=1 | n=2 | n=4 | n=8 |"]
        lines.append("|---|---|---|---|---|")
        for size in (0.1, 0.4, 1.0, 2.0):
            shares = [f"{hinge_share(n, size, triangles):.2f}" for n in (1, 2, 4, 8)]
            lines.append(f"| {size:g} | {' | '.join(shares)} |")
        lines.append("")
    return [
        *lines,
        "s is the width of the flat element on either side, which averaged normals bend too.",
        "As one piece, faces that turn by θ, -θ, θ … cost nothing, and elements across the gap",
        "do not help. Of two triangles each has one edge along the gap, so such zigzags cost",
        "something: the cells below follow the table of triangles. With edge angles every share",
        "is 1.",
        "",
    ]
