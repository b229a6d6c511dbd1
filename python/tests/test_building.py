# SPDX-License-Identifier: BSD-3-Clause
"""Atlases from arrays: sound, and the same as what they were taken from."""

import numpy as np
import pytest
import slamdb
from real_atlases import built_anew, path_of, real_atlases


@pytest.fixture(scope="module", params=[*(name for name in real_atlases() if name != "race_mono"), "i1", "i2"])
def pair(request):
    """A real atlas, and one that is made of its arrays."""
    if not path_of(request.param).exists():
        pytest.skip(f"{request.param}.osa is not there")
    atlas = slamdb.read(path_of(request.param))
    return request.param, atlas, built_anew(atlas)


def test_what_is_built_is_sound_and_read_byte_for_byte(pair):
    _, atlas, built = pair
    report = slamdb.check(built)
    rules = {each.rule for each in report.inputs[0].results}
    known = {each.rule for each in slamdb.check(atlas).inputs[0].results}
    assert report.sound and rules <= known | {"point-support"}, rules  # of points that lost what one side said alone
    data = slamdb.encode(built)
    again = slamdb.read(data)
    assert slamdb.encode(again) == data and slamdb.diff(again, built).verdict == "same"


def test_geometry_is_the_same(pair):
    name, atlas, built = pair
    report = slamdb.diff(atlas, built)
    for entities in (report.maps, report.cameras, report.keyframes, report.points):
        assert entities.removed == entities.added == entities.renumbered == 0
    assert not report.motions and not report.cameras.aspects.to_dict()
    if name != "mono_small_newmap":  # that of an empty map
        assert set(report.maps.aspects.to_dict()) <= {"count of big changes"}
    assert "pose" not in report.keyframes.aspects and "position" not in report.points.aspects
    if name not in ("mono_dist", "fisheye_stereo"):  # what OpenCV undistorts is near
        assert "features" not in report.keyframes.aspects


def test_what_is_derived_is_near(pair):
    name, atlas, built = pair
    least_shared = 0.3 if name == "fisheye_stereo" else 0.7  # whose keyframes count points of two keypoints twice
    for old, new in zip(atlas.maps, built.maps):
        if len(old.keyframes) == 0:
            continue
        rows = old.points.rows_of(new.points.ids)
        normals = (old.points.normals[rows] * new.points.normals).sum(axis=1)
        assert np.median(normals / np.linalg.norm(new.points.normals, axis=1)) > 0.9
        same = (old.points.descriptors[rows] == new.points.descriptors).all(axis=1)
        assert same.mean() > 0.4
        ratio = new.points.max_distances / old.points.max_distances[rows]
        assert 0.7 < np.median(ratio) < 1.4
        assert np.abs(new.points.weights - old.points.weights[rows]).mean() < 0.2
        shared = new.keyframes.connections.weights.sum() / max(old.keyframes.connections.weights.sum(), 1)
        assert least_shared < shared < 1.4
        same_parent = old.keyframes.parents[old.keyframes.rows_of(new.keyframes.ids)] == new.keyframes.parents
        assert same_parent.mean() > 0.2
        assert new.root_keyframe == old.root_keyframe and new.lowest_keyframe == old.lowest_keyframe


def test_undistorted_keypoints_are_those_of_opencv(pair):
    _, atlas, built = pair
    for old, new in zip(atlas.maps, built.maps):
        for one, other in zip(old.keyframes, new.keyframes):
            for axis in "xy":
                again = one.features.undistorted[axis] - other.features.undistorted[axis]
                assert np.abs(again).max() < 0.01
            assert one.image_bounds == other.image_bounds


# ---- A small world of known numbers


def world(rng, keyframes=5, points=40):
    """Arguments that make a map: a camera that goes along x and sees all points, in front of it."""
    positions = rng.uniform((-1, -1, 4), (1, 1, 8), (points, 3)).astype(np.float32)
    poses = np.tile(np.eye(4), (keyframes, 1, 1))
    poses[:, 0, 3] = np.linspace(0, 0.8, keyframes)
    features, triples = [], []
    for row in range(keyframes):
        order = rng.permutation(points)
        x, y, z = (positions[order] - poses[row, :3, 3]).T
        features.append(
            slamdb.FeatureArrays(
                keypoints=np.stack([400 * x / z + 320, 400 * y / z + 240], axis=1),
                descriptors=rng.integers(0, 256, (points, 32), np.uint8),
                octaves=rng.integers(0, 8, points),
            )
        )
        triples += [(point, row, keypoint) for keypoint, point in enumerate(order.tolist())]
    return {
        "keyframes": {"timestamps": np.arange(keyframes) / 10, "poses": poses, "features": features, "camera": 0},
        "points": {"positions": positions, "observations": triples},
    }


def atlas_of(arrays):
    atlas = slamdb.Atlas()
    atlas.add_camera("pinhole", 400, 400, 320, 240)
    map = atlas.add_map()
    map.add_keyframes(**arrays["keyframes"])
    map.add_points(**arrays["points"])
    return atlas


def test_a_world_is_sound_and_consistent():
    arrays = world(np.random.default_rng(7))
    atlas = atlas_of(arrays)
    assert slamdb.check(atlas).sound
    map = atlas.maps[0]
    assert np.allclose(map.keyframes.poses, arrays["keyframes"]["poses"], atol=1e-6)
    assert map.keyframes.ids.tolist() == [0, 1, 2, 3, 4] and map.points.ids.tolist() == list(range(40))
    assert map.covisibility().toarray().tolist() == (40 * (1 - np.eye(5))).tolist()
    assert (map.points.weights == 5).all() and map.root_keyframe == 0
    assert map.sensor == "monocular"
    for own, row in zip(map.points.descriptors, map.points):  # that of one of its keypoints
        seen = [map.keyframes.by_id(k).features.descriptors[left] for k, (left, _) in row.observations.items()]
        assert any((own == each).all() for each in seen)


@pytest.mark.parametrize("seed", range(12))
def test_random_worlds_are_sound(seed, tmp_path):
    rng = np.random.default_rng(seed)
    arrays = world(rng, int(rng.integers(2, 8)), int(rng.integers(16, 80)))
    points = arrays["points"]
    kept = rng.random(len(points["observations"])) < 0.8
    points["observations"] = [each for each, keep in zip(points["observations"], kept) if keep]
    seen = {point for point, _, _ in points["observations"]}
    new_row = {old: new for new, old in enumerate(sorted(seen))}
    points["observations"] = [(new_row[point], keyframe, keypoint) for point, keyframe, keypoint in points["observations"]]
    points["positions"] = points["positions"][sorted(seen)]
    atlas = atlas_of(arrays)
    assert slamdb.check(atlas).sound
    slamdb.write(atlas, tmp_path / "built.osa")
    again = slamdb.read(tmp_path / "built.osa")
    assert slamdb.encode(again) == (tmp_path / "built.osa").read_bytes()
    assert np.array_equal(again.maps[0].points.positions, points["positions"])


def test_poses_as_quaternions_are_those_as_matrices():
    arrays = world(np.random.default_rng(3))
    arrays["keyframes"]["poses"][2, :3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    by_matrix = atlas_of(arrays).maps[0].keyframes
    arrays["keyframes"]["poses"] = by_matrix.poses_quaternion
    assert np.allclose(atlas_of(arrays).maps[0].keyframes.poses, by_matrix.poses, atol=1e-6)


def test_depth_and_right_x_tell_each_other():
    arrays = world(np.random.default_rng(4))
    keyframes, z = arrays["keyframes"], 5.0
    count = len(keyframes["features"][0].keypoints)
    keyframes["features"] = [each._replace(depth=np.full(count, z)) for each in keyframes["features"]]
    keyframes["baseline"] = 0.1
    features = atlas_of(arrays).maps[0].keyframes[0].features
    assert np.allclose(features.right_x, features.undistorted["x"] - 400 * 0.1 / z, atol=1e-3)
    keyframes["features"] = [each._replace(depth=None, right_x=features.right_x) for each in keyframes["features"]]
    again = atlas_of(arrays).maps[0]
    assert np.allclose(again.keyframes[0].features.depth, z, atol=1e-3) and (again.points.weights == 10).all()


def test_growing_is_building():
    """Keyframe by keyframe, point by point: sound at the end, with the same covisibility."""
    arrays = world(np.random.default_rng(5))
    whole = atlas_of(arrays)
    atlas = slamdb.Atlas()
    atlas.add_camera("pinhole", 400, 400, 320, 240)
    map, keyframes = atlas.add_map(), arrays["keyframes"]
    for row in range(5):
        map.add_keyframes(
            timestamps=keyframes["timestamps"][row : row + 1], poses=keyframes["poses"][row : row + 1],
            features=keyframes["features"][row : row + 1], camera=0,
        )  # fmt: skip
    for point in range(40):
        seen = [(0, keyframe, keypoint) for each, keyframe, keypoint in arrays["points"]["observations"] if each == point]
        map.add_points(positions=arrays["points"]["positions"][point : point + 1], observations=seen)
    assert slamdb.check(atlas).sound
    report = slamdb.diff(whole, atlas)
    assert not report.points.changed and all(each.added == each.removed == 0 for each in report.links)


def _set(path, value):
    """Arguments with one changed: ("points", "positions", 3) is row 3 of the argument."""

    def change(arrays):
        kind, argument, *row = path
        if row:
            arrays[kind][argument] = list(arrays[kind][argument])
            arrays[kind][argument][row[0]] = value
        else:
            arrays[kind][argument] = value

    return change


def _feature(**parts):
    def change(arrays):
        features = arrays["keyframes"]["features"]
        features[1] = features[1]._replace(**parts)

    return change


NAN_PLACE = np.full((40, 2), 7.0)
NAN_PLACE[9, 1] = np.nan
BAD = {
    "timestamps of text": (_set(("keyframes", "timestamps"), ["a"] * 5), "timestamps: .*expected numbers"),
    "a time that is none": (_set(("keyframes", "timestamps", 2), np.nan), "timestamps: row 2 .*finite"),
    "too few times": (_set(("keyframes", "timestamps"), [0.0]), "poses: has 5 rows, but there are 1"),
    "poses of another shape": (_set(("keyframes", "poses"), np.eye(3)), r"poses: has shape \(3, 3\), expected \(N, 7\)"),
    "a pose that scales": (_set(("keyframes", "poses", 3), 2 * np.eye(4)), "poses: row 3 .*rotation"),
    "a pose of nothing": (_set(("keyframes", "poses", 3), np.full((4, 4), np.nan)), "poses: row 3"),
    "no such camera": (_set(("keyframes", "camera"), 9), "camera: the atlas has no camera 9; .*add_camera"),
    "ids twice": (_set(("keyframes", "ids"), [1, 2, 3, 2, 5]), "ids: row 3 is 2, as a row above"),
    "ids below 0": (_set(("keyframes", "ids"), [1, 2, 3, -2, 5]), "ids: row 3 is -2"),
    "ids beyond 2^31": (_set(("keyframes", "ids"), [1, 2, 3, 2**31, 5]), "ids: row 3 is 2147483648; ids are below"),
    "ids that are no whole numbers": (_set(("keyframes", "ids"), [0.5] * 5), "ids: row 0 is 0.5"),
    "features of too few": (_set(("keyframes", "features"), []), "features: has 0 rows"),
    "no features": (_set(("keyframes", "features", 1), None), "features: row 1: has no keypoints"),
    "a keypoint nowhere": (_feature(keypoints=NAN_PLACE), "features: row 1 .*keypoint 9"),
    "descriptors of floats": (_feature(descriptors=np.zeros((40, 32))), "descriptors: .*uint8"),
    "too few descriptors": (_feature(descriptors=np.zeros((7, 32), np.uint8)), "descriptors: has 7 rows"),
    "an octave too high": (_feature(octaves=[8] * 40), "keypoint 0 is of octave 8"),
    "depth without baseline": (_feature(depth=[1.0] * 40), "baseline="),
    "a right keypoint nowhere": (_feature(right_keypoints=[[1, np.inf]]), "right_keypoints: keypoint 0"),
    "distortion that is none": (_set(("keyframes", "distortion"), [np.inf]), "distortion: row 0"),
    "an image of nothing": (_set(("keyframes", "image_size"), (0, 480)), "image_size"),
    "positions of two numbers": (_set(("points", "positions"), np.zeros((40, 2))), r"positions: has shape \(40, 2\)"),
    "a position nowhere": (_set(("points", "positions", 4), [0, np.nan, 0]), "positions: row 4"),
    "a point twice": (_set(("points", "ids"), [1] * 40), "ids: row 1 is 1, as a row above"),
    "seen by nobody": (_set(("points", "positions"), np.ones((41, 3))), "positions: row 40 .*nothing observes"),
    "an observation of no point": (_set(("points", "observations", 5), (40, 0, 1)), "observations: row 5 is of point 40"),
    "by no keyframe": (_set(("points", "observations", 5), (0, 77, 1)), "observations: row 5 is by keyframe 77"),
    "of no keypoint": (_set(("points", "observations", 5), (0, 0, 40)), "observations: row 5 is keypoint 40"),
    "a keypoint that is two points": (
        _set(("points", "observations"), [(0, 0, 3), (1, 0, 3)]), "observations: row 1 .*another point already",
    ),
    "a point twice in a picture": (
        _set(("points", "observations"), [(0, 0, 3), (0, 0, 4)]), "observations: row 1 .*once more",
    ),
    "a reference that does not see it": (_set(("points", "reference_keyframes"), [99] * 40), "reference_keyframes: row 0"),
    "a range the wrong way round": (
        lambda arrays: arrays["points"].update(min_distances=[2.0] * 40, max_distances=[1.0] * 40), "min_distances: row 0",
    ),
    "normals of nothing": (_set(("points", "normals"), np.full((40, 3), np.nan)), "normals: row 0"),
}  # fmt: skip


@pytest.mark.parametrize("what", BAD)
def test_bad_arrays_are_refused_by_name_and_change_nothing(what):
    change, message = BAD[what]
    arrays = world(np.random.default_rng(1))
    change(arrays)
    atlas = slamdb.Atlas()
    atlas.add_camera("pinhole", 400, 400, 320, 240)
    map = atlas.add_map()
    kind = "keyframes"
    with pytest.raises(ValueError, match=message) as raised:
        before = slamdb.encode(atlas)
        map.add_keyframes(**arrays["keyframes"])
        kind = "points"
        before = slamdb.encode(atlas)
        map.add_points(**arrays["points"])
    assert isinstance(raised.value, slamdb.UsageError) and slamdb.encode(atlas) == before
    assert kind == ("points" if "positions" in message or len(map.keyframes) else "keyframes")


def test_ids_that_the_atlas_has_are_refused(atlas):
    map = atlas.maps[0]
    before = slamdb.encode(atlas)
    with pytest.raises(ValueError, match=f"ids: row 0 is {map.points.ids[5]}, which the atlas has"):
        map.add_points(ids=[map.points.ids[5]], positions=[[0, 0, 1]], observations=[(0, 0, 0)])
    with pytest.raises(ValueError, match="which is another point already"):
        slot = int(np.flatnonzero(map.keyframes[0].features.map_points != slamdb.NONE)[0])
        map.add_points(positions=[[0, 0, 1]], observations=[(0, map.keyframes[0].id, slot)])
    with pytest.raises(ValueError, match="has a camera 0 already"):
        atlas.add_camera("pinhole", 1, 1, 1, 1, id=0)
    with pytest.raises(ValueError, match="has a map 0 already"):
        atlas.add_map(id=0)
    assert slamdb.encode(atlas) == before


@pytest.mark.parametrize(
    "arguments, message",
    [
        (("pinhole", 1, 2, 3), "there are 3; the model has 4"),
        (("pinhole", 0, 2, 3, 4), "row 0 is 0; a focal length is above 0"),
        (("pinhole", 1, 2, np.nan, 4), "row 2"),
        (("fisheye", 1, 2, 3, 4), "none of 'pinhole'"),
    ],
)
def test_cameras_that_are_none(arguments, message):
    with pytest.raises(ValueError, match=message):
        slamdb.Atlas().add_camera(*arguments)


def test_the_vocabulary_of_a_new_atlas(tmp_path):
    assert slamdb.Atlas().vocabulary_name == "ORBvoc.txt"
    assert len(slamdb.Atlas().vocabulary_checksum) == 32
    assert slamdb.Atlas(vocabulary=("mine", "0" * 32)).vocabulary_checksum == "0" * 32
    with pytest.raises(slamdb.NotFoundError):
        slamdb.Atlas(vocabulary=tmp_path / "none.txt")


def test_adding_to_a_real_map(atlas):
    map = atlas.maps[0]
    free = np.flatnonzero(map.keyframes[0].features.map_points == slamdb.NONE)
    other = np.flatnonzero(map.keyframes[1].features.map_points == slamdb.NONE)
    first, second = map.keyframes[0].id, map.keyframes[1].id
    before = len(map.points)
    ids = map.add_points(
        positions=[[0, 0, 2], [0, 0.1, 2]],
        observations=[(0, first, free[0]), (0, second, other[0]), (1, first, free[1]), (1, second, other[1])],
    )
    assert len(map.points) == before + 2 and slamdb.check(atlas).sound
    assert map.points.by_id(ids[0]).observations == {int(first): (free[0], -1), int(second): (other[0], -1)}
    assert map.keyframes[0].features.map_points[free[0]] == ids[0]
