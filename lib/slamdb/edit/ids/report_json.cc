// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "slamdb/edit/ids/origin.h"
#include "slamdb/edit/ids/renumber.h"
#include "slamdb/model/detail/json.h"

namespace slamdb {
namespace {

using detail::Json;

Json HistogramJson(const std::map<std::uint32_t, std::uint64_t>& histogram) {
  Json list = Json::array();
  for (const auto& [origin, count] : histogram) list.push_back({{"map", origin}, {"keyframes", count}});
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
  json["changed"] = report.changed;
  json["before"] = HistogramJson(report.before);
  json["after"] = HistogramJson(report.after);
  json["next_ids"] = {{"map", detail::JsonNumber(report.next_map_after)}};
  return detail::JsonText(json);
}

}  // namespace slamdb
