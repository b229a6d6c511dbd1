// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parse_file.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/ids/id_map.h"
#include "slamdb/model/detail/json.h"

namespace slamdb {
namespace {

using detail::Concat;
using detail::Json;

bool IsJson(std::string_view path) { return path.ends_with(".json"); }

Json CountersJson(const IdMap& ids) {
  Json counters;
  for (const CounterField& counter : CounterFields())
    counters[std::string(counter.name)] = {detail::JsonNumber((*ids.counters_before).*counter.field),
                                           detail::JsonNumber((*ids.counters_after).*counter.field)};
  return counters;
}

Json JsonOf(const IdMap& ids) {
  Json input = {{"input", ids.input}, {"ids", Json::object()}};
  for (std::size_t kind = 0; kind < kIdKinds; ++kind) {
    Json pairs = Json::array();
    for (const IdPair& pair : ids.kinds[kind])
      pairs.push_back({detail::JsonId(pair.before), detail::JsonId(pair.after)});
    if (!pairs.empty()) input["ids"][std::string(NameOf(static_cast<IdKind>(kind)))] = std::move(pairs);
  }
  if (ids.counters_before && ids.counters_after) input["counters"] = CountersJson(ids);
  return input;
}

IdMap IdMapOf(const Json& input) {
  IdMap ids{.input = input.value("input", "")};
  for (const auto& [name, pairs] : input.at("ids").items()) {
    const auto kind = IdKindByName(name);
    if (!kind)
      throw Error(ErrorKind::kDamaged,
                  Concat("unknown kind '", name, "', expected map, keyframe, point, frame or camera"));
    for (const Json& pair : pairs) {
      if (pair.size() != 2) throw Error(ErrorKind::kDamaged, Concat(pair.dump(), " is no pair of ids"));
      ids[*kind].push_back({detail::IntegerOf<std::uint64_t>(pair.at(0)),
                            pair.at(1).is_null() ? kNoId : detail::IntegerOf<std::uint64_t>(pair.at(1))});
    }
    std::ranges::stable_sort(ids[*kind], {}, &IdPair::before);
  }
  if (!input.contains("counters")) return ids;
  ids.counters_before = ids.counters_after = Counters();
  for (const CounterField& counter : CounterFields()) {
    const Json& values = input.at("counters").at(std::string(counter.name));
    (*ids.counters_before).*counter.field = detail::IntegerOf<std::uint64_t>(values.at(0));
    (*ids.counters_after).*counter.field = detail::IntegerOf<std::uint64_t>(values.at(1));
  }
  return ids;
}

}  // namespace

std::string IdMapsToJson(std::span<const IdMap> maps) {
  Json table = {{"inputs", Json::array()}};
  for (const IdMap& ids : maps) table["inputs"].push_back(JsonOf(ids));
  return detail::JsonText(table, -1);
}

std::vector<IdMap> ParseIdMapsJson(std::string_view json) {
  std::vector<IdMap> maps;
  try {
    const Json table = Json::parse(json);
    for (const Json& input : table.at("inputs")) maps.push_back(IdMapOf(input));
  } catch (const Json::exception& error) {
    throw Error(ErrorKind::kDamaged, Concat("is no id map: ", error.what()));
  }
  if (maps.empty()) throw Error(ErrorKind::kDamaged, "the id map is empty");
  return maps;
}

std::string IdMapsToText(std::span<const IdMap> maps, std::string_view path) {
  return IsJson(path) ? IdMapsToJson(maps) : IdMapsToCsv(maps);
}

void WriteIdMaps(std::span<const IdMap> maps, const std::string& path, const AtomicFileOptions& options) {
  AtomicFile file(path, options);
  file.Write(IdMapsToText(maps, path));
  file.Commit();
}

std::vector<IdMap> ReadIdMaps(const std::string& path, Notices* notices) {
  if (IsJson(path)) return detail::ParseFile(path, "a table of ids", ParseIdMapsJson, {"report"});
  Notices unheard;
  return detail::ParseLines(path, "a table of ids", notices == nullptr ? unheard : *notices, ParseIdMapsCsv);
}

IdMap ReadIdMap(const std::string& path, const std::string& input, Notices* notices) {
  std::vector<IdMap> maps = ReadIdMaps(path, notices);
  const auto named = std::ranges::find(maps, input, &IdMap::input);
  if (named != maps.end()) return std::move(*named);
  if (input.empty() && maps.size() == 1) return std::move(maps.front());
  std::string names;
  for (const IdMap& ids : maps) names += (names.empty() ? "" : ", ") + ids.input;
  if (input.empty())
    throw Error(ErrorKind::kUsage, path, "",
                Concat("holds the ids of several inputs, of which one must be named: ", names));
  throw Error(ErrorKind::kNotFound, path, "", Concat("holds no ids of '", input, "'; it has those of ", names));
}

}  // namespace slamdb
