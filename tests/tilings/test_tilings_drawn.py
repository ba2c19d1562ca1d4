"""The groups that symbols generate, named, and seen in the drawn tiles."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.tilings import Family, Tiling, families
from flexscale.tilings.bravais import reduced_lattice
from flexscale.tilings.drawn_symmetry import drawn_symmetry
from flexscale.tilings.geometry import family_geometry
from flexscale.tilings.wallpaper import Reflection, group_name
from tests.tilings.tiling_checks import flat_curves

ALL = pytest.mark.parametrize("family", families(), ids=lambda family: family.name)


def parameters_of(family: Family) -> np.ndarray:
    """Parameters without meaning."""
    return np.random.default_rng(5).uniform(-0.08, 0.08, family.n_parameters)


@ALL
def test_generated_isometries_make_the_group_of_the_list(family: Family) -> None:
    group = family_geometry(family.name).group
    tiling = Tiling(family.name, parameters_of(family))
    flat, basis = tiling.corners.ravel(), reduced_lattice(tiling.lattice)
    motions = [aspect @ symmetry for aspect in group.aspects for symmetry in group.symmetries]
    reflections = []
    for motion in motions:
        if motion.linear.reverses:
            linear, shift = motion.linear.matrix, motion.shift @ flat
            images = basis @ linear.T @ np.linalg.inv(basis)
            twice = (shift + linear @ shift) @ np.linalg.inv(basis)
            assert np.abs(images - np.rint(images)).max() < 1e-9
            assert np.abs(twice - np.rint(twice)).max() < 1e-9
            (a, b), (c, d) = np.rint(images).astype(int).tolist()
            p, q = np.rint(twice).astype(int).tolist()
            reflections.append(Reflection(((a, b), (c, d)), (p, q), 0.0))
    assert group_name(len(motions) - len(reflections), reflections) == family.group


@ALL
def test_curved_tiles_show_the_group_of_their_type(family: Family) -> None:
    """Just this group and no smaller cell, unless the type needs markings on its tiles."""
    tiling = Tiling(family.name, parameters_of(family), flat_curves(family))
    drawn = drawn_symmetry(tiling.tiles, tiling.lattice)
    shown = (drawn.group, drawn.n_primitive_cells) == (family.group, 1)
    assert shown == (not family.needs_marking)
