// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "slamdb/edit/ids/origin.h"
#include "slamdb/edit/ids/renumber.h"
#include "slamdb/model/detail/json.h"

namespace slamdb {
namespace {

using detail::Json;

// Keyframes and points by the map in which they were made.
Json OriginsJson(const std::map<std::uint32_t, std::uint64_t>& keyframes,
                 const std::map<std::uint32_t, std::uint64_t>& points) {
  std::map<std::uint32_t, std::pair<std::uint64_t, std::uint64_t>> counts;
  for (const auto& [origin, count] : keyframes) counts[origin].first = count;
  for (const auto& [origin, count] : points) counts[origin].second = count;
  Json list = Json::array();
  for (const auto& [origin, count] : counts)
    list.push_back({{"map", origin}, {"keyframes", count.first}, {"points", count.second}});
  return list;
}

}  // namespace

RenumberReport SummaryOf(const IdMap& ids) {
  RenumberReport report;
  for (std::size_t kind = 0; kind < kIdKinds; ++kind) {
    const std::vector<IdPair>& pairs = ids.kinds[kind];
    if (pairs.empty()) continue;
    KindRenumbered summary{.kind = static_cast<IdKind>(kind), .ids = pairs.size()};
    for (const IdPair& pair : pairs) {
      summary.changed += pair.before != pair.after;
      if (pair.after == kNoId) continue;  // it is not in the result
      summary.first = std::min(summary.first, pair.after);
      summary.last = std::max(summary.last, pair.after);
    }
    report.kinds.push_back(summary);
  }
  return report;
}

std::string ToJson(const RenumberReport& report, const ReportFiles& files) {
  Json json = detail::ReportHead("renumber", files);
  json["kinds"] = Json::array();
  for (const KindRenumbered& kind : report.kinds)
    json["kinds"].push_back({{"kind", NameOf(kind.kind)},
                             {"ids", kind.ids},
                             {"changed", kind.changed},
                             {"first", detail::JsonId(kind.first)},
                             {"last", detail::JsonId(kind.last)}});
  return detail::JsonText(json);
}

std::string ToJson(const OriginReport& report, const ReportFiles& files) {
  Json json = detail::ReportHead("reassign-origin", files);
  json["changed"] = {{"keyframes", report.changed}, {"points", report.points_changed}};
  json["before"] = OriginsJson(report.before, report.points_before);
  json["after"] = OriginsJson(report.after, report.points_after);
  json["next_ids"] = {{"map", detail::JsonNumber(report.next_map_after)}};
  return detail::JsonText(json);
}

}  // namespace slamdb
