#!/usr/bin/env bash
# run.sh SLAMDB: what the command writes as osmap, read by protoc (Debian's protobuf-compiler), and what protoc encodes of
# that, read by the command. Exits 77, which ctest reports as skipped, where protoc is missing.
set -euo pipefail
slamdb=$(realpath "${1:-build/dev/slamdb}")
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
command -v protoc >/dev/null || { echo "skipped: protoc is not installed"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

expect() {  # expect WHAT FOUND EXPECTED
  [ "$2" = "$3" ] || { echo "FAILED: $1: found $2, expected $3"; exit 1; }
}
count() { grep -c "^$1" "$2" || true; }

"$slamdb" synthesize map.osa --keyframes 12 --points 300 --quiet
status=0; "$slamdb" convert map.osa map.yaml --quiet || status=$?
expect "status of the conversion, which loses what ORB-SLAM2 has not" "$status" 3
for part in mappoints:MappointArray keyframes:KeyframeArray features:KeyframeFeaturesArray; do
  file=map.${part%%:*}
  protoc --proto_path="$here" --decode="${part##*:}" "$here/osmap.proto" <"$file" >"$file.txt"
  if grep -qE '^ *[0-9]+:' "$file.txt"; then echo "FAILED: $file has fields that the schema does not know"; exit 1; fi
  protoc --proto_path="$here" --encode="${part##*:}" "$here/osmap.proto" <"$file.txt" >"again.${file#map.}"
done
expect "keyframes" "$(count 'keyframe {' map.keyframes.txt)" 12
expect "keyframes with features" "$(count 'features {' map.features.txt)" 12
expect "map points" "$(count 'mappoint {' map.mappoints.txt)" "$("$slamdb" dump map.osa | grep -c '"type":"map_point"')"

# The messages as protoc encodes them stand for the same map.
sed 's/map\./again./' map.yaml >again.yaml
for name in map again; do "$slamdb" convert $name.yaml $name.ndjson --quiet; done
cmp map.ndjson again.ndjson
echo "protoc $(protoc --version | grep -oE '[0-9.]+$') reads and writes the same map"
