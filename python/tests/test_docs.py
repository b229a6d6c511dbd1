# SPDX-License-Identifier: BSD-3-Clause
import doctest
import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys

import pytest
import slamdb

SOURCE = pathlib.Path(os.environ["SLAMDB_SOURCE"])


class WithoutTqdm(doctest.DocTestParser):
    def get_examples(self, string, name="<string>"):
        """Without those of the bar."""
        return [each for each in super().get_examples(string, name) if not re.search(r"tqdm|\bbar\.", each.source)]


@pytest.mark.parametrize("page", ["docs/python.md", "README.md"])
def test_what_the_page_shows_is_what_comes_out(page, fixtures, tmp_path, monkeypatch):
    for name in ("session_small_a", "session_small_b"):
        shutil.copytree(fixtures / name, tmp_path / name)
    monkeypatch.chdir(tmp_path)
    parser = WithoutTqdm() if importlib.util.find_spec("tqdm") is None else doctest.DocTestParser()
    outcome = doctest.testfile(str(SOURCE / page), module_relative=False, parser=parser)
    assert outcome.attempted > 3 and outcome.failed == 0


def test_pages_that_the_module_names_are_there():
    for path in (SOURCE / "python" / "slamdb").glob("*.py"):
        for page in re.findall(r"(?:docs|schema)/[\w./-]+\.\w+", path.read_text(encoding="utf-8")):
            assert (SOURCE / page).is_file(), f"{path.name}: {page}"


def test_types_are_known():
    mypy = shutil.which("mypy")
    if mypy is None:
        pytest.skip("mypy is not there")
    package = pathlib.Path(slamdb.__file__).parent
    done = subprocess.run(
        [mypy, "--strict", "--cache-dir", os.devnull, "--python-executable", sys.executable, package],
        stdout=subprocess.PIPE, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout


def test_everything_public_is_described():
    for name in slamdb.__all__:
        thing = getattr(slamdb, name)
        assert thing is slamdb.NONE or thing.__doc__, name
        for member, value in vars(thing).items() if isinstance(thing, type) else ():
            if isinstance(value, property) and not member.startswith("_") and name in ("Points", "KeyFrames", "Features"):
                assert value.__doc__, f"{name}.{member}"


def test_importing_takes_nothing_that_takes_long():
    """Scripts that touch no array need not wait for numpy."""
    program = "import sys, slamdb; print(sorted({'numpy', 'pandas', 'scipy', 'IPython', 'asyncio'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True, check=True)
    assert done.stdout.strip() == "[]"
