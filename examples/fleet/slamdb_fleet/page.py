# SPDX-License-Identifier: BSD-3-Clause
"""The page about a fleet: one file of HTML without script. Names and texts of files are text in it, never markup."""

import base64
import collections
import html
import pathlib
import urllib.parse
from typing import Any, Iterable, Iterator, List, NamedTuple, Sequence

import numpy as np
import slamdb

from .summary import readable
from .work import Row

MOST_ROWS = 200  # of each table; summary.csv has all


class Measure(NamedTuple):
    name: str  # of the column
    title: str
    unit: str = ""


MEASURES = (
    Measure("keyframes", "keyframes"),
    Measure("points", "points"),
    Measure("trajectory_length", "length of the trajectory", "m, or units of the map"),
    Measure("duration_s", "duration", "s"),
    Measure("observers_per_point", "observers of a point"),
    Measure("reprojection_error_px", "reprojection error", "px"),
    Measure("bytes", "size", "bytes"),
)

STYLE = """
:root { color-scheme: light dark; --faint: #777; --bar: #4a7fb5; --bad: #c0392b; }
body { font: 15px/1.5 system-ui, sans-serif; max-width: 70em; margin: 2em auto; padding: 0 1em; }
h1 { font-size: 1.6em; } h2 { font-size: 1.2em; margin-top: 2em; }
table { border-collapse: collapse; } th, td { padding: .2em .8em .2em 0; text-align: left; vertical-align: top; }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; }
td.text { overflow-wrap: anywhere; } td.text:first-child { min-width: 12em; } tr + tr td { border-top: 1px solid #8883; }
.counts { display: flex; flex-wrap: wrap; gap: 2em; } .counts b { display: block; font-size: 1.6em; }
.bad { color: var(--bad); } .faint { color: var(--faint); }
.plots { display: flex; flex-wrap: wrap; gap: 1.5em; margin-top: 1.5em; } figure { margin: 0; width: 240px; } svg { display: block; }
rect { fill: var(--bar); } text { font-size: 11px; fill: currentColor; }
"""


class Link(NamedTuple):
    """An atlas in a table: its name, which leads to its page, and its thumbnail, where it has them."""

    row: Row
    folder: pathlib.Path

    def html(self) -> str:
        if "page" not in self.row:
            return text(self.row["input"])
        picture = base64.b64encode((self.folder / self.row["thumbnail"]).read_bytes()).decode()
        image = f'<img alt="" width="120" height="75" src="data:image/png;base64,{picture}"><br>' if picture else ""
        return f'<a href="{text(urllib.parse.quote(self.row["page"]))}">{image}{text(self.row["input"])}</a>'


def write_page(folder: pathlib.Path, rows: Sequence[Row], title: str) -> None:
    """index.html of a folder of outputs."""
    read = [row for row in rows if "failure" not in row]
    parts = [
        _head(title), _counts(rows), _rules(read), _failures(rows), _unsound(read, folder), _distributions(read),
        _outliers(read, folder), _twins(read), "</main>\n</body>\n</html>\n",
    ]  # fmt: skip
    slamdb.write_file(folder / "index.html", "".join(parts).encode(), overwrite=True)


def text(value: Any) -> str:
    return html.escape(readable(str(value)))


def number(value: Any) -> str:
    if value is None:
        return ""
    return f"{value:,}" if isinstance(value, int) else f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.4g}"


def table(heads: Sequence[str], rows: Iterable[Sequence[Any]], total: int) -> str:
    """Numbers to the right; texts escaped."""
    parts = ["<table><tr>", *(f"<th>{text(head)}</th>" for head in heads), "</tr>\n"]
    for row in rows:
        parts.append("<tr>")
        for value in row:
            if isinstance(value, (int, float)):
                parts.append(f'<td class="number">{number(value)}</td>')
            else:
                shown = value.html() if isinstance(value, Link) else text(value)
                parts.append(f'<td class="text">{shown}</td>')
        parts.append("</tr>\n")
    parts.append("</table>\n")
    if total > MOST_ROWS:
        parts.append(f'<p class="faint">the first {MOST_ROWS} of {total:,}; <a href="summary.csv">all</a></p>\n')
    return "".join(parts)


def _head(title: str) -> str:
    policy = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{text(title)}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<main>\n<h1>{text(title)}</h1>\n"
    )


def _counts(rows: Sequence[Row]) -> str:
    read = [row for row in rows if "failure" not in row]
    metric = [row["trajectory_length"] or 0 for row in read if row["metric"]]
    told = (
        ("atlases", len(rows), ""),
        ("sound", sum(row["sound"] for row in read), ""),
        ("not sound", sum(not row["sound"] for row in read), "bad"),
        ("not readable or not done", len(rows) - len(read), "bad"),
        ("keyframes", sum(row["keyframes"] for row in read), ""),
        ("points", sum(row["points"] for row in read), ""),
        ("km, of maps in metres", sum(metric) / 1000, ""),
        ("hours", sum(row["duration_s"] or 0 for row in read) / 3600, ""),
        ("GB", sum(row.get("bytes") or 0 for row in rows) / 1e9, ""),
    )
    parts = [f'<div class="{kind if value else ""}"><b>{number(value)}</b>{name}</div>' for name, value, kind in told]
    table = '<p><a href="summary.csv">summary.csv</a> has a row for each.</p>\n'
    return f'<div class="counts">{"".join(parts)}</div>\n{table}'


def _rules(read: Sequence[Row]) -> str:
    counts = collections.Counter(rule for row in read for rule in row["rules"])
    if not counts:
        return ""
    ranked = sorted(counts.items(), key=lambda entry: (-entry[1], entry[0]))
    return "<h2>What is broken</h2>\n" + table(("rule", "atlases"), ranked, len(ranked))


def _failures(rows: Sequence[Row]) -> str:
    failed = [(row["input"], row["failure"]) for row in rows if "failure" in row]
    if not failed:
        return ""
    return "<h2>Not readable, or not done</h2>\n" + table(("atlas", "why"), failed[:MOST_ROWS], len(failed))


def _unsound(read: Sequence[Row], folder: pathlib.Path) -> str:
    broken = sorted((row for row in read if not row["sound"]), key=lambda row: -row["error"])
    if not broken:
        return ""
    shown = [
        (Link(row, folder), row["error"], row["warning"], ", ".join(row["rules"])) for row in broken[:MOST_ROWS]
    ]
    return "<h2>Not sound</h2>\n" + table(("atlas", "errors", "warnings", "rules"), shown, len(broken))


def values_of(read: Sequence[Row], measure: Measure) -> "np.ndarray[Any, np.dtype[np.float64]]":
    return np.array([np.nan if row[measure.name] is None else row[measure.name] for row in read], dtype=float)


def _distributions(read: Sequence[Row]) -> str:
    known = [(measure, values[np.isfinite(values)]) for measure in MEASURES if len(values := values_of(read, measure))]
    known = [(measure, values) for measure, values in known if len(values)]
    if not known:
        return ""
    quantiles = [
        (measure.title, measure.unit, *np.percentile(values, (0, 5, 50, 95, 100)).tolist())
        for measure, values in known
    ]
    plots = "".join(_histogram(measure, values) for measure, values in known)
    heads = ("", "", "least", "5 %", "median", "95 %", "greatest")
    return f'<h2>Distributions</h2>\n{table(heads, quantiles, 0)}<div class="plots">{plots}</div>\n'


def _histogram(measure: Measure, values: "np.ndarray[Any, np.dtype[np.float64]]") -> str:
    """How many atlases have how much: on a logarithmic scale where values are of several magnitudes."""
    logarithmic = values.min() > 0 and values.max() / values.min() > 100
    counts, edges = np.histogram(np.log10(values) if logarithmic else values, bins=24)
    low, high = (10.0 ** edges[[0, -1]] if logarithmic else edges[[0, -1]]).tolist()
    bars = "".join(
        f'<rect x="{10 * i}" y="{80 - height:.1f}" width="9" height="{height:.1f}"/>'
        for i, height in enumerate(80.0 * counts / counts.max())
    )
    return (
        f'<figure><figcaption>{text(measure.title)} <span class="faint">{text(measure.unit)}</span></figcaption>'
        f'<svg width="240" height="96" role="img" aria-label="{text(measure.title)}">{bars}'
        f'<text x="0" y="93">{number(low)}</text><text x="240" y="93" text-anchor="end">{number(high)}'
        f"{' (log)' if logarithmic else ''}</text></svg></figure>"
    )


def _outliers(read: Sequence[Row], folder: pathlib.Path) -> str:
    rows = sorted(outliers_of(read), key=lambda found: -found[-1])
    if not rows:
        return ""
    shown = [
        (Link(read[index], folder), measure.title, value, middle)
        for index, measure, value, middle, _ in rows[:MOST_ROWS]
    ]
    heads = ("atlas", "measure", "value", "median of all")
    about = '<p class="faint">More than six robust deviations from the median of the logarithms.</p>\n'
    return f"<h2>Outliers</h2>\n{about}" + table(heads, shown, len(rows))


def outliers_of(read: Sequence[Row]) -> Iterator[Any]:
    """(row, measure, value, median, how many deviations)"""
    for measure in MEASURES:
        values = values_of(read, measure)
        logs = np.log1p(np.where(np.isfinite(values), values, 0))
        middle = np.median(logs) if len(logs) else 0
        spread = 1.4826 * np.median(np.abs(logs - middle)) if len(logs) else 0
        if spread <= 0:
            continue
        away = np.abs(logs - middle) / spread
        for index in np.flatnonzero(away > 6):
            yield int(index), measure, float(values[index]), float(np.expm1(middle)), float(away[index])


def _twins(read: Sequence[Row]) -> str:
    by_hash: "collections.defaultdict[str, List[str]]" = collections.defaultdict(list)
    for row in read:
        if row.get("sha256"):
            by_hash[row["sha256"]].append(row["input"])
    twins = [(len(inputs), ", ".join(inputs[:5]) + (", ..." if len(inputs) > 5 else ""))
             for inputs in by_hash.values() if len(inputs) > 1]  # fmt: skip
    if not twins:
        return ""
    return "<h2>The same bytes</h2>\n" + table(("files", "which"), twins[:MOST_ROWS], len(twins))
