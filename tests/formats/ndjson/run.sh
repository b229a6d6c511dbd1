#!/usr/bin/env bash
# run.sh SLAMDB SCRIPT VOCABULARY: the map that the script builds is one that ORB-SLAM3 loads, and a script that changes lines edits
# a map. Exits 77, which ctest reports as skipped, where python3 is missing.
set -euo pipefail
slamdb=$(realpath "${1:-build/dev/slamdb}")
script=$(realpath "${2:-examples/make_map.py}")
vocabulary=$(realpath "${3:-fixtures/vocabulary/small.txt}")
command -v python3 >/dev/null || { echo "skipped: python3 is not installed"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

expect() {  # expect WHAT FOUND EXPECTED
  [ "$2" = "$3" ] || { echo "FAILED: $1: found $2, expected $3"; exit 1; }
}

python3 "$script" | "$slamdb" convert - wall.osa --from ndjson --quiet
"$slamdb" vocabulary recompute wall.osa map.osa --vocabulary "$vocabulary" --quiet
"$slamdb" check map.osa >check.txt || { cat check.txt; exit 1; }
"$slamdb" dump wall.osa >wall.ndjson
expect "keyframes" "$(grep -c '"type":"keyframe"' wall.ndjson)" 12
expect "points" "$(grep -c '"type":"map_point"' wall.ndjson)" "$(python3 "$script" | grep -c '"type": "map_point"')"

# Read once more, every byte is the same.
"$slamdb" convert wall.ndjson again.osa --quiet
cmp wall.osa again.osa

# A script that moves points and renames the vocabulary, and nothing else.
python3 -c '
import json, sys
for line in sys.stdin:
    line = json.loads(line)
    if line["type"] == "atlas":
        line["vocabulary"]["name"] = "mine.txt"
    if line["type"] == "map_point":
        line["position"][2] += 0.5
    print(json.dumps(line))
' <wall.ndjson | "$slamdb" convert - moved.osa --from ndjson --quiet
expect "vocabulary" "$("$slamdb" info moved.osa | sed -n 's/^ *vocabulary *\([^ ]*\).*/\1/p')" mine.txt
"$slamdb" diff wall.osa moved.osa >diff.txt && { echo "FAILED: nothing moved"; exit 1; }
grep -q "points by median 0.5, max 0.5" diff.txt || { cat diff.txt; exit 1; }
grep -q "keyframes: 12 -> 12$" diff.txt || { cat diff.txt; exit 1; }

# An error of a script is told with its line and place.
sed '4s/"timestamp": [^,]*/"timestamp": "noon"/' <(python3 "$script") >wrong.ndjson
if "$slamdb" convert wrong.ndjson wrong.osa --quiet 2>wrong.txt; then echo "FAILED: noon is no time"; exit 1; fi
grep -q 'line 4: timestamp: expected a number' wrong.txt || { cat wrong.txt; exit 1; }
echo "scripts build and edit maps"
