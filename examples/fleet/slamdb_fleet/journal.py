# SPDX-License-Identifier: BSD-3-Clause
"""What is done, on disk, so that whatever is killed, nothing is lost and nothing is done twice.

Whoever works on a chunk of atlases holds its journal: a file of lines of JSON, `begun` before an atlas and `done`
behind it. A chunk that is given out again, since its worker was lost, goes on where its journal ends.
"""

import collections
import errno
import fcntl
import json
import os
import pathlib
from typing import Any, Dict, Iterator, List, Optional, Tuple

Entry = Dict[str, Any]


class ChunkJournal:
    """The journal of one chunk, held by one process at a time.

    A file system without locks lets two processes work on one chunk: both then write the same outputs and lines.
    """

    def __init__(self, path: pathlib.Path) -> None:
        self._file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o666)
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX)
        except OSError as error:
            if error.errno not in (errno.ENOSYS, errno.EOPNOTSUPP, errno.ENOLCK):
                raise
        self.done: Dict[str, Entry] = {}
        self._begun: Dict[str, List[str]] = collections.defaultdict(list)
        for kind, entry in _lines(path):
            self._take(kind, entry)
        size = os.fstat(self._file).st_size
        if size and os.pread(self._file, 1, size - 1) != b"\n":  # of a writer that was killed in its line
            self._write(b"\n")

    def times_begun(self, input: str, run: str) -> int:
        """How many times an atlas was begun in a run since it was done last."""
        return self._begun[input].count(run)

    def begin(self, input: str, run: str) -> None:
        self._append("begun", {"input": input, "run": run})

    def finish(self, entry: Entry) -> None:
        self._append("done", entry)

    def _append(self, kind: str, entry: Entry) -> None:
        self._write(json.dumps({kind: entry}).encode() + b"\n")
        self._take(kind, entry)

    def _take(self, kind: str, entry: Entry) -> None:
        if kind == "begun":
            self._begun[entry["input"]].append(entry["run"])
            return
        self.done[entry["input"]] = entry
        self._begun[entry["input"]].clear()

    def _write(self, line: bytes) -> None:
        if os.write(self._file, line) != len(line):
            raise OSError(errno.ENOSPC, "the journal cannot be written")

    def __enter__(self) -> "ChunkJournal":
        return self

    def __exit__(self, *raised: object) -> None:
        os.close(self._file)


def read_journals(folder: pathlib.Path) -> Dict[str, Entry]:
    """The last `done` of every atlas, by its input."""
    entries: Dict[str, Entry] = {}
    for path in sorted(folder.glob("*.jsonl")):
        for kind, entry in _lines(path):
            known = entries.get(entry["input"])
            if kind == "done" and (known is None or known["at"] <= entry["at"]):
                entries[entry["input"]] = entry
    return entries


def lines_of(folder: pathlib.Path, chunk: str) -> int:
    """How long the journal of a chunk is: it grows with everything that is begun."""
    path = folder / "journal" / f"{chunk}.jsonl"
    return sum(1 for _ in _lines(path)) if path.exists() else 0


def _lines(path: pathlib.Path) -> Iterator[Tuple[str, Entry]]:
    with open(path, "rb") as file:
        for line in file:
            parsed = _parsed(line)
            if parsed is not None:
                yield parsed


def _parsed(line: bytes) -> Optional[Tuple[str, Entry]]:
    """None of a line that a killed writer left unfinished."""
    try:
        [(kind, entry)] = json.loads(line).items()
    except (ValueError, AttributeError):
        return None
    return (kind, entry) if isinstance(entry, dict) and "input" in entry else None
