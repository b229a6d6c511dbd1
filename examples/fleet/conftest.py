# SPDX-License-Identifier: BSD-3-Clause
import collections
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

import pytest

HERE = pathlib.Path(__file__).parent
FIXTURES = pathlib.Path(os.environ["SLAMDB_FIXTURES"])

sys.path.insert(0, str(HERE))

# In workers: an atlas takes a while, so that something can be killed in the middle, and some end their process.
HOOK = """
import os, signal, time
import slamdb

def read(path, *, really_read=slamdb.read, **options):
    time.sleep(0.02)
    if "poison" in path:
        os.kill(os.getpid(), signal.SIGKILL)
    return really_read(path, **options)

slamdb.read = read
"""


def wait_until(holds, seconds=600):
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end, "it does not come to that"
        time.sleep(0.02)


@pytest.fixture(scope="session")
def atlases(tmp_path_factory):
    """Some small atlases, all different."""
    folder = tmp_path_factory.mktemp("atlases")
    for seed in range(8):
        size = ["--keyframes", str(4 + seed % 3), "--points", str(60 + 10 * seed), "--features", "150"]
        path = folder / f"{seed}.osa"
        made = [os.environ["SLAMDB"], "synthesize", path, *size, "--seed", str(seed)]
        subprocess.run(made, check=True, stdout=subprocess.DEVNULL)
    return sorted(folder.iterdir())


@pytest.fixture
def maps(atlases, tmp_path, request):
    """Atlases in four folders, by the same names; and one that is cut, one that is none, one that is not sound, and one
    with markup in its name."""
    folder = tmp_path / "maps"
    for number in range(request.module.SOUND - 1):
        path = folder / f"day{number % 4}" / f"map{number // 4}.osa"
        path.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(atlases[number % len(atlases)], path)
    data = (FIXTURES / "session_small_a" / "session_small_a.osa").read_bytes()
    (folder / "day0" / "cut.osa").write_bytes(data[:100_000])
    (folder / "day1" / "no atlas.osa").write_bytes(b"\0" * 5000)
    shutil.copy(FIXTURES / "mono_small_twice" / "mono_small_twice.osa", folder / "day2")
    shutil.copy(atlases[0], folder / "day3" / "<script>alert(1)<&script>.osa")
    return folder


class Fleet:
    """The script, run in a folder."""

    def __init__(self, folder):
        self.folder = folder

    def start(self, *arguments):
        return subprocess.Popen(
            [sys.executable, HERE / "fleet.py", *map(str, arguments)], cwd=self.folder, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True,
        )  # fmt: skip

    def run(self, *arguments, status=1):
        """Its report; what it says besides is `said`. Most folders here have an atlas that is not sound."""
        process = self.start(*arguments, "--json")
        out, self.said = process.communicate(timeout=900)
        assert process.returncode == status, self.said
        return json.loads(out) if out else None

    def done(self, out):
        """Of each atlas, how many times it was begun and done."""
        counts = collections.Counter()
        for journal in sorted((self.folder / out / "journal").glob("*.jsonl")):
            for line in journal.read_bytes().split(b"\n"):
                try:
                    [(kind, entry)] = json.loads(line).items()
                    counts[kind, entry["input"]] += 1
                except ValueError:
                    continue  # of a writer that is at work, or was killed
        return counts

    def times(self, out, kind):
        return collections.Counter(count for (each, _), count in self.done(out).items() if each == kind)

    def number_done(self, out):
        return sum(count for (kind, _), count in self.done(out).items() if kind == "done")


@pytest.fixture
def fleet(maps):
    return Fleet(maps.parent)


class Cluster:
    """A scheduler and two workers on loopback, each a process, as on a cluster."""

    def __init__(self, folder):
        self.folder = folder
        self.file = folder / "scheduler.json"
        (folder / "hook.py").write_text(HOOK)
        self.scheduler = self._start("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--no-show")
        self.workers = [
            self._start("worker", "--host", "127.0.0.1", "--nthreads", "1", "--no-dashboard",
                        "--preload", folder / "hook.py", "--local-directory", folder)
            for _ in range(2)
        ]  # fmt: skip
        wait_until(lambda: self.file.exists() and self.file.stat().st_size)  # it is made empty

    @property
    def address(self):
        return json.loads(self.file.read_text())["address"]

    def _start(self, what, *arguments):
        with open(self.folder / "log", "ab") as log:
            return subprocess.Popen(
                [sys.executable, "-m", f"distributed.cli.dask_{what}", "--scheduler-file", self.file, *arguments],
                stdout=log, stderr=log, cwd=self.folder, start_new_session=True,
            )  # fmt: skip

    def end(self):
        for process in (*self.workers, self.scheduler):
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


@pytest.fixture
def cluster(tmp_path_factory):
    pytest.importorskip("distributed", reason="distributed is not there (python3-distributed)")
    cluster = Cluster(tmp_path_factory.mktemp("cluster"))
    yield cluster
    cluster.end()
