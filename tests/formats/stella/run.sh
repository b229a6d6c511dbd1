#!/usr/bin/env bash
# run.sh SLAMDB: reads the maps of stella_vslam that the command writes with programs that are neither: a MessagePack
# library (Python's, or npm's where that is missing) and sqlite3. Exits 77, which ctest reports as skipped, where there
# is none.
set -euo pipefail
slamdb=$(realpath "${1:-build/dev/slamdb}")
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
atlas=$here/../../../fixtures/session_small_a/session_small_a.osa
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for program in sqlite3 python3; do
  command -v "$program" >/dev/null || { echo "skipped: $program is not installed"; exit 77; }
done
"$slamdb" convert "$atlas" "$folder/map.msg" 2>/dev/null || [ $? = 3 ]
"$slamdb" convert "$atlas" "$folder/map.stella.db" 2>/dev/null || [ $? = 3 ]

python=python3
python3 -c 'import msgpack' 2>/dev/null || python=/usr/bin/python3  # which Debian's packages are for
if "$python" -c 'import msgpack' 2>/dev/null; then
  "$python" "$here/summary.py" "$folder/map.msg" >"$folder/summary"
elif command -v npm >/dev/null && (cd "$folder" && npm install --no-audit --no-fund --ignore-scripts @msgpack/msgpack@3.0.0 >/dev/null 2>&1); then
  cp "$here/summary.mjs" "$folder"
  node "$folder/summary.mjs" "$folder/map.msg" >"$folder/summary"
else
  echo "skipped: neither python3-msgpack nor npm's @msgpack/msgpack are there"
  exit 77
fi
"$slamdb" dump "$atlas" | python3 "$here/expected.py" >"$folder/expected"
diff "$folder/expected" "$folder/summary"

[ "$(sqlite3 "$folder/map.stella.db" 'PRAGMA integrity_check')" = ok ]
keyframes=$(sqlite3 "$folder/map.stella.db" \
  'SELECT count(*), sum(n_keypts), sum(length(undist_keypts)) / 28, sum(length(descs)) / 32 FROM keyframes')
echo "$keyframes" | awk -F'|' '{ exit !($1 > 0 && $2 == $3 && $3 == $4) }'
head -1 "$folder/summary" | grep -q "^keyframes ${keyframes%%|*} keypoints $(echo "$keyframes" | cut -d'|' -f2) "
sqlite3 "$folder/map.stella.db" 'SELECT count(*) FROM landmarks' | grep -qx "$(sed -n 's/^landmarks \([0-9]*\) .*/\1/p' "$folder/summary")"
echo "read alike: $(head -1 "$folder/summary")"
