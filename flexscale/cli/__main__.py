"""``python -m flexscale.cli`` is ``flexscale``."""

from __future__ import annotations

from flexscale.cli.main import main

if __name__ == "__main__":
    main()
