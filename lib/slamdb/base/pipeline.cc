// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/pipeline.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <string>
#include <vector>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/pieces.h"

namespace slamdb::detail {
namespace {

template <class Buffer>
class Pipeline {
 public:
  Pipeline(std::size_t count, std::size_t helpers, const MakeBlock<Buffer>& make)
      : count_(count), make_(make), slots_(2 * (helpers + 1)), helpers_(StartHelpers(helpers, [this] { Help(); })) {}
  ~Pipeline() {
    {
      const std::lock_guard lock(mutex_);
      stopped_ = true;
    }
    changed_.notify_all();
    helpers_.clear();
  }
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  // Block `i`, made by a helper or here and now.
  const Buffer& Wait(std::size_t i) {
    Slot& slot = SlotOf(i);
    std::unique_lock lock(mutex_);
    while (!slot.ready) {
      if (next_ < std::min(count_, taken_ + slots_.size()))
        MakeNext(lock);
      else
        changed_.wait(lock);
    }
    if (slot.failure) std::rethrow_exception(slot.failure);
    return slot.buffer;
  }
  void Taken(std::size_t i) {
    {
      const std::lock_guard lock(mutex_);
      SlotOf(i).ready = false;
      taken_ = i + 1;
    }
    changed_.notify_all();
  }

 private:
  struct Slot {
    Buffer buffer;
    std::exception_ptr failure;
    bool ready = false;
  };
  Slot& SlotOf(std::size_t i) { return slots_[i % slots_.size()]; }

  void Help() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return stopped_ || next_ >= count_ || next_ < taken_ + slots_.size(); });
      if (stopped_ || next_ >= count_) return;
      MakeNext(lock);
    }
  }
  // Takes the next block that nobody makes and makes it, without holding the lock meanwhile.
  void MakeNext(std::unique_lock<std::mutex>& lock) {
    const std::size_t i = next_++;
    Slot& slot = SlotOf(i);
    lock.unlock();
    std::exception_ptr failure;
    slot.buffer.clear();
    try {
      make_(i, slot.buffer);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    slot.failure = failure;
    slot.ready = true;
    changed_.notify_all();
  }

  const std::size_t count_;
  const MakeBlock<Buffer>& make_;
  std::vector<Slot> slots_;
  std::mutex mutex_;  // guards what follows, and the slots' `ready` and `failure`
  std::condition_variable changed_;
  std::size_t next_ = 0;   // the first block that nobody makes yet
  std::size_t taken_ = 0;  // blocks handed over
  bool stopped_ = false;
  std::vector<std::jthread> helpers_;
};

}  // namespace

template <class Buffer>
void ProduceInOrder(std::size_t count, int threads, const MakeBlock<Buffer>& make, const TakeBlock<Buffer>& take) {
  if (count == 0) return;
  const std::size_t helpers = std::min<std::size_t>(static_cast<std::size_t>(ThreadCount(threads)), count) - 1;
  Pipeline<Buffer> pipeline(count, helpers, make);
  for (std::size_t i = 0; i < count; ++i) {
    take(i, pipeline.Wait(i));
    pipeline.Taken(i);
  }
}

template void ProduceInOrder<Column<char>>(std::size_t, int, const MakeBlock<Column<char>>&,
                                           const TakeBlock<Column<char>>&);
template void ProduceInOrder<Pieces>(std::size_t, int, const MakeBlock<Pieces>&, const TakeBlock<Pieces>&);
template void ProduceInOrder<std::string>(std::size_t, int, const MakeBlock<std::string>&,
                                          const TakeBlock<std::string>&);

}  // namespace slamdb::detail
