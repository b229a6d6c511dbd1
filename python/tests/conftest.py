# SPDX-License-Identifier: BSD-3-Clause
import json
import os
import pathlib
import subprocess

import pytest
import slamdb


@pytest.fixture(scope="session")
def fixtures() -> pathlib.Path:
    return pathlib.Path(os.environ["SLAMDB_FIXTURES"])


@pytest.fixture(scope="session")
def session(fixtures: pathlib.Path) -> pathlib.Path:
    return fixtures / "session_small_a" / "session_small_a.osa"


@pytest.fixture
def atlas(session: pathlib.Path) -> slamdb.Atlas:
    return slamdb.read(session)


@pytest.fixture(scope="session")
def command():
    """The command's `--json`."""

    def run(*arguments):
        done = subprocess.run(
            [os.environ["SLAMDB"], *map(str, arguments), "--json"], stdout=subprocess.PIPE, check=False
        )
        return json.loads(done.stdout)

    return run
