"""What a joint's law depends on, without units: equal joints have equal keys."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass

from flexscale.checks import MATERIAL, checked, instance, length, number
from flexscale.errors import PatternError
from flexscale.patterns.material import NeoHookean
from flexscale.units import LENGTHS

VERSION = 1  # of the laws: a change of their numbers raises it
DEPTH, RIGID_DEPTH = 6.0, 8.0  # thicknesses behind the walls that a section reaches
HEIGHT_STEP = 0.5  # thicknesses: heights of scales are rounded, W hardly depends on them
_DIGITS = 6  # significant, of the other numbers


@checked(
    first=number("mm", 0.0, LENGTHS[1]),
    width=length("groove width"),
    pitch=length("groove pitch"),
    depth=length("groove depth"),
)
@dataclass(frozen=True)
class JointGroove:
    """Grooves of the sheet that scales fill, parallel to the wall.

    Attributes
    ----------
    first : mm, from the wall to the first.
    width : mm, of each.
    pitch : mm, from one to the next.
    depth : mm, below the top of the sheet.
    """

    first: float = 0.8
    width: float = 0.8
    pitch: float = 1.6
    depth: float = 0.2


@dataclass(frozen=True)
class JointKey:
    """Sizes in thicknesses of the sheet, moduli in Young's modulus of the sheet.

    Attributes
    ----------
    gap, height : of the gap and of the scales above the sheet.
    poisson_ratio : of the sheet.
    modulus_ratio, scale_poisson_ratio : of the scales; None if they are rigid.
    grooves : behind the walls, from and to.
    groove_depth : 0 for a plain base.
    """

    gap: float
    height: float
    poisson_ratio: float
    modulus_ratio: float | None = None
    scale_poisson_ratio: float | None = None
    grooves: tuple[tuple[float, float], ...] = ()
    groove_depth: float = 0.0

    @property
    def depth(self) -> float:
        """How far behind the walls the section reaches."""
        return RIGID_DEPTH if self.modulus_ratio is None else DEPTH

    @property
    def digest(self) -> str:
        """Sixteen digits that stand for the key and for how laws are computed."""
        text = json.dumps({"version": VERSION, **asdict(self)}, sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:16]


@checked(
    gap=length(),
    thickness=length(),
    height=length("height of the scales"),
    substrate=MATERIAL,
    scales=MATERIAL,
    groove=instance("flexscale.joints.key:JointGroove", "give a JointGroove"),
    half_width=length("half width of the scales"),
)
def joint_key(
    gap: float,
    thickness: float,
    height: float,
    substrate: NeoHookean,
    scales: NeoHookean | None = None,
    groove: JointGroove | None = None,
    half_width: float | None = None,
) -> JointKey:
    """Key of a joint.

    Parameters
    ----------
    gap, thickness, height : mm, of the gap, of the sheet, and of the scales above it.
    substrate, scales : materials; scales of None are rigid.
    groove : None for a plain base.
    half_width : mm, of the narrower of both scales, that a joint must have behind its walls.

    Raises
    ------
    UnitRangeError : a size that is not positive.
    PatternError : sizes for which no joint can be computed.
    """
    _check_sizes(gap, thickness, height, half_width, groove)
    depth = (DEPTH if scales else RIGID_DEPTH) * thickness
    grooves: list[tuple[float, float]] = []
    if groove is not None:
        start = groove.first
        while start < depth * (1.0 - 1e-9):
            grooves.append((_round(start / thickness), _round((start + groove.width) / thickness)))
            start += groove.pitch
    return JointKey(
        gap=_round(gap / thickness),
        height=max(1, round(height / thickness / HEIGHT_STEP)) * HEIGHT_STEP,
        poisson_ratio=_round(substrate.poisson_ratio),
        modulus_ratio=_round(scales.young_modulus / substrate.young_modulus) if scales else None,
        scale_poisson_ratio=_round(scales.poisson_ratio) if scales else None,
        grooves=tuple(grooves),
        groove_depth=_round(groove.depth / thickness) if grooves and groove else 0.0,
    )


def _check_sizes(
    gap: float,
    thickness: float,
    height: float,
    half_width: float | None,
    groove: JointGroove | None,
) -> None:
    if half_width is not None and gap > half_width:
        raise PatternError(
            f"The gap of {gap:g} mm is wider than the scales' half width of {half_width:g} mm: "
            "such scales share no joint; choose a smaller gap."
        )
    ratio = gap / thickness
    if not 0.1 <= ratio <= 10.0:
        raise PatternError(
            f"The gap of {gap:g} mm is {ratio:.3g} thicknesses of the sheet ({thickness:g} mm): "
            "joints are computed for 0.1 to 10; choose another gap or thickness."
        )
    if not 1.0 <= height / thickness <= 100.0:
        raise PatternError(
            f"Scales of {height:g} mm are {height / thickness:.3g} thicknesses of the sheet high: "
            "joints are computed for 1 to 100; choose another height or thickness."
        )
    if groove is not None and groove.depth >= thickness:
        raise PatternError(
            f"Grooves of {groove.depth:g} mm cut through the sheet of {thickness:g} mm: "
            "choose a smaller depth."
        )
    if groove is not None and groove.pitch <= groove.width:
        raise PatternError(
            f"Grooves of {groove.width:g} mm leave nothing between them at a pitch of "
            f"{groove.pitch:g} mm: choose a larger pitch."
        )


def _round(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")
