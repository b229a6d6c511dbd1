// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/each.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <numeric>
#include <string_view>

#include "slamdb/base/detail/file_size.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/formats/formats.h"

namespace slamdb {
namespace {

// How many of several are done, told one at a time.
class Done {
 public:
  Done(const Progress& progress, std::size_t count) : progress_(progress), count_(count) {}

  // Throws what the listener throws, to end the work.
  void Tell(std::size_t more = 0) {
    if (!progress_) return;
    const std::lock_guard lock(mutex_);
    done_ += more;
    progress_(std::to_string(done_) + " of " + std::to_string(count_),
              static_cast<double>(done_) / static_cast<double>(count_));
  }

 private:
  const Progress& progress_;
  const std::size_t count_;
  std::mutex mutex_;
  std::size_t done_ = 0;
};

// Lets rows through in their order, and keeps who is far ahead waiting.
class Order {
 public:
  Order(const std::function<void(std::size_t row)>& take, std::size_t most) : take_(take), done_(most) {}

  // False: another row has failed, and there is nothing to do any more.
  bool Begin(std::size_t row) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return failed_ || row < next_ + done_.size(); });
    return !failed_;
  }
  // Throws what `take` throws; no row is taken behind that one.
  void End(std::size_t row) {
    const std::lock_guard lock(mutex_);
    done_[row % done_.size()] = 1;
    for (std::uint8_t* done = &done_[next_ % done_.size()]; *done != 0 && !failed_;
         done = &done_[next_ % done_.size()]) {
      *done = 0;
      Take(next_++);
    }
    changed_.notify_all();
  }
  void Fail() {
    const std::lock_guard lock(mutex_);
    failed_ = true;
    changed_.notify_all();
  }

 private:
  // Fails before the lock is let go of: else another thread would take the next row.
  void Take(std::size_t row) {
    try {
      take_(row);
    } catch (...) {
      failed_ = true;
      throw;
    }
  }

  const std::function<void(std::size_t row)>& take_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t next_ = 0;
  std::vector<std::uint8_t> done_;  // rows from next_ on, in a ring
  bool failed_ = false;
};

}  // namespace

void ForEachRow(std::size_t count, const ReadOptions& read,
                const std::function<void(std::size_t row, const ReadOptions& read)>& work) {
  if (count == 1) return work(0, read);
  Done done(read.progress, count);
  ReadOptions own = read;
  if (read.progress) own.progress = [&done](std::string_view, double) { done.Tell(); };
  own.threads = std::max(1, detail::ThreadCount(read.threads) / static_cast<int>(std::max<std::size_t>(count, 1)));
  detail::ParallelFor(count, 1, read.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      work(row, own);
      done.Tell(1);
    }
  });
}

void ForEachRow(std::size_t count, const ReadOptions& read,
                const std::function<void(std::size_t row, const ReadOptions& read)>& work,
                const std::function<void(std::size_t row)>& take) {
  constexpr std::size_t kAhead = 16;  // rows for each thread
  Order order(take, kAhead * static_cast<std::size_t>(detail::ThreadCount(read.threads)));
  ForEachRow(count, read, [&](std::size_t row, const ReadOptions& own) {
    if (!order.Begin(row)) return;
    try {
      work(row, own);
      order.End(row);
    } catch (...) {
      order.Fail();
      throw;
    }
  });
}

std::vector<std::uint8_t> FindLarge(std::span<const AtlasInput> inputs, int threads) {
  std::vector<std::uintmax_t> bytes;
  for (const AtlasInput& input : inputs) {
    const bool is_file = input.location.name.empty() && !input.atlas;
    bytes.push_back(is_file ? detail::FileSize(input.location.path).value_or(0)
                            : 0);  // what is none, reading finds out
  }
  const auto share = std::accumulate(bytes.begin(), bytes.end(), std::uintmax_t{0}) /
                     static_cast<std::uintmax_t>(detail::ThreadCount(threads));
  std::vector<std::uint8_t> is_large;
  for (const std::uintmax_t each : bytes) is_large.push_back(each > share ? 1 : 0);
  return is_large;
}

std::shared_ptr<const Atlas> AtlasOf(const AtlasInput& input, ReadOptions read, Notices& notices) {
  if (input.atlas) return input.atlas;
  read.needs = Content::kObservations | Content::kLandmarks;
  return std::make_shared<const Atlas>(ReadAtlas(input.location, read, &notices));
}

}  // namespace slamdb
