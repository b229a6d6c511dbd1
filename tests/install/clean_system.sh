# Sourced by the tests that install into a clean system: `clean_system SUITE` makes one in $root, which goes when the script
# ends; `inside COMMAND...` runs in it. DEBOOTSTRAP_MIRROR may name where packages come from. What was fetched of a release is
# kept in build/systems. Exit status 77, as ctest has it, where this cannot be done.
# shellcheck shell=bash

can_make_systems() { [ "$(id -u)" = 0 ] && command -v debootstrap >/dev/null; }

skip() {
  echo "skipped: $1"
  exit 77
}

clean_system() {
  local suite=$1 kept=build/systems/$1.tar
  mkdir -p build/systems
  root=$(mktemp -d)
  trap 'rm -rf "$root"' EXIT
  if [ ! -f "$kept" ]; then
    echo "-- fetching a clean $suite"
    # shellcheck disable=SC2086  # no mirror is no word
    debootstrap --variant=minbase "$suite" "$root" ${DEBOOTSTRAP_MIRROR:-} >"$kept.log" ||
      { tail -n 5 "$kept.log"; skip "no clean $suite is to be had here"; }
    tar -C "$root" -cf "$kept.new" .
    mv "$kept.new" "$kept"
  else
    tar -C "$root" -xf "$kept"
  fi
  chmod 755 "$root"  # for apt's own user
  cp -L /etc/resolv.conf "$root/etc/resolv.conf"
}

inside() { env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive chroot "$root" "$@"; }

fail() {
  echo "FAILED: $1" >&2
  exit 1
}
