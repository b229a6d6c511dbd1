# SPDX-License-Identifier: BSD-3-Clause
"""What notebooks show: atlases, maps, reports and stores as HTML, and the viewer.

What files call things is text in it, never markup. Nothing but the viewer, which is in a frame of its own, runs
scripts. Colours are those of the notebook, and plans have paper of their own, so that light and dark themes show both.
"""

import base64
import html
import json
import os
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

from . import _slamdb
from ._slamdb import Atlas, Map
from .calls import Source, several
from .errors import Error
from .files import Box, Path, Progress, Range, told
from .report import Report
from .words import spelled

if TYPE_CHECKING:
    from .store import Store

_MOST_ROWS = 30  # of a table
_MOST_WORDS = 12  # of a list in a cell
_PLAN_WIDTH = 400  # pixels
_MAY = "allow-scripts allow-downloads"  # of pictures; reach nothing of the notebook
# Jupyter lets three seconds' worth of its usual limit through at once, 3 MB.
MOST_EMBEDDED = 2_500_000


def _text(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return f"{value:,}"
    if isinstance(value, float):
        return f"{value:.4g}"
    return html.escape(str(value))


def _cell(value: Any) -> str:
    if isinstance(value, Mapping):
        return _pairs(value)
    if isinstance(value, list) and value and all(isinstance(item, Mapping) for item in value):
        return _rows(value)
    if isinstance(value, list):
        more = f", and {len(value) - _MOST_WORDS:,} more" if len(value) > _MOST_WORDS else ""
        return ", ".join(_cell(item) for item in value[:_MOST_WORDS]) + more
    return _text(value)


def _pairs(values: Mapping[str, Any]) -> str:
    """A table of names and what they are; within cells, too."""
    rows = (f"<tr><th>{_text(name)}</th><td>{_cell(value)}</td></tr>" for name, value in values.items())
    return f"<table><tbody>{''.join(rows)}</tbody></table>"


def _rows(rows: Sequence[Mapping[str, Any]]) -> str:
    """A table with a column for each name."""
    names = list(dict.fromkeys(name for row in rows[:_MOST_ROWS] for name in row))
    head = "".join(f"<th>{_text(name.replace('_', ' '))}</th>" for name in names)
    body = "".join(
        "<tr>" + "".join(f"<td>{_cell(row.get(name))}</td>" for name in names) + "</tr>" for row in rows[:_MOST_ROWS]
    )
    more = f"<div>and {len(rows) - _MOST_ROWS:,} more</div>" if len(rows) > _MOST_ROWS else ""
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{more}"


def _under(title: str, *parts: str) -> str:
    return f"<div><strong>{html.escape(title)}</strong>{''.join(parts)}</div>"


def _plan(atlas: Atlas) -> str:
    """Its plan as a picture, in which nothing can run."""
    svg = _slamdb.plan(atlas, _PLAN_WIDTH)
    if svg is None:
        return "<div>without a plan: slamdb was built without Cairo (libcairo2-dev)</div>"
    data = base64.b64encode(svg.encode()).decode()
    style = f"max-width:100%;width:{_PLAN_WIDTH}px"
    return f'<div><img alt="plan" style="{style}" src="data:image/svg+xml;base64,{data}"></div>'


def _statistics(atlas: Atlas) -> str:
    shown = []
    for row in _slamdb.statistics(atlas):
        length, unit = row.pop("trajectory_length"), row.pop("unit")
        duration = row.pop("duration_s")
        shown.append({**row, "length": f"{length:.4g} {unit}", "duration": f"{duration:.3g} s"})
    return _rows(shown)


def html_of_atlas(atlas: Atlas) -> str:
    return _under(repr(atlas).strip("<>").split(";")[0], _statistics(atlas), _plan(atlas))


def html_of_map(map: Map) -> str:
    alone = _slamdb.alone(map)
    return _under(repr(map).strip("<>").split(":")[0], _statistics(alone), _plan(alone))


def html_of_report(report: "Report") -> str:
    values = report.to_dict()
    return _under(str(values.pop("report", "report")), _pairs(values))


def _finding(result: Mapping[str, Any]) -> Dict[str, Any]:
    first = result["findings"][0] if result["findings"] else {"where": "", "message": ""}
    told = {each: result[each] for each in ("severity", "rule", "count", "title")}
    return {**told, "first": f"{first['where']}: {first['message']}".strip(": ")}


def html_of_check(report: "Report") -> str:
    parts = []
    for checked in report["inputs"]:
        name = checked["input"]
        if "failure" in checked:
            parts.append(_under(f"{name}: not readable", f"<div>{_text(checked['failure'])}</div>"))
            continue
        counts = ", ".join(f"{severity}s {count:,}" for severity, count in checked["severities"].items())
        verdict = "sound" if checked["sound"] else "not sound"
        parts.append(_under(f"{name}: {verdict}" if name else verdict, f"<div>{counts}</div>"))
        found = [_finding(result) for result in checked["results"]]
        parts.append(_rows(found) if found else "")
    return f"<div>{''.join(parts)}</div>"


_OF_LIST = ("name", "maps", "sensors", "keyframes", "points", "trajectory_length", "duration_s", "bytes", "revision")


def html_of_store(store: "Store") -> Optional[str]:
    """None, where nothing can be told: then notebooks show the text alone."""
    if store.closed:
        return None
    try:
        if not store._file.is_made():
            return None
        atlases = store.list()["atlases"]
    except Error:
        return None
    rows = [{each: atlas.get(each) for each in (*_OF_LIST, "failure") if each in atlas} for atlas in atlases]
    return _under(f"slamdb.Store {store.path}", _rows(rows))


class View:
    """A page that shows maps in three dimensions; a notebook shows it in a frame that can reach nothing outside.

    `html`: the page; `left_out`: a sentence for each thing of the atlases that is not in it.
    """

    def __init__(self, page: str, left_out: List[str], height: int = 480) -> None:
        self.html = page
        self.left_out = left_out
        self.height = height

    def __repr__(self) -> str:
        return "<slamdb.View: shown by notebooks>"

    def _repr_html_(self) -> str:
        if len(self.html) > MOST_EMBEDDED:
            return (
                f"<div>The page takes {len(self.html):,} bytes; a notebook shows {MOST_EMBEDDED:,}: "
                "<code>slamdb.view(atlas, 'map.html')</code> writes it, and parts of atlases take less.</div>"
            )
        style = f"width:100%;height:{self.height}px;border:0"
        frame = f'<iframe sandbox="{_MAY}" style="{style}" srcdoc="{html.escape(self.html)}"></iframe>'
        return frame + "".join(f"<div>not in the page: {_text(sentence)}</div>" for sentence in self.left_out)


def view(
    sources: Union[Source, Sequence[Source]],
    output: Optional[Path] = None,
    *,
    overwrite: bool = False,
    format: str = "",
    layout: Optional[Path] = None,
    map: Optional[int] = None,
    keyframes: Optional[Tuple[int, int]] = None,
    time: Range = None,
    box: Box = None,
    title: str = "",
    keypoints: str = "auto",
    side_by_side: bool = False,
    normals: bool = False,
    check: bool = True,
    findings: Union[Path, Report, None] = None,
    diff: bool = False,
    height: int = 480,
    wait: float = 5,
    threads: int = 0,
    progress: Progress = None,
) -> View:
    """Show an atlas, or several, in a notebook; with `output` write the page of `slamdb view`, one file, to it.

    sources: an atlas or the path of one, or a sequence of them
    output: an .html; overwrite: replace it if it is there
    format, layout, map, keyframes, time, box: of sources that are paths, as `read` takes them
    title: of the page; by default what the atlases are called
    keypoints: "auto" (as there is room for), "all", "matched" (those that see a point), "none"
    side_by_side: several atlases beside each other, not over each other
    normals: with the normals of points
    check: with what `slamdb.check` finds, in place; of parts nothing is
    findings: of one atlas, what this report found, instead: of `slamdb.check`, or the conflicts of `slamdb.merge` with
        base; also the path of one in JSON
    diff: of two atlases, what the second changed
    height: of the frame in the notebook, pixels
    wait: seconds, for another program that writes to the store

    A notebook shows pages of up to 2.5 MB, which is what Jupyter lets through; keypoints that do not fit are left out.
    Raises UnsupportedError where slamdb was built without the page, saying what to install.
    """
    given: Dict[str, object] = dict(locals())
    given.pop("height")
    if isinstance(findings, Report):
        given.update(findings=None, report=json.dumps(findings.to_dict()))
    given.update(sources=several(sources), embedded=MOST_EMBEDDED if output is None else None)
    page, left_out, notices = _slamdb.view_page(given)
    told(notices)
    return View(page, [spelled(sentence) for sentence in left_out], height)
