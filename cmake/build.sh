#!/usr/bin/env bash
# build.sh [PRESET [TARGET...]]: installs the packages that are missing on Debian 12, then configures and builds
# build/PRESET (default: release), all of it or the targets named.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=${1:-release}
shift || true

packages=(g++ cmake ninja-build ccache pkg-config
  libeigen3-dev libboost-serialization-dev libsqlite3-dev libcli11-dev nlohmann-json3-dev libxxhash-dev libmd-dev zlib1g-dev
  libopencv-core-dev esbuild
  libgtest-dev libgmock-dev sqlite3 mandoc)
missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done
if [ ${#missing[@]} -gt 0 ]; then
  root=(); [ "$(id -u)" = 0 ] || root=(sudo)
  echo "Installing: ${missing[*]}"
  "${root[@]}" apt-get update -q >/dev/null
  DEBIAN_FRONTEND=noninteractive "${root[@]}" apt-get install -y -q --no-install-recommends "${missing[@]}" >/dev/null
fi

# Results of earlier builds serve every checkout, wherever it lies.
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=true
cmake --preset "$preset" -DCMAKE_CXX_COMPILER_LAUNCHER=ccache >/dev/null
cmake --build "build/$preset" ${1:+--target "$@"}
