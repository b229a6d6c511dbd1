# SPDX-License-Identifier: BSD-3-Clause
import os
import pathlib
import subprocess
import sys

import pytest

HERE = pathlib.Path(__file__).parent
sys.path.insert(0, str(HERE))


@pytest.fixture(scope="session")
def fixtures():
    return pathlib.Path(os.environ["SLAMDB_FIXTURES"])


@pytest.fixture(scope="session")
def session(fixtures):
    return fixtures / "session_small_a" / "session_small_a.osa"


@pytest.fixture
def run(tmp_path):
    """Runs an example in a folder of its own; what it prints, or where it fails what it says."""

    def run(name, *arguments, status=0):
        command = [sys.executable, HERE / name, *map(str, arguments)]
        done = subprocess.run(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        assert done.returncode == status, done.stderr
        return done.stderr if status else done.stdout

    return run
