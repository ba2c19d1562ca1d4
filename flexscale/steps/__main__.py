"""``python -m flexscale.steps EXPERIMENT JOB …``: one job in a process of its own."""

from __future__ import annotations

import os
import sys

from flexscale.processes import single_threaded
from flexscale.steps.watched import watch_run

if __name__ == "__main__":
    single_threaded(os.environ)
    watch_run()
    from flexscale.steps.worker import main  # imports numpy, so only now

    sys.exit(main(sys.argv[1:]))
