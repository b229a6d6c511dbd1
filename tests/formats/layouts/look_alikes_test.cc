// SPDX-License-Identifier: BSD-3-Clause
// Members of forks that are nearly what another one is: poses that were predicted, positions from before a loop was
// closed.
#include <gmock/gmock.h>

#include <array>
#include <span>

#include "slamdb/formats/orbslam3/detail/salvage.h"
#include "slamdb/formats/orbslam3/infer_layout.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "tests/formats/layouts/invented_layouts.h"
#include "tests/formats/orbslam3/real_atlases.h"

namespace slamdb::testing {
namespace {

using ::testing::Combine;
using ::testing::Values;

constexpr float kMetres = 0.01F, kRadians = 0.0087F;  // that a predicted pose may be off, in each of its numbers

class Noise {
 public:
  Eigen::Vector3f Vector(float most) {
    std::uniform_real_distribution<float> part(-most, most);
    return {part(random_), part(random_), part(random_)};
  }
  Rigid3f Pose(const Rigid3f& of, float part) {
    if (part == 0) return of;
    const Eigen::Vector3f axis = Vector(kRadians * part);
    const Eigen::Quaternionf turn(Eigen::AngleAxisf(axis.norm(), axis.normalized()));
    return {(turn * of.rotation).normalized(), of.translation + Vector(kMetres * part)};
  }

 private:
  std::mt19937_64 random_{7};
};

template <class Number, std::size_t kCount>
void Carry(const std::array<Number, kCount>& numbers, Boxed<Carried>& carried) {
  const Bytes bytes = std::as_bytes(std::span(numbers));
  Column<std::byte>& members = carried.Make().members;
  members.insert(members.end(), bytes.begin(), bytes.end());
}
void CarryPose(const Rigid3f& pose, KeyFrame& keyframe) {
  const Eigen::Quaternionf& q = pose.rotation;
  const Eigen::Vector3f& t = pose.translation;
  Carry(std::array{q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()}, keyframe.carried);
}

// A fork with `copies` more poses in its keyframes, each off by so many of kMetres and kRadians.
std::string WithPoses(const char* changes, float part, int copies = 1) {
  Atlas atlas = RealSession();
  atlas.layout = ToJson(Changed(changes));
  Noise noise;
  for (KeyFrame& keyframe : atlas.maps[0].keyframes)
    for (int copy = 0; copy < copies; ++copy) CarryPose(noise.Pose(keyframe.camera_from_world, part), keyframe);
  return EncodeOrbslam3(atlas);
}
// A fork with another position in its points.
std::string WithPositions(const char* changes, float metres) {
  Atlas atlas = RealSession();
  atlas.layout = ToJson(Changed(changes));
  Noise noise;
  for (MapPoint& point : atlas.maps[0].points) {
    const Eigen::Vector3f stale = point.position + noise.Vector(metres);
    Carry(std::array{stale.x(), stale.y(), stale.z()}, point.carried);
  }
  return EncodeOrbslam3(atlas);
}

bool IsReadRight(const std::string& bytes, const InferredLayout& inferred) {
  return SameCore(ReadAs(bytes, ToJson(inferred.layout)), RealSession());
}
void ExpectReadRight(const std::string& bytes) {
  const InferredLayout inferred = InferLayout(In(bytes));
  EXPECT_TRUE(inferred.same_bytes);
  EXPECT_TRUE(inferred.sure()) << ::testing::PrintToString(inferred.alternatives);
  EXPECT_TRUE(IsReadRight(bytes, inferred)) << ::testing::PrintToString(inferred.differences);
}
// What nothing tells apart is said to be so.
void ExpectReadRightOrSaid(const std::string& bytes) {
  const InferredLayout inferred = InferLayout(In(bytes));
  EXPECT_TRUE(inferred.same_bytes);
  EXPECT_TRUE(!inferred.sure() || IsReadRight(bytes, inferred)) << ::testing::PrintToString(inferred.differences);
}

constexpr const char* kInFront = "+KeyFrame.mK_ x1:arr<f32,7>";
constexpr const char* kBehind = "+KeyFrame.mTcw x1:arr<f32,7>";
constexpr const char* kFarInFront = "+KeyFrame.mTimeStamp x1:arr<f32,7>";
constexpr const char* kInItsPlace = "-KeyFrame.mTcw\n+KeyFrame.mK_ x1:arr<f32,7>\n+KeyFrame.mTimeStamp mTcw:arr<f32,7>";

class PredictedPose : public ::testing::TestWithParam<std::tuple<const char*, float>> {};
TEST_P(PredictedPose, IsNotTakenForThePose) {
  ExpectReadRight(WithPoses(std::get<0>(GetParam()), std::get<1>(GetParam())));
}
INSTANTIATE_TEST_SUITE_P(InferLayout, PredictedPose,
                         Combine(Values(kInFront, kBehind, kFarInFront, kInItsPlace), Values(0.2F, 0.5F, 1.0F)));

class NearlyThePose : public ::testing::TestWithParam<const char*> {};
TEST_P(NearlyThePose, IsSaid) { ExpectReadRightOrSaid(WithPoses(GetParam(), 0.01F)); }
INSTANTIATE_TEST_SUITE_P(InferLayout, NearlyThePose, Values(kInFront, kBehind, kFarInFront, kInItsPlace));

TEST(InferLayout, ACopyOfThePoseIsNoDoubt) { ExpectReadRight(WithPoses(kInFront, 0)); }

TEST(InferLayout, FindsThePoseBehindTwoOthers) {
  ExpectReadRight(WithPoses("+KeyFrame.mK_ x2:arr<f32,7>\n+KeyFrame.mK_ x1:arr<f32,7>", 0.5F, 2));
}
TEST(InferLayout, FindsThePoseBetweenTwoOthers) {
  ExpectReadRight(WithPoses("+KeyFrame.mK_ x1:arr<f32,7>\n+KeyFrame.mTcw x2:arr<f32,7>", 0.5F, 2));
}

// The pose as world_from_camera, as it is or off by a centimetre, in front of the pose or behind it.
class WorldFromCamera : public ::testing::TestWithParam<std::tuple<const char*, const char*, float>> {};
TEST_P(WorldFromCamera, IsNotTakenForThePose) {
  const auto& [session, changes, part] = GetParam();
  SLAMDB_REQUIRE_REAL_ATLAS(path, session);
  Notices notices;
  const Atlas truth = ReadOrbslam3(path, {}, notices);
  Atlas atlas = truth;
  atlas.layout = ToJson(Changed(changes));
  Noise noise;
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes)
      CarryPose(noise.Pose(keyframe.camera_from_world.Normalized().Inverse(), part), keyframe);
  const std::string bytes = EncodeOrbslam3(atlas);
  const InferredLayout inferred = InferLayout(In(bytes));
  EXPECT_TRUE(inferred.same_bytes);
  EXPECT_TRUE(inferred.sure()) << ::testing::PrintToString(inferred.alternatives);
  EXPECT_EQ(OwnBytes(ReadAs(bytes, ToJson(inferred.layout))), OwnBytes(truth))
      << ::testing::PrintToString(inferred.differences);
}
INSTANTIATE_TEST_SUITE_P(InferLayout, WorldFromCamera,
                         Combine(Values("session_small_a", "fisheye_stereo"), Values(kInFront, kBehind),
                                 Values(0.0F, 1.0F)));

// A second time that is off by so many seconds and up to so many more: when a keyframe was received.
struct SecondTime {
  const char* changes;
  double least, more;
};
void PrintTo(const SecondTime& of, std::ostream* out) { *out << of.changes << " by " << of.least << " to " << of.more; }
class TimeOfReceipt : public ::testing::TestWithParam<SecondTime> {};
TEST_P(TimeOfReceipt, IsNotTakenForTheTimeWithoutADoubt) {
  Atlas atlas = RealSession();
  atlas.layout = ToJson(Changed(GetParam().changes));
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> more(0, GetParam().more);
  for (KeyFrame& keyframe : atlas.maps[0].keyframes)
    Carry(std::array{keyframe.timestamp + GetParam().least + more(random)}, keyframe.carried);
  ExpectReadRightOrSaid(EncodeOrbslam3(atlas));
}
constexpr const char* kTimeInFront = "+KeyFrame.mnFrameId x1:f64";
constexpr const char* kTimeBehind = "+KeyFrame.mTimeStamp x1:f64";
INSTANTIATE_TEST_SUITE_P(InferLayout, TimeOfReceipt,
                         Values(SecondTime{kTimeInFront, 0.02, 0.004}, SecondTime{kTimeBehind, 0.02, 0.004},
                                SecondTime{kTimeInFront, 0, 0.1}, SecondTime{kTimeBehind, 0, 0.1},
                                SecondTime{kTimeInFront, 1, 0}, SecondTime{kTimeBehind, 1, 0}));

class StalePosition : public ::testing::TestWithParam<std::tuple<const char*, float>> {};
TEST_P(StalePosition, IsNotTakenForThePosition) {
  ExpectReadRight(WithPositions(std::get<0>(GetParam()), std::get<1>(GetParam())));
}
INSTANTIATE_TEST_SUITE_P(
    InferLayout, StalePosition,
    Combine(Values("+MapPoint.nObs x1:arr<f32,3>", "+MapPoint.mWorldPos x1:arr<f32,3>",
                   "-MapPoint.mWorldPos\n+MapPoint.nObs x1:arr<f32,3>\n+MapPoint.mNormalVector mWorldPos:arr<f32,3>"),
            Values(0.005F, 0.05F)));

TEST(InferLayout, SaysThatEitherMayBeThePosition) {
  ExpectReadRightOrSaid(WithPositions("+MapPoint.nObs x1:arr<f32,3>", 0.0005F));
}

// A file that is cut is read record by record.
class PredictedPoseOfACutFile : public ::testing::TestWithParam<const char*> {};
TEST_P(PredictedPoseOfACutFile, IsNotTakenForThePose) {
  std::string bytes = WithPoses(GetParam(), 0.5F);
  bytes.resize(bytes.size() * 99 / 100);
  const Salvage salvage = detail::SalvageOrbslam3(In(bytes), {});
  ASSERT_EQ(salvage.atlas.maps.size(), 1U);
  const Column<KeyFrame>&read = salvage.atlas.maps[0].keyframes, &written = RealSession().maps[0].keyframes;
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i)
    EXPECT_EQ(read[i].camera_from_world.translation, written[i].camera_from_world.translation);
}
INSTANTIATE_TEST_SUITE_P(InferLayout, PredictedPoseOfACutFile, Values(kInFront, kBehind, kFarInFront, kInItsPlace));

}  // namespace
}  // namespace slamdb::testing
