# SPDX-License-Identifier: BSD-3-Clause
"""Many atlases: what files, folders and stores stand for, and what is in each."""

from typing import Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from . import _slamdb
from ._slamdb import Atlas
from .calls import Texts, listed, reported
from .files import Path, Progress, Range
from .report import Report
from .words import in_python_words


Ball = Optional[Tuple[Sequence[float], float]]  # (x, y, z), radius


class FoundAtlas(NamedTuple):
    """One atlas that was named, or found in what was named."""

    input: str  # as `slamdb.read` takes it: a path, or STORE.db#NAME
    below: str  # its path from the folder that was named; empty: named itself, or in a store that was
    failure: str  # why a folder or a store cannot be looked into; empty: an atlas, as far as its name tells


def find_atlases(
    *names: Path, recursive: bool = False, wait: float = 5, progress: Progress = None
) -> List[FoundAtlas]:
    """What files, folders, stores and patterns (`maps.db#lab_*`) stand for, as in `slamdb list` (docs/list.md).

    recursive: folders in folders, too
    wait: seconds, for a program that holds a store

    In the order of the names, in natural order within each; nothing but stores is opened. What cannot be looked into is
    an entry with its failure.
    """
    found = _slamdb.find_atlases({"sources": names, "recursive": recursive, "wait": wait, "progress": progress})
    return [FoundAtlas(input, below, in_python_words(failure)) for input, below, failure in found]


def list_atlases(
    *names: Path,
    recursive: bool = False,
    format: str = "",
    layout: Optional[Path] = None,
    time: Range = None,
    near: Ball = None,
    keyframes: Optional[Tuple[int, int]] = None,
    where: Optional[Mapping[str, Tuple[Optional[float], Optional[float]]]] = None,
    who: str = "",
    provenance: str = "",
    tag: str = "",
    sort: Texts = (),
    check: bool = False,
    wait: float = 5,
    threads: int = 0,
    progress: Progress = None,
) -> Report:
    """What is in each of the atlases that names stand for: `slamdb list --json`. Stores tell without reading atlases.

    recursive: folders in folders, too
    format, layout: of files, as `read` takes them
    time: only those of which a map was made, in part, from the first to the last second
    near: only those of which a map has a point in the ball ((x, y, z), radius) in its world
    keyframes: only those of which a map has a keyframe of the ids from the first to the last
    where: only those where numbers lie in ranges, such as {"keyframes": (100, None), "length": (None, 50)}; both ends
        are included
    who: only those of a store with a revision that this robot or person saved: a user, a host or "user@host"; `*` and
        `?` stand for other letters here and in the next two
    provenance: with a revision that was made of this, as the log tells it
    tag: with a revision of this tag; one revision must meet all three
    sort: by "points", "size", "date" and so on, downwards by "-points"; several: equal ones by the next
    check: hold them against the rules, which reads them all
    wait: seconds, for a program that holds a store

    What cannot be read is an entry with its failure.
    """
    given: Dict[str, object] = dict(locals())
    given["sources"] = given.pop("names")
    given["sort"] = listed(sort)
    given["where"] = dict(where or {})
    return Report.parse(reported(_slamdb.list_atlases, given))


def sync(
    first: Path,
    second: Path,
    *,
    name: Texts = (),
    one_way: bool = False,
    diverged: str = "skip",
    dry_run: bool = False,
    retry: int = 0,
    sync: bool = True,
    wait: float = 5,
    threads: int = 0,
    progress: Progress = None,
) -> Report:
    """Two stores, files or databases of servers, come to hold the same atlases, revisions and tags (docs/sync.md).

    name: only the atlases of these names
    one_way: only from the first to the second
    diverged: where both went on from one revision, "skip" leaves both as they are; "branch" saves what the first has in
        the second as NAME-of-HOST (NAME-of-HOST-2, where that is another), too
    dry_run: only tell what would be done
    retry: how often in a row it goes on by itself when the connection is lost or a store is locked
    sync: wait for the disk
    wait: seconds, for a program that holds a store

    What fails for one atlas alone, or has diverged, is an entry that says so. Whatever ends it, the next call goes on.
    """
    given: Dict[str, object] = dict(locals())
    given["name"] = listed(name)
    return Report.parse(reported(_slamdb.sync, given))


def summarize(atlas: Atlas) -> Report:
    """What `list_atlases` tells of the content of an atlas: counts, sensors, the length of its trajectory, times."""
    return Report.parse(_slamdb.summarize(atlas))


def write_file(path: Path, data: bytes, *, overwrite: bool = False, sync: bool = True) -> None:
    """Write bytes of any kind as atlases are written: the file appears whole or not at all.

    overwrite: replace what is there; atlases and stores are never replaced
    sync: wait for the disk

    Raises AlreadyExistsError, NotFoundError (the folder), AccessDeniedError, OutOfResourcesError.
    """
    _slamdb.write_file(path, data, overwrite, sync)
