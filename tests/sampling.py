"""Some values of a long list for the fast suite, the others for `make test-slow`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest


def every(step: int, values: Iterable[Any]) -> list[Any]:
    """All values for `parametrize`; only every `step`-th is not slow."""
    return [
        value if k % step == 0 else pytest.param(value, marks=pytest.mark.slow)
        for k, value in enumerate(values)
    ]
