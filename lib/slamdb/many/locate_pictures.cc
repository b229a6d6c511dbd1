// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/locate_pictures.h"

#include <algorithm>
#include <string_view>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/evaluate/evaluate.h"
#include "slamdb/formats/rows/options.h"
#include "slamdb/formats/trajectories.h"
#include "slamdb/many/locate_in_store.h"
#include "slamdb/model/statistics.h"
#include "slamdb/pictures/picture_list.h"
#include "slamdb/pictures/pictures.h"

namespace slamdb {
namespace {

using detail::Concat;

CameraSettings CameraFor(const Atlas& atlas, const std::optional<CameraSettings>& given, const GrayPicture& picture) {
  if (given) return *given;
  std::optional<CameraSettings> own = SettingsOfMap(atlas, picture.width, picture.height);
  if (!own)
    throw Error(ErrorKind::kNotPossible, Concat("no keyframe has pictures of ", picture.width, " x ", picture.height,
                                                "; LocatePicturesOptions::camera tells that of this one"));
  return *std::move(own);
}

// By picture, those that could not be read.
using Unreadable = std::vector<std::optional<Error>>;

// Calls work(row) for every picture, in parallel. Throws what it throws where no picture can be read.
template <class Work>
Unreadable ForEachPicture(const std::vector<PictureFile>& files, std::string_view doing,
                          const LocatePicturesOptions& options, const Work& work) {
  constexpr std::size_t kBatch = 16;  // between two tellings
  Unreadable unreadable(files.size());
  const auto work_on = [&](std::size_t i) {
    try {
      work(i);
    } catch (const Error& error) {
      const std::string& path = error.path().empty() ? files[i].path : error.path();
      unreadable[i] = Error(error.kind(), path, error.place(), error.problem());
    }
  };
  for (std::size_t done = 0; done < files.size(); done += kBatch) {
    if (options.progress) options.progress(doing, static_cast<double>(done) / static_cast<double>(files.size()));
    detail::ParallelFor(std::min(kBatch, files.size() - done), 1, options.threads,
                        [&](std::size_t begin, std::size_t end) {
                          for (std::size_t i = done + begin; i < done + end; ++i) work_on(i);
                        });
  }
  if (std::ranges::all_of(unreadable, [](const auto& error) { return error.has_value(); })) throw *unreadable.front();
  return unreadable;
}

LocateReport ReportOf(const std::vector<PictureFile>& files) {
  LocateReport report;
  for (const PictureFile& file : files) {
    LocatedPicture& picture = report.pictures.emplace_back();
    picture.name = file.path;
    picture.timestamp = file.timestamp;
  }
  return report;
}

void TellUnreadable(const Unreadable& unreadable, LocateReport& report, Notices& notices) {
  for (std::size_t i = 0; i < unreadable.size(); ++i) {
    if (!unreadable[i]) continue;
    report.pictures[i].localization = {.verdict = LocateVerdict::kUnreadable, .reason = unreadable[i]->problem()};
    notices.Warn(unreadable[i]->what());
  }
}

// Pictures before it is known whose camera took them: as ORB-SLAM3 finds features unless it is told otherwise.
CameraSettings AnyCamera(const GrayPicture& picture) {
  CameraSettings settings{.camera = {}, .distortion = {}};
  settings.camera.parameters = {1, 1, 0, 0};
  settings.width = settings.file_width = picture.width;
  settings.height = settings.file_height = picture.height;
  return settings;
}

// A picture that all atlases of a store are asked for.
struct AskedPicture {
  CameraSettings found_with;
  PictureFeatures features;
};

// As the camera of an atlas sees it.
std::optional<PictureFeatures> SeenBy(const Atlas& atlas, const AskedPicture& picture, const std::string& file,
                                      std::int32_t features) {
  const std::optional<CameraSettings> own = SettingsOfMap(atlas, picture.found_with.width, picture.found_with.height);
  if (!own) return std::nullopt;
  std::optional<PictureFeatures> seen = WithCamera(picture.features, picture.found_with, *own);
  return seen ? seen : ExtractFeatures(ReadPicture(file), *own, features);
}

std::vector<TrajectoryPose> FoundIn(const LocateReport& report, MapId map) {
  std::vector<TrajectoryPose> poses;
  for (const LocatedPicture& picture : report.pictures) {
    const Localization& found = picture.localization;
    if (found.verdict == LocateVerdict::kFound && found.map == map)
      poses.push_back({picture.timestamp, found.position, found.rotation});
  }
  return poses;
}

// The errors of what was found, map by map, each laid onto the truth.
void HoldAgainst(const Atlas& atlas, const LocatePicturesOptions& options, LocateReport& report, Notices& notices) {
  ReadOptions read{.threads = options.threads, .progress = options.progress};
  read.of<StoreReadOptions>().lock_timeout = options.lock_timeout;
  const std::vector<TrajectoryPose> reference = ReadTrajectory(Location(options.against), read, &notices);
  for (const Map& map : atlas.maps) {
    const Estimate estimate{.map = map.id, .poses = FoundIn(report, map.id), .open_scale = !IsMetric(map)};
    if (estimate.poses.empty()) continue;
    try {
      const TrajectoryEvaluation evaluation = EvaluateTrajectory(estimate, reference, {.deltas = {}});
      for (const PairedPose& pose : evaluation.poses)
        for (LocatedPicture& picture : report.pictures)
          if (picture.localization.verdict == LocateVerdict::kFound && picture.localization.map == map.id &&
              picture.timestamp == pose.timestamp)
            picture.error = {pose.translation_error, pose.rotation_error_degrees};
    } catch (const Error& error) {
      notices.Warn(Concat(map.id, ": not held against ", options.against, ": ", error.problem()));
    }
  }
}

std::string TumOf(const std::vector<TrajectoryPose>& poses) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  for (const TrajectoryPose& pose : poses) {
    detail::AppendSeconds(text, pose.timestamp);
    const Eigen::Vector4d& q = pose.rotation.coeffs();
    for (const double number : {pose.position.x(), pose.position.y(), pose.position.z(), q.x(), q.y(), q.z(), q.w()}) {
      text += ' ';
      detail::AppendNumber(text, number);
    }
    text += '\n';
  }
  return text;
}

}  // namespace

LocateReport LocatePictures(const Atlas& atlas, const Locator& locator, const LocatePicturesOptions& options,
                            Notices& notices) {
  const std::vector<PictureFile> files = FindPictures(options.pictures);
  LocateReport report = ReportOf(files);
  const Unreadable unreadable = ForEachPicture(files, "locating", options, [&](std::size_t i) {
    const GrayPicture picture = ReadPicture(files[i].path);
    const CameraSettings camera = CameraFor(atlas, options.camera, picture);
    report.pictures[i].localization = locator.Locate(ExtractFeatures(picture, camera, options.features));
  });
  TellUnreadable(unreadable, report, notices);
  if (options.against.empty()) return report;
  if (std::ranges::none_of(files, &PictureFile::has_time))
    notices.Warn("the pictures have no times: they are paired with " + options.against +
                 " by their order, 1 for the first");
  HoldAgainst(atlas, options, report, notices);
  return report;
}

LocateReport LocatePictures(Store& store, const LocatePicturesOptions& options, Notices& notices) {
  const std::vector<PictureFile> files = FindPictures(options.pictures);
  std::vector<CameraSettings> found_with(files.size());
  std::vector<PictureFeatures> looks(files.size());
  const Unreadable unreadable = ForEachPicture(files, "looking at pictures", options, [&](std::size_t i) {
    const GrayPicture picture = ReadPicture(files[i].path);
    found_with[i] = options.camera ? *options.camera : AnyCamera(picture);
    looks[i] = ExtractFeatures(picture, found_with[i], options.features);
  });
  const auto features_for = [&](std::size_t i, const Atlas& atlas) -> std::optional<PictureFeatures> {
    if (options.camera) return looks[i];
    return SeenBy(atlas, {found_with[i], looks[i]}, files[i].path, options.features);
  };
  const LocatedInStore located =
      LocateInStore(store, looks, features_for,
                    {.lock_timeout = options.lock_timeout, .threads = options.threads, .progress = options.progress});
  for (const std::string& atlas : located.not_asked) notices.Warn("not asked: " + atlas);
  LocateReport report = ReportOf(files);
  report.not_asked = located.not_asked;
  for (std::size_t i = 0; i < files.size(); ++i) {
    LocatedPicture& picture = report.pictures[i];
    const std::vector<AtlasLocalization>& answers = located.pictures[i];
    picture.localization.reason = "no place of the store looks like it";
    picture.localization.evidence.features = looks[i].descriptors.size();
    if (answers.empty()) continue;
    picture.localization = answers.front().localization;
    const bool is_found = picture.localization.verdict != LocateVerdict::kNotFound;
    if (is_found) picture.atlas = answers.front().atlas;
    picture.others.assign(answers.begin() + (is_found ? 1 : 0), answers.end());
  }
  TellUnreadable(unreadable, report, notices);
  return report;
}

std::string PosesFound(const LocateReport& report, const Atlas& atlas) {
  std::vector<MapId> maps;
  for (const Map& map : atlas.maps)
    if (!FoundIn(report, map.id).empty()) maps.push_back(map.id);
  if (maps.empty()) return TumOf({});
  std::string text;
  for (const MapId map : maps)
    text += (maps.size() > 1 ? Concat("# map ", map.value(), "\n") : std::string()) + TumOf(FoundIn(report, map));
  return text;
}

}  // namespace slamdb
