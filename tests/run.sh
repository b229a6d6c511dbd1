#!/usr/bin/env bash
# run.sh [PRESET]: installs what is missing, builds slamdb with its tests, and runs them all. Without PRESET in the folder of
# examples/demo.sh, whose objects serve; developers take `dev`, where warnings are errors.
# SLAMDB_ATLASES may name a folder of large real atlases (*.osa); tests over them are skipped by name without it.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=${1:-release}
echo "This installs what is missing, builds slamdb with all its tests in build/$preset, and runs them: a quarter of an hour on two"
echo "cores the first time, some minutes after that."
cmake/build.sh --tests "$preset"
ctest --test-dir "build/$preset" --output-on-failure --progress -j "$(nproc)"
