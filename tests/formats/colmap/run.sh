#!/usr/bin/env bash
# run.sh SLAMDB LOADER [ATLAS...]: COLMAP's own commands on the models and databases that slamdb writes, of the fixtures, of
# made atlases of every sensor, or of the atlases named, and slamdb on what they make of them. Made against COLMAP 3.8 of
# Debian 12, without a screen or a graphics card. Exits 77, which ctest reports as skipped, where it is not installed.
set -euo pipefail
here=$(realpath "$(dirname "${BASH_SOURCE[0]}")")
SLAMDB=$(realpath "$1")
LOADER=$(realpath "$2")  # load_with_boost
fixtures=$(realpath "$here/../../../fixtures")
for program in colmap python3 sqlite3; do
  command -v "$program" >/dev/null || { echo "skipped: $program is not installed"; exit 77; }
done
atlases=()
for atlas in "${@:3}"; do atlases+=("$(realpath "$atlas")"); done
export QT_QPA_PLATFORM=offscreen
cd "$(mktemp -d)"
trap 'rm -rf "$PWD"' EXIT

fail() { echo "FAILED: $*"; exit 1; }
slamdb() { # exit status 3 is that of losses, which are many
  "$SLAMDB" "$@" >slamdb.log 2>&1 || { local status=$?; [ $status = 3 ] || fail "slamdb $* ($status): $(tail -3 slamdb.log)"; }
}
run_colmap() { colmap "$@" >colmap.log 2>&1 || { tail -20 colmap.log; fail "colmap $*"; }; }
error_in_models() { python3 "$here/model.py" error "$@" | cut -d' ' -f1; }
count_in() { python3 "$here/model.py" count "$1" "$2"; }
models_in() { if [ -e "$1/cameras.bin" ]; then echo "$1"; else printf '%s\n' "$1"/[0-9]*; fi; }
error_in_atlas() {
  rm -rf measured
  slamdb convert "$1" measured --to colmap
  mapfile -t models < <(models_in measured)
  error_in_models "${models[@]}"
}
is_at_most() { python3 -c 'import sys; sys.exit(not float(sys.argv[1]) <= float(sys.argv[2]))' "$1" "$2"; }

# What COLMAP reads is what was written, in either form, and what it writes is read as the same atlas.
convert_there_and_back() {
  rm -rf text binary again ours_text again_binary
  local model at
  slamdb convert model ours_text --to colmap-text
  for model in $(models_in model); do
    at=${model#model}
    mkdir -p "text$at" "binary$at" "again_binary$at"
    run_colmap model_analyzer --path "$model"
    grep -q "Registered images: $(count_in "$model" images)" colmap.log || fail "$(cat colmap.log)"
    run_colmap model_converter --input_path "$model" --output_path "text$at" --output_type TXT
    run_colmap model_converter --input_path "text$at" --output_path "binary$at" --output_type BIN
    run_colmap model_converter --input_path "ours_text$at" --output_path "again_binary$at" --output_type BIN
    for theirs in text binary; do
      python3 "$here/model.py" equal "$model" "$theirs$at" || fail "$theirs of $model"
    done
    python3 "$here/model.py" seen "$model" "ours_text$at" 1e-15 || fail "our text of $model"
    python3 "$here/model.py" equal "ours_text$at" "again_binary$at" || fail "COLMAP's form of our text of $model"
    cp "$model"/{rigs,frames}.bin "binary$at/"  # of which COLMAP 3.8 knows nothing
  done
  cp model/database.db binary/
  slamdb convert binary again --to colmap
  for model in $(models_in model); do
    python3 "$here/model.py" seen "$model" "again${model#model}" 1e-6 || fail "what slamdb reads of COLMAP's form of $model"
  done
}

# A bundle adjustment of each model, back onto the atlas.
adjust() { # ATLAS HAS_PAIRS
  rm -rf finer
  local model at before after
  for model in $(models_in model); do
    at=finer${model#model}
    mkdir -p "$at"
    run_colmap bundle_adjuster --input_path "$model" --output_path "$at" --BundleAdjustment.refine_focal_length 0 \
      --BundleAdjustment.refine_extra_params 0
    is_at_most "$(error_in_models "$at")" "$(error_in_models "$model")" ||
      fail "bundle adjustment made $(error_in_models "$model") px $(error_in_models "$at") px"
  done
  [ "$2" = no ] || return 0  # rigs, of which COLMAP 3.8 knows nothing
  slamdb convert finer finer.osa -O --onto "$1"
  grep -q 'put [1-9]' slamdb.log || fail "nothing was put onto $1: $(cat slamdb.log)"
  "$LOADER" finer.osa >/dev/null || fail "stock Boost does not load $1"
  "$SLAMDB" check --quiet finer.osa || fail "$1 is not sound any more: $("$SLAMDB" check finer.osa)"
  before=$(error_in_atlas "$1") after=$(error_in_atlas finer.osa)
  is_at_most "$after" "$before" || fail "$1 of $before px has $after px"
  echo "   adjusted: $before px became $after px"
}

# Points from matches and poses alone. They are numbered anew, and not taken for those of the atlas with these numbers.
triangulate() { # ATLAS HAS_PAIRS
  local model before after
  for model in $(models_in model); do
    rm -rf triangulated
    mkdir -p images triangulated
    run_colmap point_triangulator --database_path model/database.db --image_path images --input_path "$model" \
      --output_path triangulated --clear_points 1
    before=$(count_in "$model" seen)
    run_colmap model_analyzer --path triangulated
    after=$(sed -n 's/^Points: //p' colmap.log)
    [ $((3 * after)) -ge "$before" ] || fail "$model: $after of $before points triangulated"
    if [ "$2" = no ]; then
      slamdb convert triangulated numbered.osa -O --onto "$1"
      grep -q "seen elsewhere" slamdb.log || fail "points of other numbers went onto $1: $(cat slamdb.log)"
    fi
    echo "   triangulated: $after of $before points, $(error_in_models triangulated) px"
  done
}

prove() { # ATLAS
  local model pairs=no
  echo "-- $1"
  rm -rf model
  slamdb convert "$1" model --to colmap --with-database
  for model in $(models_in model); do
    echo "   $(basename "$model"): $(python3 "$here/model.py" error "$model") px of keypoints, and from the errors of points"
    is_at_most "$(python3 "$here/model.py" error "$model" | cut -d' ' -f2)" 0.01 || fail "errors of points"
  done
  convert_there_and_back
  [ "$(sqlite3 model/database.db "SELECT count(*) FROM images WHERE name LIKE 'right/%'")" = 0 ] || pairs=yes
  adjust "$1" $pairs
  triangulate "$1" $pairs
}

if [ ${#atlases[@]} = 0 ]; then
  atlases=("$fixtures/session_small_a/session_small_a.osa")
  for sensor in monocular stereo rgbd fisheye; do
    slamdb synthesize $sensor.osa --sensor $sensor --keyframes 16 --points 1000 --features 700 --maps 2
    atlases+=("$PWD/$sensor.osa")
  done
fi
for atlas in "${atlases[@]}"; do prove "$atlas"; done

# A new map from the matches alone, with descriptors from the database.
slamdb synthesize map.osa --keyframes 16 --points 1000 --features 700
mkdir mapped
slamdb convert map.osa map.colmap.db
run_colmap mapper --database_path map.colmap.db --image_path images --output_path mapped --Mapper.extract_colors 0
[ -e mapped/0/points3D.bin ] || fail "the mapper made no map: $(tail -20 colmap.log)"
slamdb convert mapped mapped.osa --database map.colmap.db
! grep -q "no ORB descriptors" slamdb.log || fail "descriptors of the database are not there"
slamdb vocabulary recompute mapped.osa words.osa --vocabulary "$fixtures/vocabulary/small.txt"
"$LOADER" words.osa
"$SLAMDB" check --quiet words.osa || fail "$("$SLAMDB" check words.osa)"
echo "ok"
