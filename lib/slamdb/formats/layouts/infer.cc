// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/infer.h"

#include <algorithm>
#include <optional>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/layouts/detail/inference.h"

namespace slamdb {
namespace layouts {
namespace {

using detail::Concat;

// Adds up what speaks against the members of all records that a walk passes.
class Judging : public RecordVisitor {
 public:
  Judging(const ArchiveBytes& archive, const Wire& wire) : file_(archive.file), known_(wire.classes.size()), wire_(wire) {}

  void Record(const WireClass& of, std::span<const std::uint64_t> offsets) override {
    std::vector<const KnownMember*>& known = known_[static_cast<std::size_t>(&of - wire_.classes.data())];
    if (known.empty())
      for (const WireMember& member : of.members) known.push_back(FindKnownMember(of.name, member.name));
    RecordFacts facts;
    for (std::size_t i = 0; i < known.size(); ++i) {
      if (known[i] == nullptr) continue;
      const MemberPlace place{offsets[i], offsets[i + 1]};
      penalty_ += PenaltyOf(*known[i], file_, std::span(&place, 1), std::span(&facts, 1));
    }
    ++records_;
  }
  double penalty() const { return records_ == 0 ? 0 : static_cast<double>(penalty_) / static_cast<double>(records_); }

 private:
  const std::string_view file_;
  std::vector<std::vector<const KnownMember*>> known_;
  const Wire& wire_;
  std::int64_t penalty_ = 0, records_ = 0;
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
  verdict.penalty = judging.penalty();
  return verdict;
}

namespace {

// A known layout that comes to the end; the one that reads what ORB-SLAM3 writes.
std::optional<InferredLayout> Known(const ArchiveBytes& archive) {
  std::optional<InferredLayout> best;
  double least = kMostPenalty;
  for (const Layout& layout : KnownLayouts()) {
    const Verdict verdict = Judge(archive, layout);
    if (!verdict.whole || verdict.penalty >= least) continue;
    least = verdict.penalty;
    best = InferredLayout{.layout = layout, .known = true};
  }
  return best;
}

class Inference {
 public:
  explicit Inference(const ArchiveBytes& archive)
      : archive_(archive), maps_(FindRecords(archive.file, archive.encoding)), layout_(KnownLayouts().front()) {}

  InferredLayout Run() {
    Count();
    if (auto known = Known(archive_)) return Finished(std::move(*known));
    if (archive_.encoding.long_bytes != 8 || archive_.encoding.size_bytes != 8)
      Fail("it is of none of the known layouts, and others are only found in archives with longs of 8 bytes");
    if (maps_.empty()) Fail("it is of none of the known layouts, and no keyframe was found by the size of its grid");
    layout_.id = layout_.title = layout_.who = "";
    const std::vector<MemberPlace> keyframes = Whole(&MapRecords::keyframes), points = Whole(&MapRecords::points);
    if (!FindClass(archive_, "KeyFrame", keyframes, layout_, findings_))
      Fail(Concat("no change of a known layout explains the ", keyframes.size(), " keyframes that were found"));
    if (!FindClass(archive_, "MapPoint", points, layout_, findings_))
      Fail(Concat("no change of a known layout explains the ", points.size(), " map points that were found"));
    FindEnds();
    if (!Types()) Fail("keyframes and map points are understood, but no change of Map and Atlas explains the rest");
    Name();
    InferredLayout inferred{.layout = std::move(layout_)};
    inferred.differences = std::move(findings_.differences);
    inferred.alternatives = std::move(findings_.alternatives);
    inferred.doubts = std::move(findings_.doubts);
    return Finished(std::move(inferred));
  }

 private:
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
    inferred.keyframes = keyframes_;
    inferred.points = points_;
    return inferred;
  }
  [[noreturn]] void Fail(const std::string& problem) const {
    throw Error(ErrorKind::kNotPossible, "",  "", Concat("no layout found: ", problem, ". `slamdb layouts from-source` derives it from the sources of the program that wrote it"));
  }

  // Records whose end is the beginning of the next one; without the first of all, in front of whose values class
  // information stands.
  std::vector<MemberPlace> Whole(RecordList MapRecords::*list) const {
    std::vector<MemberPlace> whole;
    bool first = true;
    for (const MapRecords& map : maps_) {
      const std::vector<Record>& records = (map.*list).records;
      for (std::size_t i = 0; i + 1 < records.size(); ++i) {
        if (!first) whole.push_back({records[i].body, records[i + 1].begin});
        first = false;
      }
    }
    return whole;
  }

  // By object id: the ends of records that are whole.
  void FindEnds() {
    const Wire wire(layout_, archive_.encoding);
    const WarmWalk walk(wire, archive_.file, archive_.encoding);
    for (const auto list : {&MapRecords::keyframes, &MapRecords::points}) {
      const std::int64_t row = wire.RowOf(list == &MapRecords::keyframes ? "KeyFrame" : "MapPoint");
      for (const MapRecords& map : maps_) {
        const std::vector<Record>& records = (map.*list).records;
        for (std::size_t i = 0; i + 1 < records.size(); ++i) {
          if (walk.BehindMembers(wire.classes[static_cast<std::size_t>(row)], records[i].body, 0) != records[i + 1].begin) continue;
          if (ends_.size() <= records[i].object) ends_.resize(records[i].object + 1, 0);
          ends_[records[i].object] = records[i + 1].begin;
        }
      }
    }
  }

  // Finds what the unknown members are, by the first record of each class and the class ids behind it, and the rest of
  // the layout with it.
  bool Types() {
    constexpr std::size_t kMostTrials = 512;
    std::vector<Unknown> unknown;
    std::size_t trials = 1;
    for (const LayoutClass& of : layout_.classes)
      for (std::size_t row = 0; row < of.members.size(); ++row)
        if (IsUnknown(of.members[row])) {
          unknown.push_back({of.name, row, TypesLike(of.members[row].type)});
          trials = std::min(kMostTrials, trials * unknown.back().types.size());
        }
    std::vector<Layout> farthest;
    std::uint64_t most = 0;
    for (std::size_t trial = 0; trial < trials; ++trial) {
      Layout typed = layout_;
      std::size_t rest = trial;
      for (const Unknown& one : unknown) {
        LayoutMember& member = typed.Find(one.of_class)->members[one.row];
        SetType(typed, member, one.types[rest % one.types.size()]);
        rest /= one.types.size();
      }
      const Verdict verdict = Judge(archive_, typed, ends_);
      if (verdict.whole && verdict.penalty < kMostPenalty) {
        layout_ = std::move(typed);
        return true;
      }
      if (verdict.reached > most) farthest.clear();
      most = std::max(most, verdict.reached);
      if (verdict.reached == most) farthest.push_back(std::move(typed));
    }
    for (Layout& typed : farthest)
      if (FindFrame(archive_, ends_, typed, findings_)) {
        layout_ = std::move(typed);
        return true;
      }
    return false;
  }

  void Name() {
    layout_.id = "inferred";
    layout_.title = "inferred from a file";
  }

  const ArchiveBytes archive_;
  const std::vector<MapRecords> maps_;
  Layout layout_;
  Findings findings_;
  std::vector<std::uint64_t> ends_;
  std::uint64_t keyframes_ = 0, points_ = 0;
};

}  // namespace
}  // namespace layouts
}  // namespace slamdb
