#!/usr/bin/env bash
# packages.sh BUILD: makes the Debian packages of a build folder with cpack, and holds what is in them and what they depend on.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
. tests/install/clean_system.sh
build=${1:-build/release}
for tool in cpack dpkg-deb dpkg-shlibdeps file gzip; do
  command -v "$tool" >/dev/null || skip "packages need $tool"
done

packages=$build/packages
rm -rf "$packages"
(cd "$build" && cpack -B packages) >"$build/cpack.log" 2>&1 || { cat "$build/cpack.log"; fail "cpack"; }

holds() {
  local package=$1 path
  shift
  dpkg-deb -c "$packages/$package"_*.deb | awk '{ print $6 }' >"$build/contents"
  for path in "$@"; do
    grep -qE "^\./usr/$path\$" "$build/contents" || fail "$package lacks $path"
  done
  for path in copyright changelog.gz changelog.Debian.gz; do
    grep -qx "./usr/share/doc/$package/$path" "$build/contents" || fail "$package lacks its $path"
  done
}
lacks() { ! grep -E "$2" "$build/contents" || fail "$1 holds what is not its own"; }
depends() { dpkg-deb -f "$packages/$1"_*.deb Depends; }

holds slamdb bin/slamdb share/man/man1/slamdb.1.gz share/man/man1/slamdb-check.1.gz share/bash-completion/completions/slamdb \
  share/zsh/vendor-completions/_slamdb share/fish/vendor_completions.d/slamdb.fish
[ ! -e "$build/libexec/slamdb/slamdb" ] || holds slamdb libexec/slamdb/slamdb  # what has Cairo, Ceres and OpenCV
lacks slamdb 'include|[.]a$|/cmake/|[.]pc$'
for library in libc6 libstdc++6 libsqlite3-0 zlib1g libmd0; do
  depends slamdb | grep -qF "$library" || fail "slamdb does not depend on $library"
done
! depends slamdb | grep -E 'imgcodecs|gdal|boost|-dev' || fail "slamdb depends on what it does not use"

holds libslamdb-dev include/slamdb/slamdb.h 'lib/.*libslamdb.a' 'lib/.*cmake/slamdb/slamdbConfig.cmake' 'lib/.*pkgconfig/slamdb.pc'
lacks libslamdb-dev 'bin/|man1|/detail/|slamdb/live/atlas.h|libslamdb_live|OpenCV'
! depends libslamdb-dev | grep -E 'opencv-core-dev|imgcodecs' || fail "libslamdb-dev depends on what only the live map uses"
for library in libeigen3-dev libsqlite3-dev zlib1g-dev libmd-dev; do
  depends libslamdb-dev | grep -qF "$library" || fail "libslamdb-dev does not depend on $library"
done

if [ -e "$build/lib/slamdb/live/libslamdb_live.a" ]; then
  holds libslamdb-live-dev include/slamdb/live/atlas.h 'lib/.*libslamdb_live.a' 'lib/.*pkgconfig/slamdb-live.pc'
  version=$(dpkg-deb -f "$packages"/libslamdb-dev_*.deb Version)
  depends libslamdb-live-dev | grep -qF "libslamdb-dev (= $version)" || fail "libslamdb-live-dev is not bound to its libslamdb-dev"
  depends libslamdb-live-dev | grep -q 'libopencv-core-dev' || fail "libslamdb-live-dev does not depend on OpenCV's core"
fi

if compgen -G "$build/python/slamdb/_slamdb.*.so" >/dev/null; then
  holds python3-slamdb lib/python3/dist-packages/slamdb/__init__.py 'lib/python3/dist-packages/slamdb/_slamdb[.].*[.]so' \
    lib/python3/dist-packages/slamdb/_slamdb.pyi lib/python3/dist-packages/slamdb/py.typed
  lacks python3-slamdb 'bin/|include|[.]a$|/tests?/|__pycache__'
  for library in 'python3 (>= 3' python3-numpy libc6 libsqlite3-0; do
    depends python3-slamdb | grep -qF "$library" || fail "python3-slamdb does not depend on $library"
  done
  ! depends python3-slamdb | grep -E 'pandas|scipy|-dev' || fail "python3-slamdb depends on what it can do without"
fi

for package in "$packages"/*.deb; do
  [ -n "$(dpkg-deb -f "$package" Section)" ] || fail "$package has no section"
  dpkg-deb -f "$package" Description | sed -n 2p | grep -q . || fail "$package has no description"
done
if command -v lintian >/dev/null; then
  lintian --allow-root --fail-on error --suppress-tags malformed-contact,maintainer-address-missing "$packages"/*.deb
fi
