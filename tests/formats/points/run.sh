#!/usr/bin/env bash
# run.sh SLAMDB: what the command writes as PLY and PCD, through PCL's own programs (Debian's pcl-tools) and back. Exits
# 77, which ctest reports as skipped, where they are missing.
set -euo pipefail
slamdb=$(realpath "${1:-build/dev/slamdb}")
for program in pcl_ply2pcd pcl_pcd2ply pcl_convert_pcd_ascii_binary; do
  command -v $program >/dev/null || { echo "skipped: $program is not installed"; exit 77; }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

fail() { echo "FAILED: $1"; exit 1; }
lines() {  # lines FILE: the points of a cloud, as lines that compare
  "$slamdb" convert "$1" - --to ndjson --quiet 2>/dev/null | grep '"type":"map_point"' || true
}
places() {  # of a cloud, in the order of its rows
  "$slamdb" convert "$1" - --to xyz --quiet 2>/dev/null
}
same() {  # same WHAT FOUND EXPECTED, files
  cmp -s "$2" "$3" || { diff "$2" "$3" | head -6; fail "$1"; }
}

"$slamdb" synthesize map.osa --maps 2 --keyframes 8 --points 600 --quiet
places map.osa >expected.xyz
[ "$(wc -l <expected.xyz)" -gt 1000 ] || fail "too few points to tell"

# All fields through PCL's programs that pass them on: ascii, binary, compressed.
"$slamdb" convert map.osa ours.pcd --quiet
lines ours.pcd >expected.txt
pcl_convert_pcd_ascii_binary ours.pcd ascii.pcd 0 9 >/dev/null 2>&1
pcl_convert_pcd_ascii_binary ours.pcd binary.pcd 1 >/dev/null 2>&1
pcl_convert_pcd_ascii_binary ours.pcd compressed.pcd 2 >/dev/null 2>&1
for form in ascii binary compressed; do
  grep -aq "^DATA $form\|^DATA binary_$form" $form.pcd || fail "PCL wrote no $form"
  lines $form.pcd >found.txt
  same "PCD, $form of PCL's" found.txt expected.txt
done
"$slamdb" convert map.osa text.pcd --ascii --quiet
pcl_convert_pcd_ascii_binary text.pcd text_compressed.pcd 2 >/dev/null 2>&1
lines text_compressed.pcd >found.txt
same "PCD, our text compressed by PCL" found.txt expected.txt

# PLY to PCD and back, of all fields, both ways and both encodings.
for ascii in "" --ascii; do
  # shellcheck disable=SC2086
  "$slamdb" convert map.osa ours.ply $ascii --overwrite --quiet
  pcl_ply2pcd ours.ply from_ply.pcd >/dev/null 2>&1
  lines from_ply.pcd >found.txt
  same "PLY $ascii that PCL made a PCD of" found.txt expected.txt
done
pcl_pcd2ply -format 1 -use_camera 0 ours.pcd from_pcd.ply >/dev/null 2>&1
places from_pcd.ply >found.xyz
same "PCD that PCL made a PLY of" found.xyz expected.xyz
# As text PCL writes six digits of each number.
pcl_pcd2ply -format 0 -use_camera 0 ours.pcd text.ply >/dev/null 2>&1
places text.ply | paste -d ' ' - expected.xyz >both.txt
awk 'function far(a, b) { d = a - b; return d * d > 1e-10 * (1 + b * b) }
  NF != 6 || far($1, $4) || far($2, $5) || far($3, $6) { exit 1 }' both.txt || fail "PLY of PCL as text"
pcl_pcd2ply -format 1 -use_camera 1 ours.pcd camera.ply >/dev/null 2>&1
status=0; "$slamdb" convert camera.ply camera.db --quiet 2>/dev/null || status=$?
[ $status = 3 ] || fail "an element camera is left out with status $status, expected 3"
places camera.ply >found.xyz
same "PLY of PCL with an element camera" found.xyz expected.xyz
echo "PCL reads what is written, and what it writes is read"
