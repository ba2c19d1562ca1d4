"""Text on its way to the terminal: what came out of files must not steer it."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, TextIO

#: Control characters (C0 but tab and newline, DEL, C1), and those that turn the reading direction.
_STEERING = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028\u2029\u202a-\u202e\u2066-\u2069]"
)


def printable(text: str) -> str:
    """`text` with what would steer a terminal written out, as in ``\\x1b``."""
    return _STEERING.sub(lambda found: ascii(found[0])[1:-1], text)


class _PrintableStream:
    """A text stream that passes on printable text only; everything else is the stream's own."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        return self._stream.write(printable(text))

    def writelines(self, lines: Any) -> None:
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


@contextmanager
def printable_streams() -> Iterator[None]:
    """Keep standard output and error printable; what draws on a terminal gets hold of
    `terminal_stream`."""
    before = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = (_PrintableStream(stream) for stream in before)
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before


def terminal_stream() -> TextIO:
    """Standard error itself, for a progress bar, whose text must be printable by itself."""
    stream = sys.stderr
    return stream._stream if isinstance(stream, _PrintableStream) else stream
