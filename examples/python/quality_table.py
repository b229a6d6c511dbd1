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


def row_of(checked: dict) -> dict:
    if "failure" in checked:
        return {"input": checked["input"], "failure": checked["failure"]}
    measures = {name: f"{checked['measures'][name]:.10g}" for name in MEASURES}
    return {"input": checked["input"], "sound": checked["sound"], "errors": checked["severities"]["error"], **measures}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", default=[FIXTURES / "session_small_a", FIXTURES / "session_small_b"])
    parser.add_argument("-o", "--output", help="by default it is printed")
    parser.add_argument("-O", "--overwrite", action="store_true")
    options = parser.parse_args()
    text = io.StringIO()
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(row_of(checked) for checked in slamdb.check(*options.names)["inputs"])
    if options.output:
        slamdb.write_file(options.output, text.getvalue().encode(errors="replace"), overwrite=options.overwrite)
    else:
        sys.stdout.write(text.getvalue())


if __name__ == "__main__":
    try:
        main()
    except slamdb.Error as error:
        sys.exit(f"quality_table.py: {str(error).replace('overwrite=True', '-O')}")
