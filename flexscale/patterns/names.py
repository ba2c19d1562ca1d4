"""What a pattern may be called: in Python and in experiment files alike.

A name becomes part of paths (kind/family/pattern/digest), of the names of figures and jobs, and of
tables; so it must be a plain part of a path on every file system.
"""

from __future__ import annotations

import re
import unicodedata
from typing import Any

from flexscale.errors import PatternError, shown

#: Bytes of a name: file systems hold 255, of which kinds, digests and endings take up to 100.
LONGEST = 120
_PLAIN = re.compile(r"\w(?:[\w.+-]*[\w+-])?")


def pattern_name(value: Any, label: str = "name") -> str:
    """A pattern's name, its accents composed (Unicode NFC), checked.

    Raises
    ------
    PatternError : no text of letters (of any alphabet), digits, "-", "_", "+" and "." that begins
        with a letter or digit and does not end with ".", or too long a one.
    """
    name = unicodedata.normalize("NFC", value) if isinstance(value, str) else ""
    if not _PLAIN.fullmatch(name) or name.startswith("_"):
        raise PatternError(
            f"The pattern name {shown(value)} names files: use letters, digits, -, _, + and . "
            "only, a letter or digit first, and no . at the end."
        )
    if len(name.encode()) > LONGEST:
        raise PatternError(
            f"The pattern name {shown(value)} has {len(name.encode())} bytes, but names files: "
            f"give at most {LONGEST}."
        )
    return name


def same_name(first: str, second: str) -> bool:
    """Whether two names are one on file systems that do not tell cases apart."""
    return pattern_name(first).casefold() == pattern_name(second).casefold()
