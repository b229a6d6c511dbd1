# SPDX-License-Identifier: BSD-3-Clause
"""Verbs that check, repair, edit and compare.

Those that change an atlas work on a copy and put it in place when it is done: an error or Ctrl-C changes nothing, and
arrays that were taken before show what they showed.
"""

from typing import Dict, Mapping, Optional, Tuple

from . import _slamdb
from ._slamdb import Atlas
from .calls import Source, Texts, changed, listed, made, reported
from .errors import UsageError
from .files import Path, Progress
from .report import CheckReport, Report

def check(
    *sources: Source,
    recursive: bool = False,
    revisions: bool = False,
    format: str = "",
    layout: Optional[Path] = None,
    ignore: Texts = (),
    note: Texts = (),
    warn: Texts = (),
    error: Texts = (),
    strict: bool = False,
    max_findings: int = 100,
    vocabulary: Optional[Path] = None,
    journal: Optional[Path] = None,
    gates: Optional[Mapping[str, float]] = None,
    wait: float = 5,
    threads: int = 0,
    progress: Progress = None,
) -> CheckReport:
    """Hold every rule of docs/checks.md against atlases, files, and all that is in folders and stores.

    recursive: look into folders of folders, too
    revisions: of atlases in stores every revision, not only the newest
    format, layout: of files, as `read` takes them
    ignore: rules that are left out; note, warn, error: rules of another severity than the catalogue's
    strict: warnings count as errors
    max_findings: kept of each rule; all are counted
    vocabulary: the file that the atlases were made with: their words are checked, too; of another one they fail
    journal: a file that keeps what is found as it comes: the same call goes on there when it was interrupted, and reads
        no atlas again that is as it was
    gates: limits, such as {"min-keyframes": 10}
    wait: seconds, for other programs that write to stores

    `report.sound` says whether no error was found, `report.inputs[0].results` what was in the first. What cannot be
    read is an entry with its `failure`, and not sound.
    Raises NotFoundError where there is no atlas, and UsageError for unknown rules and gates.
    """
    given: Dict[str, object] = dict(locals())
    for severity, rules in (("ignore", ignore), ("note", note), ("warn", warn), ("error", error)):
        given[severity] = listed(rules)
    return CheckReport.parse(reported(_slamdb.check, given))


def repair(
    atlas: Atlas,
    *,
    rule: Texts = (),
    vocabulary: Optional[Path] = None,
    journal: Optional[Path] = None,
    undo: Optional[Path] = None,
    overwrite: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Report:
    """Apply the safe repairs of the rules to the atlas, in place; of every rule by default (docs/repair.md).

    vocabulary: file of the words; those that are damaged are computed anew, without it they are dropped
    journal: write every edit to this file; overwrite: replace it
    undo: instead, take back the edits of this journal, of `edit_tables`, too: bit by bit
    """
    if undo is None:
        given = {key: value for key, value in locals().items() if key != "undo"}
        return changed(_slamdb.repair, {**given, "rule": listed(rule)})
    if rule or vocabulary is not None or journal is not None:
        raise UsageError("undo= takes back what its journal says, and nothing else")
    return changed(_slamdb.undo, {"atlas": atlas, "journal": undo, "threads": threads, "progress": progress})


def edit_tables(
    atlas: Atlas,
    *,
    points: Optional[Path] = None,
    keyframes: Optional[Path] = None,
    delete_missing: bool = False,
    journal: Optional[Path] = None,
    overwrite: bool = False,
    threads: int = 0,
) -> Report:
    """Give points and keyframes what the rows of CSV tables say, in place: `slamdb edit` (docs/edit.md).

    points: a table as `write` makes it with format="csv"; keyframes: with format="csv-keyframes"
    delete_missing: delete what has no row
    journal: write every edit to this file, for `repair(undo=)`; overwrite: replace it

    Raises DamagedError, with the line, for a row that does not fit.
    """
    return changed(_slamdb.edit_tables, locals())


def recover(
    path: Path,
    *,
    format: str = "",
    layout: Optional[Path] = None,
    cameras: Optional[Source] = None,
    vocabulary: Optional[Path] = None,
    triangulate: bool = True,
    accept_edits: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Tuple[Atlas, Report]:
    """Save what is whole of a damaged file (docs/recover.md). The report says what is lost, and so do LossWarnings.

    format: its id; layout: of a fork's .osa file, by id or as a JSON file
    cameras: another atlas of the same cameras and vocabulary, from which what of those is lost is taken
    vocabulary: file of the words; those that are damaged are computed anew
    triangulate: make points anew that keyframes saw and that are lost
    accept_edits: of a store: take rows that were edited in SQL as they are now
    Raises DamagedError where nothing is whole.
    """
    return made(_slamdb.recover, locals())


def diff(
    before: Source,
    after: Source,
    *,
    tolerance: float = 0.0,
    max_listed: int = 1000,
    threads: int = 0,
    progress: Progress = None,
) -> Report:
    """Compare two atlases by what they mean: `report.verdict` is "same", "renumbered" or "different".

    tolerance: numbers a and b are the same when |a - b| <= tolerance * max(1, |a|, |b|)
    max_listed: ids to list of what was removed and added
    """
    return Report.parse(reported(_slamdb.diff, locals()))
