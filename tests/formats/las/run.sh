#!/usr/bin/env bash
# run.sh SLAMDB: LAS files of the command, read by check_las.py, which knows the specification and nothing of slamdb.
# Exits 77, which ctest reports as skipped, where python3 is missing.
set -euo pipefail
slamdb=$(realpath "${1:-build/dev/slamdb}")
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
command -v python3 >/dev/null || { echo "skipped: python3 is not installed"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

expect() {  # expect WHAT FOUND EXPECTED
  [ "$2" = "$3" ] || { echo "FAILED: $1: found $2, expected $3"; exit 1; }
}

"$slamdb" synthesize map.osa --maps 2 --keyframes 6 --points 400 --quiet
points=$("$slamdb" dump map.osa | grep -c '"type":"map_point"')
check() {  # check ORIGIN EPSG: the map there
  "$slamdb" convert map.osa map.las --origin "$1" --overwrite --quiet
  python3 "$here/check_las.py" map.las >points.txt
  expect "zone at $1" "$(head -1 points.txt)" "epsg $2"
  expect "points at $1" "$(($(wc -l <points.txt) - 1))" "$points"
}
check 48.15,11.57,519 32632
check -33.8568,151.2153,5 32756
check 60.39,5.32,0 32632
check 78.22,15.65,10 32633
# Two maps by their point source, from 0 on.
expect "maps" "$(tail -n +2 points.txt | awk '{print $7}' | sort -u | tr '\n' ' ')" "0 1 "

# A point at the origin is where the grid has it, after PROJ.
printf '0 0 0\n' >origin.xyz
"$slamdb" convert origin.xyz origin.las --origin 48.1372,11.5756,519 --quiet
expect "Munich" "$(python3 "$here/check_las.py" origin.las | awk 'NR == 2 {print $1, $2, $3}')" \
  "691611.2155 5334758.0528 519.0000"

# A map without points, and one beyond the zones.
: | "$slamdb" convert - none.ndjson --from ndjson --quiet 2>/dev/null && { echo "FAILED: nothing was read"; exit 1; }
echo '{"type":"atlas"}' | "$slamdb" convert - none.las --from ndjson --origin 1,2,3 --quiet
python3 "$here/check_las.py" none.las >points.txt
expect "no points" "$(wc -l <points.txt)" 1
if "$slamdb" convert map.osa north.las --origin 85,0,0 --quiet 2>north.txt; then echo "FAILED: beyond the zones"; exit 1; fi
grep -q "no zone above 84 degrees" north.txt || { echo "FAILED: $(cat north.txt)"; exit 1; }
echo "every byte is where the specification has it"
