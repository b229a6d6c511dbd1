// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/build/build.h"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "python/src/given.h"
#include "python/src/map_in_atlas.h"
#include "python/src/module.h"
#include "python/src/new_features.h"
#include "python/src/new_imu.h"
#include "python/src/reopen.h"
#include "slamdb/formats/dbow2/vocabulary.h"
#include "slamdb/formats/info.h"
#include "slamdb/model/vocabulary.h"

// Atlases from arrays.
namespace slamdb::python {

namespace py = pybind11;

namespace {

// None: ORB-SLAM3's own. Otherwise its file, or (name, MD5).
Vocabulary VocabularyOf(const py::object& given) {
  if (given.is_none()) {
    const KnownVocabulary& own = KnownVocabularies().front();
    return {std::string(own.name), std::string(own.checksum)};
  }
  if (py::isinstance<py::tuple>(given)) {
    const auto [name, checksum] = given.cast<std::pair<std::string, std::string>>();
    return {name, checksum};
  }
  const auto path = py::module_::import("os").attr("fspath")(given).cast<std::string>();
  VocabularyFile file = ReadVocabularyFile(path);
  if (!file.other.empty()) RefuseGiven("vocabulary", path + " is " + file.other);
  return file.identity;
}

CameraModel ModelOf(const std::string& name) {
  for (const CameraModel model : {CameraModel::kPinhole, CameraModel::kKannalaBrandt8})
    if (NameOf(model) == name) return model;
  RefuseGiven("model", "'" + name + "' is none of 'pinhole' and 'kannala-brandt-8'");
}

Eigen::Quaterniond QuaternionAt(const double* xyzw) { return {xyzw[3], xyzw[0], xyzw[1], xyzw[2]}; }

// World from camera: (N, 4, 4) matrices, or (N, 7) tx ty tz qx qy qz qw.
std::vector<Rigid3f> PosesOf(py::handle given) {
  const py::array array = ArrayOrNull(given);
  const bool are_matrices = array && array.ndim() == 3;
  const auto numbers = GivenAs<double>(given, "poses", are_matrices ? Shape{-1, 4, 4} : Shape{-1, 7});
  std::vector<Rigid3f> poses;
  for (py::ssize_t row = 0; row < numbers.shape(0); ++row) {
    const double* at = numbers.data() + row * (are_matrices ? 16 : 7);
    const std::string place = "poses: row " + std::to_string(row);
    using Matrix = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
    poses.push_back(are_matrices
                        ? CameraFromWorldOf(Eigen::Matrix4d(Eigen::Map<const Matrix>(at)), place)
                        : CameraFromWorldOf(QuaternionAt(at + 3), Eigen::Map<const Eigen::Vector3d>(at), place));
  }
  return poses;
}

// As recorded: qx qy qz qw tx ty tz.
std::vector<Rigid3f> RecordedPosesOf(py::handle given) {
  static_assert(sizeof(Rigid3f) == 7 * sizeof(float));
  return GivenElements<Rigid3f, float>(given, "camera_from_world", {-1, 7});
}

std::vector<Rigid3f> EitherPoses(const py::object& poses, const py::object& camera_from_world) {
  if (poses.is_none() == camera_from_world.is_none())
    RefuseGiven("poses", "give either poses, world from camera, or camera_from_world");
  return poses.is_none() ? RecordedPosesOf(camera_from_world) : PosesOf(poses);
}

template <class Entity>
py::array IdArray(const std::vector<Id<Entity>>& ids) {
  std::vector<std::uint64_t> values;
  for (const Id<Entity> id : ids) values.push_back(id.value());
  return ArrayOf(values);
}

void SetImageSize(const py::object& image_size, NewKeyFrames& given) {
  const auto size = GivenAs<std::int32_t>(image_size, "image_size", {2});
  given.width = size.data()[0];
  given.height = size.data()[1];
  if (given.width <= 0 || given.height <= 0) RefuseGiven("image_size", "is width and height, pixels above 0");
}

// A SlamdbWarning where Python called.
void Warn(const char* text) {
  const py::object kind = py::module_::import("slamdb.errors").attr("SlamdbWarning");
  if (PyErr_WarnEx(kind.ptr(), text, 1) != 0) throw py::error_already_set();
}

py::array AddKeyFramesTo(const MapInAtlas& map, const py::object& timestamps, const py::object& poses,
                         const py::object& camera_from_world, const py::object& features, const py::object& camera,
                         const py::object& ids, const py::object& image_size, const py::object& distortion,
                         const py::object& baseline, const py::object& depth_threshold, const py::object& right_camera,
                         const py::object& left_from_right, const py::object& levels, const py::object& scale_factor,
                         const py::object& imu) {
  NewKeyFrames given{.timestamps = GivenElements<double, double>(timestamps, "timestamps", {-1}),
                     .camera_from_world = EitherPoses(poses, camera_from_world),
                     .ids = GivenIdsOf<KeyFrame>(ids, "ids"),
                     .camera = CameraId(GivenNumber<std::uint64_t>(camera, "camera")),
                     .right_camera = GivenId<Camera>(right_camera, "right_camera"),
                     .distortion = GivenElements<double, double>(distortion, "distortion", {-1}),
                     .baseline = GivenNumber<double>(baseline, "baseline"),
                     .depth_threshold = GivenNumber<double>(depth_threshold, "depth_threshold"),
                     .levels = GivenNumber<std::int32_t>(levels, "levels"),
                     .scale_factor = GivenNumber<float>(scale_factor, "scale_factor"),
                     .imu = GivenImu(imu)};
  if (!left_from_right.is_none()) given.left_from_right = GivenTransform(left_from_right, "left_from_right");
  if (!image_size.is_none()) SetImageSize(image_size, given);
  for (const py::handle item : GivenItems(features, "features"))
    given.features.push_back(GivenFeatures(item, "features: row " + std::to_string(given.features.size())));
  const bool all_described = std::ranges::all_of(
      given.features, [](const Features& each) { return each.keypoints.empty() || !each.descriptors.empty(); });
  const py::array added = IdArray(map.atlas->ApplyWhole([&](Atlas& atlas) {
    map.In(atlas);
    return AddKeyFrames(atlas, map.id, std::move(given));
  }));
  if (!all_described)
    Warn("keyframes have no descriptors: ORB-SLAM3 cannot use them, and `slamdb.check` finds their points without");
  return added;
}

// (M, 3) rows of point, keyframe id, keypoint; or Observations, compressed by rows.
std::vector<NewObservation> ObservationsOf(const py::object& given) {
  std::vector<NewObservation> observations;
  if (PartOf(given, "offsets").is_none()) {
    const std::vector<std::uint64_t> numbers = GivenIds(given, "observations", {-1, 3});
    for (std::size_t at = 0; at < numbers.size(); at += 3)
      observations.push_back({numbers[at], KeyFrameId(numbers[at + 1]), numbers[at + 2]});
    return observations;
  }
  const auto part = [&](const char* name) { return PartOf(given, name); };
  const std::vector<std::uint64_t> offsets = GivenIds(part("offsets"), "observations.offsets");
  const std::vector<std::uint64_t> keyframes = GivenIds(part("keyframes"), "observations.keyframes");
  const Shape as_many{static_cast<py::ssize_t>(keyframes.size())};
  const auto rows = [&](const char* name) {
    return GivenElements<std::int32_t, std::int32_t>(part(name), std::string("observations.") + name, as_many);
  };
  const std::vector<std::int32_t> left = rows("left");
  const std::vector<std::int32_t> right = part("right").is_none() ? std::vector<std::int32_t>() : rows("right");
  if (offsets.empty() || offsets.front() != 0 || offsets.back() != keyframes.size() || !std::ranges::is_sorted(offsets))
    RefuseGiven("observations.offsets",
                "ascend from 0 to the number of keyframes, " + std::to_string(keyframes.size()));
  for (std::size_t point = 0; point + 1 < offsets.size(); ++point)
    for (std::uint64_t i = offsets[point]; i < offsets[point + 1]; ++i)
      for (const std::int32_t row : {left[i], right.empty() ? -1 : right[i]})
        if (row >= 0) observations.push_back({point, KeyFrameId(keyframes[i]), static_cast<std::uint64_t>(row)});
  return observations;
}

py::array AddPointsTo(const MapInAtlas& map, const py::object& positions, const py::object& observations,
                      const py::object& ids, const py::object& descriptors, const py::object& normals,
                      const py::object& reference_keyframes, const py::object& min_distances,
                      const py::object& max_distances, int threads) {
  NewPoints given;
  given.positions = GivenElements<Eigen::Vector3f, float>(positions, "positions", {-1, 3});
  given.observations = ObservationsOf(observations);
  given.ids = GivenIdsOf<MapPoint>(ids, "ids");
  const Column<Descriptor> columns = GivenDescriptors(descriptors, "descriptors");
  given.descriptors.assign(columns.begin(), columns.end());
  given.normals = GivenElements<Eigen::Vector3f, float>(normals, "normals", {-1, 3});
  given.references = GivenIdsOf<KeyFrame>(reference_keyframes, "reference_keyframes");
  given.min_distances = GivenElements<float, float>(min_distances, "min_distances", {-1});
  given.max_distances = GivenElements<float, float>(max_distances, "max_distances", {-1});
  return IdArray(map.atlas->ApplyWhole([&](Atlas& atlas) {
    map.In(atlas);
    return AddPoints(atlas, map.id, std::move(given), threads);
  }));
}

MapInAtlas AddMapTo(const std::shared_ptr<HeldAtlas>& atlas, const py::object& given) {
  const auto id = GivenId<Map>(given, "id");
  const MapId added = atlas->ApplyWhole([&](Atlas& changed) { return AddMap(changed, id); });
  const std::vector<Map>& maps = atlas->value()->maps;
  const auto row = std::ranges::find(maps, added, &Map::id) - maps.begin();
  return {atlas, static_cast<std::size_t>(row), added};
}

using AtlasClass = py::class_<HeldAtlas, std::shared_ptr<HeldAtlas>>;
using MapClass = py::class_<MapInAtlas>;

void DefineAtlasBuilding(AtlasClass atlas) {
  atlas
      .def(py::init([](const py::object& vocabulary) {
             Atlas made;
             made.vocabulary = VocabularyOf(vocabulary);
             return std::make_shared<HeldAtlas>(std::move(made));
           }),
           py::kw_only(), py::arg("vocabulary") = py::none(),
           R"(An atlas of nothing: add_camera, add_map, then the map's add_keyframes and add_points.

vocabulary: that ORB-SLAM3 is started with, as it refuses maps of others: the path of its file, or (name, MD5);
    by default ORBvoc.txt, ORB-SLAM3's own. Bags of words stay empty: ORB-SLAM3 makes them when it loads the map.)")
      .def(
          "add_camera",
          [](HeldAtlas& self, const std::string& model, const py::args& parameters, const py::object& given_id) {
            const auto numbers = GivenElements<float, float>(py::list(parameters), "parameters", {-1});
            const CameraModel known = ModelOf(model);
            const auto id = GivenId<Camera>(given_id, "id");
            return self.ApplyWhole([&](Atlas& changed) { return AddCamera(changed, known, numbers, id); }).value();
          },
          py::arg("model"), py::kw_only(), py::arg("id") = py::none(),
          R"(Add a camera; returns its id.

model: "pinhole" with the parameters fx, fy, cx, cy, or "kannala-brandt-8" with k0, k1, k2, k3 behind them; pixels,
    of which (0, 0) is the middle of the first
id: by default the next one)")
      .def("add_map", &AddMapTo, py::kw_only(), py::arg("id") = py::none(), "Add an empty map; returns it.");
}

void DefineMapBuilding(MapClass map) {
  map.def("add_keyframes", &AddKeyFramesTo, py::kw_only(), py::arg("timestamps"), py::arg("poses") = py::none(),
          py::arg("camera_from_world") = py::none(), py::arg("features"), py::arg("camera"),
          py::arg("ids") = py::none(), py::arg("image_size") = py::none(), py::arg("distortion") = py::none(),
          py::arg("baseline") = 0.0, py::arg("depth_threshold") = 0.0, py::arg("right_camera") = py::none(),
          py::arg("left_from_right") = py::none(), py::arg("levels") = 8, py::arg("scale_factor") = 1.2,
          py::arg("imu") = py::none(),
          R"(Add keyframes of one camera, row by row; returns their ids, (N,) uint64.

timestamps: (N,) seconds
poses: world from (left) camera, (N, 4, 4), or (N, 7) tx ty tz qx qy qz qw; x right, y down, z forward; or instead
camera_from_world: (N, 7) qx qy qz qw tx ty tz, as KeyFrames.camera_from_world has it
features: for each keyframe slamdb.FeatureArrays, a mapping of the same names, or Features of another keyframe
camera: id; the keyframes of several cameras take several calls
ids: by default the next ones
image_size: (width, height), pixels; by default around the keypoints
distortion: k1 k2 p1 p2 [k3] of a pinhole
baseline: metres, of a rectified pair, or as chosen for an RGB-D camera; right_x and depth follow from each other
depth_threshold: metres, beyond which stereo points are far; 0: 40 baselines
right_camera, left_from_right: of a fisheye pair, id and (4, 4)
levels, scale_factor: of the image pyramid
imu: slamdb.ImuArrays, or a mapping of the same names, of sessions with an IMU; all keyframes of a map have one, or none

Made are undistorted keypoints, grids, parents (those made before, until points tell better ones), counters. With an
IMU also preintegrations, and the chain in time, whatever was added before what; set_imu_stage says how far the map is.
Raises UsageError (a ValueError) that names argument, row and what it should be; then nothing is changed.)")
      .def("add_points", &AddPointsTo, py::kw_only(), py::arg("positions"), py::arg("observations"),
           py::arg("ids") = py::none(), py::arg("descriptors") = py::none(), py::arg("normals") = py::none(),
           py::arg("reference_keyframes") = py::none(), py::arg("min_distances") = py::none(),
           py::arg("max_distances") = py::none(), py::arg("threads") = 0,
           R"(Add points, row by row, each of which keyframes observe; returns their ids, (N,) uint64.

positions: (N, 3) in the world
observations: (M, 3) whole numbers: row of positions, id of the keyframe, row of its keypoint (those of a right
    fisheye camera stand behind the left ones); or Observations as Points.observations gives them
ids: by default the next ones
descriptors: (N, 32) uint8; by default the most distinctive of those observed
normals: (N, 3); by default mean viewing directions
reference_keyframes: (N,) ids; by default the observers of the lowest id
min_distances, max_distances: (N,); by default from the reference's octave

Made are also what keypoints see, observation counts, covisibility and the spanning tree.
Raises UsageError (a ValueError) that names argument, row and what it should be; then nothing is changed.)");
}

}  // namespace

void DefineBuilding(py::module_& module) {
  DefineAtlasBuilding(Reopen<AtlasClass>(module, "Atlas"));
  DefineMapBuilding(Reopen<MapClass>(module, "Map"));
}

}  // namespace slamdb::python
