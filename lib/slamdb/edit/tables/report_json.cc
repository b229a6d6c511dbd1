// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/detail/removed_json.h"
#include "slamdb/edit/tables/tables.h"
#include "slamdb/model/detail/json.h"

namespace slamdb {
namespace {

using detail::Json;

Json JsonOf(const TableEditChanges& changes) {
  return {{"rows", changes.rows},
          {"moved", changes.moved},
          {"changed", changes.changed},
          {"deleted", changes.deleted},
          {"ignored_columns", changes.ignored}};
}

}  // namespace

std::string ToJson(const TableEditReport& report, const ReportFiles& files) {
  Json json = detail::ReportHead("edit", files);
  json["points"] = JsonOf(report.points);
  json["keyframes"] = JsonOf(report.keyframes);
  json["refreshed"] = report.refreshed;
  detail::AddRemoved(report.removed, json);
  json["edits"] = report.journal.edits.size();
  return detail::JsonText(json);
}

}  // namespace slamdb
