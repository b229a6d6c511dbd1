# SPDX-License-Identifier: BSD-3-Clause
"""Arrays share the memory of the atlas, keep it alive, and are safe from threads."""

import concurrent.futures
import gc
import os
import shutil
import subprocess
import sys
import threading

import numpy as np
import pytest
import slamdb

ATLAS_WIDE = ["ids", "positions", "normals", "descriptors", "min_distances", "max_distances", "reference_keyframes"]
OF_KEYFRAMES = ["ids", "timestamps", "camera_from_world", "parents", "velocities", "gyroscope_biases", "frame_ids"]
OF_FEATURES = ["keypoints", "undistorted", "descriptors", "map_points", "right_x", "depth", "words", "word_weights"]


def viewed(atlas):
    """Every array that is a view."""
    map = atlas.maps[0]
    yield from ((name, lambda name=name: getattr(map.points, name)) for name in ATLAS_WIDE)
    yield from ((name, lambda name=name: getattr(map.keyframes, name)) for name in OF_KEYFRAMES)
    yield from ((name, lambda name=name: getattr(map.keyframes[0].features, name)) for name in OF_FEATURES)


def test_arrays_are_not_copies(atlas):
    for name, take in viewed(atlas):
        assert np.shares_memory(take(), take()) and not take().flags.owndata, name


def test_an_array_costs_no_memory_of_its_size(atlas):
    for name, take in viewed(atlas):
        array = take()
        assert sys.getsizeof(array) < 300 < array.nbytes or array.nbytes < 300, name


def test_arrays_hold_the_atlas_and_let_go_of_it(atlas):
    """What an array holds is one object; views of it count there, and nothing is left over when all are gone."""
    for name, take in viewed(atlas):
        array = take()
        keeper = array.base
        before = sys.getrefcount(keeper)
        part = array[1:]
        assert sys.getrefcount(keeper) + sys.getrefcount(array) > before, name
        del array, part
        gc.collect()
        assert sys.getrefcount(keeper) <= before, name


SCRIPT = """
import gc, sys
import numpy as np
import slamdb

atlas = slamdb.read(sys.argv[1])
map = atlas.maps[0]
points, keyframes = map.points, map.keyframes
held = [points.positions, points.descriptors, keyframes.timestamps, keyframes[0].features.keypoints,
        keyframes[3].features.map_points, points[5].position, keyframes[1].velocity]
rows = [points[7], keyframes[2], keyframes[2].features]
with atlas.edit() as edit:
    edit.maps[0].remove_points(points.weights < 4)
    inside = edit.maps[0].points.positions
    edit.maps[0].remove_keyframes([int(keyframes.ids[4])])
held.append(inside)
edit.undo()
slamdb.repair(atlas)
map.remove_points(points.ids[:10])
held.append(map.points.positions)
map.add_keyframes(timestamps=[1.0], poses=[np.eye(4)], features=[keyframes[0].features], camera=0, baseline=0.08)
held.append(map.keyframes.timestamps)
del atlas, map, points, keyframes, edit
gc.collect()
total = sum(float(np.asarray(each[name] if each.dtype.names else each).astype(float).sum())
            for each in held for name in (each.dtype.names or ("",))[:1])
for each in held:
    if each.flags.writeable:
        each[0] = each[-1]
print(total == total, rows[0].id, rows[1].connections, len(rows[2]))
"""


def test_arrays_are_used_after_the_atlas_is_gone_under_valgrind(session, tmp_path):
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        pytest.skip("valgrind is not there")
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    # The loader compares names of libraries by words, which may lie partly behind their ends.
    suppressions = tmp_path / "loader.supp"
    suppressions.write_text("{\n  loader\n  Memcheck:Addr8\n  fun:strncmp\n  ...\n  fun:_dl_*\n}\n")
    done = subprocess.run(
        [valgrind, "--error-exitcode=9", "--errors-for-leak-kinds=none", "--leak-check=no", "--undef-value-errors=no",
         f"--suppressions={suppressions}", sys.executable, str(script), str(session)],
        env={**os.environ, "PYTHONMALLOC": "malloc", "PYTHONDONTWRITEBYTECODE": "1", "OPENBLAS_NUM_THREADS": "1"},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=600, check=False,
    )  # fmt: skip
    assert done.returncode == 0 and "ERROR SUMMARY: 0 errors" in done.stderr, done.stderr[-4000:]
    assert done.stdout.startswith("True")


def test_threads_read_while_one_changes(session):
    """Readers see the atlas before or after a change, never in between; what they hold stays as it was."""
    atlas = slamdb.read(session)
    states = {slamdb.encode(atlas)}
    stop = threading.Event()

    def read():
        seen = []
        while not stop.is_set():
            seen.append(slamdb.encode(atlas, threads=1))
            points = atlas.maps[0].points
            positions, ids = points.positions, points.ids
            assert np.isfinite(positions.sum()) and len(ids) > 0
            assert slamdb.check(atlas, threads=1).sound
        return seen

    with concurrent.futures.ThreadPoolExecutor(3) as pool:
        readers = [pool.submit(read) for _ in range(3)]
        try:
            for seed in range(8):
                map = atlas.maps[0]
                map.remove_points(map.points.ids[seed :: 50].copy())
                states.add(slamdb.encode(atlas))
                with atlas.edit() as edit:
                    edit.maps[0].remove_keyframes([int(edit.maps[0].keyframes.ids[-1])])
                states.add(slamdb.encode(atlas))
                edit.undo()
        finally:
            stop.set()
        for reader in readers:
            assert set(reader.result()) <= states


def test_two_threads_do_not_change_one_atlas(atlas):
    """One waits for nothing and loses nothing: it is refused, or comes after the other."""
    before = len(atlas.maps[0].points)
    ids = atlas.maps[0].points.ids.copy()

    def remove(part):
        try:
            atlas.maps[0].remove_points(part)
            return len(part)
        except slamdb.NotPossibleError as refused:
            assert "another thread is changing" in str(refused)
            return 0

    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        removed = sum(pool.map(remove, np.array_split(ids[:400], 8)))
    assert removed > 0 and before - len(atlas.maps[0].points) == removed
    assert slamdb.check(atlas).sound
