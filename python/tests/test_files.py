# SPDX-License-Identifier: BSD-3-Clause
import concurrent.futures
import signal
import threading

import numpy as np
import pytest
import slamdb


def test_what_is_read_is_written_byte_for_byte(session, atlas, tmp_path):
    slamdb.write(atlas, tmp_path / "copy.osa")
    assert (tmp_path / "copy.osa").read_bytes() == session.read_bytes()
    assert slamdb.encode(atlas) == session.read_bytes()
    assert slamdb.diff(atlas, slamdb.read(session.read_bytes())).verdict == "same"


def test_stores(atlas, tmp_path):
    store = tmp_path / "maps.db"
    slamdb.write(atlas, f"{store}#lab")
    part = slamdb.read(f"{store}#lab", box=((-1, -1, 0), (1, 1, 3)))
    positions = part.maps[0].points.positions
    everything = atlas.maps[0].points.positions
    inside = ((everything >= (-1, -1, 0)) & (everything <= (1, 1, 3))).all(axis=1)
    assert np.array_equal(positions, everything[inside])
    with pytest.raises(slamdb.NotFoundError):
        slamdb.read(f"{store}#kitchen")


def test_keyframes_of_a_range_of_times(session, atlas):
    times = np.sort(atlas.maps[0].keyframes.timestamps)
    part = slamdb.read(session, time=(times[2], times[5]))
    assert sorted(part.maps[0].keyframes.timestamps) == times[2:6].tolist()


def test_errors_by_kind(session, atlas, tmp_path):
    with pytest.raises(slamdb.NotFoundError) as not_found:
        slamdb.read(tmp_path / "nothing.osa")
    assert isinstance(not_found.value, FileNotFoundError)
    assert not_found.value.path.endswith("nothing.osa") and not_found.value.kind == "not found"

    slamdb.write(atlas, tmp_path / "there.osa")
    with pytest.raises(slamdb.AlreadyExistsError, match="overwrite=True replaces it"):
        slamdb.write(atlas, tmp_path / "there.osa")
    slamdb.write(atlas, tmp_path / "there.osa", overwrite=True)

    (tmp_path / "cut.osa").write_bytes(session.read_bytes()[:100_000])
    with pytest.raises(slamdb.DamagedError) as damaged:
        slamdb.read(tmp_path / "cut.osa")
    assert "byte" in damaged.value.place and "slamdb.recover saves" in damaged.value.problem

    with pytest.raises(slamdb.UsageError) as usage:
        slamdb.read(session, format="nonsense")
    assert isinstance(usage.value, ValueError)
    with pytest.raises(slamdb.Error):
        slamdb.read(tmp_path)


def test_losses_are_warnings_that_can_be_refused(atlas, tmp_path):
    with pytest.warns(slamdb.LossWarning):
        slamdb.write(atlas, tmp_path / "map.msg")
    with pytest.raises(slamdb.NotPossibleError):
        slamdb.write(atlas, tmp_path / "strict.msg", strict=True)
    assert not (tmp_path / "strict.msg").exists()


def test_progress_is_told_and_may_stop_the_work(session, tmp_path):
    told = []
    slamdb.read(session, progress=lambda stage, fraction: told.append((stage, fraction)))
    assert told and all(isinstance(stage, str) and 0 <= fraction <= 1 for stage, fraction in told)

    class Enough(Exception):
        pass

    def stop(stage, fraction):
        raise Enough

    with pytest.raises(Enough):
        slamdb.read(session, progress=stop)
    with pytest.raises(Enough):
        slamdb.write(slamdb.read(session), tmp_path / "never.osa", progress=stop)
    assert list(tmp_path.iterdir()) == []


def test_an_interrupt_stops_the_work_and_changes_nothing(atlas):
    before = slamdb.encode(atlas)

    def interrupt(stage, fraction):
        signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        slamdb.check(atlas, progress=interrupt)
    with pytest.raises(KeyboardInterrupt):
        slamdb.repair(atlas, progress=interrupt)
    assert slamdb.encode(atlas) == before


def test_threads_read_at_the_same_time(session, atlas):
    data = session.read_bytes()
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        read = list(pool.map(lambda _: slamdb.encode(slamdb.read(session, threads=1)), range(8)))
        encoded = list(pool.map(lambda _: slamdb.encode(atlas, threads=1), range(8)))
    assert all(each == data for each in read + encoded)


def test_other_threads_run_while_slamdb_works(atlas):
    """The GIL is released: a thread that waits for its turn gets it before a check is done."""
    ran = threading.Event()
    inside = threading.Event()

    def work():
        inside.wait(10)
        ran.set()

    helper = threading.Thread(target=work)
    helper.start()
    seen = []

    def progress(stage, fraction):
        inside.set()
        seen.append(ran.wait(10))

    slamdb.check(atlas, progress=progress)
    helper.join()
    assert seen and seen[-1]
