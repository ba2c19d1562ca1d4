"""What of a pattern joints were not compared with solids for: a sentence each, if there is need."""

from __future__ import annotations

import numpy as np
import pytest

import flexscale as fs
from flexscale.homogenize.joint_validity import doubts
from flexscale.patterns import Pattern
from flexscale.patterns.material import NeoHookean

SQUARE = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
SOFT = NeoHookean(young_modulus=500.0, poisson_ratio=0.4)


def squares(size: float = 1.0, **sizes: object) -> Pattern:
    return Pattern.from_polygons([size * SQUARE], [10.0 * size, 0.0], [0.0, 10.0 * size], **sizes)


def test_the_papers_sizes_raise_no_doubt() -> None:
    assert doubts(fs.named_pattern("square")) == ()
    assert doubts(squares(scale_material=fs.RIGID)) == ()


@pytest.mark.parametrize(
    ("pattern", "sentence"),
    [
        (squares(0.15), "narrower than 1.6 mm"),
        (squares(scale_material=SOFT), "scales are 19.2 times as stiff as the sheet"),
        (squares(substrate_thickness=1.0), "a gap of 0.4 mm is 0.4 thicknesses"),
        (squares(gap=2.0), "a gap of 2 mm is 5 thicknesses"),
    ],
)
def test_what_was_not_compared_is_told(pattern: Pattern, sentence: str) -> None:
    (found,) = doubts(pattern)
    assert sentence in found


def test_sharp_tips_are_told() -> None:
    tip = np.array([[0.0, 0.0], [20.0, 0.0], [30.0, 5.0], [10.0, 5.0]])  # 26.6 degree
    (found,) = doubts(Pattern.from_polygons([tip], tip[1], tip[3]))
    assert "tips of 27 degree" in found
