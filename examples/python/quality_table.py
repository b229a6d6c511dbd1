#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A table of the atlases of a folder or a store as CSV: how large they are, how good, whether ORB-SLAM3 can load them.

Of many thousand: examples/fleet.
"""

import argparse
import csv
import io
import pathlib
import sys

import slamdb

FIXTURES = pathlib.Path(__file__).parents[2] / "fixtures"
MEASURES = ("keyframes", "points", "trajectory_length", "observers_per_point", "reprojection_error_px")
COLUMNS = ("input", "sound", "errors", *MEASURES, "failure")


def row_of(found: slamdb.FoundAtlas) -> dict:
    try:
        if found.failure:
            return {"input": found.input, "failure": found.failure}
        [checked] = slamdb.check(found.input)["inputs"]
    except slamdb.Error as error:
        return {"input": found.input, "failure": str(error)}
    measures = {name: f"{checked['measures'][name]:.10g}" for name in MEASURES}
    return {"input": found.input, "sound": checked["sound"], "errors": checked["severities"]["error"], **measures}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", default=[FIXTURES / "session_small_a", FIXTURES / "session_small_b"])
    parser.add_argument("-o", "--output", help="by default it is printed")
    parser.add_argument("-O", "--overwrite", action="store_true")
    options = parser.parse_args()
    text = io.StringIO()
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(row_of(found) for found in slamdb.find_atlases(*options.names))
    if options.output:
        slamdb.write_file(options.output, text.getvalue().encode(errors="replace"), overwrite=options.overwrite)
    else:
        sys.stdout.write(text.getvalue())


if __name__ == "__main__":
    try:
        main()
    except slamdb.Error as error:
        sys.exit(f"quality_table.py: {str(error).replace('overwrite=True', '-O')}")
