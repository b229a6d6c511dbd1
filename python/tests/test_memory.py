# SPDX-License-Identifier: BSD-3-Clause
"""Columns that go to disk where memory ends. The limit is of a process, so each test has one of its own."""

import os
import subprocess
import sys

import pytest

import slamdb


def run(program, *words):
    done = subprocess.run([sys.executable, "-c", program, *map(str, words)], stdout=subprocess.PIPE, text=True, check=True)
    return done.stdout.split()


def test_atlases_are_the_same_on_disk(session, tmp_path):
    if os.statvfs("/var/tmp").f_bavail == 0:
        pytest.skip("/var/tmp is full")
    program = """
import sys, slamdb
slamdb.set_memory_limit(1, spill="/var/tmp")
atlas = slamdb.read(sys.argv[1])
print(slamdb.spilled() > 0)
slamdb.write(atlas, sys.argv[2])
del atlas
print(slamdb.spilled() < 3 << 21)
"""
    assert run(program, session, tmp_path / "copy.osa") == ["True", "True"]
    assert (tmp_path / "copy.osa").read_bytes() == session.read_bytes()


def test_a_folder_that_is_not_there_is_an_error(session):
    program = """
import sys, slamdb
slamdb.set_memory_limit(1, spill="/nowhere")
try:
    slamdb.read(sys.argv[1])
except slamdb.NotFoundError as error:
    print(error.path)
"""
    assert run(program, session) == ["/nowhere"]


@pytest.mark.parametrize("memory", [-1, 1.5, "1G", 1 << 64])
def test_limits_are_bytes(memory):
    with pytest.raises((TypeError, slamdb.UsageError, OverflowError)):
        slamdb.set_memory_limit(memory)
