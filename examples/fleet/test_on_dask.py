# SPDX-License-Identifier: BSD-3-Clause
"""A fleet on Dask: a scheduler and two workers on loopback, of which each is killed."""

import os
import shutil
import signal
import threading

import pytest
import slamdb
from conftest import wait_until
from test_fleet import SERIAL, outputs, rows_of

SOUND = 201  # atlases of the folder, see conftest.py

distributed = pytest.importorskip("distributed", reason="distributed is not there (python3-distributed)")

from slamdb_fleet.on_dask import address_of, client_of, run  # noqa: E402
from slamdb_fleet.plan import Wanted, chunks_of, make_plan  # noqa: E402
from slamdb_fleet.work import Job  # noqa: E402


@pytest.fixture
def on_cluster(cluster):
    return ("maps", "-o", "out", "-r", "--to", ".osa", "--chunk", "4", "--scheduler", cluster.address)


def is_like_the_serial_run(fleet):
    fleet.run("maps", "-o", "serial", *SERIAL, "--to", ".osa")
    out, serial = (fleet.folder / name for name in ("out", "serial"))
    assert (out / "summary.csv").read_bytes() == (serial / "summary.csv").read_bytes()
    assert (out / "index.html").read_bytes() == (serial / "index.html").read_bytes()
    return outputs(out) == outputs(serial)


def processes_of_workers(cluster):
    with distributed.Client(cluster.address, set_as_default=False) as client:
        return list(client.run(os.getpid).values())


def test_it_gives_what_the_serial_run_gives(fleet, on_cluster):
    report = fleet.run(*on_cluster)
    assert report["undone"] == 0 and report["failures"] == 2
    assert is_like_the_serial_run(fleet)


def test_a_scheduler_is_known_by_its_file_too(fleet, cluster, on_cluster):
    report = fleet.run(*on_cluster[:-1], cluster.file)
    assert report["undone"] == 0 and report["failures"] == 2


def test_a_scheduler_that_begins_has_an_empty_file_at_first(tmp_path):
    path = tmp_path / "cluster.json"
    path.touch()
    threading.Timer(0.3, path.write_text, ['{"address": "tcp://10.0.0.1:8786"}']).start()
    assert address_of(str(path)) == "tcp://10.0.0.1:8786"


@pytest.mark.parametrize("content", [None, "no JSON", "{}", "[]"])
def test_what_is_no_scheduler_is_a_wrong_argument(fleet, content):
    if content is not None:
        (fleet.folder / "cluster.json").write_text(content)
    fleet.run("maps", "-o", "out", "--scheduler", "cluster.json", status=2)
    assert "or a scheduler's file, not 'cluster.json'" in fleet.said
    assert not (fleet.folder / "out").exists()


def test_a_worker_that_is_killed_loses_nothing_and_nothing_is_done_twice(fleet, cluster, on_cluster):
    wait_until(lambda: len(processes_of_workers(cluster)) == 2)
    victim = processes_of_workers(cluster)[0]
    process = fleet.start(*on_cluster)
    wait_until(lambda: fleet.number_done("out") > 50)
    os.kill(victim, signal.SIGKILL)
    out, said = process.communicate(timeout=900)
    assert process.returncode == 1 and "204 atlases: 201 sound, 1 not sound" in out, said
    assert victim not in processes_of_workers(cluster)
    assert is_like_the_serial_run(fleet)
    assert fleet.times("out", "done") == {1: 204}
    assert fleet.times("out", "begun") in ({1: 203, 2: 1}, {1: 204})  # the one that was being worked on


def test_a_driver_that_is_killed_is_resumed(fleet, on_cluster):
    process = fleet.start(*on_cluster)
    wait_until(lambda: fleet.number_done("out") > 50)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    report = fleet.run(*on_cluster)
    assert 50 < report["resumed"] < 204 and report["undone"] == 0
    assert is_like_the_serial_run(fleet)
    assert fleet.times("out", "done") == fleet.times("out", "begun") == {1: 204}


def test_a_scheduler_that_is_killed_ends_the_run_and_the_next_goes_on(fleet, cluster, on_cluster, monkeypatch):
    monkeypatch.setenv("DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT", "10s")
    process = fleet.start(*on_cluster)
    wait_until(lambda: fleet.number_done("out") > 50)
    os.killpg(cluster.scheduler.pid, signal.SIGKILL)
    out, said = process.communicate(timeout=900)
    assert process.returncode == 1 and "the scheduler is gone" in said
    assert "not done yet; the same command goes on" in out
    cluster.end()
    report = fleet.run(*on_cluster[:-2], "--workers", "0")
    assert report["resumed"] > 50 and report["undone"] == 0
    assert is_like_the_serial_run(fleet)
    assert fleet.times("out", "done") == {1: 204}


def test_an_atlas_that_kills_its_workers_is_named_and_set_aside(fleet, maps, atlases, on_cluster):
    poison = maps / "day0" / "poison.osa"
    shutil.copy(atlases[0], poison)
    report = fleet.run(*on_cluster)
    assert report["set_aside"] == 1 and report["sound"] == 201
    [row] = [row for row in rows_of(fleet.folder / "out" / "summary.csv") if "set aside" in row["failure"]]
    assert row["input"] == "maps/day0/poison.osa" and "ended 3 processes" in row["failure"]
    assert fleet.done("out")["begun", "maps/day0/poison.osa"] == 3
    assert fleet.times("out", "done") == {1: 205}
    again = fleet.run(*on_cluster)
    assert again["resumed"] == 205 and again["set_aside"] == 1
    healed = fleet.run(*on_cluster[:-2], "--workers", "0", "--again", "failed")  # without what kills
    assert healed["set_aside"] == 0 and healed["sound"] == 202
    poison.unlink()
    (fleet.folder / "out" / "atlases" / "maps" / "day0" / "poison.osa").unlink()
    fleet.run(*on_cluster[:-2], "--merge")
    assert is_like_the_serial_run(fleet)


def test_workers_of_its_own(fleet):
    report = fleet.run("maps", "-o", "out", "-r", "--to", ".osa", "--workers", "2")
    assert report["undone"] == 0
    assert is_like_the_serial_run(fleet)


def test_few_chunks_are_out_at_a_time(fleet, cluster, monkeypatch):
    """However slowly they are taken: the scheduler never holds more than the workers need."""
    monkeypatch.chdir(fleet.folder)
    (fleet.folder / "out" / "journal").mkdir(parents=True)
    job = Job(str(fleet.folder), str(fleet.folder / "out"), slamdb.__version__, {}, "", False, 3)
    plan = make_plan(Wanted(["maps"], recursive=True), job, {})
    with client_of(cluster.address, 0) as client:
        wait_until(lambda: len(client.nthreads()) == 2)
        taken = 0
        most = 0
        for entries in run(client, job, chunks_of(plan, 2, "run")):
            taken += len(entries)
            most = max(most, len(client.futures))
        assert taken == 204 and most <= 2 * 2 + 1
        del entries
        wait_until(lambda: len(client.futures) == 0)


def test_workers_with_another_slamdb_are_refused(fleet, cluster, monkeypatch):
    monkeypatch.chdir(fleet.folder)
    job = Job(str(fleet.folder), str(fleet.folder / "out"), "0.0.0", {}, "", False, 3)
    plan = make_plan(Wanted(["maps"], recursive=True), job, {})
    with client_of(cluster.address, 0) as client, pytest.raises(Exception, match="and 0.0.0 here"):
        list(run(client, job, chunks_of(plan, 2, "run")))


def test_workers_that_end_before_they_begin_end_the_run(fleet, cluster, on_cluster):
    with open(cluster.folder / "hook.py", "a") as hook:
        hook.write("\nos.chdir = lambda folder: os.kill(os.getpid(), signal.SIGKILL)\n")
    for process in processes_of_workers(cluster):
        os.kill(process, signal.SIGKILL)
    fleet.run(*on_cluster)
    assert "before they begin" in fleet.said
