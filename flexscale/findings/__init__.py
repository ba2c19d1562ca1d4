"""What the paper's Sec. 4.2 says of scaled sheets, checked on stored datasets.

A side tower like `datasets` and `plotting`: nothing is solved here.
"""

from flexscale.findings.table import FINDINGS, all_findings
from flexscale.findings.verdict import Evidence, Finding

__all__ = ["FINDINGS", "Evidence", "Finding", "all_findings"]
