"""From a pattern and a native model's name to the problem that is solved."""

from __future__ import annotations

from flexscale.homogenize.native_model import NativeModel
from flexscale.homogenize.problem import Problem
from flexscale.patterns.pattern import Pattern


def build_problem(pattern: Pattern, native: NativeModel) -> Problem:
    """The cell of a pattern in a native model.

    Raises
    ------
    PatternError, MeshError : the model cannot be made of the pattern.
    """
    if native.name == "joints":
        from flexscale.homogenize.joint_cell import JointCell

        return JointCell.from_pattern(pattern, native)
    from flexscale.homogenize.cell_problem import CellProblem

    return CellProblem.from_pattern(pattern, native)
