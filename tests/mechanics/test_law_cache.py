"""Kernels that call a sheet law are found on disk by the next process."""

from __future__ import annotations

import os
import subprocess
import sys

CODE = """
import numpy as np
from flexscale.mechanics.linear_law import (linear_sheet)
law = linear_sheet(np.eye(3), np.eye(3))
states = np.ones((2, 6))
print(law.energies(states)[0], law.gradients(states)[0, 0], law.derivatives(states)[1][0, 0, 0])
"""


def test_a_second_process_compiles_nothing(tmp_path):
    """It leaves no file behind in the cache, as a law compiled into its caller would."""
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    files, said = [], []
    for _ in range(2):
        done = subprocess.run(
            [sys.executable, "-c", CODE],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        said.append(done.stdout)
        kept = [path for path in tmp_path.rglob("*.nbc") if "law" in path.name]
        files.append({path.name: path.stat().st_mtime_ns for path in kept})
    assert said[0] == said[1]
    assert len(files[0]) == 4
    assert files[1] == files[0]
