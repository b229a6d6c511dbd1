// SPDX-License-Identifier: BSD-3-Clause
// Id maps as CSV tables, and tables in which ids of an atlas stand.
#include <algorithm>

#include "slamdb/base/detail/csv_cells.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/ids/id_map.h"

namespace slamdb {
namespace {

std::string Unquoted(std::string_view cell) {
  if (cell.size() < 2 || !cell.starts_with('"') || !cell.ends_with('"')) return std::string(cell);
  std::string text;
  for (std::size_t i = 1; i + 1 < cell.size(); ++i) {
    text += cell[i];
    if (cell[i] == '"') ++i;  // a quote is written twice
  }
  return text;
}

std::string Quoted(std::string_view text) {
  if (text.find_first_of(",\"\n\r") == text.npos) return std::string(text);
  std::string quoted = "\"";
  for (const char letter : text) quoted.append(letter == '"' ? 2 : 1, letter);
  return quoted + '"';
}

// Which columns of an id table hold what; npos: none.
struct IdColumns {
  static constexpr std::size_t kNowhere = ~std::size_t{0};
  std::size_t input = kNowhere, kind = kNowhere, before = kNowhere, after = kNowhere;
  std::size_t count = 0;

  explicit IdColumns(const std::vector<std::string_view>& names) : count(names.size()) {
    for (std::size_t column = 0; column < names.size(); ++column) {
      const std::string name = Unquoted(names[column]);
      if (name == "input") input = column;
      if (name == "kind") kind = column;
      if (name == "old") before = column;
      if (name == "new") after = column;
    }
    if (kind == kNowhere || before == kNowhere || after == kNowhere)
      throw LineError(1, "expected the column names kind,old,new of an id map");
  }
};

void AddRow(IdMap& ids, std::string_view name, const IdPair& pair, std::size_t line) {
  if (const auto kind = IdKindByName(name)) {
    ids[*kind].push_back(pair);
    return;
  }
  const auto counters = CounterFields();
  const auto counter = std::ranges::find(counters, name, &CounterField::name);
  if (counter == counters.end())
    throw LineError(line, "unknown kind '" + std::string(name) + "', expected map, keyframe, point, frame or camera");
  if (!ids.counters_before) ids.counters_before = ids.counters_after = Counters();
  (*ids.counters_before).*counter->field = pair.before;
  (*ids.counters_after).*counter->field = pair.after;
}

// Which kind of id each column of a table holds, by the names of columns that our own tables have.
std::vector<std::optional<IdKind>> KindsOfColumns(const std::vector<std::string_view>& names) {
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
  const auto has = [&](std::string_view name) { return std::ranges::find(names, name) != names.end(); };
  std::vector<std::optional<IdKind>> kinds(names.size());
  for (std::size_t column = 0; column < names.size(); ++column) {
    const auto found = std::ranges::find(kKnown, names[column], &std::pair<std::string_view, IdKind>::first);
    if (found != std::end(kKnown))
      kinds[column] = found->second;
    else if (names[column] == "id" && has("timestamp"))
      kinds[column] = IdKind::kKeyFrame;
    else if (names[column] == "id" && has("x"))
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
  std::vector<std::string_view> cells;
  SplitCells(TakeLine(csv), cells);
  const IdColumns columns(cells);
  std::vector<IdMap> maps;
  for (std::size_t line = 2; !csv.empty(); ++line) {
    const std::string_view text = TakeLine(csv);
    if (text.empty()) continue;
    SplitCells(text, cells);
    if (cells.size() != columns.count)
      throw LineError(line,
                      "expected " + std::to_string(columns.count) + " cells, found " + std::to_string(cells.size()));
    const auto before = ParseCell<std::uint64_t>(cells[columns.before]),
               after = ParseCell<std::uint64_t>(cells[columns.after]);
    if (!before || (!after && !cells[columns.after].empty()))
      throw LineError(line,
                      "expected an id, found '" + std::string(cells[before ? columns.after : columns.before]) + "'");
    const std::string input = columns.input == IdColumns::kNowhere ? "" : Unquoted(cells[columns.input]);
    if (maps.empty() || maps.back().input != input) {
      if (std::ranges::find(maps, input, &IdMap::input) != maps.end())
        throw LineError(line, "rows of input '" + input + "' do not stand together");
      maps.push_back({.input = input});
    }
    AddRow(maps.back(), cells[columns.kind], {*before, after.value_or(kNoId)}, line);
  }
  if (maps.empty()) throw Error("the id map is empty");
  for (IdMap& ids : maps)
    for (std::vector<IdPair>& pairs : ids.kinds) std::ranges::stable_sort(pairs, {}, &IdPair::before);
  return maps;
}

std::string ApplyIdMapToCsv(std::string_view csv, const IdMap& ids) {
  std::vector<std::string_view> cells;
  const std::string_view head = TakeLine(csv);
  SplitCells(head, cells);
  const auto kinds = KindsOfColumns(cells);
  if (std::ranges::none_of(kinds, [&](const auto& kind) { return kind && !ids[*kind].empty(); }))
    throw Error(
        "the table has no column of ids that the id map changes; columns are told by their names in the first "
        "line: map, keyframe, point, frame, camera, id, parent, reference_keyframe");
  std::string result = std::string(head) + "\n";
  result.reserve(csv.size() + head.size() + csv.size() / 8);
  for (std::size_t line = 2; !csv.empty(); ++line) {
    SplitCells(TakeLine(csv), cells);
    for (std::size_t column = 0; column < cells.size(); ++column) {
      if (column > 0) result += ',';
      const auto id = column < kinds.size() && kinds[column] ? ParseCell<std::uint64_t>(cells[column]) : std::nullopt;
      const bool moves = id && !ids[*kinds[column]].empty();
      const IdPair* pair = moves ? FindPair(ids[*kinds[column]], *id) : nullptr;
      if (moves && (pair == nullptr || pair->after == kNoId))
        throw LineError(line, std::string(NameOf(*kinds[column])) + " " + std::to_string(*id) +
                                  (pair == nullptr ? " is not in the id map" : " is not in the result"));
      result += pair == nullptr ? std::string(cells[column]) : std::to_string(pair->after);
    }
    result += '\n';
  }
  return result;
}

}  // namespace slamdb
