#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How examples/fleet scales from one worker to two, and what a task costs beside its work.

    PYTHONPATH=build/release/python bench/fleet.py --slamdb build/release/slamdb

Runs are taken in turn, so that what else the machine does falls on all of them. What starts workers is left out: a run
of a few atlases is taken off each.
"""

import argparse
import json
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile

FLEET = pathlib.Path(__file__).parent.parent / "examples" / "fleet" / "fleet.py"


def make(folder, slamdb, count, *size):
    """Copies of ten atlases."""
    folder.mkdir()
    for number in range(count):
        path = folder / f"{number}.osa"
        if number < 10:
            made = [slamdb, "synthesize", path, *map(str, size), "--seed", str(number), "--quiet"]
            subprocess.run(made, check=True, stdout=subprocess.DEVNULL)
        else:
            shutil.copy(folder / f"{number % 10}.osa", path)
    return folder


def seconds(folder, *options):
    with tempfile.TemporaryDirectory() as out:
        command = [sys.executable, FLEET, folder, "-o", out, "--json", *map(str, options)]
        return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)["seconds"]


def told(name, values):
    print(f"{name}: median {statistics.median(values):.3g}, {min(values):.3g} to {max(values):.3g}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--slamdb", default="slamdb", help="the command")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--atlases", type=int, default=600)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as root:
        root = pathlib.Path(root)
        few = make(root / "few", options.slamdb, 4, "--keyframes", 4, "--points", 60, "--features", 150)
        usual = make(root / "usual", options.slamdb, options.atlases, "--keyframes", 20, "--points", 1000)
        tiny = make(root / "tiny", options.slamdb, 2 * options.atlases, "--keyframes", 4, "--points", 60, "--features", 150)
        scaling, one, two, task = [], [], [], []
        for _ in range(options.rounds):
            one.append(seconds(usual, "--workers", 1) - seconds(few, "--workers", 1))
            two.append(seconds(usual, "--workers", 2) - seconds(few, "--workers", 2))
            scaling.append(one[-1] / two[-1])
            singly = seconds(tiny, "--workers", 1, "--chunk", 1)
            together = seconds(tiny, "--workers", 1, "--chunk", 64)
            task.append(1000 * (singly - together) / (2 * options.atlases))
        told(f"{options.atlases} atlases, one worker, s", one)
        told(f"{options.atlases} atlases, two workers, s", two)
        told("times faster", scaling)
        told("a task beside its work, ms", task)


if __name__ == "__main__":
    main()
