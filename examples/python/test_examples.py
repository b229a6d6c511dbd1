# SPDX-License-Identifier: BSD-3-Clause
"""Each example does what it says, on what it takes by default."""

import csv
import io
import os
import pathlib
import pickle
import shutil

import numpy as np
import pytest
import slamdb

HERE = pathlib.Path(__file__).parent
EXAMPLES = sorted(path.name for path in HERE.glob("*.py") if path.name not in ("conftest.py", "test_examples.py"))


@pytest.mark.parametrize("example", EXAMPLES)
def test_each_says_what_it_does_and_is_short(run, example):
    if example == "plot_map.py":
        pytest.importorskip("matplotlib", reason="matplotlib is not there (python3-matplotlib)")
    assert "usage: " in run(example, "--help")
    assert len((HERE / example).read_text().split("\n")) < 125


WRITING = [example for example in EXAMPLES if example != "keyframe_dataset.py"]


@pytest.mark.parametrize("example", WRITING)
def test_each_runs_twice_and_writes_over_nothing_unasked(run, tmp_path, example):
    if example == "plot_map.py":
        pytest.importorskip("matplotlib", reason="matplotlib is not there (python3-matplotlib)")
    output = ["-o", "table.csv"] if example == "quality_table.py" else []
    run(example, *output)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    said = run(example, *output, status=1)
    assert "is there already" in said and "-O replaces" in said and "Traceback" not in said
    assert before == {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    run(example, *output, "-O")


@pytest.fixture
def real():
    """A real atlas of a name, where there are some."""

    def real(name):
        path = pathlib.Path(os.environ.get("SLAMDB_ATLASES", "")) / name
        if not path.is_file():
            pytest.skip(f"{name} is not there (SLAMDB_ATLASES)")
        return path

    return real


def test_plot_map(run, tmp_path, session):
    image = pytest.importorskip("matplotlib.image", reason="matplotlib is not there (python3-matplotlib)")
    run("plot_map.py")
    picture = image.imread(tmp_path / "map.png")
    assert picture.shape[0] > 300 and picture.shape[1] > 300
    crimson = np.abs(picture[:, :, :3] - np.array([220, 20, 60]) / 255).max(axis=2) < 0.1
    assert crimson.sum() > 200  # the way of the camera
    assert len(np.unique(picture.reshape(-1, 4), axis=0)) > 100  # points in their colours
    first = (tmp_path / "map.png").read_bytes()
    run("plot_map.py", session, "-O")
    assert (tmp_path / "map.png").read_bytes() == first
    assert "there is no map 7" in run("plot_map.py", "--map", "7", "-O", status=1)


@pytest.mark.parametrize("name, labels", [
    ("stereo_inertial.osa", [("x (m)", "y (m)")]),  # gravity along z
    ("mono_small.osa", [("x (units of the map)", "z (units of the map)")]),
    ("multimap_rgbd.osa", [("x (m)", "z (m)")] * 2),
])  # fmt: skip
def test_plot_map_draws_every_map_from_above_in_its_units(real, tmp_path, monkeypatch, name, labels):
    pytest.importorskip("matplotlib", reason="matplotlib is not there (python3-matplotlib)")
    import plot_map

    kept = []
    monkeypatch.setattr(plot_map.pyplot.Figure, "savefig", lambda figure, *_, **__: kept.append(figure))
    monkeypatch.setattr("sys.argv", ["plot_map.py", str(real(name)), "-o", str(tmp_path / "map.png")])
    plot_map.main()
    drawn = [axes for axes in kept[0].axes if axes.get_legend()]
    assert [(axes.get_xlabel(), axes.get_ylabel()) for axes in drawn] == labels
    atlas = slamdb.read(real(name))
    for map, axes in zip(atlas.maps, drawn):
        assert axes.get_legend().get_texts()[0].get_text() == f"{len(map.keyframes)} keyframes"


def test_plan_axes_are_level_and_right_handed():
    pytest.importorskip("matplotlib", reason="matplotlib is not there (python3-matplotlib)")
    from plot_map import plan_axes

    for up, axes in (((0, -1, 0), ((1, 0, 0), (0, 0, 1))), ((0, 0, 1), ((1, 0, 0), (0, 1, 0)))):
        assert np.allclose(plan_axes(np.array(up, float)), axes)
    for up in np.random.default_rng(0).normal(size=(50, 3)):
        up /= np.linalg.norm(up)
        right, forward = plan_axes(up)
        assert np.allclose(np.cross(right, forward), up) and np.isclose(np.linalg.norm(right), 1)


def test_quality_table(run, fixtures, session, tmp_path):
    maps = tmp_path / "maps"
    shutil.copytree(fixtures / "mono_small_twice", maps)
    (maps / "cut.osa").write_bytes(session.read_bytes()[:100_000])
    table = csv.DictReader(io.StringIO(run("quality_table.py", session, maps)))
    rows = {pathlib.Path(row["input"]).name: row for row in table}
    assert list(rows) == ["session_small_a.osa", "cut.osa", "mono_small_twice.osa"]
    assert rows["session_small_a.osa"]["sound"] == "True" and rows["session_small_a.osa"]["keyframes"] == "14"
    assert rows["mono_small_twice.osa"]["sound"] == "False" and rows["mono_small_twice.osa"]["errors"] == "1"
    assert "truncated" in rows["cut.osa"]["failure"]
    run("quality_table.py", "-o", "table.csv")
    assert len((tmp_path / "table.csv").read_text().split("\n")) == 4


def test_filter_points(run, tmp_path, session):
    assert run("filter_points.py", "--limit", "2.5").endswith("sound\n")
    before, after = (slamdb.read(path).maps[0] for path in (session, tmp_path / "filtered.osa"))

    def nearest(points):
        return np.linalg.norm(points.positions[:, None] - before.keyframes.centers, axis=2).min(axis=1)

    assert set(after.points.ids) == set(before.points.ids[nearest(before.points) <= 2.5])
    assert 0 < len(after.points) < len(before.points)


def test_evaluate_trajectory(run, tmp_path):
    said = run("evaluate_trajectory.py")
    assert said.startswith("map 0: 14 poses, rmse 0.0176 m, at most 0.0372 m\n")  # as docs/evaluate.md has it
    assert said.count(" s: ") == 3 and "s: 0.0372 m" in said.split("\n")[1]
    assert len((tmp_path / "errors.csv").read_text().split("\n")) == 14 + 2


def test_map_from_arrays(run, tmp_path):
    assert run("map_from_arrays.py").startswith("12 keyframes, 352 points:")
    atlas = slamdb.read(tmp_path / "wall.osa")
    assert slamdb.check(atlas).sound
    [world] = atlas.maps
    assert np.allclose(world.keyframes.poses[:, 0, 3], 0.5 * np.arange(12))
    assert (world.points.observation_counts >= 2).sum() > 300
    assert slamdb.check(atlas)["inputs"][0]["measures"]["reprojection_error_px"] < 1e-3


def test_colmap_handover(run, tmp_path, session):
    said = run("colmap_handover.py")
    assert said.startswith("model: 14 images by ") and float(said.split()[-4]) < 1e-4
    points = slamdb.read(session).maps[0].points
    written = (tmp_path / "model" / "points3D.txt").read_text().split("\n")
    assert sum(line[:1].isdigit() for line in written) == len(points) == 3162


@pytest.mark.parametrize("name, images", [("multimap_rgbd.osa", [46, 60]), ("fisheye_stereo.osa", [56])])
def test_colmap_handover_of_several_maps_and_of_fisheye_pairs(run, real, name, images):
    lines = run("colmap_handover.py", real(name)).splitlines()
    assert [int(line.split()[1]) for line in lines] == images
    assert all(float(line.split()[-4]) < 1e-4 for line in lines)


def test_keyframe_dataset(run, fixtures, session):
    from keyframe_dataset import KeyFrameDataset, ShuffledBlocks

    assert run("keyframe_dataset.py").startswith("29 keyframes with ")
    samples = KeyFrameDataset([fixtures / "session_small_a", fixtures / "session_small_b"], budget=1)
    assert len(samples) == 29
    keyframes = slamdb.read(session).maps[0].keyframes
    for number in (13, 20, 3):  # back and forth between atlases, of which one is held at least
        sample = samples[number]
        assert sample["keypoints"].shape == (len(sample["descriptors"]), 2)
        assert len(samples._held) == 1
        assert not sample["right"].any() and sample["depth"].shape == (len(sample["descriptors"]),)
    assert np.array_equal(sample["descriptors"], keyframes[3].features.descriptors)
    assert np.allclose(sample["world_from_camera"], keyframes.poses[3], atol=1e-6)
    packed = pickle.dumps(samples)
    assert len(packed) < 10_000  # for workers: places, no atlases
    assert np.array_equal(pickle.loads(packed)[20]["descriptors"], samples[20]["descriptors"])
    sample["descriptors"][:] = 0  # is the caller's own
    assert np.array_equal(samples[3]["descriptors"], keyframes[3].features.descriptors)
    assert sorted(ShuffledBlocks(samples)) == list(range(29))


@pytest.mark.parametrize("budget, again", [(1 << 30, False), (1, True)])
def test_keyframe_dataset_reads_atlases_again_only_beyond_its_budget(fixtures, monkeypatch, budget, again):
    import keyframe_dataset

    reads = []
    read = slamdb.read
    monkeypatch.setattr(slamdb, "read", lambda name, **options: reads.append(name) or read(name, **options))
    samples = keyframe_dataset.KeyFrameDataset([fixtures / f"session_small_{each}" for each in "ab"], budget)
    assert len(reads) == 2
    order = np.random.default_rng(0).permutation(29)
    reads.clear()
    for number in order:
        samples[number]
    assert len(reads) > 8 if again else not reads
    samples = pickle.loads(pickle.dumps(samples))
    reads.clear()
    for number in keyframe_dataset.ShuffledBlocks(samples):
        samples[number]
    assert len(reads) == 2 and len(samples._held) == (1 if again else 2)


def test_keyframe_dataset_has_both_cameras_of_a_fisheye_pair(real):
    from keyframe_dataset import KeyFrameDataset

    path = real("fisheye_stereo.osa")
    sample = KeyFrameDataset([path])[0]
    keyframe = slamdb.read(path).maps[0].keyframes[0]
    left, right = keyframe.features.keypoints, keyframe.features.right_keypoints
    assert len(sample["keypoints"]) == len(sample["descriptors"]) == len(sample["right"]) == len(sample["depth"])
    assert sample["keypoints"][sample["right"], 0].tolist() == right["x"].tolist()
    assert sample["keypoints"][~sample["right"], 1].tolist() == left["y"].tolist()
    assert np.allclose(sample["left_from_right"], keyframe.left_from_right, atol=1e-6)


def test_keyframe_dataset_in_pytorch(session):
    data = pytest.importorskip("torch.utils.data", reason="torch is not there")
    from keyframe_dataset import KeyFrameDataset

    loader = data.DataLoader(KeyFrameDataset([session]), batch_size=None, shuffle=True, num_workers=2)
    ids = slamdb.read(session).maps[0].keyframes.ids
    assert sorted(sample["keyframe"] for sample in loader) == sorted(ids.tolist())
