#!/usr/bin/env bash
# install_packages.sh BUILD: installs the packages that packages.sh made into a clean Debian 12, and uses them there as their
# users do: the command by itself, then a project that links the library, then one with the live map and Boost's archives, then
# the module for Python.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
. tests/install/clean_system.sh
build=${1:-build/release}
can_make_systems || skip "installing packages into a clean system needs root and debootstrap"
tests/install/packages.sh "$build"
clean_system bookworm

mkdir "$root/packages" "$root/work"
cp "$build"/packages/*.deb "$root/packages/"
cp -r tests/install "$root/work/project"
cp examples/{keep_atlas,first_lines,live_map_point,boost_archive}.cc fixtures/session_small_{a/session_small_a,b/session_small_b}.osa "$root/work/"
install_package() {
  echo "-- installing $*"
  inside sh -c "apt-get install -y -qq --no-install-recommends $*" >"$build/apt.log" 2>&1 || { tail -n 20 "$build/apt.log"; fail "apt-get install $*"; }
}
# shellcheck disable=SC2016
has() { inside dpkg-query -W -f '${Package}\n' | grep -q "$1"; }
inside apt-get update -qq >/dev/null

install_package /packages/slamdb_*.deb
! has '^libslamdb-dev\|opencv\|boost\|^g++' || fail "the command alone brought a library or a compiler"
inside sh -ec 'cd /work; slamdb check --quiet session_small_a.osa
  slamdb convert -q session_small_a.osa maps.db#lab; slamdb convert -q maps.db#lab back.osa; cmp session_small_a.osa back.osa'
inside sh -c 'gzip -t /usr/share/man/man1/slamdb*.gz' || fail "manual pages"
inside bash -c '. /usr/share/bash-completion/completions/slamdb; complete -p slamdb' >/dev/null || fail "completion"

build_consumer() {
  inside sh -ec 'rm -rf /work/build
    cmake -S /work/project -B /work/build -G Ninja -DCONSUMER_SOURCE=/work/keep_atlas.cc -DFIRST_LINES_SOURCE=/work/first_lines.cc \
      -DLIVE_CONSUMER_SOURCE=/work/live_map_point.cc -DBOOST_CONSUMER_SOURCE=/work/boost_archive.cc
    cmake --build /work/build' >"$build/consumer.log" 2>&1 || { tail -n 30 "$build/consumer.log"; fail "a project does not build: $1"; }
}
install_package /packages/libslamdb-dev_*.deb g++ cmake ninja-build pkg-config
! has 'opencv\|libboost' || fail "the library brought OpenCV or Boost"
build_consumer "libslamdb-dev alone"
# shellcheck disable=SC2016  # for the shell in there
inside sh -ec 'cd /work; build/first_lines session_small_a.osa session_small_b.osa both.db; slamdb check --quiet both.db#both
  [ ! -e build/live_consumer ]; [ ! -e build/boost_consumer ]
  g++ -std=c++20 first_lines.cc -o by_pkg_config $(pkg-config --cflags --libs slamdb); ./by_pkg_config session_small_a.osa session_small_b.osa again.db'

if compgen -G "$build/packages/libslamdb-live-dev_*.deb" >/dev/null; then
  install_package /packages/libslamdb-live-dev_*.deb libboost-serialization-dev
  build_consumer "with the live map"
  inside sh -ec 'cd /work; build/live_consumer >/dev/null; build/boost_consumer session_small_a.osa . >/dev/null'
fi

if compgen -G "$build/packages/python3-slamdb_*.deb" >/dev/null; then
  install_package /packages/python3-slamdb_*.deb
  inside sh -ec "cd /work; python3 -c '
import pathlib
import slamdb
atlas = slamdb.read(\"session_small_a.osa\")
assert slamdb.check(atlas).sound and len(atlas.maps[0].points.positions) == 3162
with slamdb.Store(\"python.db\") as store:
    store.save(\"lab\", atlas)
    assert slamdb.encode(store.load(\"lab\")) == pathlib.Path(\"session_small_a.osa\").read_bytes()'"
  inside apt-get purge -y -qq python3-slamdb >/dev/null 2>&1
fi

inside apt-get purge -y -qq slamdb libslamdb-dev >/dev/null 2>&1
[ -z "$(inside find /usr -name '*slamdb*')" ] || fail "files are left behind"
echo "The packages install, work, and go."
