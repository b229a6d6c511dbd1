#!/usr/bin/env bash
# static.sh [SUITE...]: builds the static command, sees that it asks nothing of a system, and runs it where there is nothing else,
# and in clean systems of other releases (default: bullseye, whose glibc 2.31 is Ubuntu 20.04's too).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
. tests/install/clean_system.sh
[ $# -gt 0 ] || set -- bullseye
cmake/build.sh static slamdb_cli
static=$PWD/build/static/slamdb

! readelf -ldW "$static" | grep -E 'INTERP|NEEDED' || fail "it is linked dynamically"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fixtures=(fixtures/session_small_a/session_small_a.osa fixtures/session_small_b/session_small_b.osa)

chroot=$(command -v chroot || true)
# Files, threads, stores with their locks, locales and time, each by a verb that takes them.
try() {
  local where=$1 slamdb=("${@:2}")
  cp "$static" "$where/slamdb"
  mkdir -p "$where/work"
  cp "${fixtures[@]}" "$where/work/"
  head -c 2600000 "${fixtures[0]}" >"$where/work/cut.osa"
  "${slamdb[@]}" check --quiet work/session_small_a.osa
  "${slamdb[@]}" merge -q work/session_small_a.osa work/session_small_b.osa -o work/both.osa
  "${slamdb[@]}" convert -q work/both.osa work/maps.db#both
  "${slamdb[@]}" list work/maps.db >/dev/null
  "${slamdb[@]}" convert -q work/maps.db#both work/back.osa
  cmp "$where/work/both.osa" "$where/work/back.osa"
  "${slamdb[@]}" convert -q work/both.osa work/points.ply
  local picture status=0
  for picture in plot/svg view/html; do  # where they are built in
    "${slamdb[@]}" "${picture%/*}" -q work/both.osa -o "work/both.${picture#*/}" 2>"$folder/log" || grep -q 'was built without' "$folder/log" ||
      { cat "$folder/log"; fail "$picture"; }
  done
  "${slamdb[@]}" recover -q work/cut.osa work/saved.osa 2>/dev/null || status=$?
  [ "$status" = 3 ] || fail "recover: exit status $status"
  (cd "$where/work" && sha256sum both.osa points.ply saved.osa) >"$folder/sums"
  [ -f "$folder/sums_here" ] || mv "$folder/sums" "$folder/sums_here"
  [ ! -f "$folder/sums" ] || cmp "$folder/sums_here" "$folder/sums"
}

mkdir "$folder/here"
try "$folder/here" env -C "$folder/here" LC_ALL=C ./slamdb
[ "$(id -u)" = 0 ] || skip "to run it in other systems takes root; it runs in this one"
mkdir "$folder/empty"
try "$folder/empty" env -i LC_ALL=de_DE.UTF-8 "$chroot" "$folder/empty" /slamdb
echo "It runs in an empty system."
can_make_systems || skip "other releases need debootstrap"
for suite in "$@"; do
  (
    clean_system "$suite"
    try "$root" env -i LC_ALL=de_DE.UTF-8 "$chroot" "$root" /slamdb
    echo "It runs in $suite: $(inside ldd --version | head -n 1)."
  )
done
