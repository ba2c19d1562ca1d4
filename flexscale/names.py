"""Names that become folders and files, out of files or given by users: one rule for all."""

from __future__ import annotations

import re

from flexscale.errors import SchemaError, shown

#: Letters that a name may have at most; four names and 80 more letters make the longest file name.
NAME_LENGTH = 100
#: One folder on every disk: no separator, no leading dot or dash, ASCII.
NAME_PATTERN = rf"[A-Za-z0-9][A-Za-z0-9._+-]{{0,{NAME_LENGTH - 1}}}"


def is_name(text: object) -> bool:
    """Whether `text` can be a folder or a part of a file name as it stands."""
    return isinstance(text, str) and re.fullmatch(NAME_PATTERN, text, re.ASCII) is not None


def require_name(text: object, what: str) -> str:
    """`text`, if it can be a folder as it stands.

    Parameters
    ----------
    what : of which it is the name, for the message.

    Raises
    ------
    SchemaError : it holds something else than letters, digits and a few signs, or too many.
    """
    if not is_name(text):
        raise SchemaError(
            f"The {what} is named {shown(text)}: use letters, digits, '.', '_', '+' and '-' only, "
            f"{NAME_LENGTH} at most and a letter or digit first, since it becomes a folder."
        )
    return str(text)
