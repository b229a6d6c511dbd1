#!/usr/bin/env bash
# demo.sh [PRESET]: installs what is missing, builds slamdb, and shows the main job on real ORB-SLAM3 atlases: inspect, check,
# repair, convert, keep in a store, read back, merge, recover, compare. It says before what it does.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=${1:-release}
command=build/$preset/slamdb

echo "slamdb, a map database for visual SLAM. This"
missing=$(cmake/packages.sh --missing command pictures optimization server)
[ -z "$missing" ] || echo "  - installs what is missing: $missing"
if [ -x "$command" ]; then
  echo "  - brings $command up to date"
else
  echo "  - builds $command: about seven minutes on two cores, once"
fi
echo "  - shows what it does, on real atlases of ORB-SLAM3: some seconds"
echo
cmake/build.sh "$preset" slamdb_manual
export PATH="$PWD/build/$preset:$PATH"
source=$PWD
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

cp "$source"/fixtures/session_small_[ab]/session_small_[ab].osa "$source"/fixtures/mono_small_twice/mono_small_twice.osa .
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
cat <<END

back.osa is session_small_a.osa, and again.osa mono_small_twice.osa, byte for byte.

What to try next, in $source:
  $command info MAP.osa          # a map of yours
  $command view --open MAP.osa   # look at it in a browser
  $command check MAP.osa         # will ORB-SLAM3 load it?
  $command --help                # all verbs; each has examples in its own --help
  cmake --install build/$preset --component command    # as root: command, man pages and completion, into /usr/local
  tests/run.sh    # all tests; reuses what was compiled here
END
