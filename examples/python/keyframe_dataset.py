#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Keyframes of many atlases as a data set for PyTorch, which need not be there: `DataLoader(KeyFrameDataset([...]))`."""

import argparse
import collections
import pathlib
from typing import Any, Dict, List, Tuple

import numpy as np
import slamdb

FIXTURES = pathlib.Path(__file__).parents[2] / "fixtures"


class KeyFrameDataset:
    """A sample is a dictionary of the arrays of a keyframe.

    It holds where keyframes are, and the atlases that were used last (`held`): workers of a DataLoader get the former
    alone, and read for themselves. Arrays are views of the atlas, except for the pose; a copy where they are changed.
    """

    def __init__(self, names: List[Any], held: int = 2) -> None:
        self._held = held
        self._atlases: "collections.OrderedDict[str, slamdb.Atlas]" = collections.OrderedDict()
        self._places: List[Tuple[str, int, int]] = []  # atlas, map, row
        for found in slamdb.find_atlases(*names):
            for index, map in enumerate(self._atlas(found.input).maps):
                rows = np.flatnonzero(~map.keyframes.bad)
                self._places += [(found.input, index, int(row)) for row in rows]

    def __len__(self) -> int:
        return len(self._places)

    def __getitem__(self, number: int) -> Dict[str, Any]:
        name, map, row = self._places[number]
        keyframes = self._atlas(name).maps[map].keyframes
        features = keyframes[row].features
        return {
            "atlas": name,
            "keyframe": keyframes[row].id,
            "timestamp": keyframes[row].timestamp,  # seconds
            "camera_from_world": keyframes.camera_from_world[row],  # as the atlas has it
            "world_from_camera": keyframes.poses[row].astype(np.float32),  # (4, 4)
            "keypoints": np.stack([features.keypoints["x"], features.keypoints["y"]], axis=1),  # (N, 2), px
            "descriptors": features.descriptors,  # (N, 32) uint8
            "depth": features.depth,  # (N,) metres, or negative
        }

    def __getstate__(self) -> Dict[str, Any]:
        return {**self.__dict__, "_atlases": collections.OrderedDict()}

    def _atlas(self, name: str) -> slamdb.Atlas:
        if name not in self._atlases:
            self._atlases[name] = slamdb.read(name, threads=1)
        self._atlases.move_to_end(name)
        while len(self._atlases) > self._held:
            self._atlases.popitem(last=False)
        return self._atlases[name]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", default=[FIXTURES / "session_small_a", FIXTURES / "session_small_b"])
    options = parser.parse_args()
    samples = KeyFrameDataset(options.names)
    shuffled = np.random.default_rng(0).permutation(len(samples))
    features = sum(len(samples[number]["descriptors"]) for number in shuffled)
    print(f"{len(samples)} keyframes with {features} features")


if __name__ == "__main__":
    main()
