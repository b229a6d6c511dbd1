#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Counts instructions, which are the same on every machine, and compares them with bench/instructions.csv.

Each row of slamdb_bench runs on one core under valgrind, which counts what happens within the measured work; the command
is counted from its first instruction on. Exit status 1: a row takes more than 3 % more or less than the
table says, or is not in it. Both are to be looked into; --update then writes the table anew. 77: this cannot be
counted here.

    bench/instructions.py [--build build/dev] [--update] [--only ROW,ROW...]
"""

import argparse
import csv
import os
import pathlib
import queue
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

ROOT = pathlib.Path(__file__).resolve().parent.parent
TABLE = ROOT / "bench/instructions.csv"
TOLERANCE = 0.03
ROWS = [
    "read-binary", "read-layout", "read-text", "write-binary", "write-text", "info", "check", "extract", "cull", "shrink",
    "transform", "diff", "merge", "store-save", "store-load", "store-save-again",
    "store-save-unchanged", "store-load-earlier",
    "export-stella", "export-stella-sqlite", "export-colmap",
]  # fmt: skip
PROCESSES = ["slamdb --version", "slamdb -h", "slamdb check -h", "slamdb info a.osa", "slamdb check --quiet a.osa",
             "slamdb list a.db"]  # fmt: skip
# Valgrind shows programs this processor but for its newest instructions, and the C library chooses by it how to copy and
# to search. So that this is the same everywhere, it is told to make do with what every x86-64 has.
OLDEST = ":".join(
    ["glibc.cpu.hwcaps=" + ",".join(f"-{name}" for name in ("AVX", "AVX2", "BMI1", "BMI2", "ERMS", "FSRM", "LZCNT", "MOVBE",
                                                            "RTM", "SSE4_1", "SSE4_2", "SSSE3", "AVX_Fast_Unaligned_Load",
                                                            "Fast_Unaligned_Copy"))]
    + ["glibc.cpu.x86_non_temporal_threshold=0x10000000", "glibc.cpu.x86_data_cache_size=0x8000",
       "glibc.cpu.x86_shared_cache_size=0x100000"]
)  # fmt: skip
ENVIRONMENT = {"PATH": os.environ["PATH"], "LC_ALL": "C", "GLIBC_TUNABLES": OLDEST}
CORES = queue.SimpleQueue()  # those that nothing is counted on now
for each in os.sched_getaffinity(0):
    CORES.put(each)


def first_line(command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()[0]


def made_with(build):
    """What the counts depend on besides the source."""
    compiler = re.search(r"^CMAKE_CXX_COMPILER:\w+=(.*)$", (build / "CMakeCache.txt").read_text(), re.M).group(1)
    return f"{first_line([compiler, '--version'])}; {os.confstr('CS_GNU_LIBC_VERSION')}; {os.uname().machine}"


def count(command, folder, *options):
    """Instructions of the command on one core, in that folder, where files have the same short names everywhere."""
    core = CORES.get()
    counted = subprocess.run(
        ["setarch", "-R", "taskset", "-c", str(core), "valgrind", "--tool=callgrind", "--callgrind-out-file=counts", *options,
         *map(str, command)],
        cwd=folder, env=ENVIRONMENT, capture_output=True, text=True,
    )  # fmt: skip
    CORES.put(core)
    if counted.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))} failed under valgrind:\n{counted.stderr}")
    instructions = int(re.search(r"^totals: (\d+)", (folder / "counts").read_text(), re.M).group(1))
    if instructions == 0:
        sys.exit("nothing was counted: slamdb_bench was built where valgrind was not there")
    return instructions


class Inputs:
    """The atlases that rows work on, prepared once, and a copy of the files for each row, which may change them."""

    def __init__(self, build, folder):
        self.build, self.bench, self.folder = build, build / "bench/slamdb_bench", folder
        synthetic = folder / "synthetic.made.osa"
        self.run("--synthesize", synthetic, "--sizes", "3")
        for name, atlas in (("session", ROOT / "fixtures/session_small_a/session_small_a.osa"), ("synthetic", synthetic)):
            (folder / name).mkdir()
            self.run("--prepare", atlas, "--folder", folder / name, "--name", "a")

    def run(self, *words):
        subprocess.run([self.bench, *map(str, words)], check=True)

    def count(self, name, row):
        """Bytes of the file that a row is about, 0 of a command line, and the instructions of either."""
        with tempfile.TemporaryDirectory(dir=self.folder) as own:
            own = pathlib.Path(own)
            shutil.copytree(self.folder / name, own, dirs_exist_ok=True)
            size = (own / ("a.text.osa" if row.endswith("-text") else "a.osa")).stat().st_size
            if row.startswith("slamdb "):
                return 0, count([self.build / "slamdb", *row.split()[1:]], own)
            return size, count([self.bench, "--measure", row, "--folder", ".", "--name", "a"], own, "--instr-atstart=no")


def count_all(build, wanted):
    """{(row, atlas): (bytes, instructions)}"""
    # Paths are made absolute, so it counts how deep they are.
    with tempfile.TemporaryDirectory(dir="/tmp") as name, ThreadPoolExecutor(os.cpu_count()) as pool:
        folder = pathlib.Path(name)
        inputs = Inputs(build, folder)
        rows = [(row, "session") for row in PROCESSES] + [(row, atlas) for row in ROWS for atlas in ("session", "synthetic")]
        counts = {key: pool.submit(inputs.count, key[1], key[0]) for key in rows if key[0] in wanted}
        return {key: counted.result() for key, counted in counts.items()}


def read_table():
    with TABLE.open() as stream:
        made = stream.readline().removeprefix("# ").rstrip()
        return made, {(row["row"], row["atlas"]): int(row["instructions"]) for row in csv.DictReader(stream)}


def write_table(made, counts):
    with TABLE.open("w") as stream:
        stream.write(f"# {made}\n")
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(["row", "atlas", "bytes", "instructions", "per byte"])
        for (row, atlas), (size, instructions) in counts.items():
            table.writerow([row, atlas, size or "", instructions, f"{instructions / size:.2f}" if size else ""])


def compare(known, counts):
    """Prints what differs; returns whether anything does."""
    differs = False
    for key, (_, instructions) in counts.items():
        before = known.get(key)
        change = instructions / before - 1 if before else None
        if change is not None and abs(change) <= TOLERANCE:
            continue
        differs = True
        told = "is not in the table" if change is None else f"{change:+.1%}, {'worse' if change > 0 else 'better'}"
        print(f"{' '.join(key)}: {instructions:,} instructions, {told}")
    return differs


def wanted_rows(words):
    """The rows that are named, or all."""
    if words is None:
        return ROWS + PROCESSES
    wanted = words.split(",")
    if unknown := [row for row in wanted if row not in ROWS + PROCESSES]:
        sys.exit(f"no such row: {', '.join(unknown)}; there are {', '.join(ROWS + PROCESSES)}")
    return wanted


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/dev")
    parser.add_argument("--update", action="store_true", help="write the table anew")
    parser.add_argument("--only", help="count these rows, separated by commas")
    options = parser.parse_args()
    if options.update and options.only:
        parser.error("--update writes the whole table")
    wanted, build = wanted_rows(options.only), options.build.resolve()
    if not (build / "bench/slamdb_bench").exists():
        sys.exit(f"{build}/bench/slamdb_bench is not there: `cmake/build.sh --tests dev` builds it")
    for tool in ("valgrind", "setarch", "taskset"):
        if shutil.which(tool) is None:
            print(f"skipped: instructions are counted by {tool}, which is not there")
            return 77
    made = made_with(build)
    if not options.update and (known_made := read_table()[0]) != made:
        print(f"skipped: the table was made with {known_made}, and this is {made}")
        return 77
    counts = count_all(build, wanted)
    if options.update:
        write_table(made, counts)
        return 0
    if compare(read_table()[1], counts):
        print("To be looked into; `bench/instructions.py --update` then writes bench/instructions.csv anew.")
        return 1
    print(f"{len(counts)} rows take as many instructions as bench/instructions.csv says, within {TOLERANCE:.0%}.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
