// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>
#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/import/detail/possible.h"
#include "slamdb/formats/stella/detail/cameras.h"
#include "slamdb/formats/stella/detail/message_pack.h"
#include "slamdb/formats/stella/detail/message_pack_format.h"

namespace slamdb::stella {
namespace {

using detail::Concat;

constexpr std::uint64_t kMostIds = std::uint64_t{1} << 32;  // ids have 32 bits

// What a keyframe must have, and what OpenVSLAM gives apart.
struct Seen {
  std::optional<Eigen::Quaterniond> rotation;
  std::optional<Eigen::Vector3d> translation;
  bool keypoints = false;
  std::optional<std::int64_t> count;
  std::vector<std::array<float, 2>> undistorted;  // of keypoints as detected
  bool has_undistorted = false;
};

class Decoder {
 public:
  Decoder(std::string_view bytes, const std::string& path, const ReadOptions& options)
      : reader_(bytes, path), options_(options), size_(bytes.size()) {}

  StoredMap Run() {
    bool keyframes = false;
    ForEachKey([&](std::string_view key) {
      if (key == "cameras") return ReadCameras();
      if (key == "orb_params") return ReadOrbParams();
      if (key == "keyframes") return keyframes = true, ReadKeyFrames();
      if (key == "landmarks") return ReadPoints();
      if (key == "keyframe_next_id") return SetCount(map_.next_keyframe);
      if (key == "landmark_next_id") return SetCount(map_.next_point);
      if (key == "frame_next_id") return SetCount(map_.next_frame);
      reader_.Skip();
    });
    reader_.SetPlace("");
    if (!keyframes) reader_.Fail("holds no `keyframes`, which a map of stella_vslam has");
    if (!reader_.AtEnd()) reader_.Fail(Concat("the map ends here, and ", reader_.left(), " bytes stand behind it"));
    return std::move(map_);
  }

 private:
  void Require(const std::string& why_not) const {
    if (!why_not.empty()) reader_.Fail(why_not);
  }

  template <class Take>
  void ForEachKey(const Take& take) {
    for (std::uint32_t pairs = reader_.Map(); pairs > 0; --pairs) take(reader_.Text());
  }

  template <class Value>
  void ReadList(std::vector<Value, ColumnAllocator<Value>>& column, Value (Decoder::*take)()) {
    column.resize(reader_.List());
    for (Value& value : column) value = (this->*take)();
  }

  template <class Numbers>
  void ReadNumbers(Numbers& numbers, std::uint32_t count, const char* what) {
    const std::uint32_t found = reader_.List();
    if (found != count) reader_.Fail(Concat(what, " has ", found, " numbers, expected ", count));
    for (std::uint32_t i = 0; i < count; ++i)
      numbers[i] = static_cast<std::remove_reference_t<decltype(numbers[0])>>(reader_.Number());
  }

  void SetCount(std::uint64_t& count) {
    const std::int64_t value = reader_.Integer();
    count = value > 0 ? static_cast<std::uint64_t>(value) : 0;
  }
  std::uint32_t Size() {
    const std::int64_t value = reader_.Integer();
    if (value < 0 || value >= static_cast<std::int64_t>(kMostIds)) reader_.Fail(Concat("found the size ", value));
    return static_cast<std::uint32_t>(value);
  }
  float Real() { return static_cast<float>(reader_.Number()); }
  std::uint64_t IdOf(std::string_view key, const char* what) {
    const auto id = detail::ParseNumber<std::uint64_t>(key);
    if (!id || *id >= kMostIds) reader_.Fail(Concat("the name of a ", what, " is `", key, "`, expected a number"));
    return *id;
  }
  // -1: none.
  KeyFrameId TakeKeyFrameId() {
    const std::int64_t id = reader_.Integer();
    return id < 0 ? KeyFrameId() : KeyFrameId(static_cast<std::uint64_t>(id));
  }
  MapPointId TakePointId() {
    const std::int64_t id = reader_.Integer();
    return id < 0 ? MapPointId() : MapPointId(static_cast<std::uint64_t>(id));
  }

  void ReadCameras();
  void ReadCamera(LensCamera& camera);
  void ReadOrbParams();
  void ReadKeyFrames();
  void ReadKeyFrame(StoredKeyFrame& stored);
  bool ReadFeatures(std::string_view key, Features& features, Seen& seen);
  void ReadKeypoints(Column<Keypoint>& keypoints);
  void ReadDescriptors(Column<Descriptor>& descriptors);
  void Finish(StoredKeyFrame& stored, Seen& seen);
  void ReadPoints();
  void ReadPoint(MapPoint& point);

  MessagePackReader reader_;
  const ReadOptions& options_;
  std::size_t size_;
  StoredMap map_;
};

void Decoder::ReadCameras() {
  ForEachKey([&](std::string_view name) {
    reader_.SetPlace(Concat("camera `", name, "`"));
    LensCamera& camera = map_.cameras.emplace_back();
    camera.name = name;
    ReadCamera(camera);
  });
}

void Decoder::ReadCamera(LensCamera& camera) {
  // Which place of LensCamera::distortion a number has depends on the model, which may stand behind it.
  std::array<double, 4> k{};
  double p1 = 0, p2 = 0, division = 0;
  ForEachKey([&](std::string_view key) {
    const auto set = [&](double& to) { to = reader_.Number(); };
    if (key == "model_type" || key == "setup_type") {
      const std::string_view name = reader_.Text();
      const auto model = ModelOf(name);
      const auto setup = SetupOf(name);
      if (key == "model_type" ? !model : !setup)
        throw Error(ErrorKind::kUnsupported, reader_.path(), Concat("camera `", camera.name, "`"),
                    Concat("its ", key, " is `", name, "`, which slamdb does not know"));
      if (key == "model_type") camera.model = *model;
      if (key == "setup_type") camera.setup = *setup;
      return;
    }
    if (key == "color_order") return void(camera.color_order = reader_.Text());
    if (key == "cols") return void(camera.columns = Size());
    if (key == "rows") return void(camera.rows = Size());
    if (key == "fps") return set(camera.fps);
    if (key == "fx") return set(camera.fx);
    if (key == "fy") return set(camera.fy);
    if (key == "cx") return set(camera.cx);
    if (key == "cy") return set(camera.cy);
    if (key == "focal_x_baseline") return set(camera.focal_x_baseline);
    if (key.size() == 2 && key[0] == 'k' && key[1] >= '1' && key[1] <= '4')
      return set(k[static_cast<std::size_t>(key[1] - '1')]);
    if (key == "p1") return set(p1);
    if (key == "p2") return set(p2);
    if (key == "distortion") return set(division);
    reader_.Skip();
  });
  if (camera.model == Model::kPerspective) camera.distortion = {k[0], k[1], p1, p2, k[2]};
  if (camera.model == Model::kFisheye) camera.distortion = {k[0], k[1], k[2], k[3], 0};
  if (camera.model == Model::kRadialDivision) camera.distortion = {division, 0, 0, 0, 0};
  Require(WhyNoCamera(camera));
}

void Decoder::ReadOrbParams() {
  ForEachKey([&](std::string_view name) {
    reader_.SetPlace(Concat("orb_params `", name, "`"));
    OrbParams& params = map_.orb_params.emplace_back();
    params.name = name;
    ForEachKey([&](std::string_view key) {
      if (key == "scale_factor") return void(params.scale_factor = Real());
      if (key == "num_levels") return void(params.levels = Size());
      if (key == "ini_fast_threshold") return void(params.ini_fast_threshold = Size());
      if (key == "min_fast_threshold") return void(params.min_fast_threshold = Size());
      reader_.Skip();
    });
  });
}

void Decoder::ReadKeyFrames() {
  const std::uint32_t count = reader_.Map();
  for (std::uint32_t row = 0; row < count; ++row) {
    const std::uint64_t id = IdOf(reader_.Text(), "keyframe");
    StoredKeyFrame& stored = map_.keyframes.emplace_back();
    stored.keyframe.id = KeyFrameId(id);
    stored.keyframe.frame_id = id;
    reader_.SetPlace(Concat("keyframe ", id));
    ReadKeyFrame(stored);
    if (options_.progress && size_ > 0)
      options_.progress("reading", static_cast<double>(size_ - reader_.left()) / static_cast<double>(size_));
  }
}

void Decoder::ReadKeyFrame(StoredKeyFrame& stored) {
  KeyFrame& keyframe = stored.keyframe;
  Seen seen;
  OrbParams own;
  bool has_own = false;
  ForEachKey([&](std::string_view key) {
    if (key == "ts") return void(keyframe.timestamp = reader_.Number());
    if (key == "cam") return void(stored.camera = reader_.Text());
    if (key == "orb_params") return void(stored.orb_params = reader_.Text());
    if (key == "rot_cw") return ReadNumbers(seen.rotation.emplace().coeffs(), 4, "rot_cw");
    if (key == "trans_cw") return ReadNumbers(seen.translation.emplace(), 3, "trans_cw");
    if (key == "span_parent") return void(keyframe.parent = TakeKeyFrameId());
    if (key == "span_children") return ReadList(keyframe.children, &Decoder::TakeKeyFrameId);
    if (key == "loop_edges") return ReadList(keyframe.loop_edges, &Decoder::TakeKeyFrameId);
    if (key == "src_frm_id") return SetCount(keyframe.frame_id);
    if (key == "depth_thr") return void(stored.depth_threshold = reader_.Number());
    if (key == "n_scale_levels") return has_own = true, void(own.levels = Size());
    if (key == "scale_factor") return has_own = true, void(own.scale_factor = Real());
    if (!ReadFeatures(key, keyframe.features, seen)) reader_.Skip();
  });
  if (has_own) stored.own_params = own;
  Finish(stored, seen);
}

bool Decoder::ReadFeatures(std::string_view key, Features& features, Seen& seen) {
  if (key == "n_keypts") {
    seen.count = reader_.Integer();
  } else if (key == "undist_keypts") {
    seen.keypoints = true;
    ReadKeypoints(features.undistorted);
  } else if (key == "keypts") {
    seen.keypoints = true;
    ReadKeypoints(features.keypoints);
  } else if (key == "undists") {
    seen.has_undistorted = true;
    seen.undistorted.resize(reader_.List());
    for (std::array<float, 2>& place : seen.undistorted) ReadNumbers(place, 2, "an entry of undists");
  } else if (key == "x_rights") {
    ReadList(features.right_x, &Decoder::Real);
  } else if (key == "depths") {
    ReadList(features.depth, &Decoder::Real);
  } else if (key == "descs") {
    ReadDescriptors(features.descriptors);
  } else if (key == "lm_ids") {
    ReadList(features.map_points, &Decoder::TakePointId);
  } else {
    return false;
  }
  return true;
}

void Decoder::ReadKeypoints(Column<Keypoint>& keypoints) {
  keypoints.resize(reader_.List());
  for (Keypoint& keypoint : keypoints) {
    keypoint = {.angle = 0, .response = 0, .size = 0, .x = 0, .y = 0, .class_id = -1, .octave = 0};
    std::array<float, 2> place{};
    ForEachKey([&](std::string_view key) {
      if (key == "pt") return ReadNumbers(place, 2, "pt");
      if (key == "ang") return void(keypoint.angle = Real());
      if (key == "oct") return void(keypoint.octave = static_cast<std::int32_t>(Size()));
      reader_.Skip();
    });
    keypoint.x = place[0];
    keypoint.y = place[1];
  }
}

void Decoder::ReadDescriptors(Column<Descriptor>& descriptors) {
  descriptors.resize(reader_.List());
  for (Descriptor& descriptor : descriptors) {
    std::array<std::uint32_t, 8> words{};
    if (const std::uint32_t found = reader_.List(); found != words.size())
      reader_.Fail(Concat("a descriptor has ", found, " words of 32 bits, expected 8"));
    for (std::uint32_t& word : words) word = Size();
    std::memcpy(descriptor.data(), words.data(), sizeof words);
  }
}

// All columns have the rows that the keypoints have, or none where there is no such measurement.
void Decoder::Finish(StoredKeyFrame& stored, Seen& seen) {
  if (!seen.rotation || !seen.translation) reader_.Fail("has no pose (rot_cw, trans_cw)");
  Require(detail::WhyNoPose(*seen.rotation, *seen.translation));
  stored.keyframe.camera_from_world = detail::PoseOf(*seen.rotation, *seen.translation);
  if (!seen.keypoints && !seen.has_undistorted) reader_.Fail("has no keypoints (undist_keypts)");
  Features& features = stored.keyframe.features;
  if (seen.has_undistorted) {
    features.undistorted = features.keypoints;
    if (features.keypoints.empty())
      features.undistorted.resize(seen.undistorted.size(),
                                  {.angle = 0, .response = 0, .size = 0, .x = 0, .y = 0, .class_id = -1, .octave = 0});
    if (features.undistorted.size() != seen.undistorted.size())
      reader_.Fail(Concat("has ", seen.undistorted.size(), " undists of ", features.keypoints.size(), " keypts"));
    for (std::size_t row = 0; row < seen.undistorted.size(); ++row) {
      features.undistorted[row].x = seen.undistorted[row][0];
      features.undistorted[row].y = seen.undistorted[row][1];
    }
  }
  if (features.undistorted.empty()) features.undistorted = features.keypoints;
  const std::size_t count = features.undistorted.size();
  const auto require = [&](std::size_t found, const char* what, bool may_be_empty) {
    if (found != count && !(may_be_empty && found == 0))
      reader_.Fail(Concat("has ", found, " ", what, " of ", count, " keypoints"));
  };
  if (seen.count) require(static_cast<std::size_t>(*seen.count), "n_keypts", false);
  require(features.keypoints.size(), "keypts", true);
  require(features.right_x.size(), "x_rights", true);
  require(features.depth.size(), "depths", true);
  require(features.descriptors.size(), "descs", false);
  require(features.map_points.size(), "lm_ids", false);
}

void Decoder::ReadPoints() {
  const std::uint32_t count = reader_.Map();
  for (std::uint32_t row = 0; row < count; ++row) {
    MapPoint& point = map_.points.emplace_back();
    point.descriptor_form = MatrixForm::kEmpty;
    point.id = MapPointId(IdOf(reader_.Text(), "landmark"));
    reader_.SetPlace(Concat("landmark ", point.id.value()));
    ReadPoint(point);
  }
}

void Decoder::ReadPoint(MapPoint& point) {
  std::optional<Eigen::Vector3d> position;
  const auto count = [&] {
    const std::int64_t value = reader_.Integer();
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(value, 0, std::numeric_limits<std::int32_t>::max()));
  };
  ForEachKey([&](std::string_view key) {
    if (key == "pos_w") return ReadNumbers(position.emplace(), 3, "pos_w");
    if (key == "1st_keyfrm") return void(point.first_keyframe = reader_.Integer());
    if (key == "ref_keyfrm") return void(point.reference = TakeKeyFrameId());
    if (key == "n_vis") return void(point.visible_count = count());
    if (key == "n_fnd") return void(point.found_count = count());
    reader_.Skip();
  });
  if (!position) reader_.Fail("has no position (pos_w)");
  Require(detail::WhyNoPosition(*position));
  point.position = position->cast<float>();
}

}  // namespace

StoredMap DecodeMessagePack(std::string_view bytes, const std::string& path, const ReadOptions& options) {
  return Decoder(bytes, path, options).Run();
}

}  // namespace slamdb::stella
