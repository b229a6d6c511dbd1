#!/usr/bin/env bash
# run.sh: types, unit tests and browser tests of the page of `slamdb view`. SLAMDB may name the command, SLAMDB_ATLASES a folder
# of large real atlases, SLAMDB_VIEW_SHOTS one for screenshots; SLAMDB_VIEW_TEN_MILLION=1 opens ten million points too.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
for tool in node npm esbuild; do
  if ! command -v "$tool" >/dev/null; then
    echo "skipped: View.PageTypes, View.PageUnit, View.PageBrowser: $tool is not installed"
    exit 0
  fi
done
export SLAMDB_ROOT=$PWD/../../..
page=$SLAMDB_ROOT/lib/slamdb/view/page
build=node_modules/.build
if [ ! -f node_modules/.package-lock.json ] || [ package-lock.json -nt node_modules/.package-lock.json ]; then
  npm ci --no-audit --no-fund --loglevel=error
fi
echo "types"
node_modules/.bin/tsc -p "$page"
node_modules/.bin/tsc -p .
# As the command's build does it (lib/slamdb/view/CMakeLists.txt).
esbuild "$page/main.ts" --bundle --minify --target=es2020 --charset=ascii --log-level=warning --outfile="$build/page.js"
rm -f "$build"/*_test.mjs
esbuild ./*_test.ts --bundle --platform=node --format=esm --target=node18 --log-level=warning \
  --external:playwright-core --outdir="$build" --out-extension:.js=.mjs
[ -z "${SLAMDB:-}" ] || SLAMDB=$(realpath "$SLAMDB")
PAGE_SCRIPT=$PWD/$build/page.js node --test --test-reporter=spec "$build"/*_test.mjs
