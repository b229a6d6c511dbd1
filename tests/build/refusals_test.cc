// SPDX-License-Identifier: BSD-3-Clause
// What cannot be is refused by the name of the column, its row and what it should be, and changes nothing.
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <limits>

#include "slamdb/build/links.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/build/taken_apart.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/error_of.h"

namespace slamdb {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

// A room with an IMU, of a map that has 8 keyframes, and what a map of 8 more is built of.
struct World {
  Atlas atlas =
      SynthesizeAtlas({.sensor = Sensor::kStereo, .inertial = true, .keyframes = 8, .points = 150, .features = 100});
  NewKeyFrames keyframes = KeyFramesOf(atlas.maps[0]);
  NewPoints points = PointsOf(atlas.maps[0]);
  Map& map = atlas.maps[0];
};

struct Refusal {
  const char* name;
  const char* message;  // a part of it
  std::function<void(World&)> work;
};
void PrintTo(const Refusal& refusal, std::ostream* out) { *out << refusal.name; }

std::function<void(World&)> KeyFrames(const std::function<void(NewKeyFrames&)>& change) {
  return [change](World& world) {
    world.keyframes.ids.clear();
    for (double& time : world.keyframes.timestamps) time += 1000;
    for (KeyFrameId& previous : world.keyframes.imu->previous) previous = {};
    change(world.keyframes);
    AddKeyFrames(world.atlas, MapId(0), world.keyframes);
  };
}

std::function<void(World&)> Points(const std::function<void(NewPoints&)>& change) {
  return [change](World& world) {
    world.map.points.clear();
    for (KeyFrame& keyframe : world.map.keyframes) std::ranges::fill(keyframe.features.map_points, MapPointId());
    change(world.points);
    const Atlas before = world.atlas;
    try {
      AddPoints(world.atlas, MapId(0), world.points);
    } catch (const Error&) {
      EXPECT_THAT(world.atlas, EqualsAtlas(before));
      world.atlas = World().atlas;  // as it was before the points were taken away
      throw;
    }
  };
}

std::function<void(World&)> Imu(const std::function<void(NewImu&)>& change) {
  return KeyFrames([change](NewKeyFrames& given) { change(*given.imu); });
}

// The first point and keypoint of the first keyframe that are free for each other.
PointObservation FreeOf(const Map& map) {
  const KeyFrame& keyframe = map.keyframes.front();
  const auto free = std::ranges::find(keyframe.features.map_points, MapPointId());
  for (const MapPoint& point : map.points)
    if (std::ranges::find(point.observations, keyframe.id, &Observation::keyframe) == point.observations.end())
      return {point.id, keyframe.id, static_cast<std::uint64_t>(free - keyframe.features.map_points.begin())};
  return {};
}

std::function<void(World&)> Seen(const std::function<void(const Map&, std::vector<PointObservation>&)>& change) {
  return [change](World& world) {
    std::vector<PointObservation> seen{FreeOf(world.map)};
    change(world.map, seen);
    AddObservations(world.map, seen);
  };
}

const std::vector<Refusal> kRefusals = {
    // Cameras and maps
    {"TooFewParameters", "parameters: there are 3; the model has 4",
     [](World& w) { AddCamera(w.atlas, CameraModel::kPinhole, {1, 2, 3}); }},
    {"ParameterThatIsNone", "parameters: row 2",
     [](World& w) { AddCamera(w.atlas, CameraModel::kPinhole, {1, 2, kNan, 3}); }},
    {"NoFocalLength", "parameters: row 1 is 0; a focal length is above 0",
     [](World& w) { AddCamera(w.atlas, CameraModel::kPinhole, {1, 0, 3, 4}); }},
    {"EquirectangularCamera", "model: nothing is projected",
     [](World& w) { AddCamera(w.atlas, CameraModel::kEquirectangular, {}); }},
    {"CameraIdTaken", "id: the atlas has a camera 0 already",
     [](World& w) { AddCamera(w.atlas, CameraModel::kPinhole, {1, 2, 3, 4}, CameraId(0)); }},
    {"CameraIdTooLarge", "id: 4294967295 is too large",
     [](World& w) { AddCamera(w.atlas, CameraModel::kPinhole, {1, 2, 3, 4}, CameraId(0xffffffff)); }},
    {"MapIdTaken", "id: the atlas has a map 0 already", [](World& w) { AddMap(w.atlas, MapId(0)); }},
    {"MapIdTooLarge", "id: 9223372036854775807 is too large",
     [](World& w) { AddMap(w.atlas, MapId((std::uint64_t{1} << 63) - 1)); }},

    // Keyframes
    {"TooFewPoses", "poses: has 7 rows, but there are 8", KeyFrames([](auto& k) { k.camera_from_world.pop_back(); })},
    {"TooFewFeatures", "features: has 7 rows", KeyFrames([](auto& k) { k.features.pop_back(); })},
    {"TooManyIds", "ids: has 1 rows", KeyFrames([](auto& k) { k.ids = {KeyFrameId(77)}; })},
    {"TimeThatIsNone", "timestamps: row 3 is not finite", KeyFrames([](auto& k) { k.timestamps[3] = std::nan(""); })},
    {"TimeWithoutEnd", "timestamps: row 3", KeyFrames([](auto& k) { k.timestamps[3] = HUGE_VAL; })},
    {"PoseNowhere", "poses: row 2", KeyFrames([](auto& k) { k.camera_from_world[2].translation.x() = kNan; })},
    {"PoseFarAway", "poses: row 2", KeyFrames([](auto& k) { k.camera_from_world[2].translation.x() = kInfinity; })},
    {"RotationThatIsNone", "poses: row 2",
     KeyFrames([](auto& k) { k.camera_from_world[2].rotation.coeffs().setZero(); })},
    {"NoSuchCamera", "camera: the atlas has no camera 9", KeyFrames([](auto& k) { k.camera = CameraId(9); })},
    {"PairOfPinholes", "right_camera: is of fisheye pairs", KeyFrames([](auto& k) { k.right_camera = CameraId(0); })},
    {"DistortionThatIsNone", "distortion: row 1", KeyFrames([](auto& k) { k.distortion = {0, HUGE_VAL}; })},
    {"TooMuchDistortion", "distortion: is k1 k2 p1 p2 [k3]", KeyFrames([](auto& k) { k.distortion.resize(6); })},
    {"ImageOfNothing", "image_size: 0 x 480", KeyFrames([](auto& k) { k.width = 0, k.height = 480; })},
    {"ImageBelowZero", "image_size: -640 x 480", KeyFrames([](auto& k) { k.width = -640, k.height = 480; })},
    {"HugeImage", "image_size", KeyFrames([](auto& k) { k.width = 1 << 30, k.height = 480; })},
    {"BaselineBelowZero", "baseline", KeyFrames([](auto& k) { k.baseline = -1; })},
    {"DepthThresholdThatIsNone", "depth_threshold", KeyFrames([](auto& k) { k.depth_threshold = std::nan(""); })},
    {"NoLevels", "levels: are 1 to 32", KeyFrames([](auto& k) { k.levels = 0; })},
    {"ManyLevels", "levels: are 1 to 32", KeyFrames([](auto& k) { k.levels = 1 << 30; })},
    {"ScaleThatShrinks", "scale_factor", KeyFrames([](auto& k) { k.scale_factor = 0.5F; })},
    {"KeyFrameIdTaken", "ids: row 0 is 3, which the atlas has",
     [](World& w) { AddKeyFrames(w.atlas, MapId(0), (std::ranges::fill(w.keyframes.ids, KeyFrameId(3)), w.keyframes)); }},
    {"KeyFrameIdTwice", "ids: row 1 is 70, as a row above",
     KeyFrames([](auto& k) { k.ids.assign(8, KeyFrameId(70)); })},
    {"KeyFrameIdTooLarge", "ids: row 0 is 2147483648; ids are below",
     KeyFrames([](auto& k) { k.ids.assign(8, KeyFrameId(std::uint64_t{1} << 31)); })},
    {"KeyFrameIdNearTwoToThe63", "ids: row 0 is 9223372036854775808",
     KeyFrames([](auto& k) { k.ids.assign(8, KeyFrameId(std::uint64_t{1} << 63)); })},
    {"KeyFrameIdOfNone", "ids: row 0", KeyFrames([](auto& k) { k.ids.assign(8, KeyFrameId()); })},

    // Features
    {"KeypointNowhere", "features: row 1 - keypoints: keypoint 9",
     KeyFrames([](auto& k) { k.features[1].keypoints[9].x = kNan; })},
    {"KeypointInNoPicture", "keypoint 9", KeyFrames([](auto& k) { k.features[1].keypoints[9].y = 1e20F; })},
    {"KeypointOfNoAngle", "keypoint 9 has an angle", KeyFrames([](auto& k) { k.features[1].keypoints[9].angle = kNan; })},
    {"KeypointOfNoSize", "keypoint 9 has an angle", KeyFrames([](auto& k) { k.features[1].keypoints[9].size = -1; })},
    {"OctaveTooHigh", "keypoint 9 is of octave 8, but", KeyFrames([](auto& k) { k.features[1].keypoints[9].octave = 8; })},
    {"OctaveBelowZero", "keypoint 9 is of octave -1", KeyFrames([](auto& k) { k.features[1].keypoints[9].octave = -1; })},
    {"TooFewDescriptors", "descriptors: has 7 rows", KeyFrames([](auto& k) { k.features[1].descriptors.resize(7); })},
    {"TooFewUndistorted", "undistorted: has 7 rows", KeyFrames([](auto& k) { k.features[1].undistorted.resize(7); })},
    {"DepthThatIsNone", "depth: keypoint 0", KeyFrames([](auto& k) { k.features[1].depth[0] = kInfinity; })},
    {"RightColumnThatIsNone", "right_x: keypoint 0", KeyFrames([](auto& k) { k.features[1].right_x[0] = kNan; })},
    {"DepthWithoutBaseline", "baseline= says it", KeyFrames([](auto& k) { k.baseline = 0; })},
    {"MatchWithoutPair", "right_of_left: keypoint 0 matches 0 of 0",
     KeyFrames([](auto& k) { k.features[1].right_of_left.assign(k.features[1].keypoints.size(), 0); })},

    // IMU
    {"NoImu", "imu: the keyframes of map 0 have one", KeyFrames([](auto& k) { k.imu.reset(); })},
    {"ImuBesideKeyFramesWithout", "imu: the keyframes of map 1 have none",
     [](World& w) {
       const Atlas plain = SynthesizeAtlas({.keyframes = 3, .points = 30, .features = 60});
       Atlas both = w.atlas;
       both.maps.push_back(plain.maps[0]);
       both.maps[1].id = MapId(1);
       AddKeyFrames(both, MapId(1), w.keyframes);
     }},
    {"BodyNowhere", "imu.body_from_camera", Imu([](auto& i) { i.body_from_camera.translation.x() = kNan; })},
    {"NoNoise", "imu.noise", Imu([](auto& i) { i.noise.setZero(); })},
    {"NoiseThatIsNone", "imu.noise", Imu([](auto& i) { i.noise[5] = kNan; })},
    {"NoWalk", "imu.walk_noise", Imu([](auto& i) { i.walk_noise[0] = -1; })},
    {"TooFewMeasurements", "imu.measurements: has 7 rows", Imu([](auto& i) { i.measurements.pop_back(); })},
    {"TooFewVelocities", "imu.velocities: has 7 rows", Imu([](auto& i) { i.velocities.pop_back(); })},
    {"TooFewBiases", "imu.biases: has 7 rows", Imu([](auto& i) { i.biases.pop_back(); })},
    {"TooFewIntegrationBiases", "imu.integration_biases: has 7 rows", Imu([](auto& i) { i.integration_biases.pop_back(); })},
    {"TooFewPrevious", "imu.previous: has 7 rows", Imu([](auto& i) { i.previous.pop_back(); })},
    {"AccelerationThatIsNone", "imu.measurements: row 2 - measurement 4 is not finite",
     Imu([](auto& i) { i.measurements[2][4].acceleration.x() = kNan; })},
    {"MeasurementOfNoTime", "imu.measurements: row 2 - measurement 4 lasts 0 s",
     Imu([](auto& i) { i.measurements[2][4].duration = 0; })},
    {"MeasurementsThatOverflow", "imu.measurements: row 2 adds up to more",
     Imu([](auto& i) { i.measurements[2][4].acceleration.setConstant(3e38F); })},
    {"VelocityThatIsNone", "imu.velocities: row 1", Imu([](auto& i) { i.velocities[1].x() = kInfinity; })},
    {"BiasThatIsNone", "imu.biases: row 1", Imu([](auto& i) { i.biases[1].gyroscope.x() = kNan; })},
    {"IntegrationBiasThatIsNone", "imu.integration_biases: row 1",
     Imu([](auto& i) { i.integration_biases[1].accelerometer.x() = kNan; })},
    {"PreviousThatIsNotThere", "imu.previous: row 1 is 99, which the map does not have",
     Imu([](auto& i) { i.previous[1] = KeyFrameId(99); })},
    {"PreviousThatComesLater", "imu.previous: row 1 is 13, which was not taken before",
     Imu([](auto& i) { i.previous[1] = KeyFrameId(13); })},
    {"PreviousOfTwo", "imu.previous: row 1 is 0, which is that of kf 1 already",
     Imu([](auto& i) { i.previous[1] = KeyFrameId(0); })},
    {"MeasurementsOfAnotherTime", "imu.measurements: row 1 lasts 0.25",
     Imu([](auto& i) { i.previous[1] = KeyFrameId(7); })},
    {"MeasurementsOfAnotherTimeByTime", "imu.measurements: row 0 lasts", KeyFrames([](auto& k) {
       k.imu->previous.clear();
       k.imu->measurements[0] = k.imu->measurements[1];
     })},
    {"TwoAtATime", "timestamps: row 3 is that of kf 12, too", KeyFrames([](auto& k) {
       k.imu->previous.clear();
       k.timestamps[4] = k.timestamps[3];
     })},
    {"NothingToSplit", "timestamps: row 0 is between kf 2 and kf 3, and the map has no measurements", [](World& w) {
       w.map.keyframes[3].preintegration.measurements.clear();
       w.keyframes.timestamps.assign(1, w.map.keyframes[3].timestamp - 0.01);
       w.keyframes.features.resize(1);
       w.keyframes.camera_from_world.resize(1);
       w.keyframes.ids.clear();
       w.keyframes.imu = NewImu{w.keyframes.imu->body_from_camera, w.keyframes.imu->noise,
                                w.keyframes.imu->walk_noise, {{}}};
       try {
         AddKeyFrames(w.atlas, MapId(0), w.keyframes);
       } catch (const Error&) {
         w.atlas = World().atlas;
         throw;
       }
     }},
    {"StageOfAMapWithoutImu", "stage: map 0 has no keyframes with an IMU",
     [](World&) {
       Map map{.id = MapId(0)};
       SetImuStage(map, ImuStage::kInitialized);
     }},
    {"StageWithoutCalibration", "stage: kf 3 has no calibration", [](World& w) {
       Map map = w.map;
       map.keyframes[3].imu_calibration.is_set = false;
       SetImuStage(map, ImuStage::kInitialized);
     }},
    {"StageWithoutMeasurements", "stage: kf 3 has no measurements of the IMU since kf 2", [](World& w) {
       Map map = w.map;
       map.keyframes[3].preintegration = {};
       SetImuStage(map, ImuStage::kInitialized);
     }},

    // Points
    {"PositionNowhere", "positions: row 4", Points([](auto& p) { p.positions[4].z() = kNan; })},
    {"PositionWithoutEnd", "positions: row 4", Points([](auto& p) { p.positions[4].z() = -kInfinity; })},
    {"PositionThatOverflows", "positions: row 4", Points([](auto& p) { p.positions[4].setConstant(3e38F); })},
    {"SeenByNobody", "is of a point that nothing observes", Points([](auto& p) { p.positions.emplace_back(1, 1, 1), p.ids.clear(); })},
    {"NormalThatIsNone", "normals: row 0", Points([](auto& p) { p.normals.assign(p.positions.size(), {kNan, 0, 0}); })},
    {"TooFewNormals", "normals: has 1 rows", Points([](auto& p) { p.normals.resize(1); })},
    {"TooFewPointDescriptors", "descriptors: has 1 rows", Points([](auto& p) { p.descriptors.resize(1); })},
    {"RangeTheWrongWayRound", "min_distances: row 0", Points([](auto& p) {
       p.min_distances.assign(p.positions.size(), 2);
       p.max_distances.assign(p.positions.size(), 1);
     })},
    {"RangeOfOneEnd", "max_distances: has 0 rows", Points([](auto& p) { p.min_distances.resize(p.positions.size()); })},
    {"ReferenceThatDoesNotSeeIt", "reference_keyframes: row 0 is 99",
     Points([](auto& p) { p.references.assign(p.positions.size(), KeyFrameId(99)); })},
    {"PointIdTwice", "ids: row 1 is 5, as a row above", Points([](auto& p) { std::ranges::fill(p.ids, MapPointId(5)); })},
    {"PointIdOfNone", "ids: row 0 is 18446744073709551615", Points([](auto& p) { p.ids[0] = MapPointId(); })},
    {"NewObservationOfNoPoint", "observations: row 3 is of point 1000000",
     Points([](auto& p) { p.observations[3].point = 1000000; })},
    {"NewObservationByNobody", "observations: row 3 is by keyframe 77",
     Points([](auto& p) { p.observations[3].keyframe = KeyFrameId(77); })},
    {"NewObservationOfNoKeypoint", "observations: row 3 is keypoint 4000000000",
     Points([](auto& p) { p.observations[3].keypoint = 4000000000; })},
    {"NewObservationTwice", "once more", Points([](auto& p) { p.observations.push_back(p.observations[3]); })},
    {"KeypointThatIsTwoPoints", "which is another point already", Points([](auto& p) {
       p.observations.push_back(p.observations.front());
       p.observations.back().point = p.positions.size();
       p.positions.emplace_back(1, 1, 1);
       p.ids.emplace_back(4000);
     })},

    // Observations of points that are there
    {"ObservationOfNoPoint", "points: row 1 is 4000, which the map does not have; AddPoints",
     Seen([](const Map&, auto& s) { s.push_back(s[0]), s[1].point = MapPointId(4000); })},
    {"ObservationOfNoId", "points: row 0", Seen([](const Map&, auto& s) { s[0].point = {}; })},
    {"ObservationByNobody", "keyframes: row 0 is by keyframe 77", Seen([](const Map&, auto& s) { s[0].keyframe = KeyFrameId(77); })},
    {"ObservationOfNoKeypoint", "keypoints: row 0 is keypoint 100000 of keyframe 0, which has",
     Seen([](const Map&, auto& s) { s[0].keypoint = 100000; })},
    {"ObservationTwice", "points: row 1 is point", Seen([](const Map&, auto& s) { s.push_back(s[0]); })},
    {"ObservationOfATakenKeypoint", "keypoints: row 0 is keypoint", Seen([](const Map& map, auto& s) {
       const auto& slots = map.keyframes[0].features.map_points;
       s[0].keypoint = static_cast<std::uint64_t>(std::ranges::find_if(slots, &MapPointId::has_value) - slots.begin());
     })},

    // Links
    {"ParentOfTheRoot", "keyframes: row 0 is keyframe 0, the root",
     [](World& w) { SetParents(w.map, std::array{KeyFrameEdge(0, 1)}); }},
    {"ParentOfItself", "parents: row 0 hangs keyframe 2 on keyframe 2",
     [](World& w) { SetParents(w.map, std::array{KeyFrameEdge(2, 2)}); }},
    {"ParentThatIsNotThere", "parents: row 0 names keyframe 99",
     [](World& w) { SetParents(w.map, std::array{KeyFrameEdge(2, 99)}); }},
    {"ParentsInACircle", "which hangs on itself then",
     [](World& w) { SetParents(w.map, std::array{KeyFrameEdge(2, 3), KeyFrameEdge(3, 4), KeyFrameEdge(4, 2)}); }},
    {"EdgeToItself", "pairs: row 0 leads from a keyframe to itself",
     [](World& w) { AddEdges(w.map, EdgeKind::kLoop, std::array{KeyFrameEdge(2, 2)}); }},
    {"EdgeToNobody", "pairs: row 1 names keyframe 99",
     [](World& w) { AddEdges(w.map, EdgeKind::kMerge, std::array{KeyFrameEdge(2, 5), KeyFrameEdge(2, 99)}); }},
    {"ReferenceOfNoPoint", "points: row 0 is 4000",
     [](World& w) { SetReferences(w.map, std::array{std::pair(MapPointId(4000), KeyFrameId(0))}); }},
    {"ReferenceThatIsNotThere", "keyframes: row 0 names keyframe 99",
     [](World& w) { SetReferences(w.map, std::array{std::pair(w.map.points[0].id, KeyFrameId(99))}); }},
    {"RowThatIsNotThere", "rows: there is no row 100000", [](World& w) { UpdatePoints(w.map, std::array{100000U}); }},
};

class Refused : public ::testing::TestWithParam<Refusal> {};

TEST_P(Refused, ByNameAndChangesNothing) {
  World world;
  const Atlas before = world.atlas;
  const Error error = ErrorOf([&] { GetParam().work(world); });
  EXPECT_EQ(error.kind(), ErrorKind::kUsage) << error.what();
  EXPECT_THAT(error.what(), ::testing::HasSubstr(GetParam().message));
  EXPECT_THAT(world.atlas, EqualsAtlas(before));
}

INSTANTIATE_TEST_SUITE_P(Build, Refused, ::testing::ValuesIn(kRefusals),
                         [](const auto& refusal) { return std::string(refusal.param.name); });

TEST(Build, MapsThatAreNotThereAreNotFound) {
  World world;
  EXPECT_EQ(ErrorOf([&] { AddKeyFrames(world.atlas, MapId(9), {}); }).kind(), ErrorKind::kNotFound);
  EXPECT_EQ(ErrorOf([&] { AddPoints(world.atlas, MapId(9), {}); }).kind(), ErrorKind::kNotFound);
}

TEST(Build, PointIdsNearTheirEndAreTakenAndThenUsedUp) {
  World world;
  world.map.points.clear();
  for (KeyFrame& keyframe : world.map.keyframes) std::ranges::fill(keyframe.features.map_points, MapPointId());
  const auto seen = [](std::uint64_t keypoint) { return std::vector<NewObservation>{{0, KeyFrameId(0), keypoint}}; };
  const std::uint64_t half = std::uint64_t{1} << 63;
  std::uint64_t keypoint = 0;
  for (const std::uint64_t id : {half - 1, half, ~std::uint64_t{0} - 1})
    AddPoints(world.atlas, MapId(0),
              {.positions = {{0, 0, 1}}, .observations = seen(keypoint++), .ids = {MapPointId(id)}});
  EXPECT_EQ(world.map.points.back().id, MapPointId(~std::uint64_t{0} - 1));
  EXPECT_THAT(ErrorOf([&] {
                AddPoints(world.atlas, MapId(0), {.positions = {{0, 0, 1}}, .observations = seen(9)});
              }).what(),
              ::testing::HasSubstr("ids: the next ones are used up"));
}

}  // namespace
}  // namespace slamdb
