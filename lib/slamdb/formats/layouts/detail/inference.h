// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

// What was found out, for people.
struct Findings {
  std::vector<std::string> differences, alternatives, doubts;
};

// A layout with other members of a class.
struct ClassOption {
  Layout layout;
  Findings findings;
};

// What the members of a class may be that its records have: those of a known layout, or of `layout` with the fewest
// members more or less, likeliest first. `records`: from end to end, with every class met before; none: `layout` it is.
std::vector<ClassOption> FindClass(const ArchiveBytes& archive, std::string_view class_name,
                                   std::span<const MemberPlace> records, const Layout& layout);

// Whether a member is one that FindClass put in.
bool IsUnknown(const LayoutMember& member);
// What a member may be whose bytes were seen where every class has been met, likeliest first; several members one
// behind the other are joined by `+`.
std::vector<std::string> TypesLike(const std::string& warm_type);
// Gives a member of the layout another of those types; classes of its own where it needs them.
void SetType(Layout& layout, const std::string& class_name, std::size_t row, const std::string& types);

// Gives the layout the members of Map and Atlas and the root that the file has. Returns whether it comes to the end.
bool FindFrame(const ArchiveBytes& archive, std::span<const std::uint64_t> known_ends, Layout& layout,
               Findings& findings);

// The layout that keyframes and map points have in a damaged archive; unknown members are bytes as they stand where
// every class has been met. Nothing when no change of v1.0 explains them.
std::optional<Layout> LayoutOfRecords(const ArchiveBytes& archive, std::span<const MapRecords> maps);

}  // namespace slamdb::layouts
