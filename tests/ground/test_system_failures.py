"""What the machine refuses is told apart from bugs whose text only speaks of it."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.system_failures import explain, explain_words

NO_MEMORY, FULL = "There is not enough memory", "The disk is full"


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (MemoryError(), NO_MEMORY),
        (np._core._exceptions._ArrayMemoryError((10**9,), np.dtype(float)), NO_MEMORY),
        (RuntimeError("std::bad_alloc"), NO_MEMORY),
        (ImportError("libgmsh.so: failed to map segment from shared object"), NO_MEMORY),
        (OSError("Unable to write (No space left on device)"), FULL),
        (RuntimeError("cannot cache function: no locator available for file 'a'"), "NUMBA_CACHE"),
        (OSError(13, "Permission denied", "a.nc"), "a.nc: Permission denied; choose a folder"),
    ],
)
def test_what_the_machine_refuses(error: Exception, words: str) -> None:
    assert words in str(explain(error))
    if not isinstance(error, OSError) or error.errno is None:
        said = f"Traceback:\n{type(error).__name__}: {error}\nEnd"
        assert words in str(explain_words(said))


@pytest.mark.parametrize(
    "error",
    [
        ValueError("pattern named 'MemoryError' bad"),
        RuntimeError("pattern named 'MemoryError' bad"),
        KeyError("out of memory"),
        FileNotFoundError(2, "No such file or directory", "out of memory.yaml"),
    ],
)
def test_what_only_speaks_of_it(error: Exception) -> None:
    assert explain(error) is None
    said = f'Traceback:\n    raise ValueError("MemoryError")\n{type(error).__name__}: {error}\nEnd'
    assert explain_words(said) is None
