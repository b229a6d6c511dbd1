#!/usr/bin/env bash
# run.sh SLAMDB: reads what the command writes for other viewers with the readers and validators of those formats, which
# npm fetches (package-lock.json pins them). Exits 77, which ctest reports as skipped, where node or npm are missing.
set -euo pipefail
SLAMDB=$(realpath "${1:-build/dev/slamdb}"); export SLAMDB
cd "$(dirname "${BASH_SOURCE[0]}")"
for program in node npm; do
  if ! command -v "$program" >/dev/null; then echo "skipped: $program is not installed"; exit 77; fi
done
if [ ! -e node_modules/.package-lock.json ] || [ package-lock.json -nt node_modules/.package-lock.json ]; then
  npm ci --omit-lockfile-registry-resolved --no-audit --no-fund --ignore-scripts >/dev/null ||
    { echo "skipped: npm cannot fetch the readers"; exit 77; }
fi
exec node --test ./*.test.mjs
