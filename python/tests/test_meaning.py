# SPDX-License-Identifier: BSD-3-Clause
"""Arrays of real atlases add up to what ORB-SLAM3's own loader saw (SLAMDB_MEANING: its sums of each atlas)."""

import json
import os
import pathlib

import numpy as np
import pytest
import slamdb
from real_atlases import path_of, real_atlases

MOD = 1 << 64
ODD = np.array([1, 3, 5], np.uint64)


def sum_of(*factors):
    """The sum of products, mod 2^64."""
    product = np.uint64(1)
    for factor in factors:
        product = product * np.asarray(factor).astype(np.uint64)
    return int(np.sum(product, dtype=np.uint64)) % MOD


def bits(array):
    return np.ascontiguousarray(array).view(np.uint32)


def place_in(row):
    return np.arange(1, len(row) + 1, dtype=np.uint64)


def sums_of_points(points):
    ids = points.ids + np.uint64(1)
    return {
        "n_mp": len(points), "mp_id_sum": sum_of(points.ids),
        "mp_pos_bits": sum_of(ids[:, None], bits(points.positions), ODD),
        "mp_desc_hash": sum_of(ids[:, None], points.descriptors, np.arange(1, 33)),
        "mp_nObs_sum": int(points.weights.sum()), "obs_count": int(points.observation_counts.sum()),
    }  # fmt: skip


def sums_of_observations(points):
    seen = points.observations
    ids = np.repeat(points.ids, points.observation_counts) + np.uint64(1)
    left, right = (side.astype(np.int64) + 2 for side in (seen.left, seen.right))
    there = seen.left >= 0
    both = sum_of(ids, seen.keyframes + 1, left) + sum_of(7, ids, seen.keyframes + 3, right)
    return {"obs_hash": both % MOD, "obs_kfid_x_idx_left": sum_of(seen.keyframes[there], seen.left[there])}


def sums_of_keyframe(row):
    features, factor = row.features, np.uint64(row.id + 1)
    slots, flat = features.map_points, features.descriptors.reshape(-1)
    filled = slots != slamdb.NONE
    nodes = features.word_nodes
    in_a_node = nodes != 2**32 - 1
    return {
        "kf_slots_filled": int(filled.sum()),
        "kf_slot_hash": sum_of(factor, place_in(slots)[filled], slots[filled] + np.uint64(1)),
        "mvKeys": len(features.keypoints), "mvKeysRight": len(features.right_keypoints),
        "mvKeys_octave_sum": int(features.keypoints["octave"].sum()),
        "desc_byte_sum": int(flat.sum(dtype=np.uint64)), "desc_hash": sum_of(factor, flat, place_in(flat)),
        "bow_words": len(features.words), "bow_hash": sum_of(factor, features.words.astype(np.uint64) + 1),
        "featvec_entries": int(in_a_node.sum()),
        "featvec_hash": sum_of(factor, nodes[in_a_node].astype(np.uint64) + 1, place_in(nodes)[in_a_node]),
        "imu_measurements": len(row.imu_measurements), "children": len(row.children),
        "loop_edges_directed": len(row.loop_edges), "merge_edges_directed": len(row.merge_edges),
        "prev_links": int(row.previous is not None), "next_links": int(row.next is not None),
    }  # fmt: skip


def sums_of_keyframes(keyframes):
    ids, parents = keyframes.ids + np.uint64(1), keyframes.parents
    connections = keyframes.connections
    ends = np.repeat(ids, np.diff(connections.offsets.astype(np.int64)))
    there = parents != slamdb.NONE
    sums = {
        "n_kf": len(keyframes), "kf_id_sum": sum_of(keyframes.ids), "frame_id_sum": sum_of(keyframes.frame_ids),
        "kf_tcw_t_bits": sum_of(ids[:, None], bits(keyframes.camera_from_world[:, 4:]), ODD),
        "cov_edges_directed": len(connections.weights), "cov_weight_sum": int(connections.weights.sum()),
        "cov_hash": sum_of(ends, connections.keyframes + 1, connections.weights),
        "parent_hash": sum_of(ids[there], parents[there] + np.uint64(1)), "kf_without_parent": int((~there).sum()),
    }  # fmt: skip
    for row in keyframes:
        for name, value in sums_of_keyframe(row).items():
            sums[name] = (sums.get(name, 0) + value) % MOD
    return sums


@pytest.mark.parametrize("name", real_atlases())
def test_arrays_add_up_to_what_orbslam3_saw(name):
    meaning = pathlib.Path(os.environ.get("SLAMDB_MEANING", "")) / f"{name}.json"
    if not path_of(name).exists() or not meaning.is_file():
        pytest.skip(f"{name}.osa or its meaning is not there")
    if name in ("race_mono", "mono_small_twice"):
        pytest.skip(f"{name}: what ORB-SLAM3 sees is not what the file holds, as check tells")
    expected = json.loads(meaning.read_text())
    atlas = slamdb.read(path_of(name))
    assert len(atlas.maps) == len(expected["maps"])
    for map, of_map in zip(atlas.maps, sorted(expected["maps"], key=lambda each: int(each["id"]))):
        assert (map.id, map.imu_initialized, map.inertial) == (
            int(of_map["id"]), of_map["imu_initialized"], of_map["is_inertial"],
        )  # fmt: skip
        assert (map.imu_ba1, map.imu_ba2) == (of_map["imu_ba1"], of_map["imu_ba2"])
        if len(map.keyframes) == 0:
            continue
        assert map.origin_keyframes == of_map["origins"] and map.max_keyframe_id == int(of_map["max_kf_id"])
        sums = {**sums_of_points(map.points), **sums_of_observations(map.points), **sums_of_keyframes(map.keyframes)}
        assert sums == {key: int(of_map[key]) for key in sums}
