#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Hands a map over to COLMAP: writes its model as text, and reads it back, with pycolmap where that is there."""

import argparse
import pathlib

import numpy as np
import slamdb

FIXTURES = pathlib.Path(__file__).parents[2] / "fixtures"


def centers_by_pycolmap(model: pathlib.Path) -> "dict[str, np.ndarray]":
    import pycolmap

    images = pycolmap.Reconstruction(model).images.values()
    return {image.name: np.array(image.projection_center()) for image in images}


def centers_by_hand(model: pathlib.Path) -> "dict[str, np.ndarray]":
    """Of each image the line `id qw qx qy qz tx ty tz camera name`, the pose of the world in the camera."""
    lines = [line for line in (model / "images.txt").read_text().split("\n") if not line.startswith("#")]
    centers = {}
    for _, w, x, y, z, *translation, _, name in (line.split() for line in lines[::2] if line):  # in between: its keypoints
        w, x, y, z = map(float, (w, x, y, z))
        rotation = np.array([
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ])  # fmt: skip
        centers[name] = -rotation.T @ np.array(translation, dtype=float)
    return centers


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("atlas", nargs="?", default=FIXTURES / "session_small_a" / "session_small_a.osa")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=pathlib.Path("model"), help="folder of the model")
    options = parser.parse_args()
    atlas = slamdb.read(options.atlas)
    slamdb.write(atlas, options.output, format="colmap-text")
    try:
        centers, by = centers_by_pycolmap(options.output), "pycolmap"
    except ImportError:
        centers, by = centers_by_hand(options.output), "numpy"
    known = np.sort(atlas.maps[0].keyframes.centers, axis=0)
    away = np.abs(np.sort(np.array(list(centers.values())), axis=0) - known).max()
    print(f"{len(centers)} images by {by}, their centres at most {away:.1e} from the map's")


if __name__ == "__main__":
    main()
