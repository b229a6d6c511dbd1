#!/usr/bin/env bash
# run.sh SECONDS [FUZZER...]: (FUZZ_SEED=N tries the same inputs each time)
# builds the fuzzers with clang, sanitizers on, and lets each run for so long, from its seeds,
# past finds and what earlier runs in build/fuzz/corpus came upon. Ends with an error at the first find, which is left in
# build/fuzz/finds. Limits: 2 s and 1 GB an input, of at most 64 kB (256 kB where it is an atlas).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
seconds=${1:?how many seconds}
shift
cmake/build.sh fuzz fuzzers
programs=build/fuzz/tests/fuzz
"$programs/fuzz_seeds" build/fuzz/seeds
if [ $# = 0 ]; then
  mapfile -t fuzzers < <(find "$programs" -maxdepth 1 -type f -executable -name 'fuzz_*' ! -name '*_seeds' ! -name '*_replay' -printf '%f\n' | sort)
  set -- "${fuzzers[@]}"
fi
mkdir -p build/fuzz/finds
for fuzzer in "$@"; do
  corpus=$(sed -n "s/^slamdb_fuzzer($fuzzer \([a-z0-9_]*\) .*/\1/p" tests/fuzz/CMakeLists.txt)
  grep -q "^slamdb_fuzzer($fuzzer [a-z0-9_]* ATLASES" tests/fuzz/CMakeLists.txt && length=262144 || length=65536
  folders=("build/fuzz/corpus/$fuzzer" "build/fuzz/seeds/$corpus")
  mkdir -p "${folders[0]}"
  [ ! -d "tests/fuzz/corpus/$corpus" ] || folders+=("tests/fuzz/corpus/$corpus")
  echo "-- $fuzzer"
  UBSAN_OPTIONS=print_stacktrace=1 "$programs/$fuzzer" -max_total_time="$seconds" ${FUZZ_SEED:+-seed=$FUZZ_SEED} -timeout=2 -rss_limit_mb=1024 -max_len=$length \
    -artifact_prefix=build/fuzz/finds/ -print_final_stats=1 -verbosity=0 "${folders[@]}" 2>build/fuzz/finds/log ||
    { tail -n 60 build/fuzz/finds/log; exit 1; }
  sed -n 's/^stat::number_of_executed_units: */   inputs: /p; s/^stat::average_exec_per_sec: */   a second: /p' build/fuzz/finds/log
done
