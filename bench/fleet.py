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
import resource
import shutil
import subprocess
import sys
import tempfile

import numpy as np

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


def run(folder, *options):
    """Seconds, and seconds of processors, of driver, scheduler and workers together."""
    with tempfile.TemporaryDirectory() as out:
        command = [sys.executable, FLEET, folder, "-o", out, "--json", *map(str, options)]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        report = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return np.array([report["seconds"], after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime])


def told(name, values):
    for kind, each in zip(("elapsed", "of processors"), np.transpose(values)):
        print(f"{name}, {kind}: median {np.median(each):.3g}, {each.min():.3g} to {each.max():.3g}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--slamdb", default="slamdb", help="the command")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--atlases", type=int, default=400)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as root:
        root = pathlib.Path(root)
        small = ("--keyframes", 4, "--points", 60, "--features", 150)
        few = make(root / "few", options.slamdb, 4, *small)
        usual = make(root / "usual", options.slamdb, options.atlases, "--keyframes", 20, "--points", 1000)
        many = make(root / "many", options.slamdb, 2 * options.atlases, *small)
        one, two, task = [], [], []
        for _ in range(options.rounds):
            one.append(run(usual, "--workers", 1) - run(few, "--workers", 1))
            two.append(run(usual, "--workers", 2) - run(few, "--workers", 2))
            together = run(many, "--workers", 1, "--chunk", 64)
            task.append(1000 * (run(many, "--workers", 1, "--chunk", 1) - together) / (2 * options.atlases))
        told("one worker, s", one)
        told("two workers, s", two)
        told("one worker / two workers", np.array(one) / np.array(two))
        told("a task beside its work, ms", task)


if __name__ == "__main__":
    main()
