#!/usr/bin/env bash
# mrpt.sh [PRESET]: installs MRPT 2 (Debian 12: 190 packages, 85 MB to fetch, 310 MB on disk) and exchanges landmark files
# with it in both directions, sees which way its landmarks face, and fuses the same maps by it and by slamdb.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=${1:-dev}
if ! dpkg-query -W -f '${Status}' libmrpt-vision-dev 2>/dev/null | grep -q 'ok installed'; then
  root=(); [ "$(id -u)" = 0 ] || root=(sudo)
  "${root[@]}" apt-get update -q >/dev/null
  DEBIAN_FRONTEND=noninteractive "${root[@]}" apt-get install -y -q --no-install-recommends libmrpt-vision-dev >/dev/null
fi
cmake/build.sh "$preset" mrpt_exchange_test
"build/$preset/tests/formats/mrpt/mrpt_exchange_test"
