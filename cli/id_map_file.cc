// SPDX-License-Identifier: BSD-3-Clause
#include "cli/id_map_file.h"

#include <algorithm>

#include "cli/report/json.h"
#include "slamdb/base/error.h"

namespace slamdb::cli {
namespace {

using nlohmann::ordered_json;

bool IsJson(const std::string& path) { return path.ends_with(".json"); }

ordered_json IdOrNull(std::uint64_t id) { return id == kNoId ? ordered_json() : ordered_json(id); }

ordered_json CountersJson(const IdMap& ids) {
  ordered_json counters;
  for (const CounterField& counter : CounterFields())
    counters[std::string(counter.name)] = {(*ids.counters_before).*counter.field, (*ids.counters_after).*counter.field};
  return counters;
}

std::string IdMapsToJson(std::span<const IdMap> maps) {
  ordered_json report = {{"inputs", ordered_json::array()}};
  for (const IdMap& ids : maps) {
    ordered_json input = {{"input", ids.input}, {"ids", ordered_json::object()}};
    for (std::size_t kind = 0; kind < kIdKinds; ++kind) {
      ordered_json pairs = ordered_json::array();
      for (const IdPair& pair : ids.kinds[kind]) pairs.push_back({IdOrNull(pair.before), IdOrNull(pair.after)});
      if (!pairs.empty()) input["ids"][std::string(NameOf(static_cast<IdKind>(kind)))] = std::move(pairs);
    }
    if (ids.counters_before && ids.counters_after) input["counters"] = CountersJson(ids);
    report["inputs"].push_back(std::move(input));
  }
  return JsonText(report, -1);
}

IdMap IdMapOfJson(const ordered_json& input) {
  IdMap ids{.input = input.value("input", "")};
  for (const auto& [name, pairs] : input.at("ids").items()) {
    const auto kind = IdKindByName(name);
    if (!kind) throw Error("unknown kind '" + name + "', expected map, keyframe, point, frame or camera");
    for (const ordered_json& pair : pairs)
      ids[*kind].push_back(
          {pair.at(0).get<std::uint64_t>(), pair.at(1).is_null() ? kNoId : pair.at(1).get<std::uint64_t>()});
    std::ranges::stable_sort(ids[*kind], {}, &IdPair::before);
  }
  if (!input.contains("counters")) return ids;
  ids.counters_before = ids.counters_after = Counters();
  for (const CounterField& counter : CounterFields()) {
    const ordered_json& values = input.at("counters").at(std::string(counter.name));
    (*ids.counters_before).*counter.field = values.at(0).get<std::uint64_t>();
    (*ids.counters_after).*counter.field = values.at(1).get<std::uint64_t>();
  }
  return ids;
}

std::vector<IdMap> IdMapsOfJson(std::string_view text) {
  std::vector<IdMap> maps;
  const ordered_json report = ordered_json::parse(text);
  for (const ordered_json& input : report.at("inputs")) maps.push_back(IdMapOfJson(input));
  if (maps.empty()) throw Error("the id map is empty");
  return maps;
}

}  // namespace

std::vector<IdMap> ReadIdMaps(const std::string& path) {
  const MappedFile file(path);
  const std::string_view text = file.text();
  try {
    return IsJson(path) ? IdMapsOfJson(text) : ParseIdMapsCsv(text);
  } catch (const Error& error) {
    throw Error(path, error.place(), error.problem());
  } catch (const nlohmann::json::exception& error) {
    throw Error(path, "", "is no id map: " + std::string(error.what()));
  }
}

IdMap ReadIdMap(const std::string& path, const std::string& input) {
  std::vector<IdMap> maps = ReadIdMaps(path);
  const auto named = std::ranges::find(maps, input, &IdMap::input);
  if (named != maps.end()) return std::move(*named);
  if (!input.empty() || maps.size() > 1) {
    std::string names;
    for (const IdMap& ids : maps) names += (names.empty() ? "" : ", ") + ids.input;
    throw Error(path, "",
                (input.empty() ? "holds the ids of several inputs" : "holds no ids of '" + input + "'") +
                    ("; name one with --of: " + names));
  }
  return std::move(maps.front());
}

IdMapFile::IdMapFile(const std::string& path, bool overwrite) : path_(path) {
  if (!path.empty()) file_.emplace(path, AtomicFileOptions{.overwrite = overwrite});
}

void IdMapFile::Write(std::span<const IdMap> maps) {
  if (!file_) return;
  file_->Write(IsJson(path_) ? IdMapsToJson(maps) : IdMapsToCsv(maps));
  file_->Commit();
}

}  // namespace slamdb::cli
