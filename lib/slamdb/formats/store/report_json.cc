// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/hash.h"
#include "slamdb/base/detail/json.h"
#include "slamdb/formats/store/report.h"

namespace slamdb {
namespace {

using detail::Json;

Json JsonOf(const MapChanges& changes) {
  return {{"keyframes",
           {{"added", changes.keyframes_added},
            {"removed", changes.keyframes_removed},
            {"moved", changes.keyframes_moved}}},
          {"points",
           {{"added", changes.points_added}, {"removed", changes.points_removed}, {"moved", changes.points_moved}}},
          {"observations", {{"added", changes.observations_added}, {"removed", changes.observations_removed}}}};
}

Json JsonOf(const RevisionName& revision) {
  return {{"name", revision.atlas}, {"revision", revision.number}, {"hash", detail::Hex(revision.hash)}};
}

Json JsonOf(const HistoryEntry& entry) {
  return {{"at", entry.at},
          {"tool", entry.tool},
          {"action", entry.action},
          {"name", entry.atlas},
          {"provenance", entry.provenance},
          {"maps", entry.maps},
          {"keyframes", entry.keyframes},
          {"points", entry.points},
          {"observations", entry.observations},
          {"rows",
           {{"inserted", entry.inserted},
            {"updated", entry.updated},
            {"deleted", entry.deleted},
            {"unchanged", entry.unchanged}}},
          {"hash", detail::Hex(entry.hash)},
          {"who", entry.who},
          {"revision", entry.revision == 0 ? Json() : Json(entry.revision)},
          {"readable", entry.readable},
          {"tags", entry.tags},
          {"from", entry.from ? JsonOf(*entry.from) : Json()},
          {"changes", entry.changes ? JsonOf(*entry.changes) : Json()}};
}

}  // namespace

std::string ToJson(std::span<const HistoryEntry> entries, const std::string& input) {
  Json json = detail::ReportHead("log", input);
  json["entries"] = Json::array();
  for (const HistoryEntry& entry : entries) json["entries"].push_back(JsonOf(entry));
  return detail::JsonText(json);
}

std::string TagsAsJson(std::span<const HistoryEntry> entries, const std::string& input) {
  Json json = detail::ReportHead("tag", input);
  json["tags"] = Json::array();
  for (const HistoryEntry& entry : entries)
    for (const std::string& tag : entry.tags)
      json["tags"].push_back({{"tag", tag}, {"name", entry.atlas}, {"revision", entry.revision}, {"at", entry.at}});
  return detail::JsonText(json);
}

std::string BranchAsJson(const RevisionName& from, const std::string& input, const std::string& output) {
  Json json = detail::ReportHead("branch", {.input = input, .output = output});
  json["from"] = JsonOf(from);
  return detail::JsonText(json);
}

std::string RestoreAsJson(const SaveReport& report, const RevisionName& restored, const std::string& input) {
  Json json = detail::ReportHead("restore", input);
  json["from"] = JsonOf(restored);
  json["name"] = restored.atlas;
  json["revision"] = report.revision;
  json["unchanged"] = report.unchanged;
  return detail::JsonText(json);
}

std::string RemovedAsJson(std::span<const std::string> inputs) {
  Json json = detail::ReportHead("remove");
  json["inputs"] = Json::array();
  for (const std::string& input : inputs) json["inputs"].push_back({{"input", input}});
  return detail::JsonText(json);
}

std::string ToJson(const MigrateReport& report, const std::string& input, const std::string& output) {
  Json json = detail::ReportHead("migrate", {.input = input, .output = output});
  json["before"] = {{"schema_version", report.from}};
  json["after"] = {{"schema_version", report.to}};
  json["steps"] = report.steps;
  json["backup"] = detail::TextOrNull(report.backup);
  return detail::JsonText(json);
}

std::string ToJson(const GiveUpReport& report, const std::string& input) {
  Json json = detail::ReportHead("gc", input);
  json["atlases"] = Json::array();
  for (const GivenUp& atlas : report.atlases)
    json["atlases"].push_back({{"name", atlas.atlas}, {"given_up", atlas.revisions}, {"kept", atlas.kept}});
  json["pictures"] = report.pictures;
  json["bytes"] = report.bytes;
  return detail::JsonText(json);
}

std::string ToJson(const StoreStats& stats, const std::string& input) {
  Json json = detail::ReportHead("stats", input);
  json["bytes"] = stats.file_bytes;
  json["log_bytes"] = stats.log_bytes;
  json["page_bytes"] = stats.page_bytes;
  json["pages"] = stats.pages;
  json["free_pages"] = stats.free_pages;
  json["schema_version"] = stats.version;
  json["partitions_elsewhere"] = stats.partitions_elsewhere;
  json["tables"] = Json::array();
  for (const PartSize& part : stats.tables) json["tables"].push_back({{"table", part.part}, {"bytes", part.bytes}});
  return detail::JsonText(json);
}

std::string ToJson(const Fleet& fleet, const std::string& input) {
  Json json = detail::ReportHead("fleet", input);
  json["partitions"] = Json::array();
  for (const FleetPartition& each : fleet.partitions)
    json["partitions"].push_back({{"partition", each.number},
                                  {"server", detail::TextOrNull(each.server)},
                                  {"atlases", each.atlases},
                                  {"bytes", each.bytes},
                                  {"failure", detail::TextOrNull(each.failure)}});
  return detail::JsonText(json);
}

}  // namespace slamdb
