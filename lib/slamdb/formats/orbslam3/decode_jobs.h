// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "slamdb/formats/orbslam3/decoder.h"

namespace slamdb::orbslam3 {

// A stretch of the file that can be decoded on its own: one keyframe, or map points that follow each other.
struct DecodeJob {
  std::size_t offset = 0;  // of the first record's members, behind its pointer
  ClassTable classes;      // as it was there
  Place place;
  KeyFrame* keyframe = nullptr;  // where to: one keyframe ...
  MapPoint* points = nullptr;    // ... or that many points
  std::size_t point_count = 0;
};

// Decodes jobs on other threads while the caller looks for more of them. With one thread Finish() does all the work.
// The first failure in file order is thrown by Finish().
template <class Input>
class DecodeTeam {
 public:
  DecodeTeam(const Input& input, bool features, int threads) : input_(input), features_(features) {
    for (int i = 1; i < threads; ++i) helpers_.emplace_back([this] { Work(/*wait=*/true); });
  }
  ~DecodeTeam() { Stop(); }
  DecodeTeam(const DecodeTeam&) = delete;
  DecodeTeam& operator=(const DecodeTeam&) = delete;

  void Add(DecodeJob job) {
    {
      const std::lock_guard lock(mutex_);
      jobs_.push_back(std::move(job));
    }
    if (!helpers_.empty()) available_.notify_one();
  }
  // Helps until all jobs are done.
  void Finish() {
    Work(/*wait=*/false);
    Stop();
    if (failure_) std::rethrow_exception(failure_);
  }
  const PartBytes& part_bytes() const { return part_bytes_; }

 private:
  void Stop() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    available_.notify_all();
    helpers_.clear();
  }

  void Work(bool wait) {
    PartBytes part_bytes{};
    while (true) {
      std::unique_lock lock(mutex_);
      if (wait) available_.wait(lock, [this] { return closed_ || !jobs_.empty(); });
      if (jobs_.empty()) break;
      const DecodeJob job = std::move(jobs_.front());
      jobs_.pop_front();
      lock.unlock();
      try {
        Decode(job, part_bytes);
      } catch (...) {
        const std::lock_guard guard(mutex_);
        if (!failure_ || job.offset < failure_offset_) {
          failure_ = std::current_exception();
          failure_offset_ = job.offset;
        }
      }
    }
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < part_bytes.size(); ++i) part_bytes_[i] += part_bytes[i];
  }

  void Decode(const DecodeJob& job, PartBytes& part_bytes) const {
    Input input = input_;
    input.Seek(job.offset);
    input.place = job.place;
    Decoder<Input> decoder(input, job.classes, features_);
    decoder.Restart();
    if (job.keyframe != nullptr) LayoutKeyFrame(decoder, *job.keyframe);
    for (std::size_t i = 0; i < job.point_count; ++i) {
      if (i > 0) SkipKnownPointer(decoder);
      LayoutMapPoint(decoder, job.points[i]);
    }
    for (std::size_t i = 0; i < part_bytes.size(); ++i) part_bytes[i] += decoder.part_bytes()[i];
  }
  // The pointer in front of a new object whose class has been met before.
  static void SkipKnownPointer(Decoder<Input>& decoder) {
    decoder.input.template Take<std::int16_t>();
    decoder.input.template Take<std::uint32_t>();
    decoder.input.place.id = Id<MapPoint>::kNone;
    ++decoder.input.place.ordinal;
  }

  const Input input_;
  const bool features_;
  std::mutex mutex_;  // guards everything below
  std::condition_variable available_;
  std::deque<DecodeJob> jobs_;
  bool closed_ = false;
  std::exception_ptr failure_;
  std::size_t failure_offset_ = 0;
  PartBytes part_bytes_{};
  std::vector<std::jthread> helpers_;
};

}  // namespace slamdb::orbslam3
