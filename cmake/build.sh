#!/usr/bin/env bash
# build.sh [--tests] [PRESET [TARGET...]]: installs the packages that are missing on Debian 12, then configures and builds
# build/PRESET (default: release), all of it or the targets named. --tests: with the tests and examples, in the same folder.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
settings=()
groups=(command pictures optimization server)
if [ "${1:-}" = --tests ]; then
  settings=(-DSLAMDB_BUILD_TESTS=ON -DSLAMDB_BUILD_EXAMPLES=ON -DSLAMDB_BUILD_PYTHON=ON)
  groups+=(libraries python tests postgresql)
  shift
fi
preset=${1:-release}
shift || true

# Each job needs only what it uses.
case "$preset $*" in
  "release slamdb_cli" | "release slamdb_manual") unasked='live map' ;;
  "static "*) groups+=(static) ;;
  "release "*) groups+=(libraries packaging) ;;
  *) groups+=(libraries python tests) ;;
esac
cmake/packages.sh "${groups[@]}"

if command -v ccache >/dev/null; then  # results of earlier builds serve every checkout, wherever it lies
  export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=true
  # A folder that was begun without it goes on without it: another command line would compile everything anew.
  [ -f "build/$preset/CMakeCache.txt" ] || settings+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
fi
cmake --preset "$preset" "${settings[@]}" | sed -n "/${unasked:-^$}/d; s/^-- \(.*building without.*\)/\1/p"

build=(cmake --build "build/$preset" ${1:+--target "$@"})
steps=$("${build[@]}" -- -n | grep -c '^\[' || true)
if [ "$steps" -gt 20 ]; then
  cores=$(nproc)
  # 2.2 s of one busy core a step, see docs/install.md.
  printf 'Building build/%s: %d steps, at most some %d min on %d cores\n' "$preset" "$steps" $(((steps * 22 / 10 / cores + 59) / 60)) "$cores"
fi
# Ninja's own status on a terminal; otherwise a line a tenth of the way, and all that is no status.
if [ -t 1 ]; then
  "${build[@]}"
else
  tenth=0
  "${build[@]}" | while IFS= read -r line; do
    if [[ $line =~ ^\[([0-9]+)/([0-9]+)\]\  ]]; then
      now=$((BASH_REMATCH[1] * 10 / BASH_REMATCH[2]))
      [ "$now" = "$tenth" ] || printf '  %3d%%  %s\n' "$((now * 10))" "${line#*] }"
      tenth=$now
    elif [ "$line" != 'ninja: no work to do.' ]; then
      printf '%s\n' "$line"
    fi
  done
fi
