// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/layouts/detail/inference.h"

namespace slamdb::layouts {
namespace {

using detail::Concat;

constexpr std::size_t kBeam = 24, kMostEdits = 4, kMostAlike = 3, kMostOptions = 8;
constexpr std::size_t kLongestRemoval = 6;
constexpr std::size_t kMostTrials = 15'000;

// What forks' maps, atlases and cameras may have more, likeliest first.
std::vector<std::string> FrameTypes() {
  std::vector<std::string> types = {"u64",
                                    "u32",
                                    "u8",
                                    "arr<u8,12>",
                                    "arr<u8,28>",
                                    "string",
                                    "vec<u64>",
                                    "vec<u32>",
                                    "vec<f64>",
                                    "set<u64>",
                                    "set<u32>",
                                    "map<u64,i32>",
                                    "map<u64,u64>",
                                    "map<u64,f64>",
                                    "map<u32,u32>",
                                    "vec<string>",
                                    "mat",
                                    "kps",
                                    "ptr<KeyFrame>",
                                    "ptr<MapPoint>",
                                    "ptr<Map>",
                                    "vec<ptr<KeyFrame>>",
                                    "vec<ptr<MapPoint>>",
                                    "set<ptr<KeyFrame>>",
                                    "set<ptr<Map>>",
                                    "vec<vec<u64>>",
                                    "vec<vec<f64>>",
                                    "vec<vec<f32>>",
                                    "vec<u8>",
                                    "vec<u16>"};
  for (const std::uint32_t bytes :
       {2, 3, 5, 6, 7, 9, 10, 11, 13, 14, 15, 16, 17, 18, 20, 24, 32, 36, 40, 48, 56, 64, 72, 96, 128})
    types.push_back(Concat("arr<u8,", bytes, ">"));
  for (std::uint32_t bytes = 1; bytes <= 64; bytes += bytes < 17 ? 1 : 4)
    types.push_back(Concat("val<Unknown", bytes, ">"));
  for (const std::uint32_t bytes : {2, 4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 48})
    types.push_back(Concat("set<arr<u8,", bytes, ">>"));
  for (const std::uint32_t bytes : {4, 8, 9, 12, 16, 20, 24, 28, 32, 36})
    types.push_back(Concat("vec<val<Unknown", bytes, ">>"));
  return types;
}

struct Candidate {
  Layout layout;
  Verdict verdict;
  std::vector<std::string> edits;
  std::size_t kind = 0;  // of the last edit: rarer types come later
};

class FrameSearch {
 public:
  FrameSearch(const ArchiveBytes& archive, std::span<const std::uint64_t> known_ends, const MeaningJudge& judge)
      : archive_(archive), known_ends_(known_ends), judge_(judge) {}

  // Edits one after the other; those that come farthest go on.
  std::vector<ClassOption> Run(const Layout& layout) {
    std::vector<Candidate> beam{{.layout = layout, .verdict = Judge(archive_, layout, known_ends_)}};
    AddKnown(layout, beam);
    for (std::size_t edits = 0; edits < kMostEdits && whole_.empty(); ++edits) {
      next_.clear();
      for (const Candidate& candidate : beam) Extend(candidate);
      beam = Farthest();
    }
    return Likeliest();
  }

 private:
  // The frames of the other known layouts.
  void AddKnown(const Layout& layout, std::vector<Candidate>& beam) {
    for (const Layout& known : KnownLayouts().subspan(1)) {
      Candidate candidate{.layout = layout};
      candidate.layout.root = known.root;
      for (const LayoutClass& of : known.classes) {
        LayoutClass* own = candidate.layout.Find(of.name);
        if (own == nullptr)
          candidate.layout.classes.push_back(of);
        else if (of.name == "Map" || of.name == "Atlas")
          *own = of;
      }
      candidate.edits = {Concat("Atlas and Map: as in ", known.id)};
      candidate.verdict = Judge(archive_, candidate.layout, known_ends_);
      const bool fits = candidate.verdict.whole && candidate.verdict.penalty < kMostPenalty;
      if (fits && judge_(candidate.layout).penalty < kUnreadable)
        whole_.push_back(std::move(candidate));
      else if (candidate.layout.root != layout.root)
        beam.push_back(std::move(candidate));
    }
  }

  // Many edits bring the walk to the same place: few of each are worth going on with.
  std::vector<Candidate> Farthest() {
    std::ranges::stable_sort(next_, [](const Candidate& a, const Candidate& b) {
      const std::size_t of_a = ListsPassed(a), of_b = ListsPassed(b);
      if (of_a != of_b) return of_a > of_b;
      return a.verdict.reached != b.verdict.reached ? a.verdict.reached > b.verdict.reached
                                                    : a.verdict.penalty < b.verdict.penalty;
    });
    std::vector<Candidate> beam;
    std::size_t alike = 0;
    for (Candidate& candidate : next_) {
      const bool same = !beam.empty() && beam.back().verdict.reached == candidate.verdict.reached;
      alike = same ? alike + 1 : 0;
      if (alike < kMostAlike) beam.push_back(std::move(candidate));
      if (beam.size() == kBeam) break;
    }
    return beam;
  }

  // Changes of members that the walk has come to: what stands behind them does not help it on.
  void Extend(const Candidate& from) {
    for (const char* name : {"Map", "Atlas", "GeometricCamera", "Pinhole", "KannalaBrandt8"}) {
      const LayoutClass* of = from.layout.Find(name);
      if (of == nullptr) continue;
      const std::size_t members = of->members.size();
      const std::size_t entered = from.verdict.members.at(static_cast<std::size_t>(of - from.layout.classes.data()));
      for (std::size_t row = FirstRow(from, *of); row < entered; ++row) {
        for (std::size_t type = 0; type < types_.size(); ++type) Insert(from, name, row, type);
        for (std::size_t count = 1; count <= kLongestRemoval && row + count <= members; ++count)
          Remove(from, name, row, count);
      }
    }
  }
  // The row behind the last list of objects that the walk has passed.
  static std::size_t RowBehindLists(const Candidate& from, const LayoutClass& of) {
    const std::size_t entered = from.verdict.members.at(static_cast<std::size_t>(&of - from.layout.classes.data()));
    std::size_t behind = 0;
    for (std::size_t i = 0; i < of.members.size() && i + 1 < entered; ++i)
      if (of.members[i].type.starts_with("vec<ptr<")) behind = i + 1;
    return behind;
  }
  // Whose objects no chance brings about.
  static std::size_t ListsPassed(const Candidate& from) {
    std::size_t passed = 0;
    for (const char* name : {"Map", "Atlas"}) {
      const LayoutClass* of = from.layout.Find(name);
      if (of != nullptr) passed += RowBehindLists(from, *of);
    }
    return passed;
  }
  // Where changes may stand that lead farther: behind the lists that were passed, as those are right.
  static std::size_t FirstRow(const Candidate& from, const LayoutClass& of) {
    const LayoutClass *map = from.layout.Find("Map"), *atlas = from.layout.Find("Atlas");
    const auto cameras = std::ranges::find(atlas->members, "mvpCameras", &LayoutMember::name) - atlas->members.begin();
    const std::size_t behind = RowBehindLists(from, of);
    if (&of != atlas)
      return static_cast<std::ptrdiff_t>(RowBehindLists(from, *atlas)) > cameras ? of.members.size() + 1 : behind;
    const bool in_map = map != nullptr && RowBehindLists(from, *map) > 0;
    const auto maps = std::ranges::find(atlas->members, "mvpBackupMaps", &LayoutMember::name) - atlas->members.begin();
    return in_map ? std::max(behind, static_cast<std::size_t>(maps) + 1) : behind;
  }
  void Insert(const Candidate& from, const char* name, std::size_t row, std::size_t type) {
    Candidate next = from;
    LayoutClass& of = *next.layout.Find(name);
    const std::string front = row == 0 ? "" : of.members[row - 1].name;
    const std::string back = row == of.members.size() ? "" : of.members[row].name;
    std::size_t number = 1;
    for (const LayoutClass& other : next.layout.classes)
      number += static_cast<std::size_t>(std::ranges::count_if(other.members, IsUnknown));
    of.members.insert(of.members.begin() + static_cast<std::ptrdiff_t>(row), {Concat("unknown", number), types_[type]});
    SetType(next.layout, name, row, types_[type]);
    next.edits.push_back(InsertionText(name, Concat("unknown", number), types_[type], front, back));
    next.kind = type;
    Try(std::move(next), from);
  }
  void Remove(const Candidate& from, const char* name, std::size_t row, std::size_t count) {
    Candidate next = from;
    LayoutClass& of = *next.layout.Find(name);
    std::string names;
    for (std::size_t i = row; i < row + count; ++i) {
      const std::string& type = of.members[i].type;
      if (type.find("ptr<") != std::string::npos || type.find("val<") == 0 || IsUnknown(of.members[i])) return;
      names += (i > row ? ", " : "") + of.members[i].name;
    }
    const auto begin = of.members.begin() + static_cast<std::ptrdiff_t>(row);
    of.members.erase(begin, begin + static_cast<std::ptrdiff_t>(count));
    next.edits.push_back(Concat(name, ": no ", names));
    next.kind = types_.size() + count;
    Try(std::move(next), from);
  }
  void Try(Candidate next, const Candidate& from) {
    if (++trials_ > kMostTrials) return;
    next.verdict = Judge(archive_, next.layout, known_ends_);
    if (next.verdict.whole) next.verdict = Judge(archive_, next.layout);
    if (next.verdict.whole && next.verdict.penalty < kMostPenalty)
      whole_.push_back(std::move(next));
    else if (next.verdict.reached > from.verdict.reached && !next.verdict.whole)
      next_.push_back(std::move(next));
  }

  // Those against which least speaks; of those alike the likeliest type, at the last place.
  std::vector<ClassOption> Likeliest() {
    const auto better = [](const Candidate& a, const Candidate& b) {
      return a.verdict.total != b.verdict.total ? a.verdict.total < b.verdict.total : a.kind < b.kind;
    };
    std::ranges::reverse(whole_);
    std::ranges::stable_sort(whole_, better);
    std::vector<ClassOption> options;
    for (Candidate& candidate : whole_)
      if (candidate.verdict.total == whole_.front().verdict.total && options.size() < kMostOptions)
        options.push_back({std::move(candidate.layout), {.differences = std::move(candidate.edits), .doubts = {}}});
    return options;
  }

  const ArchiveBytes& archive_;
  const std::span<const std::uint64_t> known_ends_;
  const MeaningJudge& judge_;
  const std::vector<std::string> types_ = FrameTypes();
  std::vector<Candidate> next_, whole_;
  std::size_t trials_ = 0;
};

}  // namespace

std::vector<ClassOption> FindFrame(const ArchiveBytes& archive, std::span<const std::uint64_t> known_ends,
                                   const Layout& layout, const MeaningJudge& judge) {
  return FrameSearch(archive, known_ends, judge).Run(layout);
}

}  // namespace slamdb::layouts
