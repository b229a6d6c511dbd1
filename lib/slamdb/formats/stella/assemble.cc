// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/stella/detail/assemble.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/detail/select.h"
#include "slamdb/formats/import/detail/complete.h"
#include "slamdb/formats/import/detail/keypoints.h"
#include "slamdb/formats/stella/detail/cameras.h"
#include "slamdb/formats/stella/detail/lens.h"
#include "slamdb/formats/stella/detail/links.h"
#include "slamdb/model/derive.h"

namespace slamdb::stella {
namespace {

using detail::Concat;
using detail::Counted;

// The id in `camera 3`, as slamdb names cameras; others get the lowest that are free.
std::optional<std::uint64_t> NamedId(const std::string& name) {
  constexpr std::string_view kNamed = "camera ";
  if (!name.starts_with(kNamed)) return std::nullopt;
  const auto id = detail::ParseNumber<std::uint32_t>(std::string_view(name).substr(kNamed.size()));
  if (!id || *id == ~std::uint32_t{0}) return std::nullopt;
  return *id;
}

std::vector<Camera> CamerasOf(const std::vector<LensCamera>& lenses) {
  std::vector<Camera> cameras;
  std::set<CameraId> taken;
  for (const LensCamera& lens : lenses) {
    const auto named = NamedId(lens.name);
    const bool free = named && taken.insert(CameraId(*named)).second;
    cameras.push_back(CameraOf(lens, free ? CameraId(*named) : CameraId()));
  }
  std::uint64_t next = 0;
  for (Camera& camera : cameras)
    if (!camera.id) {
      while (!taken.insert(CameraId(next)).second) ++next;
      camera.id = CameraId(next);
    }
  return cameras;
}

// How many keyframes what is told is about.
struct Derived {
  std::uint64_t redistorted = 0, equirectangular = 0, divided = 0, unknown_params = 0;

  void Tell(Notices& notices) const {
    const auto lose = [&](std::uint64_t count, std::string_view what) {
      if (count > 0) notices.Lose(Concat(what, ": ", Counted(count, "keyframe")));
    };
    lose(
        equirectangular,
        "no camera of ORB-SLAM3 is equirectangular; a pinhole stands for it that fits in the middle of the picture, so "
        "that reprojection errors mean nothing");
    lose(divided, "the distortion of RadialDivision cameras is left out; undistorted keypoints are those of a pinhole");
    if (redistorted > 0)
      notices.Warn(
          Concat("keypoints as detected are not in the file; they were found from the undistorted ones and the "
                 "distortion of the lens: ",
                 Counted(redistorted, "keyframe")));
    if (unknown_params > 0)
      notices.Warn(Concat("the file does not tell the image pyramid, taken to be 8 levels of 1.2: ",
                          Counted(unknown_params, "keyframe")));
  }
};

class Assembler {
 public:
  Assembler(StoredMap& stored, const std::string& path, const ReadOptions& options)
      : stored_(stored), path_(path), options_(options) {
    for (std::size_t row = 0; row < stored.cameras.size(); ++row) camera_rows_.emplace(stored.cameras[row].name, row);
    for (const OrbParams& params : stored.orb_params) pyramids_.emplace(params.name, PyramidOf(params));
  }

  Derived Run(Atlas& atlas) {
    atlas.cameras = CamerasOf(stored_.cameras);
    Derived derived;
    lenses_.reserve(stored_.keyframes.size());
    for (StoredKeyFrame& stored : stored_.keyframes) SetCamera(stored, atlas, derived);
    detail::ParallelFor(stored_.keyframes.size(), 1, options_.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) SetKeypoints(stored_.keyframes[row].keyframe, *lenses_[row]);
    });
    MakeMaps(atlas);
    atlas.next_ids = {.map = atlas.maps.size(),
                      .frame = stored_.next_frame,
                      .keyframe = stored_.next_keyframe,
                      .map_point = stored_.next_point};
    return derived;
  }

 private:
  ScalePyramid PyramidOf(const OrbParams& params) const {
    if (!params.is_sound())
      throw Error(ErrorKind::kDamaged, path_, Concat("orb_params `", params.name, "`"),
                  Concat("has ", params.levels, " levels, each ", static_cast<double>(params.scale_factor),
                         " times as small; expected 1 to 64, and a factor between 1 and 10"));
    return DerivePyramid(static_cast<std::int32_t>(params.levels), params.scale_factor);
  }

  void SetCamera(StoredKeyFrame& stored, const Atlas& atlas, Derived& derived) {
    KeyFrame& keyframe = stored.keyframe;
    const auto found = camera_rows_.find(stored.camera);
    if (found == camera_rows_.end())
      throw Error(ErrorKind::kDamaged, path_, Concat("keyframe ", keyframe.id.value()),
                  Concat("names the camera `", stored.camera, "`, which the file does not have"));
    const LensCamera& lens = stored_.cameras[found->second];
    keyframe.camera = atlas.cameras[found->second].id;
    SetLens(keyframe, lens, stored.depth_threshold);
    if (!stored.own_params && !pyramids_.contains(stored.orb_params))
      stored.own_params = OrbParams::Named(stored.orb_params);
    const auto known = pyramids_.find(stored.orb_params);
    derived.unknown_params += !stored.own_params && known == pyramids_.end() ? 1 : 0;
    if (stored.own_params)
      keyframe.pyramid = PyramidOf(*stored.own_params);
    else
      keyframe.pyramid = known != pyramids_.end() ? known->second : PyramidOf(OrbParams{});
    derived.equirectangular += lens.model == Model::kEquirectangular ? 1 : 0;
    derived.divided += lens.model == Model::kRadialDivision && lens.is_distorted() ? 1 : 0;
    const bool changed = lens.model == Model::kFisheye || lens.is_distorted();
    derived.redistorted += changed && keyframe.features.keypoints.empty() && !keyframe.features.undistorted.empty();
    lenses_.push_back(&lens);
  }

  // ORB-SLAM3 leaves keypoints of fisheye cameras as they were detected.
  static void SetKeypoints(KeyFrame& keyframe, const LensCamera& lens) {
    Features& features = keyframe.features;
    for (Column<Keypoint>* column : {&features.keypoints, &features.undistorted})
      for (Keypoint& keypoint : *column)
        if (keypoint.size == 0) keypoint.size = detail::PatchAt(keypoint.octave, keyframe.pyramid);
    if (features.keypoints.empty()) features.keypoints = Distorted(lens, features.undistorted);
    if (lens.model == Model::kFisheye) features.undistorted = features.keypoints;
    keyframe.not_erase = !keyframe.loop_edges.empty();
  }

  void MakeMaps(Atlas& atlas) {
    const Parts parts = PartsOf(stored_);
    atlas.maps.resize(parts.count);
    for (std::uint32_t part = 0; part < parts.count; ++part) atlas.maps[part].id = MapId(part);
    for (std::size_t row = 0; row < stored_.keyframes.size(); ++row)
      atlas.maps[parts.of_keyframe[row]].keyframes.push_back(std::move(stored_.keyframes[row].keyframe));
    for (std::size_t row = 0; row < stored_.points.size(); ++row)
      atlas.maps[parts.of_point[row]].points.push_back(std::move(stored_.points[row]));
  }

  StoredMap& stored_;
  const std::string& path_;
  const ReadOptions& options_;
  std::map<std::string, std::size_t> camera_rows_;
  std::map<std::string, ScalePyramid> pyramids_;
  std::vector<const LensCamera*> lenses_;  // of the keyframes
};

}  // namespace

Atlas Assemble(StoredMap stored, const std::string& path, const ReadOptions& options, Notices& notices) {
  CleanLinks(stored, notices);
  if (stored.markers + stored.marker_sightings > 0)
    notices.Lose(Concat(Counted(stored.markers, "marker"), ", seen ", Counted(stored.marker_sightings, "time"),
                        ": left out, as an atlas has none"));
  Atlas atlas;
  Assembler(stored, path, options).Run(atlas).Tell(notices);
  detail::CompleteAtlas(atlas, "stella_vslam", options.threads, notices);
  detail::Select(options.selection, atlas);
  return atlas;
}

}  // namespace slamdb::stella
