# SPDX-License-Identifier: BSD-3-Clause
"""Threads that change one atlas, Ctrl-C, and the end of the interpreter."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import slamdb

WITHOUT_NUMPY = """
import sys, threading
import slamdb
atlas = slamdb.read(sys.argv[1])
map = atlas.maps[0]
start = threading.Barrier(4)
def work():
    start.wait()
    {work}
threads = [threading.Thread(target=work) for _ in range(4)]
assert "numpy" not in sys.modules
[thread.start() for thread in threads]
[thread.join() for thread in threads]
print("done")
"""


@pytest.mark.parametrize(
    "work",
    [
        "map.points.positions", "map.keyframes.poses", "map.keyframes.connections", "map.keyframes[0].pose",
        "map.keyframes[0].features.keypoints", "map.points[0].position", "map.loop_edges",
        "map.points.rows_of([map.points[0].id])", "atlas.copy().maps[0].remove_points([map.points[0].id])",
        "slamdb.read(sys.argv[1], box=((-1, -1, 0), (1, 1, 3)))",
        "slamdb.extract(atlas.copy(), polygon=[(-9, -9), (9, -9), (9, 9)])", "map.points[[True] * len(map.points)]",
        "slamdb.Atlas().add_camera('pinhole', 1, 1, 1, 1)", "slamdb.list_atlases(sys.argv[1], near=((0, 0, 0), 1.0))",
    ],
)  # fmt: skip
def test_the_first_arrays_are_taken_by_several_threads(work, session):
    program = WITHOUT_NUMPY.format(work=work)
    done = subprocess.run(
        [sys.executable, "-c", program, str(session)],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert done.stdout == "done\n", done.stdout


def together(*calls):
    """What each of them gave, or raised, on a thread of its own."""
    results = [None] * len(calls)
    start = threading.Barrier(len(calls))

    def call(at):
        start.wait()
        try:
            results[at] = calls[at]() or "done"
        except slamdb.Error as error:
            results[at] = error

    threads = [threading.Thread(target=call, args=(at,)) for at in range(len(calls))]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    return results


def test_of_two_edits_that_end_at_once_one_is_refused(atlas):
    ids = atlas.maps[0].points.ids
    for _ in range(10):
        under = atlas.copy()
        edits = [under.edit(), under.edit()]
        for edit, part in zip(edits, (ids[:100], ids[-100:])):
            edit.maps[0].remove_points(part)
        results = together(*(edit.commit for edit in edits))
        assert sorted(isinstance(each, slamdb.NotPossibleError) for each in results) == [False, True], results
        assert len(under.maps[0].points) == len(ids) - 100 and len(under.history) == 1


def test_a_verb_beside_an_edit_that_ends_is_not_lost(atlas):
    ids = atlas.maps[0].points.ids
    for _ in range(10):
        under = atlas.copy()
        edit = under.edit()
        edit.maps[0].remove_points(ids[:100])
        results = together(edit.commit, lambda: under.maps[0].remove_points(ids[-100:]))
        refused = [each for each in results if isinstance(each, slamdb.Error)]
        assert all(isinstance(each, slamdb.NotPossibleError) for each in refused), results
        assert len(ids) - len(under.maps[0].points) == 100 * (2 - len(refused)) and len(refused) < 2


@pytest.mark.parametrize("how", ["commit", "drop", "change"])
def test_an_edit_is_ended_beside_something_else(atlas, how):
    """It is put in place once, or not at all, and what raised no error is in it."""
    for _ in range(8):
        under = atlas.copy()
        edit = under.edit()
        map = edit.maps[0]
        ids = map.points.ids
        map.remove_points(ids[:100])
        others = {"commit": edit.commit, "drop": edit.drop, "change": lambda: map.remove_points(ids[-100:])}
        first, other = (not isinstance(each, slamdb.Error) for each in together(edit.commit, others[how]))
        gone = len(ids) - len(under.maps[0].points)
        if how == "commit":
            assert (gone, first + other) == (100, 1)
        elif how == "drop":
            assert other and gone == (100 if first else 0)
        else:
            assert first or other
            assert gone == (100 * (1 + other) if first else 0)


# ---- Ctrl-C


def interrupted(call):
    """Whether Ctrl-C, which comes as soon as `call` lets go of the GIL, raised in it."""
    begin = threading.Event()

    def interrupt():
        begin.wait()
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    thread.start()
    interval = sys.getswitchinterval()
    sys.setswitchinterval(10)  # seconds, so that it does not come before
    is_done = False
    try:
        begin.set()
        call()
        is_done = True
        thread.join()  # it came too late, on a busy machine
        time.sleep(10)
    except KeyboardInterrupt:
        sys.setswitchinterval(interval)
        thread.join()
    return not is_done


VERBS = {
    "cull": lambda atlas: slamdb.cull(atlas, min_observations=5),
    "transform": lambda atlas: slamdb.transform(atlas, scale=2),
    "renumber": lambda atlas: slamdb.renumber(atlas, start=7),
    "repair": lambda atlas: slamdb.repair(atlas),
    "landmarks_from_points": lambda atlas: slamdb.landmarks_from_points(atlas),
    "remove_points": lambda atlas: atlas.maps[0].remove_points(atlas.maps[0].points.ids[:300]),
    "remove_keyframes": lambda atlas: atlas.maps[0].remove_keyframes(atlas.maps[0].keyframes.ids[3:5]),
    "update_points": lambda atlas: atlas.maps[0].update_points(),
    "update_covisibility": lambda atlas: atlas.maps[0].update_covisibility(),
    "undo": lambda atlas: atlas.undo(),
}


@pytest.mark.parametrize("verb", VERBS)
def test_ctrl_c_changes_nothing(atlas, verb):
    stopped = 0
    for _ in range(50):
        under = atlas.copy()
        with under.edit() as edit:  # for undo
            edit.maps[0].points.positions[:] += np.float32(1)
        before = slamdb.encode(under)
        if interrupted(lambda: VERBS[verb](under)):
            stopped += 1
            assert slamdb.encode(under) == before and len(under.history) == 1
        if stopped == 3:
            return
    assert stopped > 0


def test_ctrl_c_leaves_an_edit_open(atlas):
    before = slamdb.encode(atlas)
    for _ in range(50):
        under = atlas.copy()
        edit = under.edit()
        edit.maps[0].points.positions[:] += np.float32(1)
        if interrupted(edit.commit):
            break
    assert slamdb.encode(under) == before and under.history == []
    edit.commit()
    assert slamdb.encode(under) != before and len(under.history) == 1


# ---- The end of the interpreter

ENDING = """
import sys, threading, time
import slamdb, numpy
atlas = slamdb.read(sys.argv[1])
begun = threading.Semaphore(0)
def work():
    while True:
        begun.release()
        {work}
for _ in range(3):
    threading.Thread(target=work, daemon=True).start()
for _ in range(6):
    begun.acquire()
print("end")
"""


@pytest.mark.parametrize(
    "work",
    [
        "slamdb.cull(atlas.copy(), min_observations=5)",
        "slamdb.cull(atlas.copy(), max_error=2, progress=lambda stage, fraction: time.sleep(1e-4))",
        "atlas.copy()", "atlas.edit().commit()", "slamdb.Store(sys.argv[2] + '/none.db').names",
    ],
)  # fmt: skip
def test_daemon_threads_are_at_work_when_the_interpreter_ends(work, session, tmp_path):
    if "Store" in work:
        slamdb.Store(tmp_path / "none.db").save("a", slamdb.read(session))
    elif "commit" in work:
        work = f"try: {work}\n        except slamdb.NotPossibleError: pass"
    for _ in range(4):
        done = subprocess.run(
            [sys.executable, "-c", ENDING.format(work=work), str(session), str(tmp_path)],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=60, check=False,
        )  # fmt: skip
        assert (done.returncode, done.stdout) == (0, "end\n")
