// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <vector>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/formats/orbslam3/detail/decoder.h"

namespace slamdb::orbslam3 {

// A stretch of the file that can be decoded on its own: one keyframe, or map points that follow each other.
struct DecodeJob {
  std::size_t offset = 0;  // of the first record's members, behind its pointer
  std::size_t end = 0;     // behind the last one
  ClassTable classes;      // as it was there
  Place place;
  KeyFrame* keyframe = nullptr;  // where to: one keyframe ...
  MapPoint* points = nullptr;    // ... or that many points
  std::size_t point_count = 0;
};

// Decodes jobs on other threads while the caller looks for more of them, and releases the file behind. When too much
// waits the caller decodes too, which bounds the memory that the file takes.
template <class Input>
class DecodeTeam {
 public:
  // `input` is any cursor of the file.
  DecodeTeam(const Input& input, FeatureColumns features, int threads)
      : input_(input),
        features_(features),
        helpers_(detail::StartHelpers(static_cast<std::size_t>(std::max(threads, 1)) - 1, [this] { Help(); })) {}
  ~DecodeTeam() { Stop(); }
  DecodeTeam(const DecodeTeam&) = delete;
  DecodeTeam& operator=(const DecodeTeam&) = delete;

  // Threads beside the caller's.
  std::size_t size() const { return helpers_.size(); }

  void Add(const DecodeJob& job) {
    std::unique_lock lock(mutex_);
    waiting_bytes_ += job.end - job.offset;
    jobs_.push_back(job);
    if (!helpers_.empty()) available_.notify_one();
    while (waiting_bytes_ > kMostWaitingBytes) RunNext(lock);
  }
  // Helps until all jobs are done. Throws the first failure in file order.
  void Finish() {
    {
      std::unique_lock lock(mutex_);
      while (!jobs_.empty()) RunNext(lock);
    }
    Stop();
    if (failure_) std::rethrow_exception(failure_);
  }
  const PartBytes& part_bytes() const { return part_bytes_; }

  // Decodes a job on this thread, `input` being where it begins.
  PartBytes Decode(const DecodeJob& job, Input input) const {
    input.place = job.place;
    Decoder<Input> decoder(input, job.classes, features_);
    decoder.Restart();
    if (job.keyframe != nullptr) LayoutKeyFrame(decoder, *job.keyframe);
    for (std::size_t i = 0; i < job.point_count; ++i) {
      if (i > 0) SkipKnownPointer(decoder);
      LayoutMapPoint(decoder, job.points[i]);
    }
    return decoder.part_bytes();
  }

 private:
  static constexpr std::size_t kMostWaitingBytes = std::size_t{8} << 20;

  struct Started {
    std::size_t end;  // where the job ends in the file
    bool done;
  };

  void Stop() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    available_.notify_all();
    helpers_.clear();
  }

  void Help() {
    std::unique_lock lock(mutex_);
    while (true) {
      available_.wait(lock, [this] { return closed_ || !jobs_.empty(); });
      if (jobs_.empty()) return;
      RunNext(lock);
    }
  }

  // Takes the next job and does it, without holding the lock meanwhile.
  void RunNext(std::unique_lock<std::mutex>& lock) {
    const DecodeJob job = jobs_.front();
    jobs_.pop_front();
    waiting_bytes_ -= job.end - job.offset;
    const std::size_t number = first_started_ + started_.size();
    started_.push_back({job.end, false});
    lock.unlock();
    PartBytes part_bytes{};
    std::exception_ptr failure;
    try {
      part_bytes = Decode(job);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    for (std::size_t i = 0; i < part_bytes.size(); ++i) part_bytes_[i] += part_bytes[i];
    if (failure && (!failure_ || job.offset < failure_offset_)) {
      failure_ = failure;
      failure_offset_ = job.offset;
    }
    ReleaseDone(number);
  }
  // Gives back the file up to the first job that is not done.
  void ReleaseDone(std::size_t number) {
    started_[number - first_started_].done = true;
    std::size_t end = 0;
    for (; !started_.empty() && started_.front().done; ++first_started_) {
      end = started_.front().end;
      started_.pop_front();
    }
    if (end > 0) input_.stream().Release(end);
  }

  PartBytes Decode(const DecodeJob& job) const {
    Input input = input_;
    input.Confine(job.offset, job.end);
    return Decode(job, input);
  }
  // The pointer in front of a new object whose class has been met before.
  static void SkipKnownPointer(Decoder<Input>& decoder) {
    decoder.input.template Take<std::int16_t>();
    decoder.input.template Take<std::uint32_t>();
    decoder.input.place.id = Id<MapPoint>::kNone;
    ++decoder.input.place.ordinal;
  }

  const Input input_;
  const FeatureColumns features_;
  std::mutex mutex_;  // guards everything below
  std::condition_variable available_;
  std::deque<DecodeJob> jobs_;
  std::size_t waiting_bytes_ = 0;  // of the file, in jobs_
  std::deque<Started> started_;    // jobs taken, from the first that is not done
  std::size_t first_started_ = 0;  // its number
  bool closed_ = false;
  std::exception_ptr failure_;
  std::size_t failure_offset_ = 0;
  PartBytes part_bytes_{};
  std::vector<std::jthread> helpers_;
};

}  // namespace slamdb::orbslam3
