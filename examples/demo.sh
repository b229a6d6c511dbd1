#!/usr/bin/env bash
# demo.sh [PRESET]: installs what is missing, builds slamdb, and shows the main job on real ORB-SLAM3 atlases: inspect, check,
# convert, keep in a store, read back.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=${1:-release}
cmake/build.sh "$preset"
export PATH="$PWD/build/$preset:$PATH"
fixtures=$PWD/fixtures
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
cd "$folder"

run() { printf '\n$ %s\n' "$*"; "$@"; }
# For commands whose findings are the point: `expect STATUS COMMAND...`.
expect() {
  local want=$1 status=0; shift
  printf '\n$ %s\n' "$*"; "$@" || status=$?
  printf '(exit status %s)\n' "$status"
  [ "$status" = "$want" ]
}

cp "$fixtures"/session_small_a/session_small_a.osa "$fixtures"/mono_small_twice/mono_small_twice.osa .
run slamdb info session_small_a.osa
run slamdb check session_small_a.osa
expect 1 slamdb check mono_small_twice.osa
run slamdb convert mono_small_twice.osa safe.osa --sanitize
expect 3 slamdb convert session_small_a.osa points.ply
expect 3 slamdb convert session_small_a.osa keyframes.tum
run slamdb convert session_small_a.osa maps.db#lab
run slamdb convert safe.osa maps.db#hall
run slamdb list maps.db
run slamdb convert maps.db#lab back.osa
run cmp session_small_a.osa back.osa
echo
echo "back.osa is session_small_a.osa, byte for byte."
