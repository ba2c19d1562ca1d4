"""Surfaces as Wavefront .obj files: plain text that every modeling program reads."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from flexscale.arrays import FloatArray, IntArray


def write_obj(
    path: str | os.PathLike[str], vertices: FloatArray, groups: Mapping[str, IntArray]
) -> None:
    """Write triangles in named groups.

    Parameters
    ----------
    path : file to write; it appears complete or not at all.
    vertices : (n, 3) mm.
    groups : name without blanks -> (m, 3) vertices of its triangles, counted from 0.
    """
    lines = ["# lengths in mm"]
    lines += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices.tolist()]
    for name, triangles in groups.items():
        lines.append(f"g {name}")
        lines += [f"f {a} {b} {c}" for a, b, c in (triangles + 1).tolist()]
    target = Path(path)
    partial = target.with_name(f".{target.name}.{os.getpid()}.partial")
    partial.write_text("\n".join(lines) + "\n", encoding="ascii")
    os.replace(partial, target)
