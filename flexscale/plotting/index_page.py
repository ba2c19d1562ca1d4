"""One static page: all drawn figures with captions and dataset ids, and findings with verdicts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from flexscale.plotting.figures import FigureReport
from flexscale.plotting.saving import write_text

_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>FlexScale figures</title>
<style>
body {{ font: 15px/1.45 sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em }}
figure {{ margin: 2em 0; border-top: 1px solid #ccc; padding-top: 1em }}
img {{ max-width: 100% }} code {{ font-size: 90% }} .missing {{ color: #b2182b }}
nav {{ display: flex; flex-wrap: wrap; gap: 1em }} nav a {{ width: 9em; text-align: center }}
nav img {{ height: 6em; max-width: 9em; object-fit: contain; display: block; margin: auto }}
.sides {{ display: grid; grid-template-columns: 1fr 1fr; gap: 1.5em }}
table {{ border-collapse: collapse }} .agrees {{ color: #1b7837 }} summary {{ cursor: pointer }}
td, th {{ border-top: 1px solid #ccc; padding: .4em .8em .4em 0 }}
td, th {{ text-align: left; vertical-align: top }}
</style></head><body>
<h1>FlexScale figures</h1>
<p>Drawn from stored datasets; every figure names the ones it shows.</p>
<nav>
{thumbnails}
</nav>
{figures}
{findings}
<h2 id="not-reproduced">Not reproduced</h2>
<p>What the paper photographed or measured on prints; its measurements are not public.</p>
<ul>
{absent}
</ul>
</body></html>"""

#: What no dataset of ours can show.
NOT_REPRODUCED = (
    "Fig. 1a: photographs of printed sheets bent to both sides; the simulated cells stand in.",
    "Fig. 5: photographs of prints, grooves and infill (see flexscale fabricate).",
    "Fig. 6: photographs of the mandrel, and the force measured on a solid disc.",
    "Fig. 9: forces measured on printed discs; the simulated ones stand in.",
    "Figs. 10a, 10b, 11a, 11b: photographs of the linear stage, and forces measured on it.",
)


_FINDINGS = """<h2 id="findings">Findings</h2>
<p>What the paper says in its Sec. 4.2, held against the datasets of all named patterns.</p>
<table>
<tr><th>verdict</th><th>the paper says</th><th>asked, and what the patterns show</th></tr>
{rows}
</table>"""


def write_index(
    reports: Sequence[FigureReport], out: Path, findings: Sequence[Mapping[str, Any]] = ()
) -> Path:
    """Write `index.html` beside the figures.

    Parameters
    ----------
    reports : one per figure, in the order shown; a missing one is listed with its message.
    out : folder that holds the figures.
    findings : as `flexscale.findings.Finding.to_dict` gives them; without any there is no table.
    """
    out.mkdir(parents=True, exist_ok=True)
    path = out / "index.html"
    text = _PAGE.format(
        thumbnails="\n".join(_thumbnail(report) for report in reports),
        figures="\n".join(_entry(report) for report in reports),
        findings=_FINDINGS.format(rows="\n".join(map(_row, findings))) if findings else "",
        absent="\n".join(f"<li>{escape(item)}</li>" for item in NOT_REPRODUCED),
    )
    write_text(path, text)
    return path


def _row(finding: Mapping[str, Any]) -> str:
    verdict = escape(finding["verdict"])
    look = "agrees" if verdict == "agrees" else "missing"
    kind = "of all" if finding["of_all"] else "of at least one"
    why = f"<p><b>Why:</b> {escape(finding['why'])}</p>" if finding["why"] else ""
    shown = "".join(
        f"<li>{'yes' if fact['holds'] else 'no'} · {escape(fact['pattern'])}: "
        f"{escape(fact['numbers'])}</li>"
        for fact in finding["evidence"]
    )
    return (
        f'<tr><td class="{look}"><b>{verdict}</b></td><td>{escape(finding["paper_says"])}{why}</td>'
        f"<td>{kind}: {escape(finding['criterion'])}"
        f"<details><summary>{escape(finding['count'])} patterns</summary><ul>{shown}</ul></details>"
        "</td></tr>"
    )


def _thumbnail(report: FigureReport) -> str:
    stem = escape(report.stem)
    picture = f'<img src="{escape(report.paths["png"].name)}" alt="">' if report.paths else ""
    return f'<a href="#{stem}">{picture}{stem}</a>'


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
    found = "".join(f"<li>{escape(sentence)}</li>" for sentence in report.we_find)
    return (
        f'<figure id="{stem}"><a href="{picture}"><img src="{picture}" alt="{caption}"></a>'
        f"<figcaption><b>{stem}</b> {caption}<br>from {ids} · {links}"
        f'<div class="sides"><div><b>The paper says</b><p>{escape(report.paper_says)}</p></div>'
        f"<div><b>We find</b><ul>{found}</ul></div></div></figcaption></figure>"
    )
