// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/convert_report.h"

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/json.h"

namespace slamdb {

void ConvertReport::Add(const Notices& notices) {
  if (const auto& written = notices.counts()) {
    keyframes = written->keyframes;
    points = written->points;
    landmarks = 0;
  }
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

namespace {

// Without a descriptor of ORB.
struct Undescribed {
  std::uint64_t keypoints = 0, points = 0;
  bool any_keyframe = false, any_described = false;
};

Undescribed CountUndescribed(const Atlas& atlas) {
  Undescribed count;
  for (const Map& map : atlas.maps) {
    for (const KeyFrame& keyframe : map.keyframes) {
      const Features& features = keyframe.features;
      const std::size_t all = features.keypoints.size() + features.right_keypoints.size();
      if (!keyframe.bad && features.descriptors.empty()) count.keypoints += all;
      count.any_keyframe = true;
      count.any_described = count.any_described || !features.descriptors.empty();
    }
    for (const MapPoint& point : map.points) count.points += !point.bad && !point.has_descriptor() ? 1 : 0;
  }
  return count;
}

}  // namespace

std::string WhyNoUseToOrbslam3(const Atlas& atlas) {
  using detail::Counted;
  const Undescribed lacking = CountUndescribed(atlas);
  std::string what;
  if (lacking.keypoints > 0) what = Counted(lacking.keypoints, "keypoint");
  if (lacking.points > 0) what += (what.empty() ? "" : " and ") + Counted(lacking.points, "point");
  if (what.empty() && (lacking.any_described || !lacking.any_keyframe)) return {};
  if (what.empty()) what = "its keyframes";
  return "ORB-SLAM3 cannot use this map: " + what +
         " have no descriptors of ORB, by which it matches; PutPoses puts poses and points into the atlas of ORB-SLAM3 "
         "that they are of";
}

std::string ToJson(const ConvertReport& report, const ReportFiles& files) {
  detail::Json json = detail::ReportHead("convert", files);
  json["format"] = report.format;
  json["maps"] = detail::NumberOrNull(report.maps);
  json["keyframes"] = report.keyframes;
  json["points"] = report.points;
  json["landmarks"] = report.landmarks;
  json["bytes"] = detail::NumberOrNull(report.bytes);
  json["put"] = nullptr;
  if (report.put)
    json["put"] = {{"keyframes", report.put->keyframes},
                   {"points", report.put->points},
                   {"largest_shift", report.put->largest_shift}};
  json["warnings"] = report.warnings;
  json["losses"] = report.losses;
  return detail::JsonText(json);
}

}  // namespace slamdb
