"""A run interrupted again and again, as by Ctrl-C: does it come to the same datasets, to the bit?

    python benchmarks/interruptions.py [--number 10] [--seed N] [--output FILE]

A reduced copy of workflows/printed.yaml (sweeps of three of its patterns every 15 degrees at few
curvatures, smaller sheets of scales, and scales on both testing devices) is run once undisturbed.
Then it is run in a fresh folder, and at a random time after each start SIGINT goes to all processes
of the run's group, which is what a terminal does for Ctrl-C. The same command then goes on in the
same folder, until it comes to its end; then content digests of all datasets must be those of the
undisturbed run, and the next interruption hits a fresh folder. Times are spread evenly from nothing
to a quarter of what the undisturbed run took. After an interruption the run must end with the exit
code 130 and its sentence; no process of it may be left fifteen seconds later; no dataset and no
finished sample may be lost.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import subprocess
import tempfile
import time
import uuid
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from kills import LIMIT, STOP, digests, marked, start
from report import heading, report, table

ROOT = Path(__file__).resolve().parents[1]
PATTERNS = ("hexagon", "chevron", "threefold")
SHARE = 0.25
SENTENCE = "interrupted; finished work is kept"
#: Datasets, and finished samples of each dataset that is not published yet, by its digest.
Kept = tuple[set[str], dict[str, int]]


@dataclass(frozen=True)
class Interruption:
    """One Ctrl-C and what came of it.

    Attributes
    ----------
    folder : number of the folder that it hit, from 1.
    moment, lasted : s, from the start to the signal, and from there to the end of the run.
    datasets, samples : finished at that moment: datasets, and samples of unfinished datasets.
    lost : datasets and samples that were gone afterwards.
    told : whether the run ended with its sentence and code 130.
    left : processes of the run that had to be killed.
    """

    folder: int
    moment: float
    lasted: float
    datasets: int
    samples: int
    lost: int
    told: bool
    left: int


def reduced() -> dict[str, Any]:
    """The experiment, of the keys of workflows/printed.yaml."""
    content = yaml.safe_load((ROOT / "workflows" / "printed.yaml").read_text())
    content["patterns"] = {name: content["patterns"][name] for name in PATTERNS}
    content["sweep"]["directions"]["step"] = 15
    content["sweep"]["curvatures"] = content["sweep"]["curvatures"][::3]
    content["native_sheet"] = {"length": 40, "width": 20, "curvatures": [0, 0.005, 0.01]}
    for name in ("tangent", "fit", "sheet", "figures"):
        del content[name]
    content["native_rig"] = {
        "mandrel": {"radius": 30, "indentation": 2, "angles": [0, 45]},
        "stage": {"length": 40, "width": 20, "shortenings": [0.5, 2]},
    }
    return dict(content)


def kept(results: Path) -> Kept:
    """What a folder holds."""
    datasets = {path.parent.name for path in results.glob("local/*/*/*/*/record.json")}
    samples: dict[str, int] = {}
    for path in results.glob("local/.staging/*/line-*/*.npz"):
        digest = path.parents[1].name
        samples[digest] = samples.get(digest, 0) + 1
    return datasets, samples


def lost(before: Kept, after: Kept) -> int:
    """Datasets and samples that are gone; samples of a dataset that is published are in it."""
    count = len(before[0] - after[0])
    for digest, number in before[1].items():
        if not any(digest.startswith(name) for name in after[0]):
            count += max(number - after[1].get(digest, 0), 0)
    return count


def ended(run: subprocess.Popen[str], mark: str) -> tuple[str, int]:
    """What a run says until it ends, and how many of its processes were left."""
    try:
        said = run.communicate(timeout=LIMIT)[1]
    except subprocess.TimeoutExpired:
        for process in marked(mark):
            process.kill()
        said = run.communicate()[1]
    deadline = time.monotonic() + STOP
    while (left := marked(mark)) and time.monotonic() < deadline:
        time.sleep(0.1)
    for process in left:
        process.kill()
    return said, len(left)


def interrupt(file: Path, results: Path, folder: int, delay: float) -> Interruption | None:
    """Run, and interrupt after a delay, s; None where the run came to its end before.

    Raises
    ------
    RuntimeError : the run failed without being interrupted.
    """
    mark, begun = uuid.uuid4().hex, time.monotonic()
    run = start(file, results, mark)
    try:
        run.wait(timeout=delay)
    except subprocess.TimeoutExpired:
        before, moment = kept(results), time.monotonic()
        os.killpg(run.pid, signal.SIGINT)
        said, left = ended(run, mark)
        # It may have come to its end just then, and says so by its code.
        told = run.returncode == 0 or (run.returncode == 130 and SENTENCE in said)
        told = told and "Traceback" not in said
        print(f"{moment - begun:.1f} s: code {run.returncode}, {said.strip()[-200:]}", flush=True)
        counts = (len(before[0]), sum(before[1].values()), lost(before, kept(results)))
        times = (moment - begun, time.monotonic() - moment)
        return Interruption(folder, *times, *counts, told, left)
    said, _ = ended(run, mark)
    if run.returncode != 0:
        raise RuntimeError(f"A run failed that nobody interrupted: {said}")
    return None


def undisturbed(file: Path, results: Path) -> tuple[dict[str, str], float]:
    """Digests of a run that nobody interrupts, and the seconds that it takes."""
    begun = time.monotonic()
    if interrupt(file, results, 0, 10.0 * LIMIT) is not None:
        raise RuntimeError("The undisturbed run took too long.")
    return digests(results), time.monotonic() - begun


def do_interruptions(number: int, seed: int) -> tuple[list[Interruption], list[int], int, float]:
    """Interruptions; datasets of each folder that are as they must be, how many there must be, and
    what the undisturbed run took, s."""
    chance = random.Random(seed)
    hits: list[Interruption] = []
    equal: list[int] = []
    with tempfile.TemporaryDirectory() as name:
        file = Path(name) / "printed.yaml"
        file.write_text(yaml.safe_dump(reduced(), sort_keys=False))
        wanted, seconds = undisturbed(file, Path(name) / "undisturbed")
        results, folder = Path(name) / "interrupted", 1
        while True:
            enough = len(hits) >= number
            delay = 10.0 * LIMIT if enough else chance.uniform(0.0, SHARE * seconds)
            hit = interrupt(file, results, folder, delay)
            if hit is not None:
                hits.append(hit)
                continue
            found = digests(results)
            if found.keys() - wanted.keys():
                raise RuntimeError(f"Datasets that nobody asked for: {found.keys() - wanted}")
            equal.append(sum(found.get(key) == value for key, value in wanted.items()))
            print(f"folder {folder}: {equal[-1]} of {len(wanted)} equal", flush=True)
            shutil.rmtree(results)
            folder += 1
            if enough:
                return hits, equal, len(wanted), seconds


def rows_of(
    hits: list[Interruption], equal: list[int], wanted: int, seconds: float, seed: int
) -> list[str]:
    """Tables."""
    head = ["folder", "moment, s", "datasets then", "samples kept then", "end, s later"]
    head += ["sentence and code", "left running", "lost"]
    rows = [
        [f"{hit.folder}", f"{hit.moment:.1f}", f"{hit.datasets}", f"{hit.samples}",
         f"{hit.lasted:.1f}", "yes" if hit.told else "no", f"{hit.left}", f"{hit.lost}"]
        for hit in hits
    ]  # fmt: skip
    text = (
        f"{len(hits)} interruptions with seed {seed}, of a run that takes {seconds:.0f} s "
        f"undisturbed: {sum(not hit.told for hit in hits)} without its sentence and code, "
        f"{sum(hit.left > 0 for hit in hits)} left processes, {sum(hit.lost for hit in hits)} "
        "datasets or samples lost. Content digests equal to those of the undisturbed run, by "
        f"folder: {', '.join(f'{n} of {wanted}' for n in equal)}."
    )
    return [*table(head, rows), text]


def main() -> None:
    """Interrupt, and write the page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--number", type=int, default=10, help="interruptions in all")
    parser.add_argument("--seed", type=int, default=20240730, help="of the random moments")
    parser.add_argument("--output", type=Path, help="write the page to this Markdown file too")
    arguments = parser.parse_args()
    # Of a command in the background, shells let Ctrl-C be ignored, also by what it starts.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    rows = rows_of(*do_interruptions(arguments.number, arguments.seed), arguments.seed)
    report([*heading("Interruptions of a run", __doc__ or ""), *rows], arguments.output)


if __name__ == "__main__":
    main()
