#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How far a map is from the truth, and where: errors of all poses, and the worst of them."""

import argparse
import pathlib
import sys

import numpy as np
import slamdb

FIXTURES = pathlib.Path(__file__).parents[2] / "fixtures" / "session_small_a"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("estimate", nargs="?", default=FIXTURES / "session_small_a.osa", help="atlas or trajectory")
    parser.add_argument("truth", nargs="?", default=FIXTURES / "truth.txt", help="trajectory or atlas")
    parser.add_argument("-o", "--output", default="errors.csv", help="of every pose")
    parser.add_argument("-O", "--overwrite", action="store_true")
    options = parser.parse_args()
    report = slamdb.evaluate(
        options.estimate, options.truth, output=options.output, overwrite=options.overwrite, delta="1m"
    )
    for evaluation in report.evaluations:
        error = evaluation.absolute.translation
        print(f"map {evaluation.maps[0]}: {error.count} poses, rmse {error.rmse:.4f} m, at most {error.max:.4f} m")
    rows = np.genfromtxt(options.output, delimiter=",", names=True)
    worst = rows[np.argsort(-rows["translation_error"])[:3]]
    for row in worst:
        print(f"  {row['timestamp']:.3f} s: {row['translation_error']:.4f} m")


if __name__ == "__main__":
    try:
        main()
    except slamdb.Error as error:
        sys.exit(f"evaluate_trajectory.py: {str(error).replace('overwrite=True', '-O')}")
