// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "slamdb/base/detail/json.h"
#include "slamdb/many/sync.h"

namespace slamdb {
namespace {

using detail::Json;

const char* Which(bool to_first) { return to_first ? "first" : "second"; }

Json JsonOf(const SyncedAtlas& atlas) {
  Json json = {{"name", atlas.name},
               {"result", NameOf(atlas.result)},
               {"to", atlas.revisions.empty() ? Json() : Json(Which(atlas.to_first))},
               {"revisions", atlas.revisions},
               {"branch", detail::TextOrNull(atlas.branch)},
               {"tags", Json::array()},
               {"conflicts", Json::array()},
               {"alone", Json::array()}};
  for (const SyncedAtlas::Tag& tag : atlas.tags)
    json["tags"].push_back({{"tag", tag.tag}, {"to", Which(tag.to_first)}});
  for (const SyncedAtlas::Conflict& conflict : atlas.conflicts)
    json["conflicts"].push_back({{"tag", conflict.tag}, {"first", conflict.first}, {"second", conflict.second}});
  for (const SyncedAtlas::Alone& alone : atlas.alone)
    json["alone"].push_back({{"in", Which(alone.in_first)}, {"revisions", alone.revisions}, {"tags", alone.tags}});
  if (atlas.result == SyncResult::kFailed) json["failure"] = atlas.failure;
  return json;
}

}  // namespace

std::string_view NameOf(SyncResult result) {
  constexpr std::array<std::string_view, 6> kNames = {"same", "copied", "ahead", "diverged", "branched", "failed"};
  return kNames.at(static_cast<std::size_t>(result));
}

std::string ToJson(const SyncReport& report) {
  Json json = detail::ReportHead("sync");
  json["inputs"] = {{{"input", report.first}}, {{"input", report.second}}};
  json["atlases"] = Json::array();
  for (const SyncedAtlas& atlas : report.atlases) json["atlases"].push_back(JsonOf(atlas));
  for (const SyncResult result : {SyncResult::kSame, SyncResult::kCopied, SyncResult::kAhead, SyncResult::kDiverged,
                                  SyncResult::kBranched, SyncResult::kFailed})
    json[std::string(NameOf(result))] = report.Count(result);
  return detail::JsonText(json);
}

}  // namespace slamdb
