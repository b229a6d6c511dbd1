// SPDX-License-Identifier: BSD-3-Clause
// Greedy: the gain of a keyframe falls as places are covered, and rises when another keyframe gives half of what a
// point needs. Gains are kept exact at each step; a queue holds each as it was when it last rose. What two keyframes
// gain together by points that none has seen only falls, so it is computed anew only when its keyframe comes first
// (lazy greedy; Minoux 1978).
#include "slamdb/edit/part/detail/choose_keyframes.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <queue>
#include <string>
#include <utility>

#include "slamdb/base/error.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kMostWork = 10'000'000;  // points in view of keyframes that are tried; a second, or less

class Chooser {
 public:
  Chooser(const Sights& sights, const KeyFrameBudget& budget)
      : sights_(sights), budget_(budget), order_(sights.InOrder()) {}

  const Sights& sights() const { return sights_; }
  // Good keyframes as they were made.
  const std::vector<std::uint32_t>& order() const { return order_; }
  KeptViews Nothing() const { return {sights_, budget_.min_points, budget_.bytes_around, budget_.keyframe_bytes}; }

  // Of points by keyframes, all together.
  std::size_t CountSights() const {
    std::size_t count = 0;
    for (const std::uint32_t keyframe : order_) count += sights_.PointsOf(keyframe).size();
    return count;
  }

  std::size_t RoomBeside(const KeptViews& kept) const {
    return budget_.keyframes.value_or(std::numeric_limits<std::size_t>::max()) - kept.keyframes();
  }
  bool Fits(std::uint64_t bytes) const { return !budget_.bytes || bytes <= *budget_.bytes; }
  // Adds the keyframe if the budget allows.
  template <class Listener>
  bool TryAdd(std::uint32_t keyframe, KeptViews& kept, Listener&& listener) const {
    if (RoomBeside(kept) == 0 || !Fits(kept.BytesWith(keyframe))) return false;
    kept.Add(keyframe, listener);
    return true;
  }

  [[noreturn]] void Refuse(std::uint64_t needed) const {
    const auto kilobytes = [](std::uint64_t bytes) { return std::to_string((bytes + 999) / 1000) + " kB"; };
    throw Error(ErrorKind::kNotPossible, "the target of " + kilobytes(*budget_.bytes) +
                                             " is below what one keyframe with its points takes, " + kilobytes(needed));
  }

 private:
  const Sights& sights_;
  const KeyFrameBudget& budget_;
  const std::vector<std::uint32_t> order_;
};

// ---- greedy

// What keyframes add: views of points to places that lack them, then points.
struct Gain {
  std::uint64_t views = 0, points = 0;

  Gain& operator+=(const Gain& more) {
    views += more.views;
    points += more.points;
    return *this;
  }
  Gain& operator-=(const Gain& less) {
    views -= less.views;
    points -= less.points;
    return *this;
  }
  Gain Twice() const { return {2 * views, 2 * points}; }
  friend auto operator<=>(const Gain&, const Gain&) = default;
};

class Greedy {
 public:
  explicit Greedy(const Chooser& chooser)
      : chooser_(chooser),
        sights_(chooser.sights()),
        kept_(chooser.Nothing()),
        lacking_(sights_.points()),
        gains_(sights_.keyframes()),
        has_risen_(sights_.keyframes(), 0),
        together_(sights_.keyframes()) {
    for (std::uint32_t point = 0; point < lacking_.size(); ++point)
      lacking_[point] = static_cast<std::uint32_t>(sights_.ObserversOf(point).size());
    for (const std::uint32_t keyframe : chooser.order()) {
      Gain with_another;
      for (const auto& [point, weight] : sights_.PointsOf(keyframe))
        (Completes(point, weight) ? gains_[keyframe] : with_another) += GainOf(point);
      singles_.push({gains_[keyframe], keyframe});
      if (with_another > Gain()) pairs_.push({with_another, keyframe});
    }
  }

  KeptViews Run() {
    while (KeepNext()) {
    }
    return std::move(kept_);
  }

  // What KeptViews::Add tells.
  void BeginsToStay(std::uint32_t point) {
    beginning_ = point;
    for (const auto& [observer, weight] : sights_.ObserversOf(point))
      if (Completes(point, weight)) gains_[observer] -= GainOf(point);
  }
  void Covers(std::uint32_t place) {
    for (const Sights::Sight& sight : sights_.PointsOf(place)) {
      --lacking_[sight.number];
      if (kept_.Stays(sight.number) || sight.number == beginning_) continue;
      for (const auto& [observer, weight] : sights_.ObserversOf(sight.number))
        if (Completes(sight.number, weight)) gains_[observer] -= {.views = 1};
    }
  }
  void Weighs(std::uint32_t point) {
    for (const auto& [observer, weight] : sights_.ObserversOf(point)) {
      if (!Completes(point, weight) || weight >= sights_.Need(point)) continue;
      gains_[observer] += GainOf(point);
      if (!std::exchange(has_risen_[observer], std::uint8_t{1})) risen_.push_back(observer);
    }
  }

 private:
  struct Candidate {
    Gain gain;
    std::uint32_t keyframe;
    friend bool operator<(const Candidate& a, const Candidate& b) {
      return a.gain != b.gain ? a.gain < b.gain : a.keyframe > b.keyframe;  // the earlier of equals comes out first
    }
  };
  using Queue = std::priority_queue<Candidate>;

  Gain GainOf(std::uint32_t point) const { return {lacking_[point], 1}; }
  // Whether an observation more of this weight makes the point stay, which does not stay yet.
  bool Completes(std::uint32_t point, std::uint32_t weight) const {
    return kept_.Weight(point) + weight >= sights_.Need(point);
  }

  // Returns whether there was another one, and room for it.
  bool KeepNext() {
    const Candidate single = BestSingle();
    if (single.keyframe == kNoRow || chooser_.RoomBeside(kept_) == 0) return false;
    const auto [first, second] = BestPair(single.gain.Twice());
    if (first == kNoRow) return Keep(single.keyframe);
    return Keep(first) && Keep(second);
  }

  bool Keep(std::uint32_t keyframe) {
    if (!chooser_.TryAdd(keyframe, kept_, *this)) {
      if (kept_.keyframes() == 0) chooser_.Refuse(kept_.BytesWith(keyframe));
      return false;
    }
    for (const std::uint32_t observer : risen_) {
      has_risen_[observer] = 0;
      if (!kept_.Keeps(observer)) singles_.push({gains_[observer], observer});
    }
    risen_.clear();
    return true;
  }

  Candidate BestSingle() {
    while (!singles_.empty()) {
      const Candidate top = singles_.top();
      if (!kept_.Keeps(top.keyframe) && top.gain == gains_[top.keyframe]) return top;
      singles_.pop();
      if (!kept_.Keeps(top.keyframe) && top.gain > gains_[top.keyframe])
        singles_.push({gains_[top.keyframe], top.keyframe});
    }
    return {{}, kNoRow};
  }

  // The two that gain most together, if that is more than `least`.
  std::pair<std::uint32_t, std::uint32_t> BestPair(const Gain& least) {
    if (chooser_.RoomBeside(kept_) < 2) return {kNoRow, kNoRow};
    while (!pairs_.empty() && pairs_.top().gain > least) {
      const Candidate top = pairs_.top();
      if (!kept_.Keeps(top.keyframe)) {
        const Candidate partner = BestPartner(top.keyframe);
        if (partner.gain == top.gain) return {top.keyframe, partner.keyframe};
        pairs_.pop();
        if (partner.gain > Gain()) pairs_.push({partner.gain, top.keyframe});
      } else {
        pairs_.pop();
      }
    }
    return {kNoRow, kNoRow};
  }

  // The keyframe that completes most points with this one, which neither completes alone.
  Candidate BestPartner(std::uint32_t keyframe) {
    std::vector<std::uint32_t> partners;
    for (const auto& [point, weight] : sights_.PointsOf(keyframe)) {
      if (Completes(point, weight)) continue;
      for (const auto& [observer, other] : sights_.ObserversOf(point)) {
        if (observer == keyframe || kept_.Keeps(observer) || Completes(point, other) ||
            !Completes(point, weight + other))
          continue;
        if (together_[observer] == Gain()) partners.push_back(observer);
        together_[observer] += GainOf(point);
      }
    }
    Candidate best{{}, kNoRow};
    for (const std::uint32_t partner : partners) {
      const Candidate candidate{std::exchange(together_[partner], Gain()), partner};
      if (best.keyframe == kNoRow || best < candidate) best = candidate;
    }
    return best;
  }

  const Chooser& chooser_;
  const Sights& sights_;
  KeptViews kept_;
  std::vector<std::uint32_t> lacking_;   // by point: places that see it and are not covered
  std::vector<Gain> gains_;              // by keyframe that is not kept
  std::uint32_t beginning_ = kNoRow;     // the point that begins to stay, which gains count no more
  std::vector<std::uint8_t> has_risen_;  // by keyframe: whether it is in `risen_`
  std::vector<std::uint32_t> risen_;     // since the last keyframe
  std::vector<Gain> together_;           // by keyframe, zero between uses
  Queue singles_, pairs_;
};

// ---- what needs no computing

void TakeIfBetter(KeptViews kept, std::optional<KeptViews>& best) {
  if (!best || kept.quality() > best->quality()) best.emplace(std::move(kept));
}

// The best run of consecutive keyframes, each as long as the budget allows.
void TryConsecutive(const Chooser& chooser, std::optional<KeptViews>& best) {
  const std::vector<std::uint32_t>& order = chooser.order();
  KeptViews kept = chooser.Nothing();
  Quality highest;
  std::size_t best_begin = 0, best_end = 0;
  for (std::size_t begin = 0, end = 0; begin < order.size() && end < order.size(); ++begin) {
    while (end < order.size() && chooser.TryAdd(order[end], kept, KeptViews::Deaf())) ++end;
    if (kept.quality() > highest) {
      highest = kept.quality();
      best_begin = begin;
      best_end = end;
    }
    if (end > begin)
      kept.Remove(order[begin]);
    else
      ++end;  // too large alone
  }
  KeptViews again = chooser.Nothing();
  for (std::size_t i = best_begin; i < best_end; ++i) again.Add(order[i], KeptViews::Deaf());
  TakeIfBetter(std::move(again), best);
}

// `runs` runs of `count` keyframes in all, the i-th beginning at begin(i) or behind the one before.
void TryRuns(const Chooser& chooser, std::size_t count, std::size_t runs,
             const std::function<std::size_t(std::size_t)>& begin, std::optional<KeptViews>& best) {
  const std::vector<std::uint32_t>& order = chooser.order();
  KeptViews kept = chooser.Nothing();
  for (std::size_t run = 0, next = 0; run < runs; ++run) {
    next = std::max(next, begin(run));
    const std::size_t length = count / runs + (run < count % runs ? 1 : 0);
    for (const std::size_t end = std::min(next + length, order.size()); next < end; ++next)
      if (!chooser.TryAdd(order[next], kept, KeptViews::Deaf())) return;
  }
  TakeIfBetter(std::move(kept), best);
}

// As many keyframes as the best has in runs of equal length, from single keyframes on.
void TryEvenly(const Chooser& chooser, std::size_t count, std::optional<KeptViews>& best) {
  const std::size_t all = chooser.order().size();
  for (std::size_t length = 1; 2 * length <= std::max<std::size_t>(count, 2); length *= 2) {
    const std::size_t runs = count / length;
    const auto spread = [&](std::size_t i) { return runs < 2 ? 0 : i * (all - length) / (runs - 1); };
    const auto rounded = [&](std::size_t i) {
      return runs < 2 ? 0 : (2 * i * (all - length) + runs - 1) / (2 * (runs - 1));
    };
    TryRuns(
        chooser, count, runs, [&](std::size_t i) { return i * all / runs; }, best);
    TryRuns(
        chooser, count, runs, [&](std::size_t i) { return i * (all / runs); }, best);
    TryRuns(chooser, count, runs, spread, best);
    TryRuns(chooser, count, runs, rounded, best);
  }
}

// Keyframes at equal distances, by their places in the order: every steps/over-th from `begin` on.
struct Spacing {
  std::size_t begin, steps, over;
  std::size_t operator()(std::size_t i) const { return begin + i * steps / over; }
};

// As many keyframes as the best has, evenly spaced over all, from every keyframe that they can begin with; as much work
// as adding each keyframe a few times. In maps where that is no more work, at every smaller distance, too.
void TrySpaced(const Chooser& chooser, std::size_t count, std::optional<KeptViews>& best) {
  const std::vector<std::uint32_t>& order = chooser.order();
  KeptViews kept = chooser.Nothing();
  Quality highest = best->quality();
  std::optional<Spacing> found;
  const auto consider = [&](const Spacing& spacing) {
    std::size_t added = 0;
    while (added < count && chooser.TryAdd(order[spacing(added)], kept, KeptViews::Deaf())) ++added;
    if (added == count && kept.quality() > highest) {
      highest = kept.quality();
      found = spacing;
    }
    while (added > 0) kept.Remove(order[spacing(--added)]);
  };
  const std::size_t all = order.size(), widest = all / count;
  for (std::size_t begin = 0; begin < widest; ++begin) {
    consider({begin, all, count});
    consider({begin, widest, 1});
  }
  if (count > 1 && chooser.CountSights() * all <= 2 * kMostWork)
    for (std::size_t step = 1; step * (count - 1) < all; ++step)
      for (std::size_t begin = 0; begin + step * (count - 1) < all; ++begin) consider({begin, step, 1});
  if (!found) return;
  KeptViews again = chooser.Nothing();
  for (std::size_t i = 0; i < count; ++i) again.Add(order[(*found)(i)], KeptViews::Deaf());
  best.emplace(std::move(again));
}

// ---- local search

// Exchanges keyframes one by one for those that make the choice best, as long as there are such, up to so much work.
void Exchange(const Chooser& chooser, KeptViews& kept) {
  std::size_t work = 0;
  for (bool improves = true; improves && work < kMostWork;) {
    improves = false;
    for (const std::uint32_t out : chooser.order()) {
      if (!kept.Keeps(out) || work >= kMostWork) continue;
      Quality highest = kept.quality();
      std::uint32_t best = out;
      kept.Remove(out);
      for (const std::uint32_t in : chooser.order()) {
        if (in == out || kept.Keeps(in) || !chooser.TryAdd(in, kept, KeptViews::Deaf())) continue;
        if (kept.quality() > highest) {
          highest = kept.quality();
          best = in;
        }
        kept.Remove(in);
        work += chooser.sights().PointsOf(in).size();
      }
      kept.Add(best, KeptViews::Deaf());
      improves |= best != out;
    }
  }
}

// How many places the whole atlas covers.
std::uint64_t MostCovered(const Chooser& chooser, std::size_t min_points) {
  return static_cast<std::uint64_t>(std::ranges::count_if(chooser.order(), [&](std::uint32_t keyframe) {
    return chooser.sights().PointsOf(keyframe).size() >= min_points;
  }));
}

}  // namespace

Subset ChooseKeyFrames(const Sights& sights, const KeyFrameBudget& budget) {
  const Chooser chooser(sights, budget);
  if (chooser.order().empty())
    throw Error(ErrorKind::kNotPossible, "there is no keyframe to keep: none is there, or all are flagged bad");
  std::optional<KeptViews> best;
  TakeIfBetter(Greedy(chooser).Run(), best);
  if (best->quality().covered < MostCovered(chooser, budget.min_points)) {
    const std::size_t count = best->keyframes();
    TryConsecutive(chooser, best);
    TryEvenly(chooser, count, best);
    TrySpaced(chooser, count, best);
    Exchange(chooser, *best);
  }
  return best->ToSubset();
}

}  // namespace slamdb::detail
