"""Shape parameters and edge curves as text on the command line."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.errors import ConfigError
from flexscale.tilings.curves import CURVE_TOLERANCE


def read_parameters(text: str | None) -> list[float] | None:
    """Numbers separated by commas or spaces; None if not given."""
    if text is None:
        return None
    values = []
    for word in re.split(r"[,\s]+", text.strip(" ,")):
        try:
            values.append(float(word))
        except ValueError:
            raise ConfigError(
                f"--parameters takes numbers, such as 0.1,-0.2, and {word!r} is none."
            ) from None
    return values


def read_edges(texts: Sequence[str], kinds: dict[str, str]) -> dict[str, FloatArray]:
    """Curves (n, 2) by class letter, with the ends that were left out.

    Parameters
    ----------
    texts : "CLASS=X:Y,X:Y,…" or "CLASS=FILE".
    kinds : class letter -> kind, of the family.

    Raises
    ------
    ConfigError : text of another form, a class given twice, or a file that cannot be read.
    """
    curves: dict[str, FloatArray] = {}
    for text in texts:
        letter, equals, given = (part.strip() for part in text.partition("="))
        if not (letter and equals and given):
            raise ConfigError(
                f"--edge {text!r} gives no curve: write CLASS=X:Y,X:Y,… or CLASS=FILE.csv."
            )
        if letter in curves:
            raise ConfigError(f"--edge gives edge class {letter!r} twice: give it once.")
        points = _read_points(given, text) if ":" in given else _read_file(Path(given))
        curves[letter] = with_ends(points, kinds.get(letter, "J"))
    return curves


def with_ends(points: FloatArray, kind: str) -> FloatArray:
    """Points (n, 2) with the start (0, 0), and the end that they lead to, if these are missing.

    On S and U edges points whose last one has x at most 0.5 are the first half: straight on to
    the middle of an S edge, and straight across to the mirror image on a U edge.
    """
    ends_at_half = kind in ("S", "U") and points[-1, 0] <= 0.5 + CURVE_TOLERANCE
    end = np.array([1.0, 0.0])
    if ends_at_half:
        end = np.array([0.5, points[-1, 1] if kind == "U" else 0.0])
    start = np.zeros(2)
    parts = [points]
    if not _is_at(points[0], start):
        parts.insert(0, start[None])
    if not _is_at(points[-1], end):
        parts.append(end[None])
    return np.concatenate(parts)


def _is_at(point: FloatArray, place: FloatArray) -> bool:
    return bool(np.abs(point - place).max() <= CURVE_TOLERANCE)


def _read_points(given: str, text: str) -> FloatArray:
    rows = []
    for word in re.split(r"[,\s]+", given.strip(" ,")):
        try:
            x, y = word.split(":")
            rows.append((float(x), float(y)))
        except ValueError:
            raise ConfigError(
                f"--edge {text!r}: {word!r} is no point; write X:Y, such as 0.3:0.1."
            ) from None
    return np.array(rows)


def _read_file(path: Path) -> FloatArray:
    """Rows x,y of a file; lines that start with #, and a first line of names, do not count."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(
            f"The curve {path} cannot be read ({error}): name a file with one point x,y a line, "
            "or write points as X:Y,X:Y,…"
        ) from None
    numbered = [(n, line) for n, line in enumerate(lines, 1) if line.strip()]
    numbered = [(n, line) for n, line in numbered if not line.lstrip().startswith("#")]
    points = []
    for row, (number, line) in enumerate(numbered):
        words = next(csv.reader([line])) if "," in line else line.split()
        try:
            x, y = (float(word) for word in words)
        except ValueError:
            if row == 0:
                continue
            raise ConfigError(
                f"Line {number} of {path} is no point x,y: {line.strip()!r}."
            ) from None
        points.append((x, y))
    if not points:
        raise ConfigError(f"The file {path} has no points: write one point x,y a line.")
    return np.array(points)
