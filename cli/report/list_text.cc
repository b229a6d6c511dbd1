// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/list_text.h"

#include <algorithm>
#include <array>

#include "cli/report/layout.h"
#include "cli/words.h"
#include "slamdb/formats/info.h"

namespace slamdb::cli {
namespace {

using enum Table::Align;

std::string SensorsText(const ListedAtlas& atlas) {
  std::string text;
  for (const MapSensor sensor : atlas.summary.sensors)
    text += (text.empty() ? "" : ", ") + SensorText(sensor, /*has_imu=*/false);
  return text + (atlas.summary.has_imu ? " with IMU" : "");
}

// Whether maps with and without scale are in it, so that no sum of lengths tells anything.
bool MixesUnits(const AtlasSummary& summary) {
  return !summary.is_metric &&
         std::ranges::any_of(summary.sensors, [](MapSensor sensor) { return sensor != MapSensor::kMonocular; });
}

std::string LengthText(const ListedAtlas& atlas) {
  if (!atlas.summary.begin_time) return {};
  if (MixesUnits(atlas.summary)) return "mixed";
  return detail::LengthText(atlas.summary.trajectory_length, atlas.summary.is_metric ? "m" : "units");
}

std::string SpanText(const ListedAtlas& atlas) {
  return atlas.summary.begin_time ? DurationText(atlas.summary.duration) : std::string();
}

// To the minute; empty when the times count from elsewhere.
std::string BeginText(const ListedAtlas& atlas) {
  constexpr std::size_t kToTheMinute = 16;
  return atlas.summary.begin_time ? DateText(*atlas.summary.begin_time).substr(0, kToTheMinute) : std::string();
}

std::string SizeText(const ListedAtlas& atlas) { return atlas.bytes ? HumanBytes(*atlas.bytes) : std::string(); }

std::string RevisionText(const ListedAtlas& atlas) {
  return atlas.revision == 0 ? std::string() : Grouped(atlas.revision);
}

template <auto member>
std::string CountText(const ListedAtlas& atlas) {
  return Grouped(atlas.summary.*member);
}

template <auto member>
std::string Text(const ListedAtlas& atlas) {
  return atlas.*member;
}

struct Column {
  ListKey key;
  std::string_view heading;
  Table::Align align;
  std::string (*text)(const ListedAtlas&);
  bool of_failed = false;  // known of one that could not be read, too
};

constexpr std::array kColumns = {
    Column{ListKey::kName, "NAME", kLeft, Text<&ListedAtlas::name>, true},
    Column{ListKey::kInput, "ATLAS", kLeft, Text<&ListedAtlas::input>, true},
    Column{ListKey::kMaps, "MAPS", kRight, CountText<&AtlasSummary::maps>},
    Column{ListKey::kSensor, "SENSOR", kLeft, SensorsText},
    Column{ListKey::kKeyframes, "KEYFRAMES", kRight, CountText<&AtlasSummary::keyframes>},
    Column{ListKey::kPoints, "POINTS", kRight, CountText<&AtlasSummary::points>},
    Column{ListKey::kObservations, "OBSERVATIONS", kRight, CountText<&AtlasSummary::observations>},
    Column{ListKey::kLandmarks, "LANDMARKS", kRight, CountText<&AtlasSummary::landmarks>},
    Column{ListKey::kLength, "LENGTH", kRight, LengthText},
    Column{ListKey::kSpan, "SPAN", kRight, SpanText},
    Column{ListKey::kDate, "DATE (UTC)", kLeft, BeginText},
    Column{ListKey::kSize, "SIZE", kRight, SizeText, true},
    Column{ListKey::kFormat, "FORMAT", kLeft, Text<&ListedAtlas::format>, true},
    Column{ListKey::kRevision, "REVISION", kRight, RevisionText},
    Column{ListKey::kSaved, "SAVED", kLeft, Text<&ListedAtlas::saved_at>, true},
    Column{ListKey::kVerdict, "VERDICT", kLeft, Text<&ListedAtlas::verdict>, true},
};

const Column& ColumnOf(ListKey key) { return *std::ranges::find(kColumns, key, &Column::key); }

std::string CellOf(const ListedAtlas& atlas, const Column& column) {
  return atlas.failure.empty() || column.of_failed ? column.text(atlas) : std::string();
}

// Without the name of the atlas, which begins the line.
std::string FailureText(const ListedAtlas& atlas) {
  if (atlas.failure.empty()) return {};
  const std::string text = InCommandWords(atlas.failure);
  return text.starts_with(atlas.input + ": ") ? text.substr(atlas.input.size() + 2) : text;
}

bool Differ(std::span<const ListedAtlas> atlases, std::string ListedAtlas::*member) {
  return std::ranges::any_of(atlases, [&](const auto& atlas) { return atlas.*member != atlases[0].*member; });
}

bool AreOfOneStore(std::span<const ListedAtlas> atlases) {
  const auto store_of = [](const ListedAtlas& atlas) { return atlas.input.substr(0, atlas.input.rfind('#')); };
  return std::ranges::all_of(
      atlases, [&](const ListedAtlas& atlas) { return atlas.revision > 0 && store_of(atlas) == store_of(atlases[0]); });
}

// Columns that go where there is no room for all, the first of them first. Names are shortened before more goes.
constexpr ListKey kLeastFirst[] = {ListKey::kFormat, ListKey::kRevision, ListKey::kSpan,
                                   ListKey::kSensor, ListKey::kSaved,    ListKey::kDate,
                                   ListKey::kMaps,   ListKey::kLength,   ListKey::kLandmarks};
constexpr std::size_t kShortestName = 20;

Table TableOf(std::span<const ListedAtlas> atlases, std::span<const ListKey> columns) {
  std::vector<Table::Align> aligns;
  std::vector<std::string> headings;
  for (const ListKey key : columns) {
    aligns.push_back(ColumnOf(key).align);
    headings.emplace_back(ColumnOf(key).heading);
  }
  const bool failed = std::ranges::any_of(atlases, [](const auto& atlas) { return !atlas.failure.empty(); });
  aligns.push_back(kLeft);
  headings.emplace_back(failed ? "PROBLEM" : "");
  Table table(aligns);
  table.Add(headings);
  for (const ListedAtlas& atlas : atlases) {
    std::vector<std::string> cells;
    for (const ListKey key : columns) cells.push_back(CellOf(atlas, ColumnOf(key)));
    cells.push_back(FailureText(atlas));
    table.Add(std::move(cells));
  }
  return table;
}

// Columns of text that the first columns of a table take; problems behind them may be as long as they are.
std::size_t RoomFor(const Table& table, std::size_t columns) {
  std::size_t room = 0;
  for (std::size_t column = 0; column < columns; ++column) room += table.WidthOf(column) + (column == 0 ? 0 : 2);
  return room;
}

}  // namespace

std::vector<ListKey> UsualColumns(std::span<const ListedAtlas> atlases) {
  const bool of_store = AreOfOneStore(atlases);
  const auto some = [&](const auto& has) { return std::ranges::any_of(atlases, has); };
  std::vector<ListKey> columns = {of_store ? ListKey::kName : ListKey::kInput, ListKey::kMaps, ListKey::kSensor,
                                  ListKey::kKeyframes, ListKey::kPoints};
  if (some([](const auto& atlas) { return atlas.summary.landmarks > 0; })) columns.push_back(ListKey::kLandmarks);
  columns.insert(columns.end(), {ListKey::kLength, ListKey::kSpan});
  if (some([](const auto& atlas) { return !BeginText(atlas).empty(); })) columns.push_back(ListKey::kDate);
  columns.push_back(ListKey::kSize);
  if (!atlases.empty() && Differ(atlases, &ListedAtlas::format)) columns.push_back(ListKey::kFormat);
  if (of_store) columns.insert(columns.end(), {ListKey::kRevision, ListKey::kSaved});
  if (some([](const auto& atlas) { return !atlas.verdict.empty(); })) columns.push_back(ListKey::kVerdict);
  return columns;
}

std::string ListText(std::span<const ListedAtlas> atlases, std::vector<ListKey> columns,
                     std::optional<std::size_t> width) {
  Table table = TableOf(atlases, columns);
  std::string left_out;
  for (const ListKey least : kLeastFirst) {
    if (!width || RoomFor(table, columns.size()) <= *width) break;
    const auto column = std::ranges::find(columns, least);
    if (column == columns.end()) continue;
    table.Drop(static_cast<std::size_t>(column - columns.begin()));
    columns.erase(column);
    left_out.append(left_out.empty() ? "" : ", ").append(NameOf(least));
  }
  if (const std::size_t room = RoomFor(table, columns.size()); width && room > *width) {
    const std::size_t name = table.WidthOf(0), excess = room - *width;
    table.Shorten(0, std::max(kShortestName, name - std::min(name, excess)));
  }
  if (!left_out.empty()) left_out = "left out for want of room: " + left_out + "; --columns names what to show\n";
  return table.ToString() + left_out;
}

}  // namespace slamdb::cli
