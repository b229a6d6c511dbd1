# SPDX-License-Identifier: BSD-3-Clause
"""The verbs of the command line as functions.

Those that change an atlas work on a copy and put it in place when it is done: an error or Ctrl-C changes nothing, and
arrays that were taken before show what they showed.
"""

import os
from typing import Mapping, Optional, Sequence, Tuple, Union

from . import _slamdb
from ._slamdb import Atlas
from .files import Path, Progress, read
from .report import CheckReport, Report

Source = Union[Atlas, Path]


def _held(source: Source) -> Atlas:
    return source if isinstance(source, Atlas) else read(source)


def _name(source: Source) -> str:
    return "" if isinstance(source, Atlas) else os.fspath(source)


def check(
    source: Source,
    *,
    ignore: Sequence[str] = (),
    note: Sequence[str] = (),
    warn: Sequence[str] = (),
    error: Sequence[str] = (),
    strict: bool = False,
    max_findings: int = 100,
    gates: Optional[Mapping[str, float]] = None,
    threads: int = 0,
    progress: Progress = None,
) -> CheckReport:
    """Hold every rule of docs/checks.md against an atlas, or a file.

    ignore: rules that are left out; note, warn, error: rules of another severity than the catalogue's
    strict: warnings count as errors
    max_findings: kept of each rule; all are counted
    gates: limits, such as {"min-keyframes": 10}

    `report.sound` says whether no error was found, `report.inputs[0].results` what was.
    """
    report = _slamdb.check(
        _held(source), _name(source), list(ignore), list(note), list(warn), list(error), strict, max_findings,
        dict(gates or {}), threads, progress,
    )  # fmt: skip
    return CheckReport.parse(report)


def repair(atlas: Atlas, *, rules: Sequence[str] = (), threads: int = 0, progress: Progress = None) -> Report:
    """Apply the safe repairs of the rules to the atlas, in place; of every rule by default."""
    return Report.parse(_slamdb.repair(atlas, list(rules), threads, progress))


def recover(
    path: Path, *, format: str = "", triangulate: bool = True, threads: int = 0, progress: Progress = None
) -> Tuple[Atlas, Report]:
    """Save what is whole of a damaged file. The report says what is lost.

    triangulate: make points anew that keyframes saw and that are lost
    Raises DamagedError where nothing is whole.
    """
    atlas, report = _slamdb.recover(os.fspath(path), format, triangulate, threads, progress)
    return atlas, Report.parse(report)


def diff(
    before: Source, after: Source, *, tolerance: float = 0.0, threads: int = 0, progress: Progress = None
) -> Report:
    """Compare two atlases by what they mean: `report.verdict` is "same", "renumbered" or "different".

    tolerance: numbers a and b are the same when |a - b| <= tolerance * max(1, |a|, |b|)
    """
    names = (_name(before), _name(after))
    return Report.parse(_slamdb.diff(_held(before), _held(after), names, tolerance, threads, progress))


def merge(
    *sources: Source,
    same_map: str = "keep-both",
    ignore_vocabulary: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Tuple[Atlas, Report]:
    """Bring the maps of all atlases into a new one, side by side, with ids that do not clash.

    same_map: what becomes of a map that comes twice: "keep-both", "keep-first" or "error"
    ignore_vocabulary: keep the first vocabulary though another atlas has a different one
    """
    atlas, report = _slamdb.merge(
        [_held(source) for source in sources], [_name(source) for source in sources], same_map, ignore_vocabulary,
        threads, progress,
    )  # fmt: skip
    return atlas, Report.parse(report)
