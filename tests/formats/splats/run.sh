#!/usr/bin/env bash
# run.sh SLAMDB: scenes for NeRFs and Gaussian splatting of made atlases with every lens, followed from the points to the
# pixels by scene.py. Exits 77, which ctest reports as skipped, without Python.
set -euo pipefail
here=$(realpath "$(dirname "${BASH_SOURCE[0]}")")
SLAMDB=$(realpath "${1:-build/dev/slamdb}")
command -v python3 >/dev/null || { echo "skipped: python3 is not installed"; exit 77; }
cd "$(mktemp -d)"
trap 'rm -rf "$PWD"' EXIT

fail() { echo "FAILED: $*"; exit 1; }
slamdb() { # exit status 3 is that of losses
  "$SLAMDB" "$@" >slamdb.log 2>&1 || { local status=$?; [ $status = 3 ] || fail "slamdb $* ($status): $(tail -3 slamdb.log)"; }
}
scene() { python3 "$here/scene.py" "$@"; }

prove() { # ATLAS
  echo "-- $1"
  rm -rf model pictures splats nerf
  slamdb convert "$1" model --to colmap
  scene pictures model pictures
  slamdb convert "$1" splats --to 3dgs --images pictures
  scene 3dgs splats model
  slamdb convert "$1" nerf --to nerf --images pictures
  scene nerf nerf model
}

slamdb synthesize pinhole.osa --keyframes 6 --points 300 --features 300
slamdb synthesize fisheye.osa --sensor fisheye --keyframes 6 --points 300 --features 600
slamdb dump pinhole.osa -o pinhole.ndjson
scene bend pinhole.ndjson tangential.ndjson OPENCV -0.06 0.01 0.002 -0.001
scene bend pinhole.ndjson third.ndjson FULL_OPENCV -0.06 0.01 0.002 -0.001 0.004
for name in tangential third; do slamdb convert $name.ndjson $name.osa; done
for name in pinhole tangential third fisheye; do prove $name.osa; done

# A list of `time name` tells the times of files whose names do not.
mkdir named
(cd pictures && for picture in *; do
  number=$((${number:-0} + 1))
  cp "$picture" "../named/frame_$number.ppm"
  echo "${picture%.ppm} frame_$number.ppm"
done) >named/list.txt
slamdb convert fisheye.osa listed --to 3dgs --images named/list.txt
[ -e listed/images/frame_1.png ] || fail "$(ls listed/images)"
echo ok
