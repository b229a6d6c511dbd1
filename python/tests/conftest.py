# SPDX-License-Identifier: BSD-3-Clause
import os
import pathlib
import subprocess
from json import loads

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
    """The command's `--json`; without json, that it ends well."""

    def run(*arguments, json=True):
        words = [os.environ["SLAMDB"], *map(str, arguments), *(["--json"] if json else [])]
        done = subprocess.run(words, stdout=subprocess.PIPE, check=not json)
        return loads(done.stdout) if json else None

    return run
