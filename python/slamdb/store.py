# SPDX-License-Identifier: BSD-3-Clause
"""Stores: many atlases in one SQLite file or database of a server, each under a name, with their history."""

import os
from types import TracebackType
from typing import Any, List, Mapping, Optional, Tuple, Type

from . import _slamdb
from ._slamdb import Atlas
from .calls import Texts
from .errors import NotFoundError, UsageError
from .files import Box, Path, Progress, Range, told
from .many import Ball, list_atlases
from .report import CheckReport, Report
from .verbs import check


class Store:
    """Many atlases in one SQLite file, each under a name, with the history of what was done to them (docs/store.md).

        with slamdb.Store("maps.db") as store:
            store.save("lab", atlas)
            part = store.load("lab", box=((-1, -1, 0), (1, 1, 3)))

    Every call is a transaction of its own and opens the file for itself. So threads may share a store, the same file
    may be open several times, what others save meanwhile is seen, and a Store can be pickled and sent to other
    processes. Those of a pool have to be started with "spawn", since SQLite is not to be used across a fork. Nothing is
    held between calls; `close` only ends the use of this object.

    path: of a file, or `postgresql://user@host/database` as a str, since a pathlib.Path keeps only one of two slashes. A
        password is best kept in ~/.pgpass, and is shown nowhere. `backup` and `vacuum` are for files
    read_only: nothing is written, and nothing made; otherwise a file that is missing is made by the first save
    wait: seconds for which a call waits for another program that writes; then it raises LockedError
    sync: a save that has returned survives power loss

    Raises NotFoundError where it is missing and `read_only`, UnsupportedError for databases of other programs. A store
    of an older version opens, for `migrate`; all else raises UnsupportedError.
    """

    def __init__(self, path: Path, *, read_only: bool = False, wait: float = 5.0, sync: bool = True) -> None:
        self._path = os.fspath(path)
        self._shown = _slamdb.without_password(os.fsencode(self._path))
        self._read_only = read_only
        self._options = (wait, sync)
        self._closed = False
        file = self._file
        if read_only or file.is_made():
            file.migrate(False, True, False)  # without doing anything: it is a store

    @property
    def path(self) -> str:
        """Of a server without the password."""
        return self._shown

    @property
    def closed(self) -> bool:
        return self._closed

    def close(self) -> None:
        """Ends its use: all that is called afterwards raises UsageError."""
        self._closed = True

    def __enter__(self) -> "Store":
        return self

    def __exit__(
        self, kind: Optional[Type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<slamdb.Store {self._shown!r}{' closed' if self._closed else ''}>"

    def _repr_html_(self) -> Optional[str]:
        from .notebook import html_of_store

        return html_of_store(self)

    @property
    def _file(self) -> _slamdb.StoreFile:
        if self._closed:
            raise UsageError("the store is closed", self._shown)
        return _slamdb.StoreFile(os.fsencode(self._path), *self._options)

    @property
    def _writer(self) -> _slamdb.StoreFile:
        if self._read_only:
            raise UsageError("the store was opened with read_only=True", self._shown)
        return self._file

    @property
    def names(self) -> List[str]:
        """What its atlases are called, ascending; none, where the file is not made yet."""
        file = self._file
        return file.names() if self._read_only or file.is_made() else []

    def __contains__(self, name: object) -> bool:
        return name in self.names

    def save(
        self,
        name: str,
        atlas: Atlas,
        *,
        overwrite: bool = False,
        keep_equal: bool = False,
        provenance: str = "",
        threads: int = 0,
        progress: Progress = None,
    ) -> Report:
        """Save an atlas under a name, whole or not at all. Of one that is replaced only rows that differ are written.

        overwrite: replace the atlas of that name by this one, as its next revision
        keep_equal: one that is there as it is, by its hash, stays, also without `overwrite`
        provenance: a line for the history: what made the atlas

        The report has `replaced`, `unchanged` (by keep_equal), `revision` (its number) and `rows` (inserted, updated, deleted, unchanged).
        Raises AlreadyExistsError, LockedError, OutOfResourcesError (the disk is full), UsageError for names that
        cannot be.
        """
        saved, notices = self._writer.save(_bytes(name), atlas, overwrite, keep_equal, provenance, threads, progress)
        told(notices)
        return Report(saved)

    def load(
        self,
        name: str,
        *,
        map: Optional[int] = None,
        keyframes: Optional[Tuple[int, int]] = None,
        time: Range = None,
        box: Box = None,
        features: bool = True,
        threads: int = 0,
        progress: Progress = None,
    ) -> Atlas:
        """Load an atlas, or a part of it as `slamdb.read` does. The rest is not read.

        name: of the atlas, or of an earlier revision: "lab@3", "lab@-1" (the one before the newest),
            "lab@{2026-11-20}" (the newest of that day, UTC), "lab@release" (a tag)
        features: False leaves out keypoints, descriptors, what keypoints see, and words: most of the bytes

        Every row is held against its hash: raises DamagedError, naming the first that differs; NotFoundError, naming
        the atlases that there are.
        """
        given = {key: value for key, value in locals().items() if key != "self"}
        return self._file.load(_bytes(given.pop("name")), given)

    def restore(self, name: str, *, threads: int = 0, progress: Progress = None) -> int:
        """Make an earlier revision ("lab@3") the newest again, by saving it anew; returns the number that it has then.

        Those between stay. Raises NotFoundError, naming the revisions that there are.
        """
        return self._writer.restore(_bytes(name), threads, progress)

    def branch(self, name: str, branch: str, *, threads: int = 0, progress: Progress = None) -> None:
        """Begin an atlas `branch` as another one, or as a revision of it. What both share of pictures is stored once.

        Raises NotFoundError; AlreadyExistsError where there is an atlas of that name.
        """
        self._writer.branch(_bytes(name), _bytes(branch), threads, progress)

    def tag(self, name: str, tag: str, *, remove: bool = False) -> None:
        """Give a revision ("lab" is the newest) a name, by which `load` takes it and which `gc` leaves.

        remove: take the tag from the atlas instead

        Raises UsageError for what is no name, AlreadyExistsError where another revision has it, NotFoundError.
        """
        self._writer.tag(_bytes(name), _bytes(tag), remove)

    def gc(
        self,
        name: str = "",
        *,
        keep: Optional[int] = None,
        keep_days: Optional[float] = None,
        keep_tags: bool = False,
        dry_run: bool = False,
    ) -> Report:
        """Give up earlier revisions of one atlas, or of all: `slamdb gc --json`. One way to keep has to be given.

        keep: so many of the newest revisions of each atlas
        keep_days: what was saved in so many days up to now
        keep_tags: nothing but the newest and what has a tag, which stays anyway
        dry_run: only tell what would go

        The file keeps its size until `vacuum`. Raises NotFoundError where there is no such atlas.
        """
        if keep is None and keep_days is None and not keep_tags:
            raise UsageError("say what to keep: keep, keep_days, or keep_tags=True", self._shown)
        if (keep is not None and keep < 1) or (keep_days is not None and not keep_days >= 0):
            raise UsageError("keep is at least 1, and keep_days is not negative", self._shown)
        return Report.parse(self._writer.gc(_bytes(name), keep, keep_days, dry_run))

    def remove(self, name: str, *, progress: Progress = None) -> None:
        """Remove an atlas with all its revisions; its history stays. The file keeps its size until `vacuum`. Raises NotFoundError."""
        self._writer.remove(_bytes(name), progress)

    def list(
        self,
        *,
        time: Range = None,
        near: Ball = None,
        keyframes: Optional[Tuple[int, int]] = None,
        sort: Texts = (),
        check: bool = False,
        threads: int = 0,
        progress: Progress = None,
    ) -> Report:
        """What is in each atlas, as `slamdb list --json` tells. Reads none of them, unless to check them.

        time: only those of which a map was made, in part, from the first to the last second
        near: only those of which a map has a point in the ball ((x, y, z), radius) in its world
        keyframes: only those of which a map has a keyframe of the ids from the first to the last
        sort: by "points", "size", "saved" and so on, downwards by "-points"; several: equal ones by the next
        check: hold them against the rules of `slamdb.check`, and count what is found
        """
        self._file.names()  # what is wrong with the store as a whole is an error, not an entry
        return list_atlases(
            self._path, time=time, near=near, keyframes=keyframes, sort=sort, check=check, wait=self._options[0],
            threads=threads, progress=progress,
        )  # fmt: skip

    def log(self) -> Report:
        """The history of the store, oldest first, as `slamdb log --json` tells."""
        return Report.parse(self._file.log(b""))

    def history(self, name: str) -> Report:
        """The history of one atlas: `entries` with `at`, `action`, `provenance`, counts, `rows`, `hash`, and of
        revisions `revision`, `readable`, `who`, `changes`, `tags` and `from`."""
        return Report.parse(self._file.log(_bytes(name)))

    def stats(self) -> Report:
        """What takes the space, as `slamdb stats --json` tells."""
        return Report.parse(self._file.stats())

    def check(
        self,
        *,
        ignore: Texts = (),
        note: Texts = (),
        warn: Texts = (),
        error: Texts = (),
        strict: bool = False,
        max_findings: int = 100,
        gates: Optional[Mapping[str, float]] = None,
        revisions: bool = False,
        journal: Optional[Path] = None,
        threads: int = 0,
        progress: Progress = None,
    ) -> CheckReport:
        """Check all atlases: `slamdb check STORE --json`. Arguments are those of `slamdb.check`.

        One that cannot be read is an entry with its `failure`. Raises NotFoundError where there is no atlas.
        """
        if not self.names:
            raise NotFoundError("there is no atlas to check", self._shown)
        return check(
            self._path, ignore=ignore, note=note, warn=warn, error=error, strict=strict, max_findings=max_findings,
            gates=gates, revisions=revisions, journal=journal, wait=self._options[0], threads=threads, progress=progress,
        )  # fmt: skip

    def add(
        self,
        *paths: Path,
        recursive: bool = False,
        name: str = "",
        name_from: str = "stem",
        overwrite: bool = False,
        dry_run: bool = False,
        format: str = "",
        layout: str = "",
        threads: int = 0,
        progress: Progress = None,
    ) -> Report:
        """Save the atlases of files, folders and other stores, each under a name of its own: `slamdb add --json`.

        recursive: folders in folders, too
        name: of the only one, in the place of what its file is called
        name_from: "stem", the file's name without suffix, or "path", the whole path below the folder that was named
        overwrite: another atlas of a name that is taken is replaced; otherwise it fails
        dry_run: read everything, write nothing
        format, layout: of the files, as `slamdb.read` takes them

        Each is saved by itself, and one that is there as it is stays. What fails is an entry with its `failure`;
        `report.failed` counts them. What ends the work early leaves whole atlases.
        """
        added, notices = self._writer.add(
            [os.fsencode(path) for path in paths], recursive, _bytes(name), name_from, overwrite, dry_run, format,
            layout, threads, progress,
        )  # fmt: skip
        told(notices)
        return Report.parse(added)

    def table(self, kind: str, name: Optional[str] = None) -> Any:
        """The "keyframes", "points" or "observations" of one atlas, or of all of them, with columns `atlas` and `map`.

        A pandas.DataFrame where pandas is installed, in which ids that are none are <NA>; otherwise a dictionary of
        numpy arrays, one for each column, in which they are slamdb.NONE. Behind `atlas` and `map`:

        keyframes: id, timestamp (seconds), x, y, z, qx, qy, qz, qw (world from camera), parent, bad
        points: id, x, y, z, nx, ny, nz, observations (how many), reference_keyframe, min_distance, max_distance, bad
        observations: point, keyframe, left, right (rows of keypoints; -1: none)

        In the tables that `slamdb convert` writes (.keyframes.csv, .csv, .observations.csv) what is the same has the
        same name; they have more columns, no `bad`, and not the rows that it flags.
        """
        from . import tables  # here, because it imports numpy

        if kind not in tables.KINDS:
            raise UsageError(f"there is no table {kind!r}: there are {', '.join(tables.KINDS)}", self._shown)
        names = self.names if name is None else [name]
        columns = tables.atlas_columns(kind, ((each, self.load(each, features=False)) for each in names))
        return tables.frame_of(columns) if tables.has_pandas() else columns

    def backup(self, target: Path, *, overwrite: bool = False) -> None:
        """Copy the store as it is now, also while others write to it. Raises AlreadyExistsError."""
        self._file.backup(os.fsencode(target), overwrite)

    def vacuum(self, *, progress: Progress = None) -> None:
        """Give free space back to the disk."""
        self._writer.vacuum(progress)

    def migrate(self, *, back: bool = False, dry_run: bool = False, backup: bool = True) -> Report:
        """Bring a store of an older slamdb to this one's version; nothing is done where it is.

        back: go one version back instead, for an earlier slamdb; refused where something would be lost
        dry_run: only tell
        backup: keep it as it was, in a file beside it

        The report has `from_version`, `to_version`, `steps` and `backup`, the path or None.
        """
        return Report(self._writer.migrate(back, dry_run, backup))


def _bytes(name: str) -> bytes:
    return name.encode("utf-8", "surrogateescape")
