"""Kills of every process of a run at random moments: sentence, exit code, nothing left, resumption.

    python benchmarks/kills.py [--number 200] [--log FILE] [--output FILE]

A small experiment (squares on a very coarse mesh: cell, tangent, sweep in two processes, figure) is
run by `flexscale run`. As soon as a process of the role in turn is there (for the two that live as
long as the run: as one of a random role is), and a random time later, it is sent SIGKILL or
SIGTERM. The same command then goes on in the same folder, and may be killed again, until it comes
to its end; then the datasets must have the digests of an undisturbed run, and the next folder
follows. For every kill: the run must end within five minutes (else it counts as hung), with a
sentence and the exit code 4 (130 where `flexscale` itself was sent SIGTERM; 0 where the process had
done its work), without speaking of a bug; no process of it may be left fifteen seconds later; and
no dataset and no finished sample may be lost. With --log, kills are kept in a file of JSON lines,
and a second call goes on from there.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time
import uuid
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import psutil

import flexscale as fs

EXPERIMENT = """
patterns: {square: {family: IH76}}
native: shell
mesh: {along: 4, corner: 1, scale_size: 10, scale_layers: 1, scale_order: 1}
tangent: {}
sweep: {sides: [closing, opening], directions: [0, 45], curvatures: [0, 0.001, 0.002, 0.003]}
figures: [polar]
"""
MARK = "FLEXSCALE_KILLS"  # environment variable by which all processes of a run are known
ROLES = ("flexscale", "snakemake", "shell", "job", "worker", "drawing")
LONG_LIVED = ("flexscale", "snakemake")  # killed after any process of the run has come up
LIMIT, STOP, POLL = 300.0, 15.0, 0.01  # s


@dataclass(frozen=True)
class Kill:
    """One kill and what came of it; `moment` and `lasted` in s from start to kill to end."""

    role: str
    sign: str
    moment: float
    lasted: float
    code: int
    hung: bool
    told: bool
    left: int
    lost: int


def role_of(process: psutil.Process) -> str:
    """Role of a descendant of the run, "" for others, such as git."""
    try:
        words = process.cmdline()
    except psutil.Error:
        return ""
    line = " ".join(words)
    if "line_worker" in line:
        return "worker"
    if "flexscale.steps.watched" in words:
        return "snakemake"
    if "flexscale.steps" in line:
        if "-c" in words[:3]:
            return "shell"
        return "drawing" if any(word.startswith("figure-") for word in words) else "job"
    return "snakemake" if "snakemake" in words else ""


def members(root: psutil.Process) -> Iterator[tuple[str, psutil.Process]]:
    """Roles and processes of a run."""
    yield "flexscale", root
    try:
        family = root.children(recursive=True)
    except psutil.Error:
        return
    for process in family:
        yield role_of(process), process


def marked(mark: str) -> list[psutil.Process]:
    """All processes of a run that live, whoever their parent is now."""
    found = []
    for process in psutil.process_iter():
        try:
            zombie = process.status() == psutil.STATUS_ZOMBIE
            if not zombie and process.environ().get(MARK) == mark:
                found.append(process)
        except psutil.Error:
            continue
    return found


def kept(results: Path) -> tuple[set[str], int]:
    """Datasets, and the number of finished samples of sweeps that are not published yet."""
    datasets = {str(path.parent) for path in results.glob("local/*/*/*/*/record.json")}
    return datasets, len(list(results.glob("local/.staging/*/line-*/*.npz")))


def lost(before: tuple[set[str], int], after: tuple[set[str], int]) -> int:
    """Datasets and samples that are gone; published samples are in their dataset."""
    published = any("/sweep/" in path for path in after[0])
    return len(before[0] - after[0]) + (0 if published else max(before[1] - after[1], 0))


def start(file: Path, results: Path, mark: str) -> subprocess.Popen[str]:
    """`flexscale run`, in a session of its own."""
    command = [sys.executable, "-m", "flexscale.cli", "run", str(file), "--cores", "2"]
    return subprocess.Popen(
        [*command, "--results", str(results)],
        env=dict(os.environ) | {MARK: mark},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def find(role: str, run: subprocess.Popen[str]) -> psutil.Process | None:
    """A process of the role as soon as there is one; None when the run ends before."""
    root = psutil.Process(run.pid)
    deadline = time.monotonic() + LIMIT
    while run.poll() is None and time.monotonic() < deadline:
        for found, process in members(root):
            if found == role:
                return process
        time.sleep(POLL)
    return None


def told(role: str, sign: signal.Signals, code: int, said: str) -> bool:
    """Whether the exit code is the right one and comes with a sentence, not with a trace."""
    if "Traceback" in said or "this is a bug" in said:
        return False
    if code == 0:
        return True
    if role == "flexscale" and sign == signal.SIGKILL:
        return code == -signal.SIGKILL
    expected = 130 if role == "flexscale" else 4
    # SIGTERM may come before Python has set up anything.
    early = role == "flexscale" and code == -signal.SIGTERM
    return early or (code == expected and "flexscale: " in said)


def kill_one(
    file: Path,
    results: Path,
    role: str,
    sign: signal.Signals,
    delay: float,
    after: str = "flexscale",
) -> tuple[Kill | None, int, str]:
    """Run once and kill a process of a role, some time after one of another role was there.

    Returns
    -------
    The kill, None where the run ended first; its exit code, and what it said.
    """
    mark, begun = uuid.uuid4().hex, time.monotonic()
    run = start(file, results, mark)
    victim = find(role, run) if find(after, run) else None
    if victim is not None:
        time.sleep(delay)
    before, moment = kept(results), time.monotonic()
    alive = victim is not None and victim.is_running() and run.poll() is None
    if alive:
        try:
            victim.send_signal(sign)
        except psutil.NoSuchProcess:
            alive = False
    hung = False
    try:
        said = run.communicate(timeout=LIMIT)[1]
    except subprocess.TimeoutExpired:
        hung = True
        for process in marked(mark):
            process.kill()
        said = run.communicate()[1]
    ended = time.monotonic()
    while (left := marked(mark)) and time.monotonic() < ended + STOP:
        time.sleep(0.1)
    for process in left:
        process.kill()
    code = run.returncode
    if not alive:
        return None, code, said
    good = told(role, sign, code, said)
    facts = (round(moment - begun, 3), round(ended - moment, 3), code, hung, good)
    gone = lost(before, kept(results))
    return Kill(role, sign.name, *facts, len(left), gone), code, said


def digests(results: Path) -> dict[str, str]:
    """Dataset id -> content digest."""
    return {entry.id: entry.content_digest for entry in fs.open_registry(results)}


def undisturbed(file: Path, results: Path) -> dict[str, str]:
    """Digests of a run that nobody kills."""
    run = start(file, results, "undisturbed")
    said = run.communicate()[1]
    assert run.returncode == 0, said
    return digests(results)


def do_kills(number: int, log: Path) -> list[dict[str, object]]:
    """Lines of the log, made as far as they are missing: kills, and ends of folders."""
    lines = [json.loads(line) for line in log.read_text().splitlines()] if log.exists() else []
    counts = Counter(line["role"] for line in lines if "role" in line)
    chance = random.Random()
    with tempfile.TemporaryDirectory() as name:
        file = Path(name) / "kills.yaml"
        file.write_text(EXPERIMENT)
        wanted = undisturbed(file, Path(name) / "undisturbed")
        results = Path(name) / "results"
        while counts.total() < number:
            role = min(ROLES, key=lambda role: (counts[role], chance.random()))
            sign = chance.choice([signal.SIGKILL, signal.SIGTERM])
            delay = chance.uniform(0.0, chance.choice([0.1, 0.6, 4.0]))
            after = chance.choice(ROLES) if role in LONG_LIVED else role
            kill, code, said = kill_one(file, results, role, sign, delay, after)
            made: list[dict[str, object]] = []
            if kill is not None:
                counts[role] += 1
                made.append(asdict(kill))
                if kill.hung or not kill.told or kill.left or kill.lost:
                    made[0]["said"] = said[-2000:]
            elif code != 0:
                made.append({"unprovoked": code, "said": said[-2000:]})
            if code == 0:
                made.append({"equal": digests(results) == wanted})
                shutil.rmtree(results)
            lines += made
            with log.open("a") as kept_lines:
                kept_lines.writelines(json.dumps(line) + "\n" for line in made)
    return lines


def rows_of(lines: list[dict[str, object]], doc: str) -> list[str]:
    """The page."""
    from report import heading, table

    kills = [Kill(**{k: v for k, v in line.items() if k != "said"}) for line in lines
             if "role" in line]  # fmt: skip
    ends = [line for line in lines if "equal" in line]
    unprovoked = sum("unprovoked" in line for line in lines)
    rows = []
    for role in ROLES:
        mine = [kill for kill in kills if kill.role == role]
        if not mine:
            continue
        codes = ", ".join(f"{c}: {n}" for c, n in sorted(Counter(k.code for k in mine).items()))
        times = [kill.lasted for kill in mine]
        moments = [kill.moment for kill in mine]
        rows.append([
            role, str(len(mine)), str(sum(k.sign == "SIGKILL" for k in mine)),
            f"{min(moments):.1f} to {max(moments):.1f}", codes,
            f"{statistics.median(times):.1f}", f"{max(times):.1f}",
            str(sum(k.hung for k in mine)), str(sum(not k.told for k in mine)),
            str(sum(k.left > 0 for k in mine)), str(sum(k.lost > 0 for k in mine)),
        ])  # fmt: skip
    head = ["role", "kills", "SIGKILL", "moment / s", "exit codes", "end / s", "longest / s"]
    head += ["hung", "untold", "left running", "losses"]
    equal = sum(bool(end["equal"]) for end in ends)
    text = (
        f"{len(kills)} kills: {sum(k.hung for k in kills)} hung, "
        f"{sum(not k.told for k in kills)} without the right sentence and code, "
        f"{sum(k.left > 0 for k in kills)} left processes, {sum(k.lost > 0 for k in kills)} lost "
        f"work. Of {len(ends)} folders brought to an end after them, {equal} have the digests of "
        f"an undisturbed run. Runs that failed without a kill: {unprovoked}."
    )
    return [*heading("Kills of every process of a run", doc), *table(head, rows), text]


def main() -> None:
    """Kill, and write the page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--number", type=int, default=200, help="kills in all")
    parser.add_argument("--log", type=Path, help="file that keeps the kills done so far")
    parser.add_argument("--output", type=Path, help="write the page to this Markdown file too")
    arguments = parser.parse_args()
    from report import report

    with tempfile.TemporaryDirectory() as name:
        log = arguments.log or Path(name) / "kills.jsonl"
        report(rows_of(do_kills(arguments.number, log), __doc__ or ""), arguments.output)


if __name__ == "__main__":
    main()
