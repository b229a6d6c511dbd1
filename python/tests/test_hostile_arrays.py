# SPDX-License-Identifier: BSD-3-Clause
"""Arrays of every kind that numpy has: they are taken for what they are, or refused by name, and then change nothing."""

import gc

import numpy as np
import pytest
import slamdb
from test_building import atlas_of, world


def arguments():
    return world(np.random.default_rng(11), keyframes=3, points=20)


def with_octaves(arrays):
    for row, each in enumerate(arrays["keyframes"]["features"]):
        arrays["keyframes"]["features"][row] = each._replace(keypoints=np.asarray(each.keypoints, np.float64))
    return arrays


NUMBERS = (("keyframes", "timestamps"), ("keyframes", "poses"), ("points", "positions"), ("points", "observations"))


def strided(array):
    wide = np.zeros((*array.shape[:-1], 2 * array.shape[-1]), array.dtype)
    wide[..., ::2] = array
    return wide[..., ::2]


SAME = {
    "of the other byte order": lambda array: array.astype(array.dtype.newbyteorder()),
    "strided": strided,
    "in Fortran's order": np.asfortranarray,
    "backwards": lambda array: array[::-1].copy()[::-1],
    "read-only": lambda array: np.broadcast_to(array, array.shape),
    "nested lists": lambda array: array.tolist(),
    "unmasked": lambda array: np.ma.masked_array(array),
    "of a memory view": lambda array: memoryview(np.ascontiguousarray(array)),
}


@pytest.mark.parametrize("what", SAME)
def test_what_holds_the_same_numbers_makes_the_same_atlas(what):
    expected, arrays = slamdb.encode(atlas_of(with_octaves(arguments()))), with_octaves(arguments())
    for kind, name in NUMBERS:
        arrays[kind][name] = SAME[what](np.asarray(arrays[kind][name]))
    for row, each in enumerate(arrays["keyframes"]["features"]):
        arrays["keyframes"]["features"][row] = slamdb.FeatureArrays(
            **{name: None if part is None else SAME[what](np.asarray(part)) for name, part in each._asdict().items()
               if name != "descriptors"},
            descriptors=strided(each.descriptors),
        )  # fmt: skip
    assert slamdb.encode(atlas_of(arrays)) == expected


def masked(array):
    return np.ma.masked_array(array, mask=np.arange(array.size).reshape(array.shape) == 1)


HOSTILE = {
    "masked": (masked, "has masked values"),
    "objects": (lambda array: array.astype(object), "has dtype object, expected"),
    "complex": (lambda array: array.astype(complex), "has dtype complex128"),
    "texts": (lambda array: array.astype(str), "has dtype <U"),
    "truths": (lambda array: array.astype(bool), "has dtype bool"),
    "dates": (lambda array: array.astype("i8").astype("M8[s]"), "has dtype datetime64"),
    "one number": (lambda array: np.float64(1), r"has shape \(\)"),
    "a matrix of too many dimensions": (lambda array: array[..., None], r"has shape \("),
    "ragged": (lambda array: [[1], [1, 2]], "is no array of|has dtype object"),
    "a text": (lambda array: "positions", "has dtype <U"),
    "an object": (lambda array: object(), "has dtype object"),
    "a mapping": (lambda array: {"a": 1}, "has dtype object"),
    "void": (lambda array: np.zeros(3, "V8"), "has dtype "),
}


@pytest.mark.parametrize("place", [(kind, name) for kind, name in NUMBERS] + ["keypoints", "descriptors", "octaves"], ids=str)
@pytest.mark.parametrize("what", HOSTILE)
def test_what_is_no_array_of_numbers_is_refused_by_name(what, place):
    make, message = HOSTILE[what]
    arrays = arguments()
    if isinstance(place, str):
        features = arrays["keyframes"]["features"]
        kind, name = "keyframes", f"features: row 1.{place}"
        features[1] = features[1]._replace(**{place: make(np.asarray(getattr(features[1], place)))})
    else:
        kind, name = place
        arrays[kind][name] = make(np.asarray(arrays[kind][name]))
    atlas = slamdb.Atlas()
    atlas.add_camera("pinhole", 400, 400, 320, 240)
    map = atlas.add_map()
    before = slamdb.encode(atlas)
    with pytest.raises(slamdb.UsageError, match=f"^{name}: .*({message})"):
        map.add_keyframes(**arrays["keyframes"])
        assert kind == "points"
        before = slamdb.encode(atlas)
        map.add_points(**arrays["points"])
    assert slamdb.encode(atlas) == before


SCALARS = {
    "camera": (-1, 0.5, 2**64, True, "0", None, [0, 1]),
    "right_camera": (-1, 0.5, 2**64, "0"),
    "baseline": ("wide", [1], None, -1, np.nan, np.inf),
    "depth_threshold": ("far", -1, np.nan),
    "levels": (0, -1, 2**31, 2**63, 2.5, "8", None),
    "scale_factor": (0, -1, 1, np.nan, "1.2", 1e300),
    "image_size": ((640,), (640, -480), (640.5, 480), (2**31, 480), (0, 0), "640x480", 640, (1, 2, 3)),
    "left_from_right": ([], np.eye(3), np.zeros((4, 4)), "none", np.full((4, 4), np.inf)),
    "distortion": ([[0]], ["a"], [np.nan], [0] * 9),
    "features": (7, None, {"keypoints": []}, "features"),
    "ids": ([-1, 0, 1], [0.5, 1, 2], [2**63, 1, 2], ["a", "b", "c"], [[1, 2, 3]], [2**64, 1, 2]),
    "imu": (7, "imu", {}, []),
}


@pytest.mark.parametrize("name", SCALARS)
@pytest.mark.filterwarnings("ignore:overflow")
def test_arguments_of_no_sense_are_refused_by_name(name):
    for value in SCALARS[name]:
        atlas = slamdb.Atlas()
        atlas.add_camera("pinhole", 400, 400, 320, 240)
        map = atlas.add_map()
        before = slamdb.encode(atlas)
        with pytest.raises(slamdb.UsageError, match=f"^{name}"):
            map.add_keyframes(**{**arguments()["keyframes"], name: value})
        assert slamdb.encode(atlas) == before, value


@pytest.mark.parametrize("id", [-1, 0.5, 2**64, "0", [1], 2**32])
def test_ids_of_cameras_and_maps_that_are_none(id):
    atlas = slamdb.Atlas()
    before = slamdb.encode(atlas)
    with pytest.raises(slamdb.UsageError, match="^id: "):
        atlas.add_camera("pinhole", 400, 400, 320, 240, id=id)
    with pytest.raises(slamdb.UsageError, match="^id: "):
        atlas.add_map(id=id)
    assert slamdb.encode(atlas) == before


def test_lists_of_ids_may_have_none_beside_small_ones():
    arrays = arguments()
    arrays["keyframes"]["ids"] = [4, np.uint64(7), 2**31 - 1]
    map = atlas_of({**arrays, "points": {**arrays["points"], "positions": [], "observations": []}}).maps[0]
    assert map.keyframes.ids.tolist() == [4, 7, 2**31 - 1]
    with pytest.raises(slamdb.UsageError, match="^ids: row 1 is 18446744073709551615; ids are below"):
        map.add_keyframes(**{**arrays["keyframes"], "ids": [5, slamdb.NONE, 6]})


CSR = slamdb.Observations
OBSERVATIONS = {
    "left of nothing": CSR([0, 1, 2], [0, 1], [], None),
    "left of too few": CSR([0, 1, 2], [0, 1], [0], None),
    "no left": CSR([0, 1, 2], [0, 1], None, None),
    "right of too few": CSR([0, 1, 2], [0, 1], [0, 0], [1]),
    "offsets that fall": CSR([0, 2, 1], [0, 1], [0, 0], None),
    "offsets that begin late": CSR([1, 1, 2], [0, 1], [0, 0], None),
    "offsets that go too far": CSR([0, 1, 2**40], [0, 1], [0, 0], None),
    "no offsets": CSR([], [0, 1], [0, 0], None),
    "rows below the least": CSR([0, 1, 2], [0, 1], [-(2**40), 0], None),
}


@pytest.mark.parametrize("what", OBSERVATIONS)
def test_compressed_observations_that_do_not_fit(what):
    arrays = arguments()
    arrays["points"] = {"positions": [[0, 0, 5], [0, 1, 5]], "observations": OBSERVATIONS[what]}
    with pytest.raises(slamdb.UsageError, match="^observations.(left|right|offsets): "):
        atlas_of(arrays)


def test_huge_arrays_without_memory_are_refused_and_change_nothing():
    atlas = atlas_of(arguments())
    map, before = atlas.maps[0], slamdb.encode(atlas)
    with pytest.raises((MemoryError, slamdb.Error)):
        map.add_points(positions=np.broadcast_to(np.float32(0), (2**50, 3)), observations=[(0, 0, 0)])
    assert slamdb.encode(atlas) == before


class Meddling:
    """An array that does something while it is read."""

    def __init__(self, array, work):
        self.array, self.work = array, work

    def __array__(self, dtype=None, copy=None):
        self.work()
        return np.asarray(self.array, dtype)


def test_arrays_that_change_the_others_meanwhile_harm_nothing():
    arrays = arguments()
    features = arrays["keyframes"]["features"]
    left = np.arange(20, dtype=np.int32)
    positions = np.array(arrays["points"]["positions"])
    atlas = slamdb.Atlas()
    atlas.add_camera("pinhole", 400, 400, 320, 240)
    map = atlas.add_map()
    features[0] = features[0]._replace(octaves=Meddling([0] * 20, features.clear))
    map.add_keyframes(**arrays["keyframes"])
    assert len(map.keyframes) == 3

    def shrink():
        left.resize(0, refcheck=False)
        positions.resize(0, refcheck=False)

    seen = slamdb.Observations(np.arange(21), np.zeros(20, np.uint64), left, Meddling([-1] * 20, shrink))
    map.add_points(positions=positions, observations=seen)
    assert len(map.points) == 20 and slamdb.check(atlas).sound


def test_a_map_that_is_taken_away_while_arrays_are_read_is_gone(atlas):
    map = atlas.maps[0]

    def replace():
        atlas.add_map()
        map.remove_keyframes(map.keyframes.ids[:3])

    point = int(map.points.ids[0])
    seen_by = sorted(map.points[0].observations)
    with pytest.raises(slamdb.UsageError, match="once more|by keyframe|points: row 0"):
        map.add_observations([point], Meddling(np.array(seen_by[:1], np.uint64), replace), [0])
    assert slamdb.check(atlas).sound


def test_features_outlive_their_atlas(session):
    features = [row.features for row in slamdb.read(session).maps[0].keyframes][:3]
    gc.collect()
    arrays = arguments()
    arrays["keyframes"]["features"] = features
    arrays["keyframes"]["baseline"] = 0.1
    atlas = slamdb.Atlas()
    atlas.add_camera("pinhole", 400, 400, 320, 240)
    atlas.add_map().add_keyframes(**arrays["keyframes"])
    assert [len(row.features) for row in atlas.maps[0].keyframes] == [len(each) for each in features]
