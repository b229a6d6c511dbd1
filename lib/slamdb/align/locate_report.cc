// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/locate_report.h"

#include <algorithm>
#include <numbers>

#include "slamdb/align/detail/report_json.h"
#include "slamdb/base/detail/median.h"
#include "slamdb/base/detail/parallel.h"

namespace slamdb {
namespace {

using detail::Json;

constexpr double kDegrees = 180 / std::numbers::pi;

// The errors of those whose error is known, position and rotation each by itself.
template <class Choose>
std::optional<PoseError> Chosen(const std::vector<LocatedPicture>& pictures, const Choose& choose) {
  std::vector<double> positions, rotations;
  for (const LocatedPicture& picture : pictures) {
    if (!picture.error) continue;
    positions.push_back(picture.error->position);
    rotations.push_back(picture.error->rotation_degrees);
  }
  if (positions.empty()) return std::nullopt;
  return PoseError{choose(positions), choose(rotations)};
}

LocatedPicture LeaveOut(const Locator& locator, const Atlas& atlas, const KeyFrameRef& row) {
  const KeyFrame& keyframe = atlas.maps[row.map].keyframes[row.keyframe];
  LocatedPicture picture{.name = ToString(keyframe.id),
                         .timestamp = keyframe.timestamp,
                         .localization = locator.LocateLeftOut(row),
                         .error = {},
                         .atlas = {},
                         .others = {}};
  const Localization& found = picture.localization;
  if (found.verdict != LocateVerdict::kFound) return picture;
  const Rigid3f world_from_camera = keyframe.camera_from_world.Normalized().Inverse();
  picture.error = {
      (found.position - world_from_camera.translation.cast<double>()).norm(),
      found.rotation.angularDistance(Eigen::Quaterniond(world_from_camera.rotation.cast<double>())) * kDegrees};
  return picture;
}

Json JsonOf(const LocateEvidence& evidence) {
  return {{"features", evidence.features},
          {"candidates", evidence.candidates},
          {"inliers", evidence.inliers},
          {"visible", evidence.visible},
          {"found_share", evidence.found_share},
          {"cell_share", evidence.cell_share},
          {"front_share", evidence.front_share},
          {"checked_share", evidence.checked_share},
          {"extent", evidence.extent},
          {"spread", evidence.spread},
          {"contradicting", evidence.contradicting},
          {"rmse", evidence.rms},
          {"focal_factor", evidence.focal_factor},
          {"focal_deviation", evidence.focal_deviation}};
}

Json JsonOf(const std::optional<PoseError>& error) {
  if (!error) return nullptr;
  return {{"position", error->position}, {"rotation_degrees", error->rotation_degrees}};
}

Json JsonOf(const Localization& localization) {
  if (!localization.has_pose) return nullptr;
  const PosePrecision precision = PrecisionOf(localization);
  return {{"map", detail::JsonId(localization.map)},
          {"world_from_camera",
           detail::JsonOf(Similarity3d{.rotation = localization.rotation, .translation = localization.position})},
          {"precision", {{"rotation_degrees", precision.rotation_degrees}, {"position", precision.position}}},
          {"covariance", detail::MatrixJson(localization.covariance)},
          {"resembles", detail::JsonId(localization.resembles)}};
}

Json VerdictJson(const Localization& localization) {
  return {{"verdict", NameOf(localization.verdict)},
          {"reason", localization.reason},
          {"pose", JsonOf(localization)},
          {"evidence", JsonOf(localization.evidence)}};
}

Json JsonOf(const LocatedPicture& picture) {
  Json json = VerdictJson(picture.localization);
  json["name"] = picture.name;
  json["timestamp"] = picture.timestamp;
  json["error"] = JsonOf(picture.error);
  json["found_in"] = picture.atlas.empty() ? Json() : Json(picture.atlas);
  json["others"] = Json::array();
  for (const AtlasLocalization& other : picture.others) {
    json["others"].push_back(VerdictJson(other.localization));
    json["others"].back()["found_in"] = other.atlas;
  }
  return json;
}

}  // namespace

std::uint64_t LocateReport::found() const {
  return static_cast<std::uint64_t>(std::ranges::count_if(
      pictures, [](const LocatedPicture& each) { return each.localization.verdict == LocateVerdict::kFound; }));
}

std::optional<PoseError> LocateReport::MedianError() const {
  return Chosen(pictures, [](const std::vector<double>& errors) { return detail::MedianOf(errors); });
}

std::optional<PoseError> LocateReport::LargestError() const {
  return Chosen(pictures, [](const std::vector<double>& errors) { return *std::ranges::max_element(errors); });
}

LocateReport BenchmarkLocating(const Locator& locator, const Atlas& atlas, const LocateBenchmarkOptions& options) {
  std::vector<KeyFrameRef> rows;
  for (std::size_t map = 0; map < atlas.maps.size(); ++map)
    for (std::size_t keyframe = 0; keyframe < atlas.maps[map].keyframes.size(); ++keyframe)
      if (!atlas.maps[map].keyframes[keyframe].bad) rows.push_back({map, keyframe});
  const std::size_t most = std::max<std::size_t>(1, options.most_keyframes), step = (rows.size() + most - 1) / most;
  LocateReport report;
  report.pictures.resize(step == 0 ? 0 : (rows.size() + step - 1) / step);
  constexpr std::size_t kBatch = 32;  // between two tellings
  for (std::size_t done = 0; done < report.pictures.size(); done += kBatch) {
    if (options.progress)
      options.progress("leaving keyframes out",
                       static_cast<double>(done) / static_cast<double>(report.pictures.size()));
    detail::ParallelFor(std::min(kBatch, report.pictures.size() - done), 1, options.threads,
                        [&](std::size_t begin, std::size_t end) {
                          for (std::size_t i = done + begin; i < done + end; ++i)
                            report.pictures[i] = LeaveOut(locator, atlas, rows[i * step]);
                        });
  }
  return report;
}

std::string ToJson(const LocateReport& report, const std::string& input) {
  Json json = detail::ReportHead("locate");
  json["input"] = input;
  json["found"] = report.found();
  json["pictures"] = Json::array();
  for (const LocatedPicture& picture : report.pictures) json["pictures"].push_back(JsonOf(picture));
  json["median_error"] = JsonOf(report.MedianError());
  json["largest_error"] = JsonOf(report.LargestError());
  json["not_asked"] = report.not_asked;
  return detail::JsonText(json);
}

}  // namespace slamdb
