"""Small experiments, and what is said about bad ones."""

from __future__ import annotations

import copy
from typing import Any

import pytest

from flexscale.errors import BadInputError
from flexscale.steps.experiment import parse_experiment
from flexscale.steps.plan import Plan, build_plan

SMALL: dict[str, Any] = {
    "patterns": {"tiles": {"family": "IH76"}},
    "sweep": {"directions": [0, 45], "curvatures": [0, 0.001]},
}
SHELL: dict[str, Any] = SMALL | {"native": "shell"}
FITTED: dict[str, Any] = SMALL | {
    "sweep": {
        "directions": {"start": 0, "stop": 180, "step": 15},
        "curvatures": [0, 0.005, 0.01, 0.015, 0.02],
    },
    "fit": {},
}

#: Sheets and devices of scales that are computed in seconds.
NATIVE: dict[str, Any] = {
    "patterns": {"hexagon": {"family": "IH20"}},
    "native_sheet": {"length": 60, "width": 30, "curvatures": [0, 0.004], "sides": "opening"},
    "native_turned_sheet": {
        "length": 60,
        "width": 30,
        "curvature": 0.004,
        "directions": [0, 45, 60],
    },
    "native_rig": {
        "sides": "closing",
        "mandrel": {"radius": 30, "indentation": "2 mm", "angles": [0, 45, 60]},
        "stage": {"length": 60, "width": 30, "shortenings": [0.1, "0.05 cm"], "direction": 90},
    },
}


def changed(**changes: Any) -> dict[str, Any]:
    """SMALL with the pattern's keys changed."""
    content = copy.deepcopy(SMALL)
    content["patterns"]["tiles"].update(changes)
    return content


def message_of(content: Any) -> str:
    """What the user reads about a bad experiment; it must be ready for exit code 2."""
    with pytest.raises(BadInputError) as caught:
        build_plan(parse_experiment(content, "file.yaml"))
    assert caught.value.exit_code == 2
    return str(caught.value)


def plan_of(content: dict[str, Any]) -> Plan:
    """The plan of an experiment file of this content."""
    return build_plan(parse_experiment(content, "file.yaml"))
