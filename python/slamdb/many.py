# SPDX-License-Identifier: BSD-3-Clause
"""Many atlases: what files, folders and stores stand for, and what is in each."""

import os
from typing import List, NamedTuple

from . import _slamdb
from ._slamdb import Atlas
from .files import Path, Progress
from .report import Report
from .words import in_python_words


class FoundAtlas(NamedTuple):
    """One atlas that was named, or found in what was named."""

    input: str  # as `slamdb.read` takes it: a path, or STORE.db#NAME
    below: str  # its path from the folder that was named; empty: named itself, or in a store that was
    failure: str  # why a folder or a store cannot be looked into; empty: an atlas, as far as its name tells


def find_atlases(
    *names: Path, recursive: bool = False, lock_timeout: float = 5, progress: Progress = None
) -> List[FoundAtlas]:
    """What files, folders, stores and patterns (`maps.db#lab_*`) stand for, as in `slamdb list` (docs/list.md).

    recursive: folders in folders, too
    lock_timeout: seconds to wait for a program that holds a store

    In the order of the names, in natural order within each; nothing but stores is opened. What cannot be looked into is
    an entry with its failure.
    """
    found = _slamdb.find_atlases([os.fspath(name) for name in names], recursive, lock_timeout, progress)
    return [FoundAtlas(input, below, in_python_words(failure)) for input, below, failure in found]


def list_atlases(
    *names: Path,
    recursive: bool = False,
    check: bool = False,
    lock_timeout: float = 5,
    threads: int = 0,
    progress: Progress = None,
) -> Report:
    """What is in each of the atlases that names stand for: `slamdb list --json`. Stores tell without reading atlases.

    check: hold them against the rules, which reads them all

    What cannot be read is an entry with its failure.
    """
    paths = [os.fspath(name) for name in names]
    report = _slamdb.list_atlases(paths, recursive, check, lock_timeout, threads, progress)
    return Report.parse(in_python_words(report))


def summarize(atlas: Atlas) -> Report:
    """What `list_atlases` tells of the content of an atlas: counts, sensors, the length of its trajectory, times."""
    return Report.parse(_slamdb.summarize(atlas))


def write_file(path: Path, data: bytes, *, overwrite: bool = False, sync: bool = True) -> None:
    """Write bytes of any kind as atlases are written: the file appears whole or not at all.

    overwrite: replace what is there; a store is never replaced
    sync: wait for the disk

    Raises AlreadyExistsError, NotFoundError (the folder), AccessDeniedError, OutOfResourcesError.
    """
    _slamdb.write_file(os.fspath(path), data, overwrite, sync)
