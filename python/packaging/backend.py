# SPDX-License-Identifier: BSD-3-Clause
"""Wheels and source archives of slamdb for pip and other PEP 517 front ends: CMake builds, this packs.

It needs nothing but Python and what compiling slamdb needs, so that Debian 12 builds wheels without a network.
Equal sources give equal source archives, and equal modules equal wheels; SOURCE_DATE_EPOCH dates what is in them.

Settings (`--config-settings build-dir=build/dev`):
    build-dir  where CMake builds; one that is configured already is used as it is. By default build/wheel-TAG
CMAKE_ARGS and CMAKE_BUILD_PARALLEL_LEVEL are heeded.
"""

import base64
import gzip
import hashlib
import io
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import time
import zipfile
from typing import Any, Dict, Iterator, List, Mapping, Optional, Tuple

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

SOURCE = pathlib.Path(__file__).resolve().parents[2]
OLDEST_CMAKE = (3, 25)
FIRST_PYBIND11_FOR_NUMPY_2 = (2, 12)
# What the module is built from.
SOURCES = (
    "CMakeLists.txt", "CMakePresets.json", "LICENSE", "README.md", "pyproject.toml", "cli", "cmake", "lib", "python", "schema",
)  # fmt: skip

Settings = Optional[Mapping[str, str]]


def build_wheel(
    wheel_directory: str, config_settings: Settings = None, metadata_directory: Optional[str] = None
) -> str:
    build = _built(dict(config_settings or {}))
    info = f"slamdb-{_version()}.dist-info"
    name = f"slamdb-{_version()}-{_tag()}.whl"
    with tempfile.TemporaryDirectory() as staged:
        _run("cmake", "--install", build, "--component", "python", "--strip", "--prefix", staged)
        [package] = pathlib.Path(staged).glob("**/slamdb")
        files = {f"slamdb/{path.name}": path.read_bytes() for path in sorted(package.iterdir())}
    files[f"{info}/licenses/LICENSE"] = (SOURCE / "LICENSE").read_bytes()
    files[f"{info}/METADATA"] = _metadata(_numpy(build)).encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: slamdb\nRoot-Is-Purelib: false\nTag: {_tag()}\n".encode()
    record = [f"{path},sha256={_digest(data)},{len(data)}" for path, data in files.items()]
    files[f"{info}/RECORD"] = "\n".join([*record, f"{info}/RECORD,,", ""]).encode()
    with zipfile.ZipFile(pathlib.Path(wheel_directory, name), "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, data in files.items():
            entry = zipfile.ZipInfo(path, time.gmtime(max(_date(), 315532800))[:6])  # zip begins in 1980
            entry.external_attr = (0o755 if path.endswith(".so") else 0o644) << 16
            wheel.writestr(entry, data, zipfile.ZIP_DEFLATED)
    return name


def build_sdist(sdist_directory: str, config_settings: Settings = None) -> str:
    name = f"slamdb-{_version()}"
    with open(pathlib.Path(sdist_directory, f"{name}.tar.gz"), "wb") as file:
        file.write(gzip.compress(_archive(name), 9, mtime=0))
    return f"{name}.tar.gz"


def _archive(name: str) -> bytes:
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w") as archive:
        for path, data, mode in _sources():
            entry = tarfile.TarInfo(f"{name}/{path}")
            entry.size, entry.mode, entry.mtime = len(data), mode, _date()
            archive.addfile(entry, io.BytesIO(data))
    return buffer.getvalue()


def get_requires_for_build_wheel(config_settings: Settings = None) -> List[str]:
    """What the system does not have."""
    needed = []
    if _cmake_version() < OLDEST_CMAKE:
        needed.append("cmake>=" + ".".join(map(str, OLDEST_CMAKE)))
    prefixes = ("/usr", "/usr/local", sys.prefix)
    if not any(list(pathlib.Path(prefix).glob("*/cmake/pybind11/pybind11Config.cmake")) for prefix in prefixes):
        needed.append("pybind11>=2.12")
    return needed


def get_requires_for_build_sdist(config_settings: Settings = None) -> List[str]:
    return []


def _built(settings: Dict[str, str]) -> pathlib.Path:
    build = SOURCE / settings.get("build-dir", f"build/wheel-{_tag()}")
    cache = build / "CMakeCache.txt"
    if not cache.exists() or "build-dir" not in settings:
        options = {"CMAKE_BUILD_TYPE": "Release", "SLAMDB_BUILD_PYTHON": "ON", "SLAMDB_BUILD_CLI": "OFF",
                   "SLAMDB_BUILD_LIVE": "OFF", "Python_EXECUTABLE": sys.executable, **_pybind11()}  # fmt: skip
        generator = ["-G", "Ninja"] if shutil.which("ninja") and not cache.exists() else []
        defined = [f"-D{name}={value}" for name, value in options.items()]
        _run("cmake", "-S", SOURCE, "-B", build, *generator, *defined, *shlex.split(os.environ.get("CMAKE_ARGS", "")))
    if not _numpy(build):
        sys.exit("slamdb: CMake found no headers of Python, or no pybind11: apt install python3-dev pybind11-dev")
    jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))
    _run("cmake", "--build", build, "--target", "slamdb_python", "--parallel", jobs)
    return build


def _pybind11() -> Dict[str, str]:
    try:
        import pybind11  # type: ignore[import]
    except ImportError:  # CMake finds the system's
        return {}
    return {"pybind11_DIR": pybind11.get_cmake_dir()}


def _numpy(build: pathlib.Path) -> str:
    """The numpy that the module works with: older versions of pybind11 do not know numpy 2. Empty: there is none."""
    found = re.search(r"SLAMDB_PYBIND11_VERSION:INTERNAL=(\d+)\.(\d+)", (build / "CMakeCache.txt").read_text())
    if not found:
        return ""
    version = (int(found[1]), int(found[2]))
    return "numpy" if version >= FIRST_PYBIND11_FOR_NUMPY_2 else "numpy<2"


def _metadata(numpy: str = "") -> str:
    with open(SOURCE / "pyproject.toml", "rb") as file:
        project: Dict[str, Any] = tomllib.load(file)["project"]
    lines = [
        "Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {_version()}",
        f"Summary: {project['description']}", f"Requires-Python: {project['requires-python']}",
        f"License: {project['license']['text']}", "Classifier: Operating System :: POSIX :: Linux",
    ]  # fmt: skip
    lines += [f"Requires-Dist: {numpy}"] if numpy else []
    for extra, packages in project["optional-dependencies"].items():
        lines += [f"Provides-Extra: {extra}", *(f'Requires-Dist: {each}; extra == "{extra}"' for each in packages)]
    return "\n".join([*lines, ""])


def _sources() -> Iterator[Tuple[str, bytes, int]]:
    """Path, content and mode of all that is in a source archive."""
    yield "PKG-INFO", _metadata().encode(), 0o644
    for top in map(SOURCE.joinpath, SOURCES):
        for path in sorted(top.rglob("*")) if top.is_dir() else [top]:
            below = path.relative_to(SOURCE)
            hidden = any(part.startswith(".") or part in ("__pycache__", "node_modules") for part in below.parts)
            if path.is_file() and not hidden:
                yield str(below), path.read_bytes(), 0o755 if os.access(path, os.X_OK) else 0o644


def _version() -> str:
    """It stands in one place."""
    text = (SOURCE / "lib/slamdb/version.h").read_text()
    return ".".join(re.findall(r"SLAMDB_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", text))


def _tag() -> str:
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def _date() -> int:
    return int(os.environ.get("SOURCE_DATE_EPOCH", "315532800"))


def _digest(data: bytes) -> str:
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip("=")


def _cmake_version() -> Tuple[int, ...]:
    try:
        told = subprocess.run(["cmake", "--version"], stdout=subprocess.PIPE, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return (0,)
    return tuple(int(number) for number in re.findall(r"\d+", told)[:2])


def _run(*command: object) -> None:
    subprocess.run([str(word) for word in command], check=True, stdout=sys.stderr)
