// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/infer.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/layouts/detail/inference.h"

namespace slamdb::layouts {
namespace {

using detail::Concat;

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

// A layout that reads the file to its end.
struct Fit {
  Layout layout;
  double penalty = 0;  // of its members
  Findings findings;
  bool known = false;
  Meaning meaning = {};

  // What speaks against it; a member that is not like it is a change that was not found.
  double against() const {
    constexpr double kUnlike = 20;
    return penalty + meaning.penalty + kUnlike * static_cast<double>(findings.doubts.size());
  }
};

void Take(const Findings& from, Findings& to) {
  for (const auto part : {&Findings::differences, &Findings::doubts})
    (to.*part).insert((to.*part).end(), (from.*part).begin(), (from.*part).end());
}

// Pairs of rows of two lists, first ones first.
std::vector<std::pair<std::size_t, std::size_t>> Pairs(std::size_t firsts, std::size_t seconds, std::size_t most) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t sum = 0; sum < firsts + seconds && pairs.size() < most; ++sum)
    for (std::size_t first = 0; first <= sum && first < firsts; ++first)
      if (sum - first < seconds && pairs.size() < most) pairs.emplace_back(first, sum - first);
  return pairs;
}

// What keyframes and map points may be, both in one layout.
RecordLayouts::Found OptionsOf(const ArchiveBytes& archive, std::span<const MapRecords> maps, bool thorough) {
  constexpr std::size_t kMost = 24;
  const auto none_explains = [](std::size_t count, const char* what) {
    return RecordLayouts::Found{
        {}, Concat("no change of a known layout explains the ", count, " ", what, " that were found")};
  };
  const auto keyframes = WholeRecords(maps, &MapRecords::keyframes), points = WholeRecords(maps, &MapRecords::points);
  const Layout& own = KnownLayouts().front();
  const std::vector<ClassOption> of_keyframes = FindClass(archive, "KeyFrame", keyframes, own, thorough);
  if (of_keyframes.empty()) return none_explains(keyframes.size(), "keyframes");
  const std::vector<ClassOption> of_points =
      FindClass(archive, "MapPoint", points, of_keyframes.front().layout, thorough);
  if (of_points.empty()) return none_explains(points.size(), "map points");
  RecordLayouts::Found found;
  for (const auto& [keyframe, point] : Pairs(of_keyframes.size(), of_points.size(), kMost)) {
    ClassOption& option = found.options.emplace_back(of_keyframes[keyframe]);
    *option.layout.Find("MapPoint") = *of_points[point].layout.Find("MapPoint");
    Take(of_points[point].findings, option.findings);
  }
  return found;
}

// Finds types of unknown members, and the rest of a layout, with which it comes to the end.
class TypeSearch {
 public:
  TypeSearch(const ArchiveBytes& archive, std::span<const MapRecords> maps, const MeaningJudge& judge)
      : archive_(archive), maps_(maps), judge_(judge) {}

  // Of options that the first records and the class ids behind them bear out.
  std::vector<Fit> Run(const std::vector<ClassOption>& options) {
    std::vector<Fit> fits;
    for (const ClassOption& option : options)
      if (std::optional<Fit> fit = Typed(option)) fits.push_back(*std::move(fit));
    if (!fits.empty() || farthest_.empty()) return fits;
    const Farthest& first = farthest_.front();
    for (const ClassOption& frame : FindFrame(archive_, first.ends, first.layout, judge_))
      for (const Farthest& farthest : farthest_) AddFramed(frame, farthest, fits);
    return fits;
  }
  // How far it came.
  std::uint64_t most() const { return most_; }

 private:
  struct Farthest {
    Layout layout;
    std::vector<std::uint64_t> ends;
    Findings findings;
  };

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

  // Keeps those that come farthest.
  std::optional<Fit> Typed(const ClassOption& option) {
    const std::vector<std::uint64_t> ends = EndsIn(option.layout);
    const Typings typings(option.layout);
    for (std::size_t trial = 0; trial < typings.count() && trials_ < kMostTrials; ++trial, ++trials_) {
      Layout typed = typings.At(trial);
      const Verdict verdict = Judge(archive_, typed, ends);
      if (verdict.whole) {
        const Verdict cold = Judge(archive_, typed);
        if (cold.penalty < kMostPenalty) return Fit{std::move(typed), cold.total, option.findings};
        continue;
      }
      Keep(verdict.reached, {std::move(typed), ends, option.findings});
    }
    return std::nullopt;
  }
  void Keep(std::uint64_t reached, Farthest farthest) {
    most_ = std::max(most_, reached);
    if (reached < farthest_reached_ || IsInRecord(reached)) return;
    if (reached > farthest_reached_) farthest_.clear();
    farthest_reached_ = reached;
    if (farthest_.size() < kMostFarthest) farthest_.push_back(std::move(farthest));
  }

  // Whether a walk ended in a keyframe or map point, where no change of Map and Atlas helps: it is damaged, or others
  // before it were of other types.
  bool IsInRecord(std::uint64_t at) const {
    const auto is_in = [&](const std::vector<Record>& records) {
      const auto behind = std::ranges::upper_bound(records, at, {}, &Record::body);
      if (behind == records.begin()) return false;
      return behind == records.end() ? records.size() == 1 : at < behind->begin;
    };
    return std::ranges::any_of(
        maps_, [&](const MapRecords& map) { return is_in(map.keyframes.records) || is_in(map.points.records); });
  }

  // The keyframes and map points of one layout in the frame of another.
  void AddFramed(const ClassOption& frame, const Farthest& farthest, std::vector<Fit>& fits) const {
    constexpr std::size_t kMostFits = 32;
    if (fits.size() == kMostFits) return;
    Fit fit{farthest.layout, 0, farthest.findings};
    fit.layout.root = frame.layout.root;
    for (const LayoutClass& of : frame.layout.classes) {
      LayoutClass* own = fit.layout.Find(of.name);
      if (own == nullptr)
        fit.layout.classes.push_back(of);
      else if (of.name != "KeyFrame" && of.name != "MapPoint")
        *own = of;
    }
    const Verdict verdict = Judge(archive_, fit.layout);
    if (!verdict.whole || verdict.penalty >= kMostPenalty) return;
    fit.penalty = verdict.total;
    Take(frame.findings, fit.findings);
    fits.push_back(std::move(fit));
  }

  static constexpr std::size_t kMostTrials = 2048, kMostFarthest = 6;

  const ArchiveBytes& archive_;
  const std::span<const MapRecords> maps_;
  const MeaningJudge& judge_;
  std::vector<Farthest> farthest_;
  std::uint64_t most_ = 0, farthest_reached_ = 0;
  std::size_t trials_ = 0;
};

class Inference {
 public:
  Inference(RecordLayouts& records, std::size_t choice, const MeaningJudge& judge)
      : records_(records), archive_(records.archive()), maps_(records.maps()), choice_(choice), judge_(judge) {}

  InferredLayout Run() {
    AddKnown(kMostPenalty);
    if (maps_.empty() && fits_.empty()) AddKnown(std::numeric_limits<double>::max());
    Rank();
    std::string problem;
    if (IsDoubtful()) problem = Search(/*thorough=*/false);
    if (IsDoubtful()) (void)Search(/*thorough=*/true);
    if (fits_.empty()) Fail(problem);
    return Chosen();
  }

 private:
  bool IsDoubtful() const {
    return fits_.empty() || !fits_.front().meaning.doubts.empty() || !fits_.front().findings.doubts.empty();
  }

  // Known layouts that come to the end.
  void AddKnown(double most) {
    for (const Layout& layout : KnownLayouts()) {
      const Verdict verdict = Judge(archive_, layout);
      if (!verdict.whole || verdict.penalty >= most) continue;
      fits_.push_back({layout, verdict.total, {}, /*known=*/true});
      if (verdict.penalty >= kMostPenalty)
        fits_.back().findings.doubts.emplace_back("the last byte is reached, but values are unlike those of ORB-SLAM3");
    }
  }

  // Adds changed layouts; what speaks against finding any.
  std::string Search(bool thorough) {
    if (archive_.encoding.long_bytes != 8 || archive_.encoding.size_bytes != 8)
      return "it is of none of the known layouts, and others are only found in archives with longs of 8 bytes";
    if (maps_.empty()) return "it is of none of the known layouts, and no keyframe was found by the size of its grid";
    const auto& [options, problem] = records_.Find(thorough);
    if (!problem.empty()) return problem;
    TypeSearch search(archive_, maps_, judge_);
    const std::size_t before = fits_.size();
    for (Fit& fit : search.Run(options)) fits_.push_back(std::move(fit));
    Rank();
    if (fits_.size() > before) return {};
    return Concat("keyframes and map points are understood", Listed(options.front().findings.differences),
                  ", but nothing explains what stands from byte ", search.most(), " on");
  }
  // ` (KeyFrame: no mnId; MapPoint: no nObs)`.
  static std::string Listed(const std::vector<std::string>& differences) {
    std::string text;
    for (const std::string& difference : differences) text += (text.empty() ? " (" : "; ") + difference;
    return text.empty() ? text : text + ")";
  }

  // By what speaks against them. Decoding all of a large file takes long: then of the first ones only.
  void Rank() {
    constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30U;
    std::ranges::stable_sort(fits_, {}, &Fit::against);
    const std::size_t most = std::clamp<std::size_t>(kMostBytes / (archive_.file.size() + 1), 3, 32);
    if (fits_.size() > most) fits_.erase(fits_.begin() + static_cast<std::ptrdiff_t>(most), fits_.end());
    for (Fit& fit : fits_)
      if (fit.meaning.penalty == 0) fit.meaning = judge_(fit.layout);
    std::erase_if(fits_, [](const Fit& fit) { return fit.meaning.penalty >= kUnreadable; });
    std::ranges::stable_sort(fits_, {}, &Fit::against);
    constexpr std::uint64_t kMostReformed = kMostBytes / 8;  // which are walked through some hundred times
    if (fits_.empty() || fits_.front().meaning.doubts.empty() || archive_.file.size() > kMostReformed) return;
    Fit reformed = fits_.front();
    reformed.meaning.penalty += Judge(archive_, reformed.layout).penalty;
    Reform([this](const Layout& layout) { return MeaningAndMembers(layout); }, reformed.layout, reformed.meaning,
           reformed.findings.differences);
    if (reformed.findings.differences.size() == fits_.front().findings.differences.size()) return;
    reformed.known = false;
    fits_.insert(fits_.begin(), std::move(reformed));
  }

  // A layout is only decoded where its members are like what they are called.
  Meaning MeaningAndMembers(const Layout& layout) const {
    const Verdict verdict = Judge(archive_, layout);
    if (!verdict.whole || verdict.penalty >= kMostPenalty) return {.penalty = kUnreadable, .doubts = {}};
    Meaning meaning = judge_(layout);
    meaning.penalty += verdict.penalty;
    return meaning;
  }

  InferredLayout Chosen() {
    constexpr double kAlike = 2;  // what does not tell one from another
    NameKnown();
    const double most = fits_.front().against() + kAlike;
    std::erase_if(
        fits_, [&](const Fit& fit) { return fit.against() > most || (fits_.front().known && &fit != &fits_.front()); });
    ExpectChoiceUpTo(fits_.size());
    Fit& taken = fits_[choice_ - 1];
    InferredLayout inferred{.layout = taken.layout, .known = taken.known};
    for (const Fit& other : fits_)
      if (&other != &taken) inferred.alternatives.push_back(OtherThan(taken, other));
    inferred.differences = taken.findings.differences;
    inferred.doubts = taken.findings.doubts;
    inferred.doubts.insert(inferred.doubts.end(), taken.meaning.doubts.begin(), taken.meaning.doubts.end());
    if (!taken.known) inferred.layout.who = "";
    if (!taken.known) inferred.layout.id = "inferred", inferred.layout.title = "inferred from a file";
    for (const MapRecords& map : maps_) {
      inferred.keyframes += map.keyframes.records.size();
      inferred.points += map.points.records.size();
    }
    return inferred;
  }
  // The search comes upon known layouts, too, and upon one by several ways.
  void NameKnown() {
    std::vector<Fit> named;
    for (Fit& fit : fits_) {
      for (const Layout& known : KnownLayouts())
        if (!fit.known && SameBytes(known, fit.layout)) {
          fit.layout = known;
          fit.known = true;
          fit.findings.differences.clear();
        }
      if (std::ranges::none_of(named, [&](const Fit& other) { return SameBytes(other.layout, fit.layout); }))
        named.push_back(std::move(fit));
    }
    fits_ = std::move(named);
  }

  // The changes of another layout that are not those of the one that is taken.
  static std::string OtherThan(const Fit& taken, const Fit& other) {
    if (other.known) return "as " + other.layout.id;
    std::string text;
    for (const std::string& difference : other.findings.differences)
      if (std::ranges::find(taken.findings.differences, difference) == taken.findings.differences.end())
        text += (text.empty() ? "" : "; ") + difference;
    if (!text.empty()) return text;
    for (const std::string& difference : other.findings.differences) text += (text.empty() ? "" : "; ") + difference;
    return text.empty() ? "members of other types" : "only " + text;
  }

  void ExpectChoiceUpTo(std::size_t most) const {
    if (choice_ < 1 || choice_ > most)
      throw Error(ErrorKind::kUsage, "", "",
                  Concat("there is no layout ", choice_, " to choose: ", detail::Counted(most, "layout"), " fit",
                         most == 1 ? "s" : ""));
  }
  [[noreturn]] static void Fail(const std::string& problem) {
    throw Error(
        ErrorKind::kNotPossible, "", "",
        Concat(
            "no layout found: ", problem,
            ". `RecoverAtlas` saves what is whole of a file that is cut or damaged, and `DeriveLayoutOfFolder` derives "
            "the layout from the sources of the program that wrote it"));
  }

  RecordLayouts& records_;
  const ArchiveBytes& archive_;
  const std::span<const MapRecords> maps_;
  const std::size_t choice_;  // from 1
  const MeaningJudge& judge_;
  std::vector<Fit> fits_;
};

}  // namespace

const RecordLayouts::Found& RecordLayouts::Find(bool thorough) {
  std::optional<Found>& found = found_[thorough ? 1 : 0];
  if (!found) found = OptionsOf(archive_, maps_, thorough);
  return *found;
}

InferredLayout Infer(RecordLayouts& records, const InferOptions& options, const MeaningJudge& meaning) {
  return Inference(records, options.choice, meaning).Run();
}

}  // namespace slamdb::layouts
