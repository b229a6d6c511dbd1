#!/usr/bin/env bash
# demo.sh [PRESET]: installs what is missing, builds slamdb, and shows the main job on real ORB-SLAM3 atlases: inspect, check,
# repair, convert, keep in a store, read back, merge, recover, compare.
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

cp "$fixtures"/session_small_[ab]/session_small_[ab].osa "$fixtures"/mono_small_twice/mono_small_twice.osa .
run slamdb info session_small_a.osa
run slamdb check session_small_a.osa
expect 1 slamdb check mono_small_twice.osa
run slamdb repair mono_small_twice.osa fixed.osa --journal fix.json
run slamdb check fixed.osa
run slamdb repair --undo fix.json fixed.osa again.osa
run cmp mono_small_twice.osa again.osa
run slamdb convert session_small_a.osa points.ply
run slamdb convert session_small_a.osa keyframes.tum
run slamdb convert session_small_a.osa maps.db#lab
run slamdb convert fixed.osa maps.db#hall
run slamdb list maps.db
run slamdb convert maps.db#lab back.osa
run cmp session_small_a.osa back.osa

run slamdb merge session_small_a.osa session_small_b.osa -o both.osa
run slamdb check both.osa
expect 1 slamdb diff session_small_a.osa both.osa
head -c 2600000 session_small_a.osa > cut.osa
expect 1 slamdb info cut.osa
expect 3 slamdb recover cut.osa saved.osa
run slamdb check saved.osa
echo
echo "back.osa is session_small_a.osa, and again.osa mono_small_twice.osa, byte for byte."
