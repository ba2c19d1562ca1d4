"""Settings of every test: one thread per process, as in job processes."""

from __future__ import annotations

import os

from flexscale.steps.environment import single_threaded

single_threaded(os.environ)  # before any test module imports numpy
