"""What blocks on sheets of a macro model share."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from flexscale.errors import BadInputError
from flexscale.mesh.sheet import rectangle_triangles, require_moderate_triangles


@contextmanager
def named(place: str) -> Iterator[None]:
    """Names the place in the file where a check of the simulation refuses a value."""
    try:
        yield
    except BadInputError as error:
        raise type(error)(f"{place}: {error}") from error


def refuse_many_triangles(place: str, length: float, width: float, size: float) -> None:
    """Refuse a sheet [mm] of very many triangles."""
    with named(place):
        require_moderate_triangles(rectangle_triangles(length, width, size), size)
