// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/infer.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <unordered_set>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/layouts/detail/inference.h"

namespace slamdb {
namespace layouts {
namespace {

using detail::Concat;

// What is wrong where members contradict other records.
constexpr std::int64_t kContradiction = 30, kUnusual = 5;

// Adds up what speaks against the members of all records that a walk passes: by what each is like, and by what records
// say of others, so that one counter is not taken for its neighbour.
class Judging : public RecordVisitor {
 public:
  Judging(const ArchiveBytes& archive, const Wire& wire)
      : file_(archive.file), wire_(wire), known_(wire.classes.size()), sums_(wire.classes.size()) {}

  void Record(const WireClass& of, std::span<const std::uint64_t> offsets) override {
    const auto row = static_cast<std::size_t>(&of - wire_.classes.data());
    std::vector<const KnownMember*>& known = known_[row];
    if (known.empty())
      for (const WireMember& member : of.members) known.push_back(FindKnownMember(of.name, member.name));
    Sum& sum = sums_[row];
    RecordFacts facts;
    for (std::size_t i = 0; i < known.size(); ++i) {
      if (known[i] == nullptr) continue;
      const MemberPlace place{offsets[i], offsets[i + 1]};
      sum.penalty += PenaltyOf(*known[i], file_, std::span(&place, 1), std::span(&facts, 1));
    }
    sum.penalty += Contradictions(of, offsets);
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

  std::int64_t Contradictions(const WireClass& of, std::span<const std::uint64_t> offsets) {
    const auto number = [&](std::string_view name) {
      const auto member = std::ranges::find(of.members, name, &WireMember::name);
      if (member == of.members.end()) return std::optional<std::int64_t>();
      return NumberAt<std::int64_t>(file_, offsets[static_cast<std::size_t>(member - of.members.begin())]);
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
  std::vector<std::vector<const KnownMember*>> known_;
  std::vector<Sum> sums_;
  std::unordered_set<std::int64_t> keyframes_;  // of the map that is walked through
  std::int64_t last_keyframe_ = -1, last_frame_ = -1, last_point_ = -1, last_map_ = -1;
};

}  // namespace

Verdict Judge(const ArchiveBytes& archive, const Layout& layout, std::span<const std::uint64_t> known_ends) {
  const Wire wire(layout, archive.encoding);
  WireWalk walk(wire, archive.file, archive.encoding);
  Judging judging(archive, wire);
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

namespace {

// Records whose end is known; without the first of all, in front of whose values class information stands.
std::vector<MemberPlace> WholeRecords(std::span<const MapRecords> maps, RecordList MapRecords::*list) {
  std::vector<MemberPlace> whole;
  bool first = true;
  for (const MapRecords& map : maps) {
    for (std::size_t i = 0; i < (map.*list).records.size(); ++i) {
      const std::uint64_t end = EndOf(map.*list, i);
      if (end > 0 && !first) whole.push_back({(map.*list).records[i].body, end});
      first = false;
    }
  }
  return whole;
}

// A known layout that comes to the end; the one that reads what ORB-SLAM3 writes, or most likely does.
std::optional<InferredLayout> Known(const ArchiveBytes& archive, double most) {
  std::optional<InferredLayout> best;
  double least = std::numeric_limits<double>::max();
  for (const Layout& layout : KnownLayouts()) {
    const Verdict verdict = Judge(archive, layout);
    if (!verdict.whole || verdict.penalty >= most || verdict.total >= least) continue;
    least = verdict.total;
    best = InferredLayout{.layout = layout, .known = true};
  }
  return best;
}

class Inference {
 public:
  Inference(const ArchiveBytes& archive, std::size_t choice)
      : archive_(archive),
        choice_(choice),
        maps_(FindRecords(archive.file, archive.encoding)),
        layout_(KnownLayouts().front()) {}

  InferredLayout Run() {
    Count();
    if (auto known = Known(archive_, kMostPenalty)) return Finished(std::move(*known));
    if (auto doubtful = maps_.empty() ? Known(archive_, std::numeric_limits<double>::max()) : std::nullopt) {
      doubtful->doubts.emplace_back("the last byte is reached, but values are unlike those of ORB-SLAM3");
      return Finished(std::move(*doubtful));
    }
    if (archive_.encoding.long_bytes != 8 || archive_.encoding.size_bytes != 8)
      Fail("it is of none of the known layouts, and others are only found in archives with longs of 8 bytes");
    if (maps_.empty()) Fail("it is of none of the known layouts, and no keyframe was found by the size of its grid");
    layout_.id = layout_.title = layout_.who = "";
    const std::vector<MemberPlace> keyframes = Whole(&MapRecords::keyframes), points = Whole(&MapRecords::points);
    keyframe_options_ = FindClass(archive_, "KeyFrame", keyframes, layout_);
    if (keyframe_options_.empty())
      Fail(Concat("no change of a known layout explains the ", keyframes.size(), " keyframes that were found"));
    point_options_ = FindClass(archive_, "MapPoint", points, keyframe_options_.front().layout);
    if (point_options_.empty())
      Fail(Concat("no change of a known layout explains the ", points.size(), " map points that were found"));
    if (!Choose())
      Fail(Concat("keyframes and map points are understood", Understood(),
                  ", but nothing explains what stands from byte ", most_, " on"));
    Name();
    InferredLayout inferred{.layout = std::move(layout_)};
    inferred.differences = std::move(findings_.differences);
    inferred.alternatives = std::move(findings_.alternatives);
    inferred.doubts = std::move(findings_.doubts);
    return Finished(std::move(inferred));
  }

 private:
  // ` (KeyFrame: u64 more, behind mnId)`.
  std::string Understood() const {
    std::string text;
    for (const ClassOption* option : {&keyframe_options_.front(), &point_options_.front()})
      for (const std::string& difference : option->findings.differences)
        text += (text.empty() ? " (" : "; ") + difference;
    return text.empty() ? text : text + ")";
  }

  struct Unknown {
    std::string of_class;
    std::size_t row = 0;
    std::vector<std::string> types;
  };

  void Count() {
    for (const MapRecords& map : maps_) {
      keyframes_ += map.keyframes.records.size();
      points_ += map.points.records.size();
    }
  }
  InferredLayout Finished(InferredLayout inferred) const {
    ExpectChoiceUpTo(inferred.alternatives.size() + 1);
    inferred.keyframes = keyframes_;
    inferred.points = points_;
    return inferred;
  }
  void ExpectChoiceUpTo(std::size_t most) const {
    if (choice_ < 1 || choice_ > most)
      throw Error(ErrorKind::kUsage, "", "",
                  Concat("there is no layout ", choice_, " to choose: ", detail::Counted(most, "layout"), " fit",
                         most == 1 ? "s" : ""));
  }
  [[noreturn]] void Fail(const std::string& problem) const {
    throw Error(ErrorKind::kNotPossible, "", "",
                Concat("no layout found: ", problem,
                       ". `DeriveLayoutOfFolder` derives it from the sources of the program that wrote it"));
  }

  std::vector<MemberPlace> Whole(RecordList MapRecords::*list) const { return WholeRecords(maps_, list); }

  // By object id: the ends of records that the layout reads from end to end.
  std::vector<std::uint64_t> EndsIn(const Layout& layout) const {
    std::vector<std::uint64_t> ends;
    const Wire wire(layout, archive_.encoding);
    const WarmWalk walk(wire, archive_.file, archive_.encoding);
    for (const auto list : {&MapRecords::keyframes, &MapRecords::points}) {
      const std::int64_t row = wire.RowOf(list == &MapRecords::keyframes ? "KeyFrame" : "MapPoint");
      const WireClass& of = wire.classes[static_cast<std::size_t>(row)];
      for (const MapRecords& map : maps_) {
        const std::vector<Record>& records = (map.*list).records;
        for (std::size_t i = 0; i + 1 < records.size(); ++i) {
          const std::uint64_t end = EndOf(map.*list, i);
          if (end == 0 || walk.BehindMembers(of, records[i].body, 0) != end) continue;
          if (ends.size() <= records[i].object) ends.resize(records[i].object + 1, 0);
          ends[records[i].object] = end;
        }
      }
    }
    return ends;
  }

  // Takes one of the changes of keyframes and map points that the first records and the class ids behind them bear out,
  // and with it what the unknown members are, or else the rest of the layout.
  bool Choose() {
    std::vector<Candidate> candidates = Candidates();
    if (!candidates.empty()) {
      ExpectChoiceUpTo(candidates.size());
      Candidate& taken = candidates[choice_ - 1];
      layout_ = std::move(taken.typed.layout);
      findings_ = taken.findings;
      for (const Candidate& other : candidates)
        if (&other != &taken) findings_.alternatives.push_back(OtherThanTaken(other.findings.differences));
      return true;
    }
    for (Farthest& farthest : farthest_)
      if (FindFrame(archive_, farthest.ends, farthest.layout, findings_)) {
        layout_ = std::move(farthest.layout);
        const ClassOption &keyframe = keyframe_options_.front(), &point = point_options_.front();
        Take(keyframe.findings, findings_);
        Take(point.findings, findings_);
        for (const ClassOption* option : {&keyframe, &point})  // none of which was held against the whole file
          for (const std::string& alternative : option->findings.alternatives)
            findings_.doubts.push_back("could as well be " + alternative);
        return true;
      }
    return false;
  }

  // Layouts that read the file to its end, those first against which least speaks.
  struct Typed {
    Layout layout;
    double penalty = 0;
  };
  struct Candidate {
    Typed typed;
    Findings findings;
  };
  std::vector<Candidate> Candidates() {
    std::vector<Candidate> candidates;
    std::size_t choices = 0;
    for (const ClassOption& keyframe : keyframe_options_)
      for (const ClassOption& point : point_options_) {
        if (choices++ == kMostChoices) break;
        Layout layout = keyframe.layout;
        *layout.Find("MapPoint") = *point.layout.Find("MapPoint");
        const std::vector<std::uint64_t> ends = EndsIn(layout);
        std::optional<Typed> typed = Types(layout, ends);
        if (!typed) continue;
        Candidate& candidate = candidates.emplace_back(Candidate{*std::move(typed), {}});
        Take(keyframe.findings, candidate.findings);
        Take(point.findings, candidate.findings);
      }
    std::ranges::stable_sort(candidates, {}, [](const Candidate& candidate) { return candidate.typed.penalty; });
    return candidates;
  }
  static void Take(const Findings& from, Findings& to) {
    for (const auto part : {&Findings::differences, &Findings::doubts})
      (to.*part).insert((to.*part).end(), (from.*part).begin(), (from.*part).end());
  }
  // The changes of another layout that are not those of the one that is taken.
  std::string OtherThanTaken(const std::vector<std::string>& differences) const {
    std::string text;
    for (const std::string& difference : differences)
      if (std::ranges::find(findings_.differences, difference) == findings_.differences.end())
        text += (text.empty() ? "" : "; ") + difference;
    return text.empty() ? "fewer changes" : text;
  }

  // Finds types of the unknown members with which the layout comes to the end; keeps those that come farthest.
  std::optional<Typed> Types(const Layout& layout, const std::vector<std::uint64_t>& ends) {
    std::vector<Unknown> unknown;
    std::size_t trials = 1;
    for (const LayoutClass& of : layout.classes)
      for (std::size_t row = 0; row < of.members.size(); ++row)
        if (IsUnknown(of.members[row])) {
          unknown.push_back({of.name, row, TypesLike(of.members[row].type)});
          trials = std::min(kMostTrials, trials * unknown.back().types.size());
        }
    for (std::size_t trial = 0; trial < trials && trials_ < kMostTrials; ++trial, ++trials_) {
      Layout typed = layout;
      std::size_t rest = trial;
      for (auto one = unknown.rbegin(); one != unknown.rend(); ++one) {  // rows in front stay where they are
        SetType(typed, one->of_class, one->row, one->types[rest % one->types.size()]);
        rest /= one->types.size();
      }
      const Verdict verdict = Judge(archive_, typed, ends);
      if (verdict.whole) {
        const Verdict cold = Judge(archive_, typed);
        if (cold.penalty < kMostPenalty) return Typed{std::move(typed), cold.total};
      }
      if (verdict.reached < most_ || IsInFirstRecord(verdict.reached)) continue;
      if (verdict.reached > most_) farthest_.clear();
      most_ = verdict.reached;
      if (farthest_.size() < kMostFarthest) farthest_.push_back({std::move(typed), ends});
    }
    return std::nullopt;
  }

  // Whether a walk ended in the first keyframe or map point, where no change of Map and Atlas helps.
  bool IsInFirstRecord(std::uint64_t at) const {
    const auto is_in = [&](const RecordList& list) {
      return !list.records.empty() && at >= list.records.front().body &&
             (list.records.size() < 2 || at < list.records[1].begin);
    };
    return is_in(maps_.front().keyframes) || is_in(maps_.front().points);
  }

  void Name() {
    layout_.id = "inferred";
    layout_.title = "inferred from a file";
  }

  struct Farthest {
    Layout layout;
    std::vector<std::uint64_t> ends;
  };
  static constexpr std::size_t kMostTrials = 2048, kMostFarthest = 3, kMostChoices = 16;

  const ArchiveBytes archive_;
  const std::size_t choice_;  // from 1
  const std::vector<MapRecords> maps_;
  Layout layout_;
  Findings findings_;
  std::vector<ClassOption> keyframe_options_, point_options_;
  std::vector<Farthest> farthest_;
  std::uint64_t most_ = 0;
  std::size_t trials_ = 0;
  std::uint64_t keyframes_ = 0, points_ = 0;
};

}  // namespace

std::optional<Layout> LayoutOfRecords(const ArchiveBytes& archive, std::span<const MapRecords> maps) {
  const std::vector<MemberPlace> keyframes = WholeRecords(maps, &MapRecords::keyframes);
  const std::vector<ClassOption> of_keyframes = FindClass(archive, "KeyFrame", keyframes, KnownLayouts().front());
  if (of_keyframes.empty()) return std::nullopt;
  const std::vector<MemberPlace> points = WholeRecords(maps, &MapRecords::points);
  const std::vector<ClassOption> of_points = FindClass(archive, "MapPoint", points, of_keyframes.front().layout);
  if (of_points.empty()) return std::nullopt;
  return of_points.front().layout;
}

}  // namespace layouts

InferredLayout InferLayoutOf(Bytes archive, const ArchiveEncoding& encoding, std::uint64_t begin,
                             const InferOptions& options) {
  const std::string_view file(reinterpret_cast<const char*>(archive.data()), archive.size());
  return layouts::Inference({file, encoding, begin}, options.choice).Run();
}

}  // namespace slamdb
