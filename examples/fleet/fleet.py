#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Checks, describes and writes again many thousand atlases, on all cores of a machine or of a cluster.

What is killed in the middle, be it a worker, the scheduler or this script, is made up for: the same command goes on
where the journal in the folder of outputs ends, and does again only what has changed. docs/fleet.md tells more.
"""

import argparse
import json
import os
import pathlib
import sys
import tempfile
import time
import uuid
import warnings
from typing import Any, Dict, Iterator, List, Optional, Sequence

import slamdb
from slamdb_fleet.journal import Entry, read_journals
from slamdb_fleet.page import write_page
from slamdb_fleet.plan import Plan, Wanted, chunks_of, make_plan, refuse_inputs_below
from slamdb_fleet.summary import rows_of, write_csv, write_parquet
from slamdb_fleet.work import Chunk, ClusterError, Job, Row, UnwritableError, do_chunk

EXAMPLES = """examples:
  fleet.py maps/ -r -o out                       check all of a folder, a process on each core
  fleet.py lab.db -o out --gate min-keyframes=50   of a store, held against a gate, too
  fleet.py maps/ -o out --to .osa                write each again, as out/atlases/maps/NAME.osa
  fleet.py maps/ -o out --scheduler cluster.json   on a cluster of Dask
  fleet.py maps/ -o out --part $SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT   one task of a Slurm array
  fleet.py maps/ -o out --merge                  what all parts have done

exit status: 0: all are done and sound; 1: some are not; 2: wrong arguments"""


def parse(arguments: Optional[Sequence[str]]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, epilog=EXAMPLES, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="+", metavar="NAME", help="folders, stores, atlases, as in `slamdb list`")
    parser.add_argument("-o", "--output", required=True, type=pathlib.Path, help="folder of outputs and journal")
    parser.add_argument("-r", "--recursive", action="store_true", help="folders in folders, too")
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--workers", type=int, default=os.cpu_count(), help="processes on this machine; 0: this one alone")
    how.add_argument("--scheduler", default="", metavar="ADDRESS",
                     help="of Dask, whose workers do it; or the file of its scheduler")  # fmt: skip
    how.add_argument("--part", type=part, metavar="I/N", help="do every N-th chunk here, from the I-th, counted from 0")
    how.add_argument("--merge", action="store_true", help="do nothing but the summary of what is done")
    parser.add_argument("--chunk", type=positive, default=16, help="atlases that a worker gets at a time")
    parser.add_argument("--attempts", type=positive, default=3,
                        help="processes that an atlas may end, then it is set aside")  # fmt: skip
    parser.add_argument("--again", action="append", default=[], choices=["failed", "hash"],
                        help="failed: what failed or was set aside, too; hash: trust no times of files")  # fmt: skip
    parser.add_argument("--to", default="", metavar="SUFFIX", help="write each atlas again, with this suffix (.osa)")
    parser.add_argument("--format", default="", help="of these, by its id; by default the suffix tells")
    parser.add_argument("--strict", action="store_true", help="do not write what loses something")
    parser.add_argument("--ignore", action="append", default=[], metavar="RULE", help="leave a rule of the check out")
    parser.add_argument("--gate", action="append", default=[], type=gate, metavar="NAME=LIMIT", help="a limit to check")
    parser.add_argument("--pages", action="store_true", help="a page of each, as `slamdb report` makes it")
    parser.add_argument("--parquet", action="store_true", help="the table as summary.parquet, too (pyarrow)")
    parser.add_argument("--json", action="store_true", help="tell what was done as JSON")
    options = parser.parse_args(arguments)
    if options.to and (not options.to.startswith(".") or os.sep in options.to):
        parser.error(f"--to takes a suffix, such as .osa, not {options.to!r}")
    if options.to in (".slamdb", ".db", ".sqlite", ".sqlite3") or options.format == "store":
        parser.error("--to: a store is one file for all, which `slamdb add` fills")
    if options.format and not options.to:
        parser.error("--format is of what --to writes")
    try:
        refuse_what_is_not_there(options)
        if options.scheduler:
            from slamdb_fleet.on_dask import address_of

            options.scheduler = address_of(options.scheduler)
    except slamdb.UsageError as error:
        parser.error(error.problem)
    return options


def refuse_what_is_not_there(options: argparse.Namespace) -> None:
    """Rules, gates and formats: a typing error is no failure of every atlas, and replaces no summary."""
    nothing = slamdb.Atlas()
    slamdb.check(nothing, ignore=options.ignore, gates=dict(options.gate))
    if options.to:
        with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of how little there is to write
            slamdb.write(nothing, os.path.join(folder, f"map{options.to}"), format=options.format)


def part(text: str) -> "tuple[int, int]":
    index, _, count = text.partition("/")
    if not 0 <= int(index) < int(count):
        raise argparse.ArgumentTypeError("from 0/N to N-1/N: `sbatch --array=0-15` counts from 0")
    return int(index), int(count)


def positive(text: str) -> int:
    if int(text) < 1:
        raise argparse.ArgumentTypeError("at least 1")
    return int(text)


def gate(text: str) -> "tuple[str, float]":
    name, _, limit = text.partition("=")
    return name, float(limit)


def open_folder(folder: pathlib.Path) -> None:
    """A folder of this script alone, since what is in it is replaced."""
    if folder.exists() and not (folder / "journal").is_dir() and any(folder.iterdir()):
        raise slamdb.AlreadyExistsError("holds other files: name a new folder with -o", str(folder))
    (folder / "journal").mkdir(parents=True, exist_ok=True)


def work(options: argparse.Namespace, job: Job, chunks: List[Chunk]) -> Iterator[List[Entry]]:
    if options.merge:
        return
    if options.scheduler or (options.workers and not options.part):
        from slamdb_fleet.on_dask import client_of, run

        with client_of(options.scheduler, options.workers) as client:
            yield from run(client, job, chunks)
    else:
        index, count = options.part or (0, 1)
        for chunk in chunks[index::count]:
            if chunk.items:
                yield do_chunk(job, chunk)


class Told:
    """A line on a terminal, now and then."""

    def __init__(self, done: int, total: int) -> None:
        self.done, self._total = done, total
        self._failed = 0
        self._resumed = done
        self._begin = self._last = time.monotonic()

    def take(self, entries: List[Entry]) -> None:
        self.done += len(entries)
        self._failed += sum(bool(entry["kind"]) for entry in entries)
        now = time.monotonic()
        if sys.stderr.isatty() and (now - self._last > 0.2 or self.done == self._total):
            self._last = now
            rate = (self.done - self._resumed) / max(now - self._begin, 1e-9)
            left = (self._total - self.done) / rate
            print(f"\r\033[K{self.done:,} of {self._total:,} atlases, {self._failed:,} failed, {rate:.0f} a second, "
                  f"{left:.0f} s left", end="", file=sys.stderr, flush=True)  # fmt: skip

    def end(self) -> None:
        if sys.stderr.isatty():
            print(end="\r\033[K", file=sys.stderr)


def report_of(options: argparse.Namespace, plan: Plan, rows: List[Row], resumed: int, seconds: float) -> Dict[str, Any]:
    kinds = [plan.done[item.input]["kind"] for item in plan.items if item.input in plan.done]
    return {
        "report": "slamdb-fleet-1",
        "atlases": len(rows),
        "sound": sum(row.get("sound") is True for row in rows),
        "unsound": sum(row.get("sound") is False for row in rows),
        "failures": sum("failure" in row for row in rows),
        "set_aside": kinds.count("set aside"),
        "undone": len(plan.items) - len(kinds),
        "resumed": resumed,
        "seconds": round(seconds, 3),
        "table": str(options.output / "summary.csv"),
        "page": str(options.output / "index.html"),
    }


def tell(options: argparse.Namespace, report: Dict[str, Any]) -> None:
    if options.json:
        print(json.dumps(report, indent=2))
        return
    noun = "atlas" if report["atlases"] == 1 else "atlases"
    print(f"{report['atlases']:,} {noun}: {report['sound']:,} sound, {report['unsound']:,} not sound, "
          f"{report['failures']:,} not readable or not done")  # fmt: skip
    if report["set_aside"]:
        print(f"  {report['set_aside']:,} set aside, since processes ended over them; --again failed tries them again")
    if report["undone"]:
        print(f"  {report['undone']:,} not done yet; the same command goes on")
    if report["resumed"]:
        print(f"  {report['resumed']:,} of them were done before")
    if not options.part:
        print(f"wrote {report['table']} and {report['page']}")


def run_fleet(options: argparse.Namespace) -> int:
    begin = time.monotonic()
    open_folder(options.output)
    job = job_of(options)
    known = read_journals(options.output / "journal")
    plan = make_plan(Wanted(options.names, options.recursive, options.to, options.pages, options.again), job, known)
    refuse_inputs_below(options.output, plan.items)
    resumed = len(plan.done)
    try:
        take_all(options, job, plan)
    finally:  # whatever stops it, what is done is told
        rows = rows_of(plan)
        if not options.part:
            write_summary(options, rows)
        report = report_of(options, plan, rows, resumed, time.monotonic() - begin)
        tell(options, report)
    if options.part:  # unsound atlases are for the merge to tell
        return 0
    return 0 if report["sound"] == report["atlases"] else 1


def job_of(options: argparse.Namespace) -> Job:
    check = {"ignore": options.ignore, "gates": dict(options.gate)}
    folder = str(options.output.resolve())
    return Job(os.getcwd(), folder, slamdb.__version__, check, options.format, options.strict, options.attempts)


def take_all(options: argparse.Namespace, job: Job, plan: Plan) -> None:
    chunks = chunks_of(plan, options.chunk, "" if options.part else uuid.uuid4().hex)
    told = Told(len(plan.done), len(plan.items))
    try:
        for entries in work(options, job, chunks):
            plan.done.update((entry["input"], entry) for entry in entries)
            told.take(entries)
    finally:
        told.end()


def write_summary(options: argparse.Namespace, rows: List[Row]) -> None:
    write_csv(options.output / "summary.csv", rows)
    if options.parquet:
        write_parquet(options.output / "summary.parquet", rows)
    write_page(options.output, rows, ", ".join(options.names))


def main(arguments: Optional[Sequence[str]] = None) -> int:
    try:
        return run_fleet(parse(arguments))
    except KeyboardInterrupt:
        print("fleet.py: stopped; the same command goes on", file=sys.stderr)
        return 130
    except (slamdb.Error, OSError, ClusterError, UnwritableError, ImportError) as error:
        print(f"fleet.py: error: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
