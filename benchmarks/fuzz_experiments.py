"""Experiment files with mistakes: values, keys, and texts that are no YAML."""

from __future__ import annotations

import copy
import math
import os
import random
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import yaml

from flexscale.datasets.store import Store
from flexscale.errors import FlexScaleError
from flexscale.steps.events import EventWriter
from flexscale.steps.experiment import load_experiment
from flexscale.steps.plan import build_plan
from flexscale.steps.worker import run_job

COARSE = {"scale_layers": 2, "scale_size": 6.0, "scale_strips": 1, "across": 2}
SQUARE = [[0, 0], [10, 0], [10, 10], [0, 10]]
_COMMON: dict[str, Any] = {
    "patterns": {
        "squares": {"family": "IH76", "gap": "0.4 mm", "scale_material": "PETG"},
        "bent": {"named": "chevron", "tile_area": "1 cm2"},
        "own": {"tiles": [SQUARE], "lattice": [[10, 0], [0, 10]], "scale_height": 4,
                "substrate_material": {"young_modulus": 12, "poisson_ratio": 0.45}},
        "curved": {"family": "IH64", "parameters": [-0.2], "edges": {"b": [[0, 0], [0.5, 0.1]]}},
    },
    "contact": {"activation": 0.005, "edge": "0.4 mm"},
    "solver": {"tolerance": 1e-9, "max_iterations": 60},
    "tangent": {"directions": [0, 45, 90]},
    "sweep": {"sides": ["closing", "opening"], "symmetry": True,
              "directions": {"start": 0, "stop": 180, "step": 15},
              "curvatures": [0, 0.005, 0.01, "15 1/m", 0.02]},
    "fit": {"weighting": "relative", "variant": "tangent", "w_biaxial": 100.0},
    "shape": [{"side": "closing", "direction": 0, "curvature": 0.01}],
    "gap_model": {"softened": True, "w_biaxial": 100.0, "directions": [0, 45]},
    "sheet": {"model": "fit", "length": 100, "width": 50, "curvatures": [0, 0.01], "direction": 0,
              "size": 10},
    "turned_sheet": {"length": 100, "width": 50, "curvature": 0.02, "directions": [0, 90],
                     "sides": ["closing"], "size": 10},
    "rig": {"sides": ["closing"], "size": 10, "stage": {"shortenings": [1, 2]},
             "mandrel": {"radius": 100, "hub": 10, "indentation": 5, "angles": [0, 90]}},
    "figures": ["polar", "tangent", "fit"],
}  # fmt: skip
#: Every block of two native models, small enough to be planned at once.
FULL: tuple[dict[str, Any], ...] = (
    _COMMON | {
        "native": "joints",
        "joint": {"groove": True},
        "tensor_sweep": {"directions": [0, 45], "shapes": [-45, 0], "curvatures": [0, 0.01],
                         "in_plane": "held", "symmetry": True},
        "native_sheet": {"length": 60, "width": 30, "curvatures": [0, 0.01], "offset": [1, 2],
                         "outline": [[0, 0], [60, 0], [60, 30], [30, 25], [0, 30]]},
        "native_turned_sheet": {"length": 60, "width": 30, "curvature": 0.01, "directions": [0]},
        "native_rig": {"sides": ["closing"], "stage": {"length": 60, "shortenings": [1]},
                       "mandrel": {"radius": 60, "hub": 10, "angles": [0, 90]}},
    },
    _COMMON | {
        "native": "shell",
        "mesh": dict(COARSE),
        "scales": {"model": "modes", "cutoff": 0.01},
        "substrate": {"element": "c1"},
        "joint": {"groove": False},
    },
)  # fmt: skip
#: What is computed in seconds.
SMALL: dict[str, Any] = {
    "patterns": {"squares": {"family": "IH76", "gap": 0.4, "scale_height": 4.0}},
    "native": "shell",
    "mesh": dict(COARSE),
    "contact": {"activation": 0.005},
    "solver": {"tolerance": 1e-9, "max_iterations": 60, "time_limit": 20},
    "tangent": {"directions": [0, 45]},
    "sweep": {"sides": ["opening"], "directions": [0], "curvatures": [0, 0.005]},
    "figures": ["tangent"],
}
VALUES: list[Any] = [
    None, True, False, "", "abc", "0.4", "0.4 mm", "-1 mm", "1e400 mm", "4,5 mm", "0.4 parsec",
    "400 \u03bcm", "2020 N/mm\u00b2", math.nan, math.inf, -math.inf, 0, -1, 1, 2, 0.5, 1e300,
    1e-300, 1e-6, 1e6, 10**400, [], {}, [0], [[0, 1]], [None], {"a": 1}, {1: 2}, "x" * 3000,
    "closing", "PETG", "\u00e9\u4e2d", "../../x", "-dash", {"start": 0, "stop": 1, "step": 0},
    {"start": 0, "stop": math.inf, "step": 1}, {"start": 0, "stop": 1, "step": 1e-9}, [0, 0],
    [1, 0], [math.nan], ["closing", "closing"], [[[0, 0]]],
]  # fmt: skip
TEXTS = [
    "!!int abc", "!!float x", "!!timestamp x", "!!binary '*'", "!!python/object/apply:os.getcwd []",
    "2020-13-45", "2020-01-01", "? [a] : 1", "[" * 300 + "]" * 300, "9" * 4400, "0x" + "f" * 5000,
    "*nothing", "&a [*a]", "- - -", "{a: 1, a: 2}", "\t- x", "'", '"\\x', "%YAML 9", "--- 1\n---",
    "<<: *x", "!!set {a, b}", "!!bool maybe", "1:60:99", "~", "=", "@x", "`x`", "| \n  x", "\x00",
    "\x1b[31m", "\ufeff", "\ud800".encode("utf-16", "surrogatepass").decode("utf-16", "ignore"),
]  # fmt: skip


def mutated_content(base: dict[str, Any], chance: random.Random) -> dict[str, Any]:
    """The experiment with one to three values or keys changed."""
    content = copy.deepcopy(base)
    names = chance.sample(sorted(base["patterns"]), min(2, len(base["patterns"])))
    content["patterns"] = {name: content["patterns"][name] for name in names}
    for _ in range(chance.choice([1, 1, 2, 3])):
        _change_somewhere(content, chance)
    return content


def _change_somewhere(content: Any, chance: random.Random) -> None:
    holder: Any = content
    while True:
        keys = list(holder) if isinstance(holder, dict) else list(range(len(holder)))
        if not keys:
            return
        key = chance.choice(keys)
        inner = holder[key]
        if not isinstance(inner, dict | list) or not inner or chance.random() < 0.15:
            break
        holder = inner
    how = chance.random()
    if how < 0.55:
        holder[key] = copy.deepcopy(chance.choice(VALUES))
    elif how < 0.75 and isinstance(inner, int | float) and not isinstance(inner, bool):
        holder[key] = inner * chance.choice([-1, 0, 1e-9, 1e-3, 0.5, 2, 1e3, 1e9, 1e-12])
    elif how < 0.85:
        del holder[key]
    elif isinstance(holder, dict):
        names = ["", "a b", "Squares", "4.8.8", "x" * 300, 3, "caf\u00e9", "-x", str(key) + "s"]
        holder[chance.choice(names)] = holder.pop(key)
    else:
        holder.insert(key, holder[key])


def mutated_file(bases: Sequence[dict[str, Any]], chance: random.Random) -> bytes:
    """Bytes of one of some experiments with mistakes in its content, its text, or its bytes."""
    base = chance.choice(bases)
    data = yaml.safe_dump(mutated_content(base, chance), allow_unicode=True).encode()
    if chance.random() < 0.7:
        return data
    text = data.decode()
    lines = text.split("\n")
    place = chance.randrange(len(lines))
    how = chance.randrange(5)
    if how == 0:
        head = lines[place].partition(":")[0]
        lines[place] = f"{head}: {chance.choice(TEXTS)}"
    elif how == 1:
        lines.insert(place, chance.choice(TEXTS))
    elif how == 2:
        bomb = ["b0: &b0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"]
        bomb += [f"b{k}: &b{k} [{', '.join([f'*b{k - 1}'] * 10)}]" for k in range(1, 10)]
        return ("\n".join([*bomb, text.replace("[]", "*b9")])).encode()
    elif how == 3:
        raw = bytearray(data)
        for _ in range(chance.randrange(1, 5)):
            raw[chance.randrange(len(raw))] = chance.randrange(256)
        return bytes(raw)
    else:
        return text.encode(chance.choice(["utf-16", "utf-8-sig", "latin-1"]), "replace")
    return "\n".join(lines).encode("utf-8", "replace")


def plan_file(path: Path) -> None:
    """Read and plan an experiment file, as `flexscale run --dry-run` does."""
    build_plan(load_experiment(path))


def run_all(seed: int, number: int, seconds: float) -> list[tuple[str, float, str]]:
    """Compute mutated experiments, each in a process of its own that is killed after a time.

    Parameters
    ----------
    seconds : of processor time; ten times as much of the clock.

    Returns
    -------
    Outcome ("done", "refused", "foreign", "hangs"), processor time and message of each.
    """
    chance = random.Random(seed)
    outcomes = []
    with tempfile.TemporaryDirectory() as folder:
        warm = Path(folder, "warm.yaml")
        warm.write_text(yaml.safe_dump(SMALL))
        _compute(warm, Path(folder, "warm"))  # kernels are compiled before processes begin
        for k in range(number):
            path = Path(folder, f"{k}.yaml")
            path.write_text(yaml.safe_dump(mutated_content(SMALL, chance)))
            outcomes.append(_in_a_process(path, Path(folder, str(k)), seconds))
            print(k, *outcomes[-1], file=sys.stderr, flush=True)
            if outcomes[-1][0] in ("foreign", "hangs"):
                print(path.read_text(), file=sys.stderr, flush=True)
    return outcomes


def _compute(path: Path, results: Path) -> None:
    plan = build_plan(load_experiment(path))
    store = Store(results)
    for job in plan:
        run_job(plan, job, store, 1, EventWriter(None))


def _in_a_process(path: Path, results: Path, seconds: float) -> tuple[str, float, str]:
    message = path.with_suffix(".txt")
    child = os.fork()
    if child == 0:
        code, used = 0, int(time.process_time())
        resource.setrlimit(resource.RLIMIT_CPU, (used + int(seconds), used + int(seconds) + 1))
        try:
            _compute(path, results)
        except FlexScaleError as error:
            code = 2
            message.write_text(str(error))
        except BaseException:
            code = 1
            message.write_text(traceback.format_exc())
        os._exit(code)
    deadline, ended = time.monotonic() + 10.0 * seconds, 0
    while not ended and time.monotonic() < deadline:
        time.sleep(0.02)
        ended, status, usage = os.wait4(child, os.WNOHANG)
    if not ended:
        os.kill(child, signal.SIGKILL)
        _, status, usage = os.wait4(child, 0)
    code = os.waitstatus_to_exitcode(status)
    told = message.read_text() if message.exists() else f"exit code {code}"
    outcome = {0: "done", 1: "foreign", 2: "refused"}.get(code, "hangs")
    return outcome, usage.ru_utime + usage.ru_stime, told if code else ""
