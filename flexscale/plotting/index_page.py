"""One static page that shows all drawn figures with captions and dataset ids."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path

from flexscale.plotting.figures import FigureReport
from flexscale.plotting.saving import write_text

_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>FlexScale figures</title>
<style>
body {{ font: 15px/1.45 sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em }}
figure {{ margin: 2em 0; border-top: 1px solid #ccc; padding-top: 1em }}
img {{ max-width: 100% }} code {{ font-size: 90% }} .missing {{ color: #b2182b }}
</style></head><body>
<h1>FlexScale figures</h1>
<p>Drawn from stored datasets; every figure names the ones it shows. Photographs and measurements
of the paper are not reproduced.</p>
{figures}
</body></html>"""


def write_index(reports: Sequence[FigureReport], out: Path) -> Path:
    """Write `index.html` beside the figures.

    Parameters
    ----------
    reports : one per figure, in the order shown; a missing one is listed with its message.
    out : folder that holds the figures.
    """
    out.mkdir(parents=True, exist_ok=True)
    path = out / "index.html"
    write_text(path, _PAGE.format(figures="\n".join(_entry(report) for report in reports)))
    return path


def _entry(report: FigureReport) -> str:
    stem, caption = escape(report.stem), escape(report.caption)
    if not report.paths:
        message = escape(report.message)
        return (
            f'<figure id="{stem}"><figcaption><b>{stem}</b> {caption}'
            f'<p class="missing">{message}</p></figcaption></figure>'
        )
    ids = ", ".join(f"<code>{escape(source)}</code>" for source in report.sources)
    links = " ".join(
        f'<a href="{escape(file.name)}">{ending}</a>' for ending, file in report.paths.items()
    )
    picture = escape(report.paths["png"].name)
    return (
        f'<figure id="{stem}"><a href="{picture}"><img src="{picture}" alt="{caption}"></a>'
        f"<figcaption><b>{stem}</b> {caption}<br>from {ids} · {links}</figcaption></figure>"
    )
