# SPDX-License-Identifier: BSD-3-Clause
import email
import hashlib
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tarfile
import zipfile

import pytest
import slamdb

SOURCE = pathlib.Path(os.environ["SLAMDB_SOURCE"])


def run(*command, cwd=None, **environment):
    variables = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(
        list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, cwd=cwd,
        env={**variables, **environment},
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-4000:]
    return done.stdout


@pytest.fixture(scope="module")
def build():
    """The folder that this module was built in."""
    folder = pathlib.Path(slamdb.__file__).parents[2]
    if not (folder / "CMakeCache.txt").exists():
        pytest.skip("slamdb is not imported from where it was built")
    if re.search("BUILD_SHARED_LIBS:[A-Z]*=ON", (folder / "CMakeCache.txt").read_text()):
        pytest.skip("the module needs a shared library, which is in no wheel")
    return folder


@pytest.fixture(scope="module")
def pip():
    if importlib.util.find_spec("pip") is None:
        pytest.skip("pip is not there")
    return (sys.executable, "-m", "pip", "--no-cache-dir", "--disable-pip-version-check")


def wheel_of(pip, build, folder):
    """Neither a network nor anything of an index is needed."""
    settings = ("--config-settings", f"build-dir={build}")
    run(*pip, "wheel", "--no-index", "--no-deps", *settings, "--wheel-dir", folder, SOURCE, PIP_CONFIG_FILE=os.devnull)
    [wheel] = folder.glob("*.whl")
    return wheel


@pytest.fixture(scope="module")
def wheel(pip, build, tmp_path_factory):
    return wheel_of(pip, build, tmp_path_factory.mktemp("wheel"))


def test_a_wheel_installs_and_reads(wheel, session, tmp_path):
    run(sys.executable, "-m", "venv", "--without-pip", "--system-site-packages", tmp_path / "venv")
    python = tmp_path / "venv" / "bin" / "python"
    run(python, "-m", "pip", "install", "--no-index", wheel)
    program = f"import slamdb; print(slamdb.__file__); print(slamdb.read({str(session)!r}))"
    told = run(python, "-c", program, cwd=tmp_path)
    assert str(tmp_path / "venv") in told and "3162 points" in told
    listed = run(python, "-c", "import importlib.metadata as m; print(m.version('slamdb'), m.requires('slamdb'))")
    assert slamdb.__version__ in listed and "numpy" in listed
    run(python, "-m", "pip", "uninstall", "--yes", "slamdb")
    assert not list((tmp_path / "venv").rglob("*slamdb*"))


def test_a_wheel_holds_the_package_and_what_describes_it(wheel):
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    assert re.fullmatch(rf"slamdb-{re.escape(slamdb.__version__)}-{python}-{python}-linux_\w+\.whl", wheel.name)
    package = {path.name for path in pathlib.Path(slamdb.__file__).parent.iterdir() if path.is_file()}
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        assert {name[len("slamdb/") :] for name in names if name.startswith("slamdb/")} == package
        [info] = {name.split("/")[0] for name in names if ".dist-info/" in name}
        metadata = email.message_from_bytes(archive.read(f"{info}/METADATA"))
        assert metadata["Version"] == slamdb.__version__ and metadata["Name"] == "slamdb"
        record = dict(line.split(",", 1) for line in archive.read(f"{info}/RECORD").decode().splitlines())
        assert set(record) == set(names)
        size = len(archive.read("slamdb/__init__.py"))
        assert record["slamdb/__init__.py"].endswith(f",{size}")


def test_equal_modules_are_equal_wheels(wheel, pip, build, tmp_path):
    again = wheel_of(pip, build, tmp_path)
    assert hashlib.sha256(again.read_bytes()).digest() == hashlib.sha256(wheel.read_bytes()).digest()


@pytest.fixture(scope="module")
def backend():
    spec = importlib.util.spec_from_file_location("backend", SOURCE / "python" / "packaging" / "backend.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_source_archive_has_what_cmake_needs(backend, tmp_path):
    name = backend.build_sdist(str(tmp_path))
    assert name == f"slamdb-{slamdb.__version__}.tar.gz"
    first = (tmp_path / name).read_bytes()
    backend.build_sdist(str(tmp_path))
    assert (tmp_path / name).read_bytes() == first
    with tarfile.open(tmp_path / name) as archive:
        archive.extractall(tmp_path)
    source = tmp_path / name[: -len(".tar.gz")]
    assert f"Version: {slamdb.__version__}" in (source / "PKG-INFO").read_text()
    left_out = ("__pycache__", "node_modules", ".pytest_cache")
    assert not [path for path in source.rglob("*") if path.name in left_out] and not (source / "build").exists()
    options = [f"-DSLAMDB_BUILD_{part}={on}" for part, on in (("PYTHON", "ON"), ("CLI", "OFF"), ("LIVE", "OFF"))]
    # CMake holds every source that it is told of against what is there.
    run("cmake", "-S", source, "-B", source / "build", *options, f"-DPython_EXECUTABLE={sys.executable}")
    targets = run("cmake", "--build", source / "build", "--target", "help")
    assert "slamdb_python" in targets


def test_what_the_system_has_is_not_asked_of_an_index(backend, monkeypatch, tmp_path):
    assert backend.get_requires_for_build_wheel() == []
    monkeypatch.setattr(backend.pathlib.Path, "glob", lambda self, pattern: iter(()))
    monkeypatch.setenv("PATH", str(tmp_path))
    assert backend.get_requires_for_build_wheel() == ["cmake>=3.25", "pybind11>=2.12"]
