# SPDX-License-Identifier: BSD-3-Clause
"""Chunks on the workers of Dask: few at a time are out, lost workers are made up for, and results are let go of."""

import asyncio
import contextlib
import json
import os
import pathlib
import sys
import tempfile
import time
import zipfile
from typing import Any, Dict, Iterator, List, Optional, Sequence, Type

import distributed
import slamdb
from distributed.client import CancelledError
from distributed.comm import CommClosedError
from distributed.diagnostics.plugin import UploadFile
from distributed.scheduler import KilledWorker

from .journal import Entry, lines_of
from .work import Chunk, ClusterError, Job, do_chunk


@contextlib.contextmanager
def client_of(scheduler: str, workers: int) -> Iterator[distributed.Client]:
    """Of a scheduler that runs somewhere, or with workers on this machine: a process for each, with one thread."""
    with contextlib.ExitStack() as opened:
        address: Any = scheduler
        if not scheduler:
            address = opened.enter_context(
                distributed.LocalCluster(
                    n_workers=workers,
                    threads_per_worker=1,  # what ends a process is then one atlas
                    processes=True,
                    host="127.0.0.1",
                    dashboard_address="127.0.0.1:0",
                )
            )
        client = opened.enter_context(distributed.Client(address, set_as_default=False))
        if not client.nthreads():
            print(f"waiting for workers of {scheduler or 'this machine'}", file=sys.stderr)
        client.register_worker_plugin(UploadFile(_package(opened)), name="slamdb_fleet")
        yield client


def address_of(scheduler: str) -> str:
    """Of an address or the file that a scheduler writes, as workers take it with --scheduler-file."""
    try:
        if os.path.isfile(scheduler):
            return str(json.loads(_written(pathlib.Path(scheduler)))["address"])
        distributed.comm.get_address_host_port(scheduler)
        return scheduler
    except (ValueError, KeyError, TypeError) as error:
        wanted = f"an address, such as tcp://10.0.0.1:8786, or a scheduler's file, not {scheduler!r}"
        raise slamdb.UsageError(f"--scheduler takes {wanted}") from error


def _written(path: pathlib.Path, seconds: float = 10) -> bytes:
    """A file once something stands in it: a scheduler that begins makes it first and fills it a moment later."""
    end = time.monotonic() + seconds
    while not (content := path.read_bytes()) and time.monotonic() < end:
        time.sleep(0.05)
    return content


def _package(opened: contextlib.ExitStack) -> str:
    """This package for workers, which may have no folder in common with us."""
    folder = opened.enter_context(tempfile.TemporaryDirectory())
    path = os.path.join(folder, "slamdb_fleet.zip")
    with zipfile.ZipFile(path, "w") as archive:
        for source in sorted(pathlib.Path(__file__).parent.glob("*.py")):
            archive.write(source, f"slamdb_fleet/{source.name}")
    return path


@contextlib.contextmanager
def _scheduler(*losses: Type[BaseException]) -> Iterator[None]:
    """Says so where it is gone, of which it depends on the moment what Dask raises."""
    try:
        yield
    except (CancelledError, CommClosedError, *losses) as error:
        raise ClusterError("the scheduler is gone") from error


class Window:
    """How many chunks may be out: enough that no worker waits, however many come or go."""

    def __init__(self, client: distributed.Client) -> None:
        self._client = client
        self._asked = -1.0
        self._threads = 1

    def size(self) -> int:
        if time.monotonic() - self._asked > 1:
            self._asked = time.monotonic()
            with _scheduler(OSError, asyncio.TimeoutError):
                self._threads = max(1, sum(self._client.nthreads().values()))
        return 2 * self._threads + 1


def run(client: distributed.Client, job: Job, chunks: Sequence[Chunk]) -> Iterator[List[Entry]]:
    """The entries of each chunk, as they come.

    Raises ClusterError, and what a chunk raises that is no failure of an atlas, such as a full disk.
    """
    window = Window(client)
    waiting = (chunk for chunk in chunks if chunk.items)
    out: Dict[str, Chunk] = {}
    lost: Dict[str, int] = {}  # lines of the journals of chunks whose workers were lost, when that was seen last
    completed = distributed.as_completed(loop=client.loop)

    def give_out(chunk: Chunk) -> None:
        key = f"chunk-{chunk.name}-{chunk.run}-{lost.get(chunk.name, 0)}"
        with _scheduler():
            future = client.submit(do_chunk, job, chunk, key=key)
        out[future.key] = chunk
        completed.add(future)

    while True:
        while len(out) < window.size() and (chunk := next(waiting, None)) is not None:
            give_out(chunk)
        if not out:
            return
        future = next(completed)
        chunk = out.pop(future.key)
        entries = _entries_of(future, job, chunk, lost)
        if entries is None:
            give_out(chunk)
        else:
            yield entries


def _entries_of(future: distributed.Future, job: Job, chunk: Chunk, lost: Dict[str, int]) -> Optional[List[Entry]]:
    """None: it is to be given out again, as its workers were lost, but came forward."""
    try:
        with _scheduler():
            entries: List[Entry] = future.result()
        return entries
    except KilledWorker as error:
        lines = lines_of(pathlib.Path(job.folder), chunk.name)
        if lines == lost.get(chunk.name, 0):
            raise ClusterError(f"workers end before they begin to work: {error}") from error
        lost[chunk.name] = lines
        return None
    finally:
        future.release()
