# SPDX-License-Identifier: BSD-3-Clause
"""What is done with one atlas, and with a chunk of them: in a worker, or in a part of a Slurm array."""

import contextlib
import hashlib
import os
import pathlib
import threading
import time
import warnings
from typing import Any, Dict, Iterator, List, NamedTuple, Optional

import slamdb

from .journal import ChunkJournal, Entry

Row = Dict[str, Any]

LASTING = ("", "damaged", "unsupported", "usage", "not possible", "set aside")  # kinds of failures that stay


class Job(NamedTuple):
    """What is to be done with every atlas."""

    base: str  # the folder from which inputs are named
    folder: str  # where journals and outputs are
    version: str  # of slamdb
    check: Dict[str, Any]  # keywords of slamdb.check
    format: str  # that outputs have; empty: their suffix tells
    strict: bool  # what loses something is not written
    attempts: int  # how many processes an atlas may end before it is set aside

    def digest(self) -> str:
        """Tells entries of this job from those of others."""
        asked = repr((self.version, sorted(self.check.items()), self.format, self.strict))
        return hashlib.sha256(asked.encode()).hexdigest()[:16]


class Item(NamedTuple):
    """One atlas, and what is known of it."""

    input: str
    output: str  # below Job.folder; empty: it is not written again
    page: str  # below Job.folder; empty: it gets no page
    stored: Optional[Dict[str, Any]]  # `hash` and `bytes` of an atlas in a store; None: a file
    before: Optional[Entry]  # of an earlier run: it holds where the bytes are the same
    seen: Optional[float]  # `at` of the entry that did not keep this atlas from being given out


class Chunk(NamedTuple):
    name: str  # of its journal
    run: str  # attempts are counted in one run
    items: List[Item]


class ClusterError(Exception):
    """No work can be done: the scheduler is gone, workers do not live to begin, or have another slamdb."""


_ONE_AT_A_TIME = threading.Lock()  # in a process: warnings are caught of one atlas, and one is to blame for a crash


def do_chunk(job: Job, chunk: Chunk) -> List[Entry]:
    """Do what is not done yet of a chunk; the entries of all of it."""
    if slamdb.__version__ != job.version:
        raise ClusterError(f"slamdb is {slamdb.__version__} where workers run, and {job.version} here")
    journal_path = pathlib.Path(job.folder, "journal", f"{chunk.name}.jsonl")
    with _ONE_AT_A_TIME, _inside(job.base), ChunkJournal(journal_path) as journal:
        return [_do_once(job, item, chunk.run, journal) for item in chunk.items]


def _do_once(job: Job, item: Item, run: str, journal: ChunkJournal) -> Entry:
    earlier = journal.done.get(item.input)
    if earlier is not None and earlier["at"] != item.seen and holds(earlier, job, item):
        return earlier  # of a worker that was lost, or of one that still worked for a driver that was
    attempts = journal.times_begun(item.input, run)
    if attempts < job.attempts:
        journal.begin(item.input, run)
        entry = _entry_of(job, item)
    else:
        entry = set_aside(job, item, f"it ended {attempts} processes that worked on it")
    journal.finish(entry)
    return entry


def signature_of(item: Item) -> Dict[str, Any]:
    """What changes when an atlas does: quickly told, without reading it."""
    if item.stored is not None:
        return dict(item.stored)
    status = os.stat(item.input)
    return {"bytes": status.st_size, "mtime_ns": status.st_mtime_ns}


def is_of(entry: Entry, job: Job, item: Item) -> bool:
    """Whether it was made by the same job, and what was written is still there."""
    if entry["job"] != job.digest() or entry["asked"] != [item.output, item.page] or entry["kind"] not in LASTING:
        return False
    return all(_size(os.path.join(job.folder, path)) == size for path, size in entry["written"].items())


def holds(entry: Entry, job: Job, item: Item) -> bool:
    """Whether an entry tells of the atlas as it is."""
    with contextlib.suppress(OSError):
        return is_of(entry, job, item) and signature_of(item).items() <= entry["signature"].items()
    return False


def set_aside(job: Job, item: Item, reason: str) -> Entry:
    """Of an atlas that is not worked on any more."""
    signature: Dict[str, Any] = {}
    with contextlib.suppress(OSError):
        signature = signature_of(item)
    return _entry(job, item, signature, {"failure": f"set aside: {reason}"}, "set aside")


def _entry_of(job: Job, item: Item) -> Entry:
    """Of what was done; a failure of the atlas is an entry, and one of the folder of outputs is raised."""
    signature: Dict[str, Any] = {}
    try:
        with contextlib.suppress(OSError):  # reading says it better
            signature = signature_of(item)
            if item.stored is None:
                signature["sha256"] = _sha256_of(item.input)
        if item.before is not None and item.before["signature"].get("sha256") == signature.get("sha256", ""):
            return {**item.before, "signature": signature, "at": time.time()}
        row = _row_of(job, item)
        if not signature_of(item).items() <= signature.items():
            raise slamdb.LockedError("was changed while it was read", item.input)
        return _entry(job, item, signature, row, "")
    except slamdb.Error as error:
        return _entry(job, item, signature, {"failure": str(error)}, error.kind)
    except OSError as error:
        return _entry(job, item, signature, {"failure": f"{item.input}: {error.strerror}"}, "not found")
    except MemoryError:
        return _entry(job, item, signature, {"failure": f"{item.input}: memory does not suffice"}, "out of resources")
    except (UnicodeError, TypeError, ValueError) as error:
        return _entry(job, item, signature, {"failure": f"{item.input!a}: {error}"}, "internal")


def _entry(job: Job, item: Item, signature: Dict[str, Any], row: Row, kind: str) -> Entry:
    known = {"input": item.input, "bytes": signature.get("bytes"), "sha256": signature.get("sha256")}
    files = [row[column] for column in ("output", "page", "thumbnail") if column in row]
    return {
        "input": item.input, "signature": signature, "job": job.digest(), "asked": [item.output, item.page],
        "written": {path: _size(os.path.join(job.folder, path)) for path in files},
        "kind": kind, "row": {**known, **row}, "at": time.time(),
    }  # fmt: skip


def _row_of(job: Job, item: Item) -> Row:
    with _said() as said:
        atlas = slamdb.read(item.input, threads=1)
    row: Row = {**slamdb.summarize(atlas).to_dict(), "warnings": said}
    [checked] = slamdb.check(atlas, max_findings=1, threads=1, **job.check)["inputs"]
    row["sound"] = checked["sound"]
    row.update(checked["severities"])
    row["rules"] = [result["rule"] for result in checked["results"] if result["severity"] == "error"]
    for measure in ("components", "observers_per_point", "reprojection_error_px"):
        row[measure] = checked["measures"][measure]
    if item.output:
        with _said() as said, _blaming_no_atlas():
            path = _place(job, item.output)
            slamdb.write(atlas, path, format=job.format, overwrite=True, strict=job.strict, threads=1)
        row.update(output=item.output, losses=said)
    if item.page:
        row.update(_write_page(job, item, atlas))
    return row


def _write_page(job: Job, item: Item, atlas: slamdb.Atlas) -> Row:
    page = slamdb.report(atlas, name=item.input.encode(errors="replace").decode(), threads=1)
    files = {"page": item.page, "thumbnail": os.path.splitext(item.page)[0] + ".png"}
    with _blaming_no_atlas():
        slamdb.write_file(_place(job, files["page"]), page.html.encode(errors="replace"), overwrite=True)
        slamdb.write_file(_place(job, files["thumbnail"]), page.thumbnail, overwrite=True)
    return files


def _place(job: Job, output: str) -> str:
    """Where it is written: in the folder of outputs, whatever links are in it."""
    path = os.path.join(job.folder, output)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    if os.path.realpath(path) != os.path.join(os.path.realpath(job.folder), output):
        raise slamdb.UsageError("leads out of the folder of outputs", path)
    return path


class UnwritableError(Exception):
    """A full disk, or the like: it says nothing of the atlas, and would be the same with the next."""


@contextlib.contextmanager
def _blaming_no_atlas() -> Iterator[None]:
    try:
        yield
    except slamdb.NotPossibleError:  # of losses, which are of the atlas
        raise
    except (slamdb.Error, OSError) as error:
        raise UnwritableError(str(error)) from error


@contextlib.contextmanager
def _inside(folder: str) -> Iterator[None]:
    """Rows and errors name an atlas as it was named, wherever the process works."""
    before = os.getcwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


@contextlib.contextmanager
def _said() -> Iterator[List[str]]:
    """What slamdb warns of."""
    texts: List[str] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield texts
    texts.extend(str(each.message) for each in caught if issubclass(each.category, slamdb.SlamdbWarning))


def _size(path: str) -> Optional[int]:
    with contextlib.suppress(OSError):
        return os.stat(path).st_size
    return None


def _sha256_of(path: str) -> str:
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()
