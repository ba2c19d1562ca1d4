"""Sizes of elements, the only knobs of the mesher."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from flexscale.checks import Check, checked, length, number, whole
from flexscale.errors import MeshError

MOST_GROWTH = 1e3  # of neighboring sizes: beyond, triangles are needles whatever the mesh


def _size(name: str) -> Check:
    return length(f"mesh option {name}")


def _growth(name: str, low: float) -> Check:
    return number("1", low, MOST_GROWTH, above=0.0, name=f"mesh option {name}")


def _count(name: str, low: int, high: int) -> Check:
    return whole(low, high, f"mesh option {name}")


@checked(
    across=_count("across", 2, 64),
    along=_size("along"),
    corner=_size("corner"),
    growth=_growth("growth", 1.0),
    across_grading=_growth("across_grading", 1.0 / MOST_GROWTH),
    scale_size=_size("scale_size"),
    scale_corner=_size("scale_corner"),
    scale_rim=_size("scale_rim"),
    scale_strips=_count("scale_strips", 0, 64),
    scale_growth=_growth("scale_growth", 1.0),
    scale_layers=_count("scale_layers", 1, 64),
    layer_growth=_growth("layer_growth", 1.0 / MOST_GROWTH),
    scale_order=_count("scale_order", 1, 2),
)
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
        if self.across % 2:
            raise MeshError(
                f"Mesh option across is {self.across}, but each tile owns half a gap: "
                "give an even number, 2 or more."
            )

    def to_config(self) -> dict[str, Any]:
        """The options as plain numbers; `MeshOptions(**config)` makes them again."""
        return asdict(self)

    @checked(factor=number("1", 0.01, 100.0, name="refinement factor"))
    def finer(self, factor: float) -> MeshOptions:
        """Options with all elements smaller by `factor`, graded over the same distances."""
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
