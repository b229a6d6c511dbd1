// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/formats/layouts/detail/record_search.h"
#include "slamdb/formats/layouts/detail/records.h"
#include "slamdb/formats/layouts/infer.h"

// The parts of InferLayout.
namespace slamdb::layouts {

// An archive whose layout is looked for.
struct ArchiveBytes {
  std::string_view file;
  ArchiveEncoding encoding;
  std::uint64_t begin = 0;  // behind the header
};

// How far a layout comes, and what speaks against what it reads: penalties by record.
struct Verdict {
  bool whole = false;
  std::uint64_t reached = 0;
  double penalty = 0;                // of the class against which most speaks
  double total = 0;                  // of all classes
  std::vector<std::size_t> members;  // by class: how many were come to
};
// Above this, a layout that comes to the end reads other members than it says.
inline constexpr double kMostPenalty = 40;
Verdict Judge(const ArchiveBytes& archive, const Layout& layout, std::span<const std::uint64_t> known_ends = {});

// What speaks against what a whole file means, read in a layout: whether points lie where keyframes see them, and more.
struct Meaning {
  double penalty = 0;               // as Verdict's
  std::vector<std::string> doubts;  // for people
};
using MeaningJudge = std::function<Meaning(const Layout&)>;
// From here on it cannot be read in the layout at all.
inline constexpr double kUnreadable = 1000;

// Puts members into other forms of as many bytes, or into another order, as long as that takes away much of what speaks
// against the meaning. Says what it changed.
void Reform(const MeaningJudge& judge, Layout& layout, Meaning& meaning, std::vector<std::string>& differences);

// What was found out, for people.
struct Findings {
  std::vector<std::string> differences, doubts;
};

// A layout with other members of a class.
struct ClassOption {
  Layout layout;
  Findings findings;
};

// What the members of a class may be that its records have: those of a known layout, or of `layout` with the fewest
// changes, likeliest first; `thorough`: changes even where a known one fits. `records`: from end to end, with every
// class met before; none: `layout` it is.
std::vector<ClassOption> FindClass(const ArchiveBytes& archive, std::string_view class_name,
                                   std::span<const MemberPlace> records, const Layout& layout, bool thorough = false);

// The option with unknown bytes that are much like the pose of a keyframe or the position of a point, as one that was
// predicted, in place of that member, and the member in theirs: the meaning tells which is right. `records` as above.
std::vector<ClassOption> LookAlikesOf(const ArchiveBytes& archive, const ClassOption& option,
                                      std::string_view class_name, std::span<const MemberPlace> records);

// How a member that was put in is told, between its neighbours; there may be none on one side:
// `KeyFrame: unknown1, 8 bytes, between mnId and mnFrameId`.
std::string InsertionText(std::string_view of_class, std::string_view name, const std::string& type,
                          std::string_view front, std::string_view back);

// Whether a member is one that FindClass put in.
bool IsUnknown(const LayoutMember& member);
// Gives a member of the layout another type, or several members joined by `+`; classes of its own where it needs them.
void SetType(Layout& layout, const std::string& class_name, std::size_t row, const std::string& types);

// The types that a layout's unknown members may have, one combination after the other, likeliest first.
class Typings {
 public:
  explicit Typings(const Layout& layout);
  std::size_t count() const { return count_; }
  Layout At(std::size_t row) const;

 private:
  struct Unknown {
    std::string of_class;
    std::size_t row = 0;
    std::vector<std::string> types;
  };
  static constexpr std::size_t kMost = 2048;

  const Layout& layout_;
  std::vector<Unknown> unknown_;
  std::size_t count_ = 1;
};

// The layout with other members of Map, Atlas and cameras, and another root, that come to the end of the file,
// likeliest first; empty where none is found.
std::vector<ClassOption> FindFrame(const ArchiveBytes& archive, std::span<const std::uint64_t> known_ends,
                                   const Layout& layout, const MeaningJudge& judge);

// The keyframes and map points of an archive, and the layouts that they may have, which are looked for once.
class RecordLayouts {
 public:
  explicit RecordLayouts(const ArchiveBytes& archive)
      : archive_(archive), maps_(FindRecords(archive.file, archive.encoding)) {}

  const ArchiveBytes& archive() const { return archive_; }
  std::span<const MapRecords> maps() const { return maps_; }

  // Likeliest first; unknown members are bytes as they stand where every class has been met.
  struct Found {
    std::vector<ClassOption> options;
    std::string problem;  // where no change of v1.0 explains them
  };
  const Found& Find(bool thorough);

 private:
  const ArchiveBytes archive_;
  const std::vector<MapRecords> maps_;
  std::array<std::optional<Found>, 2> found_;  // by `thorough`
};

// InferLayout of a binary archive, but for the proof: InferredLayout::same_bytes stays false, and keyframes and points
// are those whose records were found.
//
// Throws Error: kNotPossible when no layout was found, saying how far it came; kUsage for a choice that is not there.
InferredLayout Infer(RecordLayouts& records, const InferOptions& options, const MeaningJudge& meaning);

}  // namespace slamdb::layouts
