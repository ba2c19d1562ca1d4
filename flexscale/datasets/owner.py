"""Which process on which machine something belongs to, and whether it is provably gone."""

from __future__ import annotations

import hashlib
import os
import re
from dataclasses import dataclass
from pathlib import Path

_TOKEN = re.compile(r"(\d{1,10})-(\d{1,20})-([0-9a-f]{12})-([A-Za-z0-9._-]{1,64})")


@dataclass(frozen=True)
class Owner:
    """A process.

    Attributes
    ----------
    pid : its number.
    started : when it started, in clock ticks since its machine did; 0 where that is not known.
    place : digest of the machine's name, of its present start, and of what processes are seen
        there; only from an equal place can an owner be known to be gone.
    host : the machine's name.
    """

    pid: int
    started: int
    place: str
    host: str

    @classmethod
    def of_this_process(cls) -> Owner:
        """This very process."""
        host = re.sub(r"[^A-Za-z0-9._-]", "_", os.uname().nodename)[:64] or "unnamed"
        return cls(os.getpid(), _start_time(os.getpid()) or 0, _place(), host)

    @classmethod
    def parse(cls, token: str) -> Owner | None:
        """Owner of a token, None where it is none."""
        found = _TOKEN.fullmatch(token)
        return cls(int(found[1]), int(found[2]), found[3], found[4]) if found else None

    @property
    def token(self) -> str:
        """Text that is part of a file's name."""
        return f"{self.pid}-{self.started}-{self.place}-{self.host}"

    def __str__(self) -> str:
        return f"process {self.pid} on {self.host}"

    @property
    def is_gone(self) -> bool:
        """Whether it has provably ended; never true of another machine's processes."""
        if self.place != _place():
            return False
        try:
            os.kill(self.pid, 0)
        except ProcessLookupError:
            return True
        except OSError:  # it is somebody else's
            pass
        # Numbers of processes are used again; some systems hide when those of others started.
        now = _start_time(self.pid)
        return now is not None and self.started not in (now, 0)


def _place() -> str:
    """What makes equal process numbers mean the same process, as a digest."""
    facts = [os.uname().nodename]
    try:
        facts.append(Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii"))
        facts.append(os.readlink("/proc/self/ns/pid"))
    except OSError:  # not Linux
        facts.append("")
    return hashlib.sha256("\n".join(facts).encode(errors="replace")).hexdigest()[:12]


def _start_time(pid: int) -> int | None:
    """Clock ticks from the machine's start to the process's; None where /proc does not tell.

    -1 for a process that has ended and whose parent does not look.
    """
    try:
        text = Path(f"/proc/{pid}/stat").read_text(encoding="ascii", errors="replace")
    except OSError:
        return None
    fields = text.rpartition(")")[2].split()  # the name, in parentheses, may hold anything
    return -1 if fields[0] in "ZX" else int(fields[19])
