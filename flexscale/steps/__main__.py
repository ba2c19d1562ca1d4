"""``python -m flexscale.steps EXPERIMENT JOB …``: one job in a process of its own."""

from __future__ import annotations

import os
import sys

from flexscale.processes import single_threaded

if __name__ == "__main__":
    single_threaded(os.environ)
    from flexscale.steps.worker import main  # imports numpy, so only now

    sys.exit(main(sys.argv[1:]))
