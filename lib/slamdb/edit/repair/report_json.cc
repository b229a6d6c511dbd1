// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/checks/detail/json.h"
#include "slamdb/edit/repair/journal.h"
#include "slamdb/edit/repair/recover.h"
#include "slamdb/edit/repair/repair.h"

namespace slamdb {
namespace {

using detail::Json;

Json JsonOf(const AppliedFix& fix) {
  return {{"rule", fix.rule},
          {"severity", ToString(fix.severity)},
          {"title", fix.title},
          {"fix", fix.fix},
          {"changes", fix.changes},
          {"count", fix.findings},
          {"findings", Json::array({detail::JsonOf(fix.first)})}};
}

Json JsonOf(const Unrepaired& rule) {
  return {{"rule", rule.rule},      {"severity", ToString(rule.severity)},
          {"title", rule.title},    {"reason", rule.reason},
          {"count", rule.findings}, {"findings", Json::array({detail::JsonOf(rule.first)})}};
}

Json JsonOf(const SalvagedList& list) { return {{"listed", list.listed}, {"recovered", list.read}}; }

template <class Item>
Json ListOf(const std::vector<Item>& items) {
  Json list = Json::array();
  for (const Item& item : items) list.push_back(JsonOf(item));
  return list;
}

}  // namespace

std::string ToJson(const RepairReport& report, const ReportFiles& files) {
  Json json = detail::ReportHead("repair", files);
  json["sound"] = report.sound();
  json["repairs"] = ListOf(report.applied);
  json["left"] = ListOf(report.left);
  json["edits"] = report.journal.edits.size();
  return detail::JsonText(json);
}

std::string ToJson(const UndoReport& report, const ReportFiles& files) {
  Json json = detail::ReportHead("undo", files);
  json["edits"] = report.edits;
  return detail::JsonText(json);
}

std::string ToJson(const SalvageReport& report, const ReportFiles& files) {
  Json json = detail::ReportHead("recover", files);
  json["whole"] = report.whole();
  json["sound"] = report.recovery.sound();
  json["maps"] = JsonOf(report.maps);
  json["keyframes"] = JsonOf(report.keyframes);
  json["points"] = JsonOf(report.points);
  json["points"]["triangulated"] = report.recovery.triangulated_points.size();
  json["landmarks"] = JsonOf(report.landmarks);
  json["transfer"] = detail::TextOrNull(report.undone);
  json["damage"] = report.damage;
  json["accepted"] = report.accepted;
  json["losses"] = report.losses;
  json["repairs"] = ListOf(report.recovery.repairs);
  json["left"] = ListOf(report.recovery.left);
  return detail::JsonText(json);
}

}  // namespace slamdb
