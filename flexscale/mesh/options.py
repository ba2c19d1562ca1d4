"""Sizes of elements, the only knobs of the mesher."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from flexscale.errors import MeshError
from flexscale.units import require_finite, require_positive


@dataclass(frozen=True)
class MeshOptions:
    """Element sizes of a periodic mesh.

    Attributes
    ----------
    across : elements across the whole gap, even: each tile owns half a gap. Where tiles are too
        sharp for rows of elements along the gap, it bounds the elements near the scales' tips.
    along : mm, largest element along the gap.
    corner : mm, size along the gap at tiling vertices.
    growth : ratio of neighboring sizes along the gap, away from the vertices, at least 1.
    across_grading : ratio of neighboring sizes across the gap, away from the scale outline.
    scale_size : mm, largest size of the triangles of a scale's base.
    scale_corner : mm, size along the outline of the base at the tiling's vertices.
    scale_rim : mm, width of the outermost strip of the base. The sheet pulls there: a third to
        half of the bond radius is good.
    scale_strips : strips along the outline of the base, each `scale_growth` times as wide as the
        one outside it; fewer where they would not fit, none if 0.
    scale_growth : ratio of neighboring sizes in a base, away from the vertices and the outline, at
        least 1.
    scale_layers : layers of tets over the height of a scale.
    layer_growth : ratio of neighboring layers' heights, upward from the base.
    scale_order : 1 linear tets (the paper's; they lock in bending), 2 quadratic.
    """

    across: int = 4
    along: float = 0.8
    corner: float = 0.1
    growth: float = 2.0
    across_grading: float = 1.6
    scale_size: float = 2.4
    scale_corner: float = 0.6
    scale_rim: float = 0.14
    scale_strips: int = 4
    scale_growth: float = 1.5
    scale_layers: int = 7
    layer_growth: float = 1.5
    scale_order: int = 2

    def __post_init__(self) -> None:
        for name in ("along", "corner", "scale_size", "scale_corner", "scale_rim"):
            require_positive(getattr(self, name), f"mesh option {name}", "mm")
        for name in ("across_grading", "growth", "scale_growth", "layer_growth"):
            require_positive(getattr(self, name), f"mesh option {name}", "1")
        for name in ("growth", "scale_growth"):
            if getattr(self, name) < 1.0:
                raise MeshError(
                    f"Mesh option {name} is {getattr(self, name):g}, but sizes grow away from the "
                    "tiling vertices: give at least 1."
                )
        across = require_finite(self.across, "mesh option across", "1")
        if across < 2 or across % 2:
            raise MeshError(
                f"Mesh option across is {across:g}, but each tile owns half a gap: "
                "give an even number, 2 or more."
            )
        object.__setattr__(self, "across", int(across))
        for name, least in (("scale_layers", 1), ("scale_strips", 0)):
            number = require_finite(getattr(self, name), f"mesh option {name}", "1")
            if number < least or number % 1:
                raise MeshError(
                    f"Mesh option {name} is {number:g}: give a whole number, {least} or more."
                )
            object.__setattr__(self, name, int(number))
        if self.scale_order not in (1, 2):
            raise MeshError(
                f"Mesh option scale_order is {self.scale_order}: give 1 for linear tets or 2 for "
                "quadratic ones."
            )

    def to_config(self) -> dict[str, Any]:
        """The options as plain numbers; `MeshOptions(**config)` makes them again."""
        return asdict(self)

    def finer(self, factor: float) -> MeshOptions:
        """Options with all elements smaller by `factor`, graded over the same distances."""
        factor = require_positive(factor, "refinement factor", "1")
        return MeshOptions(
            across=2 * max(1, round(0.5 * self.across * factor)),
            along=self.along / factor,
            corner=self.corner / factor,
            growth=self.growth ** (1.0 / factor),
            across_grading=self.across_grading ** (1.0 / factor),
            scale_size=self.scale_size / factor,
            scale_corner=self.scale_corner / factor,
            scale_rim=self.scale_rim / factor,
            scale_strips=round(self.scale_strips * factor),
            scale_growth=self.scale_growth ** (1.0 / factor),
            scale_layers=max(1, round(self.scale_layers * factor)),
            layer_growth=self.layer_growth ** (1.0 / factor),
            scale_order=self.scale_order,
        )
