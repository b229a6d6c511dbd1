#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes an atlas from arrays, as an own SLAM or SfM system has them: a camera that goes along a wall."""

import argparse
import sys

import numpy as np
import slamdb

FX, FY, CX, CY, WIDTH, HEIGHT = 400.0, 400.0, 320.0, 240.0, 640, 480


def seen_from(wall: np.ndarray, place: np.ndarray) -> "tuple[np.ndarray, np.ndarray]":
    """Which points a camera there, looking along z, sees; and at which pixels."""
    x, y, z = (wall - place).T
    pixels = np.stack([FX * x / z + CX, FY * y / z + CY], axis=1)
    rows = np.flatnonzero(((pixels >= 0) & (pixels < (WIDTH, HEIGHT))).all(axis=1))
    return rows, pixels[rows]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", default="wall.osa")
    parser.add_argument("--vocabulary", help="file of the words that ORB-SLAM3 is started with; by default its own")
    parser.add_argument("-O", "--overwrite", action="store_true")
    options = parser.parse_args()

    random = np.random.default_rng(0)
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(-1, 7, 0.25), np.arange(-1.25, 1.5, 0.25)))
    wall = np.stack([x, y, 3 + 0.1 * random.random(len(x))], axis=1)
    descriptors = random.integers(256, size=(len(wall), 32), dtype=np.uint8)  # of ORB, in a real system
    poses = np.tile(np.eye(4), (12, 1, 1))  # world from camera
    poses[:, 0, 3] = 0.5 * np.arange(12)
    seen = [seen_from(wall, pose[:3, 3]) for pose in poses]

    atlas = slamdb.Atlas(vocabulary=options.vocabulary)
    camera = atlas.add_camera("pinhole", FX, FY, CX, CY)
    world = atlas.add_map()
    ids = world.add_keyframes(
        timestamps=1.7e9 + 0.5 * np.arange(12), poses=poses, camera=camera, image_size=(WIDTH, HEIGHT),
        features=[slamdb.FeatureArrays(keypoints=pixels, descriptors=descriptors[rows]) for rows, pixels in seen],
    )  # fmt: skip
    observations = [
        np.stack([rows, np.full(len(rows), id), np.arange(len(rows))], axis=1) for id, (rows, _) in zip(ids, seen)
    ]
    world.add_points(positions=wall, observations=np.concatenate(observations))
    slamdb.write(atlas, options.output, overwrite=options.overwrite)
    print(f"{len(world.keyframes)} keyframes, {len(world.points)} points:", slamdb.check(atlas).inputs[0].severities)


if __name__ == "__main__":
    try:
        main()
    except slamdb.Error as error:
        sys.exit(f"map_from_arrays.py: {str(error).replace('overwrite=True', '-O')}")
