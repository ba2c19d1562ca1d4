"""The linear joint against the clamped strip: values of the first estimate, and convergence."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.joints.compute import build_section, linear_stiffness
from flexscale.joints.key import JointKey
from flexscale.joints.section_mesh import Grading
from flexscale.joints.states import rest_state

RATIO = 0.48
PLANE, SHEAR = 1.0 / (1.0 - RATIO**2), 0.5 / (1.0 + RATIO)
COARSE = (Grading(0.04, 1.6, 0.3), Grading(0.02, 1.6, 0.3))


def over_strip(stiffness: np.ndarray, gap: float) -> np.ndarray:
    """Stretch, hinge, hinge with u free, coupling, S-mode and slide over Kirchhoff's strip."""
    (uu, ww, ss, pp), up = np.diag(stiffness), stiffness[0, 3]
    bending = PLANE / 12.0
    return np.array(
        [uu * gap / PLANE, pp * gap / bending, (pp - up**2 / uu) * gap / bending,
         up / np.sqrt(uu * pp), ww * gap**3 / (12.0 * bending), ss * gap / SHEAR]
    )  # fmt: skip


def test_values_at_a_gap_of_one_thickness() -> None:
    """Of an independent solid, given to two or three digits: 0.34, 0.64, 0.545, -0.39, 0.094 and
    0.53. Ours in the limit: 0.3413, 0.6423, 0.5444, -0.3904, 0.0934, 0.5332; two coarse meshes
    with Richardson's extrapolation come within 0.5 % of these."""
    found = over_strip(linear_stiffness(JointKey(1.0, 10.0, RATIO), COARSE), 1.0)
    assert found == pytest.approx([0.3413, 0.6423, 0.5444, -0.3904, 0.0934, 0.5332], rel=5e-3)
    assert found == pytest.approx([0.34, 0.64, 0.545, -0.39, 0.094, 0.53], rel=1.2e-2)


def test_wide_joints_tend_to_the_strip_from_below() -> None:
    """The bond's compliance is as of some tenths of a thickness more gap, so that 1 - ratio falls
    as 1/g; a strip has no coupling about its middle surface, so that falls too."""
    ratios = np.array(
        [over_strip(linear_stiffness(JointKey(g, 10.0, RATIO), COARSE), g) for g in (2, 4, 8)]
    )
    missing = 1.0 - ratios[:, [0, 1, 2, 4, 5]]
    assert (missing > 0.0).all()
    assert (np.diff(missing, axis=0) < 0.0).all()
    compliance = 1.0 / ratios[:, [0, 1, 2, 5]] - 1.0
    assert compliance[2] == pytest.approx(0.5 * compliance[1], rel=0.12)
    assert np.abs(ratios[:, 3]) == pytest.approx(sorted(np.abs(ratios[:, 3]), reverse=True))


def test_error_of_the_stiffness_falls_with_the_smallest_element() -> None:
    """The stress is singular as r^(-1/2), so that elements of size a at the edge miss an energy of
    the order a; those farther off, of fixed growth, add a constant."""
    key, found = JointKey(1.0, 10.0, RATIO), []
    for size in (0.08, 0.04, 0.02, 0.01):
        grading = Grading(size, 1.5, 0.25)
        found.append(np.diag(rest_state(build_section(key, grading, slides=True)).tangent))
    steps = -np.diff(found, axis=0)
    assert (steps > 0.0).all()  # from above
    rates = np.log2(steps[:-1] / steps[1:])
    # From mesh to mesh the number of elements between edge and middle jumps: hence the spread.
    assert rates.mean(axis=0) == pytest.approx(np.ones(4), abs=0.35)


def test_elastic_scales_are_softer_and_hard_ones_rigid() -> None:
    rigid, petg, hard = (
        linear_stiffness(JointKey(1.0, 6.0, RATIO, ratio, other), COARSE)
        for ratio, other in ((None, None), (77.7, 0.35), (1e6, 0.35))
    )
    assert np.linalg.eigvalsh(rigid - petg).min() > -1e-6
    assert np.diag(petg) == pytest.approx(np.diag(rigid), rel=0.06)
    # Depths behind the walls differ, 6 and 8 thicknesses.
    assert np.diag(hard) == pytest.approx(np.diag(rigid), rel=4e-3)
