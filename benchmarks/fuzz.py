"""Wrong calls of the public functions and wrong experiment files: is every one answered?

    python benchmarks/fuzz.py [--calls N] [--files N] [--seed S] [--run N] [--output FILE]

Arguments of every public function, options class and method are changed, one or two at a time: to
texts, truth values, numbers that are not finite, huge or negative ones, arrays of other shapes and
types, masked ones, lists that hold themselves, None, other objects; datasets lose, rename or retype
their variables. Sweeps, tangents and native sheets end where meshing begins, after all checks.
Experiment files get other values, keys and texts, broken YAML, and are read and planned. A call or
file is answered if it succeeds, or is refused by an error of ours with its sentence; everything
else is counted: exceptions of others, numbers that are not finite taken without a word or returned,
and calls that take more than ten seconds of processor time. With --run, small experiments with
mistakes are computed to their end, each in a process that has a minute of processor time.
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib as mpl
from fuzz_calls import Call, StoppedError, all_calls, results_are_finite, stopped_before_meshing
from fuzz_experiments import FULL, mutated_file, plan_file, run_all
from fuzz_values import has_infinity_or_nan, mutated
from report import heading, report, table

from flexscale.errors import LONGEST_LINE, FlexScaleError

ROOT = Path(__file__).resolve().parents[1]
SLOW, HANGS, MINUTE = 10.0, 300, 60.0  # s; of processor time, else of a clock
KINDS = ("succeeds", "refused", "foreign exception", "took nan or infinity", "slow", "no sentence")
#: Methods whose numbers may be infinite or nan: no contact, ever.
_MAY_BE_INFINITE = ("GapModel.onset", "GapModel.tensor_onset")


class HangsError(BaseException):
    """The time of a call is over."""


def _alarm(*_: Any) -> None:
    raise HangsError


def outcome_of(action: Callable[[], Any]) -> tuple[str, Any]:
    """What became of a call, of KINDS, and what it returned or how it failed."""
    signal.signal(signal.SIGALRM, _alarm)
    signal.alarm(HANGS)
    started = time.process_time()
    try:
        kind, found = "succeeds", action()
    except StoppedError:
        kind, found = "succeeds", None
    except FlexScaleError as error:
        text = str(error)
        kind, found = "refused", text
        if not text.strip() or max(map(len, text.split("\n"))) > LONGEST_LINE:
            kind = "no sentence"
    except HangsError:
        kind, found = "slow", "hangs"
    except Exception:
        kind, found = "foreign exception", traceback.format_exc()
    finally:
        signal.alarm(0)
    spent = time.process_time() - started
    if spent > SLOW and kind in ("succeeds", "refused"):
        return "slow", f"{spent:.0f} s"
    return kind, found


def try_call(call: Call, chance: random.Random) -> tuple[str, str]:
    """A call with one or two arguments changed: its outcome, and what to know of a fault."""
    arguments = call.with_changes(chance, mutated)

    def action() -> Any:
        result = call.function(**arguments)
        repr(result)  # what comes back can be looked at
        return result

    kind, found = outcome_of(action)
    if kind == "succeeds":
        taken = any(map(has_infinity_or_nan, arguments.values()))
        finite = results_are_finite(found) or call.name in _MAY_BE_INFINITE
        kind = "took nan or infinity" if taken or not finite else kind
    changed = {k: v for k, v in arguments.items() if v is not call.arguments[k]}
    return kind, f"{call.name}({_short(changed)}): {found}"


def _short(value: Any) -> str:
    try:
        return repr(value)[:300]
    except ValueError:
        return "…"


def try_calls(calls: list[Call], number: int, seed: int) -> Counter[tuple[str, str]]:
    """Outcomes by function; faults go to stderr."""
    chance, counts = random.Random(seed), Counter()
    with stopped_before_meshing():
        for k in range(number):
            call = (
                calls[k]
                if k < len(calls)
                else chance.choices(calls, [one.weight for one in calls])[0]
            )
            kind, told = try_call(call, chance)
            counts[call.name, kind] += 1
            if k % 500 == 499:
                _tell(f"{k + 1} calls: {_totals(counts)}")
            if kind not in ("succeeds", "refused"):
                _tell(f"{kind}: {told}")
    return counts


def _tell(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def try_files(number: int, seed: int) -> Counter[tuple[str, str]]:
    """Outcomes of reading and planning; faults go to stderr."""
    chance, counts = random.Random(seed), Counter()
    path = Path("experiment.yaml")
    for k in range(number):
        data = mutated_file(FULL, chance)
        path.write_bytes(data)
        kind, told = outcome_of(lambda: plan_file(path))
        counts["experiment files", kind] += 1
        if k % 500 == 499:
            _tell(f"{k + 1} files: {_totals(counts)}")
        if kind not in ("succeeds", "refused"):
            _tell(f"{kind}: {told}\n{data[:3000]!r}")
    return counts


def _rows(counts: Counter[tuple[str, str]]) -> list[list[str]]:
    names = sorted({name for name, _ in counts})
    return [[name, *(str(counts[name, kind]) for kind in KINDS)] for name in names]


def _totals(counts: Counter[tuple[str, str]]) -> str:
    return ", ".join(f"{kind} {sum(n for (_, k), n in counts.items() if k == kind)}"
                     for kind in KINDS)  # fmt: skip


def _computed(outcomes: list[tuple[str, float, str]]) -> list[str]:
    counts = Counter(outcome for outcome, _, _ in outcomes)
    longest = max((seconds for _, seconds, _ in outcomes), default=0.0)
    told = ", ".join(f"{kind} {counts[kind]}" for kind in ("done", "refused", "foreign", "hangs"))
    lines = ["## Experiments computed", ""]
    return [
        *lines,
        f"{len(outcomes)} in all: {told}; the longest took {longest:.0f} s of processor time.",
        "",
    ]


def main() -> None:
    """Calls, files, and experiments if they are asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--calls", type=int, default=7000)
    parser.add_argument("--files", type=int, default=7000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--run", type=int, default=0, help="experiments to compute")
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    options = parser.parse_args()
    output = options.output.resolve() if options.output else None
    mpl.use("Agg")
    rows = heading("Wrong calls and wrong experiment files", __doc__ or "")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        calls = Counter()
        if options.calls:
            wrong = all_calls(ROOT / "results")
            for call in wrong:  # unchanged, they succeed; kernels are compiled here
                call.function(**call.arguments)
            calls = try_calls(wrong, options.calls, options.seed)
        files = try_files(options.files, options.seed)
        os.chdir(ROOT)
    rows += [f"Seed {options.seed}. Calls: {_totals(calls)}.", ""]
    rows += [f"Experiment files: {_totals(files)}.", ""]
    if options.run:
        rows += _computed(run_all(options.seed, options.run, MINUTE))
    report(rows + table(["function", *KINDS], _rows(calls)), output)


if __name__ == "__main__":
    main()
