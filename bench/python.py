# SPDX-License-Identifier: BSD-3-Clause
"""What Python costs: `import slamdb`, and slamdb.read beside the library's ReadAtlas.

    PYTHONPATH=build/dev/python python3 bench/python.py --bench build/dev/bench/slamdb_read_bench session_b.osa

All times are processor time on one core, to which all processes are pinned. Imports are without what Python itself takes
to start. Python and the library take turns of some reads, each first in every other pair of turns, and the ratio is that
of a pair: its median, the least and the greatest.
"""

import argparse
import os
import resource
import statistics
import subprocess
import sys
import time


def processor_time(program):
    """Seconds that Python takes to run it."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-c", program], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def imports(rounds):
    """What modules take, each beside a Python that imports nothing."""
    for modules in ("slamdb", "numpy", "slamdb, numpy"):
        yield modules, [processor_time(f"import {modules}") - processor_time("pass") for _ in range(rounds)]


def read_in_python(path, reads):
    import slamdb

    before = time.process_time()
    for _ in range(reads):
        slamdb.read(path, threads=1)  # and lets go of it
    return (time.process_time() - before) / reads


def pairs_of_reads(bench, path, rounds, reads):
    library = subprocess.Popen([bench, path], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)

    def read_in_library(_, reads):
        library.stdin.write(f"{reads}\n")
        return float(library.stdout.readline()) / reads

    turns = (read_in_python, read_in_library)
    for turn in turns:
        turn(path, reads)  # which warms it up
    for round in range(rounds):
        spent = {turn: turn(path, reads) for turn in turns[:: 1 if round % 2 else -1]}
        yield spent[read_in_python], spent[read_in_library]
    library.stdin.close()
    library.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bench", required=True, help="the program slamdb_read_bench")
    parser.add_argument("--rounds", type=int, default=31, help="pairs of turns")
    parser.add_argument("--reads", type=int, default=10, help="in a turn")
    parser.add_argument("atlases", nargs="+")
    options = parser.parse_args()
    os.sched_setaffinity(0, [max(os.sched_getaffinity(0))])
    print("| measurement | Python | library | ratio | least - greatest |\n|---|---|---|---|---|")
    for modules, times in imports(20):
        least, usual, greatest = (1000 * f(times) for f in (min, statistics.median, max))
        print(f"| import {modules} | {usual:.0f} ms | | | {least:.0f} - {greatest:.0f} ms |")
    for path in options.atlases:
        pairs = list(pairs_of_reads(options.bench, path, options.rounds, options.reads))
        ratios = [python / library for python, library in pairs]
        python, library = (statistics.median(each) * 1000 for each in zip(*pairs))
        spread = f"{min(ratios):.3f} - {max(ratios):.3f}"
        name = os.path.basename(path)
        print(f"| read {name} | {python:.2f} ms | {library:.2f} ms | {statistics.median(ratios):.3f} | {spread} |")


if __name__ == "__main__":
    main()
