// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/parallel.h"

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <new>
#include <system_error>

namespace slamdb::detail {

// Those that this process may run on: fewer than the machine has under taskset, in a container or a batch job.
int ThreadCount(int requested) {
  if (requested > 0) return requested;
  cpu_set_t allowed;
  if (::sched_getaffinity(0, sizeof(allowed), &allowed) == 0) return std::max(1, CPU_COUNT(&allowed));
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

std::vector<std::jthread> StartHelpers(std::size_t count, const std::function<void()>& help) {
  std::vector<std::jthread> helpers;
  try {
    helpers.reserve(count);
    while (helpers.size() < count) helpers.emplace_back(help);
  } catch (const std::system_error&) {  // limits of processes, of a container, of address space
  } catch (const std::bad_alloc&) {
  }
  return helpers;
}

void ParallelFor(std::size_t count, std::size_t grain, int threads,
                 const std::function<void(std::size_t begin, std::size_t end)>& work) {
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t blocks = (count + grain - 1) / grain;
  const std::size_t helpers = std::min<std::size_t>(static_cast<std::size_t>(ThreadCount(threads)), blocks);
  if (helpers <= 1) {
    if (count > 0) work(0, count);
    return;
  }
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto run = [&] {
    for (std::size_t block = next++; block < blocks; block = next++) {
      try {
        work(block * grain, std::min(count, (block + 1) * grain));
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        next = blocks;
      }
    }
  };
  {
    const std::vector<std::jthread> team = StartHelpers(helpers - 1, run);
    run();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace slamdb::detail
