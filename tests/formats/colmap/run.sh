#!/usr/bin/env bash
# run.sh SLAMDB: COLMAP's own commands on the models and databases that slamdb writes, and slamdb on what they make of
# them. Made against COLMAP 3.8 of Debian 12, without a screen. Exits 77, which ctest reports as skipped, without it.
set -euo pipefail
SLAMDB=$(realpath "${1:-build/dev/slamdb}")
command -v colmap >/dev/null || { echo "skipped: colmap is not installed"; exit 77; }
export QT_QPA_PLATFORM=offscreen
cd "$(mktemp -d)"
trap 'rm -rf "$PWD"' EXIT

fail() { echo "FAILED: $*"; exit 1; }
slamdb() { # exit status 3 is that of losses, which are many
  "$SLAMDB" "$@" 2>>slamdb.log || { local status=$?; [ $status = 3 ] || fail "slamdb $* ($status): $(tail -3 slamdb.log)"; }
}
colmap_run() { colmap "$@" >colmap.log 2>&1 || { tail -20 colmap.log; fail "colmap $*"; }; }
# The mean reprojection error that info tells, in millionths.
error_of() { "$SLAMDB" info "$1" --json | python3 -c 'import json, sys; print(round(1e6 * json.load(sys.stdin)["maps"][0]["reprojection"]["mean"]))'; }

for sensor in mono stereo fisheye-stereo; do
  slamdb synthesize map.osa -O --sensor $sensor --keyframes 20 --points 1500 --features 600
  rm -rf model text binary finer triangulated
  mkdir images text binary finer triangulated 2>/dev/null || mkdir text binary finer triangulated
  slamdb convert map.osa model --to colmap --with-database
  images=20; [ $sensor = fisheye-stereo ] && images=40

  colmap_run model_analyzer --path model
  grep -q "Registered images: $images" colmap.log || fail "$sensor: $(cat colmap.log)"

  # There and back: the same atlas, but for quaternions, which COLMAP makes units of.
  colmap_run model_converter --input_path model --output_path text --output_type TXT
  colmap_run model_converter --input_path text --output_path binary --output_type BIN
  slamdb convert model ours.osa -O
  for theirs in text binary; do
    rm -rf same && mkdir same && cp model/{rigs,frames}.bin model/database.db same/
    [ $theirs = text ] && slamdb convert model rigs --to colmap-text -O && cp rigs/{rigs,frames}.txt same/ && rm same/*.bin
    cp $theirs/* same/
    slamdb convert same theirs.osa -O
    "$SLAMDB" diff ours.osa theirs.osa --json >diff.json || true
    python3 - <<'PYTHON' || fail "$sensor: $theirs is not what was written: $(cat diff.json)"
import json
diff = json.load(open("diff.json"))
text = json.dumps(diff)
for kind in ("keyframes", "points", "observations", "slots"):
    counts = diff[kind]
    assert counts.get("removed", 0) in (0, []) and counts.get("added", 0) in (0, []), counts
PYTHON
  done

  # Bundle adjustment, and back into the map.
  colmap_run bundle_adjuster --input_path model --output_path finer --BundleAdjustment.refine_focal_length 0 \
    --BundleAdjustment.refine_extra_params 0
  cp model/database.db finer/
  if [ $sensor != fisheye-stereo ]; then  # of whose rigs COLMAP 3.8 knows nothing
    slamdb convert finer finer.osa -O
    [ "$(error_of finer.osa)" -le "$(error_of ours.osa)" ] ||
      fail "$sensor: $(error_of ours.osa) became $(error_of finer.osa)"
  fi

  # Points from the matches and poses alone.
  colmap_run point_triangulator --database_path model/database.db --image_path images --input_path model \
    --output_path triangulated --clear_points 1
  colmap_run model_analyzer --path triangulated
  points=$(sed -n 's/^Points: //p' colmap.log)
  [ "$points" -gt 300 ] || fail "$sensor: $points points triangulated"
  echo "ok $sensor: $points points triangulated"
done

# A new map from the matches alone.
slamdb synthesize map.osa -O --keyframes 20 --points 1500 --features 600
mkdir mapped
slamdb convert map.osa map.colmap.db
colmap_run mapper --database_path map.colmap.db --image_path images --output_path mapped --Mapper.extract_colors 0
[ -e mapped/0/points3D.bin ] || fail "the mapper made no map: $(tail -20 colmap.log)"
slamdb convert mapped mapped.osa --database map.colmap.db
echo "ok mapper"
