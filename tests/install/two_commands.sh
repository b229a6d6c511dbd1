#!/usr/bin/env bash
# two_commands.sh: after examples/demo.sh, what would tests/run.sh compile? Nothing of the library and the command again.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
cmake --build build/release --target slamdb_cli >/dev/null
cmake --preset release -DSLAMDB_BUILD_TESTS=ON -DSLAMDB_BUILD_EXAMPLES=ON >/dev/null
left=$(cmake --build build/release -- -n)
if grep -q 'Re-' <<<"$left"; then
  echo "ninja asks CMake first, and so cannot tell what is left (CONFIGURE_DEPENDS?)" >&2
  exit 1
fi
again=$(grep -E 'Building CXX object (lib|cli)/' <<<"$left" | grep -vE 'lib/slamdb/live/' || true)
if [ -n "$again" ]; then
  printf 'tests/run.sh compiles anew what examples/demo.sh compiled:\n%s\n' "$again" >&2
  exit 1
fi
# And the first again finds all done.
if cmake --preset release >/dev/null && cmake --build build/release --target slamdb_manual -- -n | grep -q 'Building CXX'; then
  echo "examples/demo.sh compiles anew what tests/run.sh compiled" >&2
  exit 1
fi
