#!/usr/bin/env bash
# run.sh SECONDS [FUZZER...]: (FUZZ_SEED=N tries the same inputs each time)
# builds the fuzzers with clang, sanitizers on, and lets each run for so long, one on each core, from its seeds,
# past finds and what earlier runs in build/clang/fuzz/corpus came upon. Ends with an error at a find, which is left in
# build/clang/fuzz/finds. Limits: 10 s and 1 GB an input, of at most 64 kB (256 kB where it is an atlas).
# Those that look for layouts (LAYOUTS in CMakeLists.txt), which takes a minute an input under sanitizers, run where they are named.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
export seconds=${1:?how many seconds} programs=build/clang/tests/fuzz work=build/clang/fuzz
shift
cmake/build.sh clang fuzzers
"$programs/fuzz_seeds" "$work/seeds"
if [ $# = 0 ]; then
  mapfile -t fuzzers < <(find "$programs" -maxdepth 1 -type f -executable -name 'fuzz_*' ! -name '*_seeds' ! -name '*_replay' -printf '%f\n' | sort)
  mapfile -t slow < <(sed -n 's/^slamdb_fuzzer(\([a-z0-9_]*\) .*LAYOUTS.*/\1/p' tests/fuzz/CMakeLists.txt)
  echo "not run, since they were not named: ${slow[*]}"
  mapfile -t fuzzers < <(printf '%s\n' "${fuzzers[@]}" | grep -vxF "$(printf '%s\n' "${slow[@]}")")
  set -- "${fuzzers[@]}"
fi
mkdir -p "$work/finds"

fuzz() {
  local fuzzer=$1 log=$work/finds/$1.log corpus length limit folders
  corpus=$(sed -n "s/^slamdb_fuzzer($fuzzer \([a-z0-9_]*\) .*/\1/p" tests/fuzz/CMakeLists.txt)
  grep -q "^slamdb_fuzzer($fuzzer [a-z0-9_]* ATLASES" tests/fuzz/CMakeLists.txt && length=262144 || length=65536
  grep -q "^slamdb_fuzzer($fuzzer .*LAYOUTS" tests/fuzz/CMakeLists.txt && limit=120 || limit=10
  folders=("$work/corpus/$fuzzer" "$work/seeds/$corpus")
  mkdir -p "${folders[0]}"
  [ ! -d "tests/fuzz/corpus/$corpus" ] || folders+=("tests/fuzz/corpus/$corpus")
  UBSAN_OPTIONS=print_stacktrace=1 "$programs/$fuzzer" -max_total_time="$seconds" ${FUZZ_SEED:+-seed=$FUZZ_SEED} -timeout=$limit -rss_limit_mb=1024 \
    -max_len=$length -artifact_prefix="$work/finds/" -print_final_stats=1 -verbosity=0 "${folders[@]}" 2>"$log" ||
    { printf -- '-- %s\n' "$fuzzer"; tail -n 60 "$log"; exit 255; }  # with which xargs begins no other
  sed -n "s/^stat::number_of_executed_units: */-- $fuzzer: inputs /p" "$log"
  rm "$log"
}
export -f fuzz
printf '%s\n' "$@" | xargs -P "$(nproc)" -I{} bash -euo pipefail -c 'fuzz {}'
