// SPDX-License-Identifier: BSD-3-Clause
#include "bench/timing.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

// What valgrind counts begins and ends here, see instructions.py.
#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#else
#define CALLGRIND_START_INSTRUMENTATION
#define CALLGRIND_STOP_INSTRUMENTATION
#endif

namespace slamdb::bench {
namespace {

// Megabytes of this process that are not of a file.
double AnonymousMemory() {
  std::ifstream stream("/proc/self/statm");
  double pages = 0, resident = 0, shared = 0;
  stream >> pages >> resident >> shared;
  return (resident - shared) * static_cast<double>(sysconf(_SC_PAGESIZE)) * 1e-6;
}

}  // namespace

Sample Time(const std::function<void()>& work) {
  CALLGRIND_START_INSTRUMENTATION;  // nothing where valgrind does not watch
  const auto begin = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  CALLGRIND_STOP_INSTRUMENTATION;
  return {.seconds = seconds.count()};
}

Sample WatchMemory(const std::function<void()>& work) {
  const double before = AnonymousMemory();
  std::atomic<bool> done = false;
  double peak = 0;
  std::thread watcher([&] {
    while (!done) {
      peak = std::max(peak, AnonymousMemory());
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  Sample sample = Time(work);
  peak = std::max(peak, AnonymousMemory());
  done = true;
  watcher.join();
  sample.peak_megabytes = peak - before;
  return sample;
}

}  // namespace slamdb::bench
