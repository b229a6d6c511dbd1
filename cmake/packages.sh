#!/usr/bin/env bash
# packages.sh [--missing] GROUP...: installs the Debian packages of these groups that are missing; --missing prints their
# names instead. Where all are there, nothing is asked of apt or of the network.
set -euo pipefail

declare -A packages=(
  # What the command is built with.
  [command]="g++ cmake ninja-build libeigen3-dev libsqlite3-dev libcli11-dev nlohmann-json3-dev libxxhash-dev libmd-dev zlib1g-dev"
  # Its page, its plots, and features of pictures, without which everything else is built.
  [pictures]="esbuild libcairo2-dev fonts-dejavu-core libopencv-features2d-dev libopencv-imgproc-dev libpng-dev libturbojpeg0-dev"
  # Bundle adjustment, likewise.
  [optimization]="libceres-dev"
  # Stores on servers, likewise.
  [server]="libpq-dev"
  # The live map, and archives of Boost.
  [libraries]="libopencv-core-dev libboost-serialization-dev"
  # The module for Python, and its tests.
  [python]="python3-dev pybind11-dev python3-numpy python3-pytest"
  # What examples in Python use besides: plots, many machines. Their tests skip what is not there.
  [examples]="python3-matplotlib python3-distributed"
  # What the module goes with: matrices, tables, notebooks, wheels. Its tests skip likewise.
  [notebooks]="python3-scipy python3-pandas python3-tqdm python3-nbformat python3-nbconvert python3-nbclient python3-ipykernel python3-pip"
  # What cpack makes packages with.
  [packaging]="file dpkg-dev"
  [tests]="ccache pkg-config libgtest-dev libgmock-dev sqlite3 protobuf-compiler python3-msgpack mandoc file dpkg-dev"
  # A server for tests, a pool in front of it, certificates for it: tests skip what needs one that is not to be had.
  [postgresql]="postgresql pgbouncer openssl"
  # What tells which libraries a static Cairo is made of.
  [static]="pkg-config"
  # What .ci/run adds: another compiler and what looks at sources and at running programs, a browser, clean systems to install into.
  [checkers]="clang clang-format clang-tidy libclang-rt-dev mypy shellcheck valgrind xz-utils"
  [browser]="chromium"
  [node]="nodejs npm"
  [systems]="debootstrap lintian"
  # Other programs that read what slamdb writes; tests/formats/*/run.sh skip what is not there.
  [readers]="colmap pcl-tools python3-numpy"
)
optional=" ${packages[pictures]} ${packages[optimization]} ${packages[server]} ${packages[postgresql]} ${packages[libraries]} ${packages[python]} ${packages[examples]} "  # a distribution that lacks one builds without it

only_tell=no
[ "${1:-}" != --missing ] || { only_tell=yes; shift; }
wanted=()
for group in "$@"; do
  read -ra names <<<"${packages[$group]:?no such group}"
  wanted+=("${names[@]}")
done

if ! command -v dpkg-query >/dev/null; then  # not Debian: CMake says what it does not find
  [ "$only_tell" = yes ] || echo "No dpkg here: install what these Debian packages are made of: ${wanted[*]}"
  exit 0
fi
there=" $(dpkg-query -W -f '${Package}=${db:Status-Status} ' "${wanted[@]}" 2>/dev/null || true)"
missing=()
for package in "${wanted[@]}"; do
  case "$there ${missing[*]/%/=installed} " in *" $package=installed "*) ;; *) missing+=("$package") ;; esac
done
if [ "$only_tell" = yes ]; then
  echo "${missing[*]}"
  exit 0
fi
[ ${#missing[@]} -gt 0 ] || exit 0

by_hand() {
  printf '%s\nAs root:\n  apt-get update && apt-get install -y --no-install-recommends %s\n' "$1" "${missing[*]}" >&2
  exit 1
}
root=(env)
if [ "$(id -u)" != 0 ]; then
  command -v sudo >/dev/null || by_hand "Packages are missing, and here is neither root nor sudo to install them."
  sudo -v || by_hand "Packages are missing, and sudo does not let this account install them."
  root=(sudo env)
fi
root+=(DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8)

log=$(mktemp)
trap 'rm -f "$log"' EXIT
# Apt's own status, on one line of a terminal, or a line a third of the way.
progress() {
  local kind percent what third told=
  while IFS=: read -r kind _ percent what; do
    case $kind in dlstatus | pmstatus) ;; *) continue ;; esac
    percent=${percent%%.*}
    third="$kind $((percent / 34))"
    if [ -t 1 ]; then
      printf '\r\033[K  %3d%% %.70s' "$percent" "$what"
    elif [ "$third" != "$told" ]; then
      told=$third
      printf '  %3d%% %s\n' "$percent" "$what"
    fi
  done
  [ ! -t 1 ] || printf '\r\033[K'
}

"${root[@]}" apt-get -qq update >>"$log" 2>&1 || true  # what it cannot fetch may be here from before
available=()
for package in "${missing[@]}"; do
  case $optional in
    *" $package "*)
      apt-cache show "$package" >/dev/null 2>&1 || { echo "Going on without $package, which is not to be had here."; continue; } ;;
  esac
  available+=("$package")
done
[ ${#available[@]} -gt 0 ] || exit 0
echo "Installing ${available[*]}"
# Its status on a descriptor of its own, which sudo would close: what packages print as they are set up needs the first two.
if ! "${root[@]}" sh -c 'exec apt-get -qq -o Dpkg::Use-Pty=0 -o APT::Status-Fd=3 install -y --no-install-recommends "$@" 3>&1 1>&2' \
  apt-get "${available[@]}" 2>>"$log" </dev/null | progress; then
  tail -n 20 "$log" >&2
  by_hand "apt-get could not install them: see above."
fi
