// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <unordered_set>

#include "slamdb/formats/layouts/detail/inference.h"

namespace slamdb::layouts {
namespace {

// What is wrong where members contradict other records.
constexpr std::int64_t kContradiction = 30, kUnusual = 5;

// Adds up what speaks against the members of all records that a walk passes: by what each is like, and by what records
// say of others, so that one counter is not taken for its neighbour.
class Judging : public RecordVisitor {
 public:
  Judging(const ArchiveBytes& archive, const Layout& layout, const Wire& wire)
      : file_(archive.file), wire_(wire), checks_(wire.classes.size()), sums_(wire.classes.size()) {
    for (std::size_t row = 0; row < wire.classes.size(); ++row)
      for (const LayoutMember& member : layout.classes[row].members)
        checks_[row].emplace_back(layout.classes[row].name, member);
  }

  void Record(const WireClass& of, std::span<const std::uint64_t> offsets) override {
    const auto row = static_cast<std::size_t>(&of - wire_.classes.data());
    const std::vector<CheckedMember>& checks = checks_[row];
    Sum& sum = sums_[row];
    RecordFacts facts;
    for (std::size_t i = 0; i < checks.size(); ++i) {
      if (!checks[i].known()) continue;
      const MemberPlace place{offsets[i], offsets[i + 1]};
      sum.penalty += checks[i].Penalty(file_, std::span(&place, 1), std::span(&facts, 1));
    }
    sum.penalty += Contradictions(of, checks, offsets);
    ++sum.records;
  }
  // By record, of the class against which most speaks.
  double most() const {
    double most = 0;
    for (const Sum& sum : sums_) most = std::max(most, sum.mean());
    return most;
  }
  // Of all classes.
  double total() const {
    double total = 0;
    for (const Sum& sum : sums_) total += sum.mean();
    return total;
  }

 private:
  struct Sum {
    std::int64_t penalty = 0, records = 0;
    double mean() const { return records == 0 ? 0 : static_cast<double>(penalty) / static_cast<double>(records); }
  };

  std::int64_t Contradictions(const WireClass& of, std::span<const CheckedMember> checks,
                              std::span<const std::uint64_t> offsets) {
    const auto number = [&](std::string_view name) {
      const auto member = std::ranges::find(of.members, name, &WireMember::name);
      if (member == of.members.end()) return std::optional<std::int64_t>();
      const auto row = static_cast<std::size_t>(member - of.members.begin());
      if (!checks[row].known()) return NumberAt<std::int64_t>(file_, offsets[row]);
      return checks[row].Whole(file_, {offsets[row], offsets[row + 1]});
    };
    if (of.name == "KeyFrame") {
      keyframes_.insert(number("mnId").value_or(-1));
      last_keyframe_ = std::max(last_keyframe_, number("mnId").value_or(-1));
      last_frame_ = std::max(last_frame_, number("mnFrameId").value_or(-1));
    } else if (of.name == "MapPoint") {
      last_point_ = std::max(last_point_, number("mnId").value_or(-1));
      last_keyframe_ = std::max(last_keyframe_, number("mnFirstKFid").value_or(-1));
      last_frame_ = std::max(last_frame_, number("mnFirstFrame").value_or(-1));
      if (const auto reference = number("mBackupRefKFId"); reference && !keyframes_.contains(*reference))
        return kUnusual;
    } else if (of.name == "Map") {
      return OfMap(number);
    } else if (of.name == "Atlas") {
      return OfAtlas(number);
    }
    return 0;
  }

  template <class Number>
  std::int64_t OfMap(const Number& number) {
    std::int64_t penalty = 0;
    const std::int64_t last = keyframes_.empty() ? -1 : *std::ranges::max_element(keyframes_);
    last_map_ = std::max(last_map_, number("mnId").value_or(-1));
    if (!number("mnId")) penalty += kUnusual;
    if (number("mnMaxKFid").value_or(last) < last) penalty += kContradiction;
    if (number("mnInitKFid").value_or(0) > number("mnMaxKFid").value_or(last)) penalty += kContradiction;
    if (number("mvBackupKeyFrameOriginsId") == 0) penalty += kUnusual;
    for (const char* name : {"mnBackupKFinitialID", "mnBackupKFlowerID"})
      if (const auto id = number(name); id && !keyframes_.contains(*id)) penalty += kUnusual;
    keyframes_.clear();
    return penalty;
  }
  template <class Number>
  std::int64_t OfAtlas(const Number& number) const {
    std::int64_t penalty = 0;
    const auto above = [&](const char* name, std::int64_t last) {
      const auto counter = number(name);
      if (!counter || last < 0) return;
      if (*counter <= last) penalty += kContradiction;
      if (*counter > last + last / 4 + 16) penalty += kUnusual;
    };
    above("Map::nNextId", last_map_);
    above("Frame::nNextId", last_frame_);
    above("KeyFrame::nNextId", last_keyframe_);
    above("MapPoint::nNextId", last_point_);
    above("GeometricCamera::nNextId", 0);
    if (number("mnLastInitKFidMap").value_or(0) > last_keyframe_) penalty += kUnusual;
    return penalty;
  }

  const std::string_view file_;
  const Wire& wire_;
  std::vector<std::vector<CheckedMember>> checks_;  // by class
  std::vector<Sum> sums_;
  std::unordered_set<std::int64_t> keyframes_;  // of the map that is walked through
  std::int64_t last_keyframe_ = -1, last_frame_ = -1, last_point_ = -1, last_map_ = -1;
};

}  // namespace

Verdict Judge(const ArchiveBytes& archive, const Layout& layout, std::span<const std::uint64_t> known_ends) {
  const Wire wire(layout, archive.encoding);
  WireWalk walk(wire, archive.file, archive.encoding);
  Judging judging(archive, layout, wire);
  walk.visitor = &judging;
  walk.known_ends = known_ends;
  Verdict verdict;
  verdict.whole = walk.Run(layout.header ? archive.begin : 0);
  verdict.reached = walk.at();
  verdict.penalty = judging.most();
  verdict.total = judging.total();
  verdict.members = walk.members_entered();
  return verdict;
}

}  // namespace slamdb::layouts
