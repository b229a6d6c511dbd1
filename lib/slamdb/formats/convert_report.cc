// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/convert_report.h"

#include "slamdb/base/detail/json.h"

namespace slamdb {

void ConvertReport::Add(const Notices& notices) {
  for (const Notice& notice : notices.items())
    if (notice.kind != Notice::Kind::kNote)
      (notice.kind == Notice::Kind::kLoss ? losses : warnings).push_back(notice.text);
}

ConvertReport ConvertReportOf(const Atlas& atlas, const Format& format) {
  ConvertReport report;
  report.format = format.id;
  report.maps = atlas.maps.size();
  for (const Map& map : atlas.maps) {
    report.keyframes += map.keyframes.size();
    report.points += map.points.size();
    report.landmarks += map.landmarks.size();
  }
  return report;
}

std::string ToJson(const ConvertReport& report, const ReportFiles& files) {
  detail::Json json = detail::ReportHead("convert", files);
  json["format"] = report.format;
  json["maps"] = detail::NumberOrNull(report.maps);
  json["keyframes"] = report.keyframes;
  json["points"] = report.points;
  json["landmarks"] = report.landmarks;
  json["bytes"] = detail::NumberOrNull(report.bytes);
  json["warnings"] = report.warnings;
  json["losses"] = report.losses;
  return detail::JsonText(json);
}

}  // namespace slamdb
