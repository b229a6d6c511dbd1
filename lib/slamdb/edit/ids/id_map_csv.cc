// SPDX-License-Identifier: BSD-3-Clause
// Id maps as CSV tables, and tables in which ids of an atlas stand.
#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/table.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/ids/id_map.h"

namespace slamdb {
namespace {

// A cell that is read back as it is: not as several, not trimmed, not as a comment.
std::string Quoted(std::string_view text) {
  if (text.find_first_of(",\"\n\r#%") == text.npos && detail::Trimmed(text) == text) return std::string(text);
  std::string quoted = "\"";
  for (const char letter : text) quoted.append(letter == '"' ? 2 : 1, letter);
  return quoted + '"';
}

enum IdColumn : std::size_t { kInput, kKind, kBefore, kAfter };

const detail::TableKind& IdTable() {
  static const detail::TableKind kind = {
      .columns = {{{"input"}, detail::Column::kOptional}, {{"kind"}}, {{"old"}}, {{"new"}}},
      .expected = "the column names kind,old,new of an id map",
      .by_position = false};
  return kind;
}

IdPair PairOf(const detail::Table& table) {
  constexpr std::string_view kAnId = "an id";
  return {table.Get<std::uint64_t>(kBefore, kAnId),
          table.Raw(kAfter).empty() ? kNoId : table.Get<std::uint64_t>(kAfter, kAnId)};
}

// An input's ids, and the names of the counters that its rows gave.
struct RowsOfInput {
  IdMap ids;
  std::vector<std::string_view> counters;
};

void AddRow(RowsOfInput& rows, const detail::Table& table) {
  IdMap& ids = rows.ids;
  const IdPair pair = PairOf(table);
  const std::string name = table.Text(kKind);
  if (const auto kind = IdKindByName(name)) {
    ids[*kind].push_back(pair);
    return;
  }
  const auto counters = CounterFields();
  const auto counter = std::ranges::find(counters, name, &CounterField::name);
  if (counter == counters.end())
    throw table.LineError(detail::Concat("unknown kind '", name, "', expected map, keyframe, point, frame or camera"));
  if (!ids.counters_before) ids.counters_before = ids.counters_after = Counters();
  (*ids.counters_before).*counter->field = pair.before;
  (*ids.counters_after).*counter->field = pair.after;
  rows.counters.push_back(counter->name);
}

// A table that was cut between two lines: the counters stand last. One without any may be of a person.
void RequireAllCounters(const RowsOfInput& rows) {
  if (rows.counters.empty()) return;
  for (const CounterField& counter : CounterFields())
    if (std::ranges::find(rows.counters, counter.name) == rows.counters.end())
      throw Error(ErrorKind::kDamaged,
                  detail::Concat("the id map has a row ", rows.counters.back(), ", and none ", counter.name,
                                 "; the counters stand together at its end: it may be cut there"));
}

// Which kind of id each column of a table holds, by the names of columns that our own tables have.
std::vector<std::optional<IdKind>> KindsOfColumns(const std::vector<detail::ColumnName>& names) {
  static constexpr std::pair<std::string_view, IdKind> kKnown[] = {
      {"map", IdKind::kMap},
      {"keyframe", IdKind::kKeyFrame},
      {"parent", IdKind::kKeyFrame},
      {"reference_keyframe", IdKind::kKeyFrame},
      {"point", IdKind::kPoint},
      {"frame", IdKind::kFrame},
      {"frame_id", IdKind::kFrame},
      {"camera", IdKind::kCamera},
      {"keyframe_id", IdKind::kKeyFrame},
  };
  const auto has = [&](std::string_view name) {
    return std::ranges::find(names, name, &detail::ColumnName::text) != names.end();
  };
  std::vector<std::optional<IdKind>> kinds(names.size());
  for (std::size_t column = 0; column < names.size(); ++column) {
    const auto found = std::ranges::find(kKnown, names[column].text, &std::pair<std::string_view, IdKind>::first);
    if (found != std::end(kKnown))
      kinds[column] = found->second;
    else if (names[column].text == "id" && has("timestamp"))
      kinds[column] = IdKind::kKeyFrame;
    else if (names[column].text == "id" && has("x"))
      kinds[column] = IdKind::kPoint;
  }
  return kinds;
}

}  // namespace

std::string IdMapsToCsv(std::span<const IdMap> maps) {
  std::string csv = "input,kind,old,new\n";
  for (const IdMap& ids : maps) {
    const std::string input = Quoted(ids.input);
    const auto add = [&](std::string_view kind, std::uint64_t before, std::uint64_t after) {
      csv.append(input).append(",").append(kind).append(",").append(std::to_string(before)).append(",");
      csv.append(after == kNoId ? std::string() : std::to_string(after)).append("\n");
    };
    for (std::size_t kind = 0; kind < kIdKinds; ++kind)
      for (const IdPair& pair : ids.kinds[kind]) add(NameOf(static_cast<IdKind>(kind)), pair.before, pair.after);
    if (!ids.counters_before || !ids.counters_after) continue;
    for (const CounterField& counter : CounterFields())
      add(counter.name, (*ids.counters_before).*counter.field, (*ids.counters_after).*counter.field);
  }
  return csv;
}

std::vector<IdMap> ParseIdMapsCsv(std::string_view csv) {
  detail::Table table(csv, IdTable());
  std::vector<RowsOfInput> inputs;
  const auto input_of = [](const RowsOfInput& rows) -> const std::string& { return rows.ids.input; };
  while (table.Next()) {
    const std::string input = table.Text(kInput);
    if (inputs.empty() || input_of(inputs.back()) != input) {
      if (std::ranges::find(inputs, input, input_of) != inputs.end())
        throw table.LineError(detail::Concat("rows of input '", input, "' do not stand together"));
      inputs.push_back({.ids = {.input = input}});
    }
    AddRow(inputs.back(), table);
  }
  if (inputs.empty()) throw Error(ErrorKind::kDamaged, "the id map is empty");
  std::vector<IdMap> maps;
  for (RowsOfInput& rows : inputs) {
    RequireAllCounters(rows);
    for (std::vector<IdPair>& pairs : rows.ids.kinds) std::ranges::stable_sort(pairs, {}, &IdPair::before);
    maps.push_back(std::move(rows.ids));
  }
  return maps;
}

std::string ApplyIdMapToCsv(std::string_view csv, const IdMap& ids) {
  detail::Table table(csv, {.by_position = false, .more_cells = true});
  const auto kinds = KindsOfColumns(table.names());
  if (std::ranges::none_of(kinds, [&](const auto& kind) { return kind && !ids[*kind].empty(); }))
    throw Error(ErrorKind::kDamaged,
                "the table has no column of ids that the id map changes; columns are told by their names in the first "
                "line: map, keyframe, point, frame, camera, id, parent, reference_keyframe");
  std::string result;
  result.reserve(csv.size() + csv.size() / 8);
  const char* copied = csv.data();
  while (table.Next()) {
    const auto cells = table.cells();
    for (std::size_t column = 0; column < std::min(cells.size(), kinds.size()); ++column) {
      const std::string_view cell = cells[column].text;
      if (!kinds[column] || ids[*kinds[column]].empty()) continue;
      if (cell.empty()) continue;  // none
      const auto id = detail::ParseNumber<std::uint64_t>(cell);
      if (!id) throw table.LineError(detail::Concat("'", cell, "' is no ", NameOf(*kinds[column]), " id"));
      const IdPair* pair = FindPair(ids[*kinds[column]], *id);
      if (pair == nullptr || pair->after == kNoId)
        throw table.LineError(detail::Concat(NameOf(*kinds[column]), " ", *id,
                                             pair == nullptr ? " is not in the id map" : " is not in the result"));
      if (pair->after == *id) continue;
      result.append(copied, cell.data());
      detail::AppendNumber(result, pair->after);
      copied = cell.data() + cell.size();
    }
  }
  return result.append(copied, csv.data() + csv.size());
}

}  // namespace slamdb
