// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/anchors.h"

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parse_file.h"
#include "slamdb/base/detail/table.h"
#include "slamdb/base/error.h"

namespace slamdb {
namespace {

// The columns of a pair of keyframes, then those of a pair of places; a table has either or both.
constexpr std::size_t kKeyFrames = 0, kPlaces = 2;

const detail::TableKind& AnchorTable() {
  static const detail::TableKind kind = {
      .columns = {{{"first", "first_keyframe", "keyframe_first", "first_kf"}, 0},
                  {{"second", "second_keyframe", "keyframe_second", "second_kf"}, 0},
                  {{"first_x"}, 1},
                  {{"first_y"}, 1},
                  {{"first_z"}, 1},
                  {{"second_x"}, 1},
                  {{"second_y"}, 1},
                  {{"second_z"}, 1}},
      .expected =
          "the columns first,second of keyframes, or first_x,first_y,first_z,second_x,second_y,second_z of "
          "places"};
  return kind;
}

// The numbers in the columns from `first` on; nothing when all cells are empty, or the columns are not there.
template <class Number, std::size_t count>
std::optional<std::array<Number, count>> NumbersAt(const detail::Table& table, std::size_t first) {
  bool any = false;
  for (std::size_t i = 0; i < count; ++i) any |= !table.Raw(first + i).empty();
  if (!any) return std::nullopt;
  std::array<Number, count> numbers{};
  for (std::size_t i = 0; i < count; ++i) numbers[i] = table.Get<Number>(first + i);
  return numbers;
}

}  // namespace

Anchors ParseAnchors(std::string_view text) {
  Anchors anchors;
  for (const std::string_view pair : detail::Split(text, ',')) {
    const auto ids = detail::Split(pair, ':');
    const auto first = detail::ParseNumber<std::uint64_t>(detail::Trimmed(ids.front()));
    const auto second = detail::ParseNumber<std::uint64_t>(detail::Trimmed(ids.back()));
    if (ids.size() != 2 || !first || !second)
      throw Error(ErrorKind::kUsage,
                  detail::Concat("expected pairs of keyframes as FIRST:SECOND,..., or a file, found '", text, "'"));
    anchors.keyframes.push_back({KeyFrameId(*first), KeyFrameId(*second)});
  }
  return anchors;
}

Anchors ParseAnchorsCsv(std::string_view csv) {
  Anchors anchors;
  detail::Table table(csv, AnchorTable());
  while (table.Next()) {
    if (const auto ids = NumbersAt<std::uint64_t, 2>(table, kKeyFrames))
      anchors.keyframes.push_back({KeyFrameId((*ids)[0]), KeyFrameId((*ids)[1])});
    if (const auto x = NumbersAt<double, 6>(table, kPlaces))
      anchors.places.push_back({{(*x)[0], (*x)[1], (*x)[2]}, {(*x)[3], (*x)[4], (*x)[5]}});
  }
  return anchors;
}

Anchors ReadAnchors(const std::string& text_or_path, Notices* notices) {
  Notices unheard;
  std::error_code missing;
  if (!std::filesystem::exists(text_or_path, missing)) return ParseAnchors(text_or_path);
  return detail::ParseLines(text_or_path, "a table of anchors", notices == nullptr ? unheard : *notices,
                            ParseAnchorsCsv);
}

}  // namespace slamdb
