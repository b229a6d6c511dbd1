#!/usr/bin/env bash
# run.sh [PRESET]: installs what is missing, builds slamdb with its tests, and runs them all.
# SLAMDB_ATLASES may name a folder of large real atlases (*.osa); tests over them are skipped by name without it.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=${1:-dev}
cmake/build.sh "$preset"
ctest --test-dir "build/$preset" --output-on-failure -j "$(nproc)"
