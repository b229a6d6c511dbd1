// SPDX-License-Identifier: BSD-3-Clause
// Greedy, backwards. Losses grow as a rule as others go, so a queue holds each as it was, and the least is measured
// anew before it counts (lazy greedy; Minoux 1978). They fall where keyframes stand in each other's way; so all are
// measured anew now and then.
#include "slamdb/edit/part/detail/choose_keyframes.h"

#include <limits>
#include <queue>
#include <string>

#include "slamdb/base/error.h"

namespace slamdb::detail {
namespace {

constexpr double kBetweenMeasuring = 0.9;  // of the keyframes are left when all are measured anew

struct Candidate {
  double loss;  // for each byte where bytes are asked for
  std::uint32_t keyframe;
  friend bool operator<(const Candidate& a, const Candidate& b) {
    return a.loss != b.loss ? a.loss > b.loss : a.keyframe < b.keyframe;  // the later of equals comes out first
  }
};

class Chooser {
 public:
  Chooser(Remains& remains, Finding& finding) : remains_(remains), finding_(finding) {}

  void Run() {
    while (remains_.keyframes() > 1) {
      if (static_cast<double>(remains_.keyframes()) <= measure_at_) MeasureAll();
      const Candidate next = Next();
      if (remains_.Fits() && next.loss >= 0) return;
      const std::vector<std::uint32_t> going = remains_.GoingWith(next.keyframe);
      finding_.Remove(next.keyframe, going);
      remains_.Remove(next.keyframe, going);
    }
  }

 private:
  Candidate Measure(std::uint32_t keyframe) {
    const std::vector<std::uint32_t> going = remains_.GoingWith(keyframe);
    const double loss = finding_.Loss(keyframe, going);
    if (!remains_.budget().bytes) return {loss, keyframe};
    return {loss / static_cast<double>(remains_.BytesOf(keyframe, going)), keyframe};
  }

  void MeasureAll() {
    queue_ = {};
    for (std::uint32_t keyframe = 0; keyframe < remains_.sights().keyframes(); ++keyframe)
      if (remains_.Keeps(keyframe)) queue_.push(Measure(keyframe));
    measure_at_ = kBetweenMeasuring * static_cast<double>(remains_.keyframes());
  }

  // Out of the queue, which has all that remain.
  Candidate Next() {
    while (true) {
      const Candidate was = queue_.top();
      queue_.pop();
      const Candidate now = Measure(was.keyframe);
      if (now.loss <= was.loss || queue_.empty() || queue_.top() < now) return now;
      queue_.push(now);
    }
  }

  Remains& remains_;
  Finding& finding_;
  std::priority_queue<Candidate> queue_;
  double measure_at_ = std::numeric_limits<double>::infinity();  // so many keyframes
};

[[noreturn]] void Refuse(const Remains& remains) {
  if (!remains.budget().bytes) throw Error(ErrorKind::kNotPossible, "no keyframe may be kept");
  const auto kilobytes = [](std::uint64_t bytes) { return std::to_string((bytes + 999) / 1000) + " kB"; };
  throw Error(ErrorKind::kNotPossible, "the target of " + kilobytes(*remains.budget().bytes) +
                                           " is below what one keyframe with its points takes, " +
                                           kilobytes(remains.bytes()));
}

}  // namespace

void ChooseKeyFrames(Remains& remains, Finding& finding) {
  if (remains.keyframes() == 0)
    throw Error(ErrorKind::kNotPossible, "there is no keyframe to keep: none is there, or all are flagged bad");
  if (remains.budget().bytes && remains.budget().lean && !remains.Fits()) {
    const std::vector<std::uint32_t> points = finding.ShownOnce();
    finding.Drop(points);
    remains.Drop(points);
  }
  Chooser(remains, finding).Run();
  if (!remains.Fits()) Refuse(remains);
}

}  // namespace slamdb::detail
