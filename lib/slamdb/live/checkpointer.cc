// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/checkpointer.h"

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <thread>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "slamdb/live/atlas.h"
#include "slamdb/live/detail/replica.h"
#include "slamdb/live/detail/snapshot.h"

namespace slamdb::live {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

// The atlas's only checkpointer, while it lives.
class Claim {
 public:
  explicit Claim(Atlas& atlas) : atlas_(atlas) {
    if (!Bridge::Claim(atlas))
      throw Error(ErrorKind::kUsage, "the atlas has a checkpointer already; one saves all that changes");
  }
  ~Claim() { Bridge::Release(atlas_); }
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;

 private:
  Atlas& atlas_;
};

}  // namespace

struct Checkpointer::State {
  State(Atlas& source, Location target, CheckpointOptions given)
      : atlas(source), location(std::move(target)), options(std::move(given)), claim(source) {}

  CheckpointReport Save();
  void Run();

  Atlas& atlas;
  const Location location;
  const CheckpointOptions options;
  const Claim claim;

  std::mutex saving;  // one save at a time: the replica and the store
  Replica replica;

  mutable std::mutex mutex;  // what follows
  std::condition_variable wake;
  bool stop = false;
  CheckpointReport last;
  std::optional<std::string> failure;
  std::thread thread;
};

CheckpointReport Checkpointer::State::Save() {
  const std::lock_guard<std::mutex> alone(saving);
  const Clock::time_point begin = Clock::now();
  CheckpointReport report{.number = last.number + 1};
  Snapshot snapshot;
  {
    const ClosedGate closed(atlas.gate());
    snapshot = Bridge::TakeChanges(atlas, report.number == 1, options.threads);
  }
  report.pause = SecondsSince(begin);
  for (const MapSnapshot& map : snapshot.maps) {
    report.keyframes += map.map.keyframes.size() + map.erased_keyframes.size();
    report.points += map.map.points.size() + map.erased_points.size();
  }
  replica.Apply(std::move(snapshot));
  Store store = Store::OpenForWriting(location.path, {.sync = options.sync});
  report.saved =
      store.Save(location.name, replica.atlas(), {.provenance = options.provenance, .threads = options.threads});
  report.duration = SecondsSince(begin);
  const std::lock_guard<std::mutex> lock(mutex);
  failure.reset();
  return last = report;
}

void Checkpointer::State::Run() {
  const auto interval = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.interval));
  Clock::time_point next = Clock::now() + interval;
  std::unique_lock<std::mutex> lock(mutex);
  while (!wake.wait_until(lock, next, [&] { return stop; })) {
    next = std::max(next + interval, Clock::now());
    lock.unlock();
    std::optional<std::string> problem;
    try {
      Save();
    } catch (const std::exception& error) {
      problem = error.what();
    }
    lock.lock();
    if (problem) failure = problem;
  }
}

Checkpointer::Checkpointer(Atlas& atlas, const std::string& location, const CheckpointOptions& options) {
  const Location target = Location::Parse(location);
  constexpr double kLongest = 1e9;  // seconds
  if (!(options.interval >= 0 && options.interval <= kLongest))
    throw Error(ErrorKind::kUsage,
                slamdb::detail::Concat("an interval of ", options.interval, " seconds, expected 0 to 1e9"));
  if (target.name.empty())
    throw Error(ErrorKind::kUsage, target.path, "", "name the atlas in the store to save to, as STORE#NAME");
  if (!target.is_server() && !std::filesystem::exists(target.path) && !FormatOfOutput(target).named)
    throw Error(ErrorKind::kUsage, target.path, "",
                "is not named like a store, which a checkpointer needs; its suffix is .db");
  state_ = std::make_unique<State>(atlas, target, options);
  state_->Save();
  if (options.interval > 0) state_->thread = std::thread([state = state_.get()] { state->Run(); });
}

Checkpointer::~Checkpointer() {
  {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    state_->stop = true;
  }
  state_->wake.notify_all();
  if (state_->thread.joinable()) state_->thread.join();
}

CheckpointReport Checkpointer::Save() { return state_->Save(); }

CheckpointReport Checkpointer::LastSave() const {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  return state_->last;
}

std::optional<std::string> Checkpointer::LastFailure() const {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  return state_->failure;
}

}  // namespace slamdb::live
