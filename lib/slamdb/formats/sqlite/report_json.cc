// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/hash.h"
#include "slamdb/base/detail/json.h"
#include "slamdb/formats/sqlite/report.h"

namespace slamdb {
namespace {

using detail::Json;

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
          {"hash", detail::Hex(entry.hash)}};
}

}  // namespace

std::string ToJson(std::span<const HistoryEntry> entries, const std::string& input) {
  Json json = detail::ReportHead("log", input);
  json["entries"] = Json::array();
  for (const HistoryEntry& entry : entries) json["entries"].push_back(JsonOf(entry));
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
  json["tables"] = Json::array();
  for (const PartSize& part : stats.tables) json["tables"].push_back({{"table", part.part}, {"bytes", part.bytes}});
  return detail::JsonText(json);
}

}  // namespace slamdb
