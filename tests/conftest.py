"""Settings of every test, and where tests find the datasets that come with the code."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from flexscale.processes import single_threaded

single_threaded(os.environ)  # one thread per process, as in jobs; before any imports numpy


@pytest.fixture(scope="session")
def shipped_results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results folder with the shipped datasets alone, whatever else the checkout's has."""
    from tests.shipped import link_shipped

    return link_shipped(tmp_path_factory.mktemp("shipped") / "results")


@pytest.fixture(scope="session")
def crowded_results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results folder with the shipped datasets, and a user's own of the same patterns."""
    from tests.shipped import add_twins, link_shipped

    results = link_shipped(tmp_path_factory.mktemp("crowded") / "results")
    add_twins(results)
    return results
