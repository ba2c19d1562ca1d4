"""Equal joints have equal keys; sizes of which no joint can be computed are refused."""

from __future__ import annotations

from dataclasses import fields

import pytest

from flexscale.errors import BadInputError, PatternError, UnitRangeError
from flexscale.fabricate.options import Grooves
from flexscale.joints.key import JointGroove, joint_key
from flexscale.joints.library import half_width, pattern_key
from flexscale.patterns import PETG, RIGID, TPU, NeoHookean, Pattern
from flexscale.tilings import Tiling


def test_joints_of_one_shape_and_ratio_have_one_key() -> None:
    soft = NeoHookean(TPU.young_modulus / 2.0, TPU.poisson_ratio)
    half = NeoHookean(PETG.young_modulus / 2.0, PETG.poisson_ratio)
    small = joint_key(0.4, 0.4, 4.0, TPU, PETG)
    assert joint_key(0.8, 0.8, 8.0, soft, half) == small
    assert joint_key(0.8, 0.8, 8.0, soft, half).digest == small.digest
    assert joint_key(0.4, 0.4, 4.02, TPU, PETG) == small  # heights are rounded
    others = [
        joint_key(0.41, 0.4, 4.0, TPU, PETG),
        joint_key(0.4, 0.4, 4.4, TPU, PETG),
        joint_key(0.4, 0.4, 4.0, soft, PETG),
        joint_key(0.4, 0.4, 4.0, TPU),
        joint_key(0.4, 0.4, 4.0, TPU, PETG, JointGroove()),
    ]
    digests = {key.digest for key in (small, *others)}
    assert len(digests) == 1 + len(others)


def test_rigid_scales_have_no_material() -> None:
    assert joint_key(0.4, 0.4, 4.0, TPU).modulus_ratio is None
    pattern = Pattern(Tiling("IH76"))
    assert pattern_key(pattern.with_(scale_material=RIGID)) == joint_key(0.4, 0.4, 4.0, TPU)
    assert pattern_key(pattern) == joint_key(0.4, 0.4, 4.0, TPU, PETG)


def test_grooves_are_those_that_are_printed() -> None:
    printed, groove = Grooves(), JointGroove()
    assert (groove.first, groove.width) == (printed.first, printed.width)
    assert (groove.pitch, groove.depth) == (printed.pitch, printed.depth)
    assert len(fields(groove)) == 4
    key = joint_key(0.4, 0.4, 4.0, TPU, PETG, groove)
    assert key.grooves == ((2.0, 4.0),)
    assert key.groove_depth == 0.5


def test_half_width_is_the_radius_of_the_largest_circle_in_a_scale() -> None:
    assert half_width(Pattern(Tiling("IH76")), 0.4) == pytest.approx(4.8, rel=1e-3)


@pytest.mark.parametrize(
    ("sizes", "error", "said"),
    [
        ((0.0, 0.4, 4.0), UnitRangeError, "gap is 0 mm, but must be positive"),
        ((0.4, -0.4, 4.0), UnitRangeError, "thickness is -0.4 mm, but must be positive"),
        ((8.0, 0.4, 4.0), PatternError, "20 thicknesses"),
        ((0.4, 0.4, 0.2), PatternError, "0.5 thicknesses of the sheet high"),
    ],
)
def test_sizes_without_a_joint_are_refused(
    sizes: tuple[float, float, float], error: type[BadInputError], said: str
) -> None:
    with pytest.raises(error, match=said):
        joint_key(*sizes, TPU, PETG)


def test_a_gap_wider_than_half_a_scale_is_refused() -> None:
    with pytest.raises(PatternError, match=r"wider than the scales' half width of 0\.5 mm"):
        joint_key(0.6, 0.4, 4.0, TPU, PETG, half_width=0.5)


def test_grooves_that_cut_through_or_leave_nothing_are_refused() -> None:
    with pytest.raises(PatternError, match=r"cut through the sheet of 0\.4 mm"):
        joint_key(0.4, 0.4, 4.0, TPU, PETG, JointGroove(depth=0.4))
    with pytest.raises(PatternError, match="leave nothing between them"):
        joint_key(0.4, 0.4, 4.0, TPU, PETG, JointGroove(pitch=0.8))
    with pytest.raises(BadInputError, match="give a JointGroove"):
        joint_key(0.4, 0.4, 4.0, TPU, PETG, 0.2)  # type: ignore[arg-type]
