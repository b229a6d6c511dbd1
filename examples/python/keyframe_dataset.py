#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Keyframes of many atlases as a data set for PyTorch, which need not be there.

    samples = KeyFrameDataset(["maps/"])
    DataLoader(samples, batch_size=None, sampler=ShuffledBlocks(samples), num_workers=2)

To make it reads every atlas once. What it gives of keyframes, some 50 KB of each, stays in memory as far as the budget
allows, the atlases do not: where all fits, any order reads nothing again. Where it does not, `shuffle=True` reads an
atlas anew for nearly every sample, and ShuffledBlocks each once an epoch. Each worker has a budget of its own.
"""

import argparse
import collections
import pathlib
import sys
from typing import Any, Dict, Iterator, List

import numpy as np
import slamdb

FIXTURES = pathlib.Path(__file__).parents[2] / "fixtures"
Sample = Dict[str, Any]


def sample_of(atlas: str, keyframe: slamdb.KeyFrame) -> Sample:
    """Of a fisheye pair the right camera's keypoints stand behind the left one's, as their descriptors do."""
    features = keyframe.features
    cameras = [features.keypoints] + ([features.right_keypoints] if keyframe.right_camera is not None else [])
    points = [np.stack([each["x"], each["y"]], axis=1) for each in cameras]
    right = sum(map(len, points[1:]))
    return {
        "atlas": atlas,
        "keyframe": keyframe.id,
        "timestamp": keyframe.timestamp,  # seconds
        "world_from_camera": keyframe.pose.astype(np.float32),  # (4, 4), of the left one
        "left_from_right": keyframe.left_from_right.astype(np.float32),  # (4, 4), of a fisheye pair
        "keypoints": np.concatenate(points),  # (N, 2), px
        "right": np.arange(len(points[0]) + right) >= len(points[0]),  # (N,) bool: of the right fisheye camera
        "descriptors": features.descriptors.copy(),  # (N, 32) uint8
        "depth": np.pad(features.depth, (0, right), constant_values=-1),  # (N,) metres, or negative
    }


class KeyFrameDataset:
    """A sample is a dictionary of the arrays of a keyframe, copies. budget: bytes of arrays that it holds."""

    def __init__(self, names: List[Any], budget: int = 1 << 30) -> None:
        self.budget = budget
        self._held: "collections.OrderedDict[str, List[Sample]]" = collections.OrderedDict()
        self._bytes: Dict[str, int] = {}
        self._places: "List[tuple[str, int]]" = []
        for found in slamdb.find_atlases(*names):
            self._places += [(found.input, number) for number in range(len(self._samples(found.input)))]

    def __len__(self) -> int:
        return len(self._places)

    def __getitem__(self, number: int) -> Sample:
        atlas, place = self._places[number]
        sample = self._samples(atlas)[place]
        return {name: value.copy() if isinstance(value, np.ndarray) else value for name, value in sample.items()}

    def __getstate__(self) -> Dict[str, Any]:
        return {**self.__dict__, "_held": collections.OrderedDict()}

    def blocks(self, random: np.random.Generator) -> Iterator[List[int]]:
        """Samples of atlases that fit into the budget together."""
        rows: Dict[str, List[int]] = {atlas: [] for atlas in self._bytes}
        atlases = list(rows)
        for row, (atlas, _) in enumerate(self._places):
            rows[atlas].append(row)
        block, size = [], 0
        for atlas in (atlases[number] for number in random.permutation(len(atlases))):
            if block and size + self._bytes[atlas] > self.budget:
                yield block
                block, size = [], 0
            block, size = block + rows[atlas], size + self._bytes[atlas]
        yield block

    def _samples(self, atlas: str) -> List[Sample]:
        if atlas not in self._held:
            maps = slamdb.read(atlas, threads=1).maps
            read = [sample_of(atlas, keyframe) for map in maps for keyframe in map.keyframes if not keyframe.bad]
            self._bytes[atlas] = sum(getattr(value, "nbytes", 64) for sample in read for value in sample.values())
            self._held[atlas] = read
        self._held.move_to_end(atlas)
        while len(self._held) > 1 and sum(self._bytes[each] for each in self._held) > self.budget:
            self._held.popitem(last=False)
        return self._held[atlas]


class ShuffledBlocks:
    """A sampler: atlases in random order, and of as many as fit into the budget the keyframes in random order."""

    def __init__(self, samples: KeyFrameDataset, seed: int = 0) -> None:
        self._samples, self._random = samples, np.random.default_rng(seed)

    def __len__(self) -> int:
        return len(self._samples)

    def __iter__(self) -> Iterator[int]:
        for block in self._samples.blocks(self._random):
            yield from self._random.permutation(block).tolist()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", default=[FIXTURES / "session_small_a", FIXTURES / "session_small_b"])
    options = parser.parse_args()
    samples = KeyFrameDataset(options.names)
    features = sum(len(samples[number]["descriptors"]) for number in ShuffledBlocks(samples))
    print(f"{len(samples)} keyframes with {features} features")


if __name__ == "__main__":
    try:
        main()
    except slamdb.Error as error:
        sys.exit(f"keyframe_dataset.py: {error}")
