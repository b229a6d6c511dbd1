// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/g2o/detail/g2o.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "slamdb/base/error.h"
#include "slamdb/edit/frame/put_poses.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/g2o/detail/edges.h"
#include "slamdb/formats/g2o/detail/similarity_log.h"
#include "slamdb/formats/g2o/options.h"
#include "slamdb/formats/keyframe_poses.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/model/derive.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/error_of.h"

namespace slamdb {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::Not;

const Format& G2o() { return detail::kG2oFormat; }

Atlas ReadGraph(const std::string& text, Notices& notices) {
  return G2o().read({std::as_bytes(std::span(text)), "graph"}, {}, notices);
}
Atlas ReadGraph(const std::string& text) {
  Notices notices;
  return ReadGraph(text, notices);
}
std::string Refusal(const std::string& text) {
  return RefusalOf([&] { ReadGraph(text); });
}

TEST(G2o, SaysByHowMuchPosesFarOffAreRounded) {
  Notices near, far;
  ReadGraph("VERTEX_SE3:QUAT 0 1000.1 0 0 0 0 0 1\n# TIME 0 1\n", near);
  EXPECT_FALSE(near.lossy());
  ReadGraph("VERTEX_SE3:QUAT 0 4600000.2 0 0 0 0 0 1\n# TIME 0 1\n", far);
  ASSERT_TRUE(far.lossy());
  EXPECT_THAT(far.items().front().text, HasSubstr("rounded to the 32-bit floats of an atlas: 1, by up to 0.2"));
}

TEST(G2o, WritesVerticesTimesAnchorsAndEdges) {
  EXPECT_EQ(Encoded(G2o(), SmallAtlas()),
            "VERTEX_SE3:QUAT 1 0 0 0 0 0 0 1\n"
            "VERTEX_SE3:QUAT 3 1 0 0 0 0 0 1\n"
            "# TIME 1 0.5\n"
            "# TIME 3 1.5\n"
            "FIX 1\n"
            "EDGE_SE3:QUAT 1 3 1 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n"
            "VERTEX_SE3:QUAT 7 0 -3 0 -0.5 -0.5 -0.5 0.5\n"
            "# TIME 7 2\n"
            "FIX 7\n");
}

TEST(G2o, WritesSimilaritiesAsLogarithms) {
  const std::string text = Encoded(G2o(), OneMapAtlas(), WriteOptions{}.With(G2oWriteOptions{.similarities = true}));
  // No turn: the translation is its own logarithm.
  EXPECT_THAT(text, HasSubstr("VERTEX_SIM3:EXPMAP 3 0 0 0 1 0 0 0 "));
  EXPECT_THAT(text, HasSubstr("EDGE_SIM3:EXPMAP 1 3 0 0 0 1 0 0 0 1 0 0 0 0 0 0 1 "));
}

TEST(G2o, LogarithmsAndExponentialsAreInverse) {
  for (const double angle : {0.0, 1e-7, 0.3, 3.0})
    for (const double sigma : {0.0, 1e-7, 0.4, -1.0}) {
      const Similarity3d similarity{
          std::exp(sigma), Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, -2) / 3)), {4, -5, 6}};
      const Similarity3d back = g2o::ExpOf(g2o::LogOf(similarity));
      EXPECT_NEAR(back.scale, similarity.scale, 1e-9);
      EXPECT_LT((back.translation - similarity.translation).norm(), 1e-6) << angle << " " << sigma;
      EXPECT_LT(back.rotation.angularDistance(similarity.rotation), 1e-6);
    }
}

// exp by its series, of the matrix that a similarity's logarithm stands for.
TEST(G2o, ExponentialsAreThoseOfMatrices) {
  g2o::Vector7d logarithm;
  logarithm << 0.3, -0.2, 0.5, 1, 2, 3, 0.25;
  Eigen::Matrix4d generator = Eigen::Matrix4d::Zero();
  generator.topLeftCorner<3, 3>() << 0.25, -0.5, -0.2, 0.5, 0.25, -0.3, 0.2, 0.3, 0.25;
  generator.topRightCorner<3, 1>() << 1, 2, 3;
  Eigen::Matrix4d sum = Eigen::Matrix4d::Identity(), term = sum;
  for (int i = 1; i < 40; ++i) sum += term = term * generator / i;
  const Similarity3d similarity = g2o::ExpOf(logarithm);
  const Eigen::Matrix3d scaled = similarity.scale * similarity.rotation.toRotationMatrix();
  EXPECT_LT((sum.topRightCorner(3, 1) - similarity.translation).norm(), 1e-12);
  EXPECT_LT((sum.topLeftCorner(3, 3) - scaled).norm(), 1e-12);
}

using Vector6d = Eigen::Matrix<double, 6, 1>;

// world from camera, moved in the camera's frame: shift, turn.
Eigen::Isometry3d Moved(const Eigen::Isometry3d& pose, const Vector6d& motion) {
  const Eigen::Vector3d turn = motion.tail<3>();
  Eigen::Isometry3d small = Eigen::Isometry3d::Identity();
  small.translation() = motion.head<3>();
  if (turn.norm() > 0) small.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  return pose * small;
}

Eigen::Isometry3d PoseOf(const KeyFrame& keyframe) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaternionf(keyframe.camera_from_world.rotation).cast<double>().toRotationMatrix();
  pose.translation() = keyframe.camera_from_world.translation.cast<double>();
  return pose.inverse();
}

// Of the points that `other` sees, too: J^T J by differences of projections.
g2o::Matrix6d InformationByDifferences(const Atlas& atlas, const KeyFrame& keyframe, KeyFrameId other) {
  constexpr double kStep = 1e-3;
  g2o::Matrix6d information = g2o::Matrix6d::Zero();
  for (const MapPoint& point : atlas.maps[0].points) {
    const auto own = std::ranges::find(point.observations, keyframe.id, &Observation::keyframe);
    if (own == point.observations.end()) continue;
    if (std::ranges::find(point.observations, other, &Observation::keyframe) == point.observations.end()) continue;
    const auto pixel = [&](const Vector6d& motion) -> Eigen::Vector2d {
      const Eigen::Vector3d x = Moved(PoseOf(keyframe), motion).inverse() * point.position.cast<double>();
      const std::vector<float>& k = atlas.cameras[0].parameters;
      return {k[0] * x.x() / x.z(), k[1] * x.y() / x.z()};
    };
    Eigen::Matrix<double, 2, 6> jacobian;
    for (int i = 0; i < 6; ++i)
      jacobian.col(i) = (pixel(kStep * Vector6d::Unit(i)) - pixel(-kStep * Vector6d::Unit(i))) / (2 * kStep);
    const auto octave = static_cast<std::size_t>(ObservedKeypoint(keyframe, own->left)->octave);
    information += jacobian.transpose() * jacobian / static_cast<double>(keyframe.pyramid.sigma2[octave]);
  }
  return information;
}

TEST(G2o, InformationIsThatOfReprojection) {
  const Atlas atlas = SynthesizeAtlas({.keyframes = 6, .points = 200, .features = 200});
  const KeyFrame &first = atlas.maps[0].keyframes[0], &second = atlas.maps[0].keyframes[1];
  const auto information = g2o::SharedViews(atlas, atlas.maps[0]).InformationOf(0, 1);
  ASSERT_TRUE(information);
  const Eigen::Isometry3d measured = PoseOf(first).inverse() * PoseOf(second);
  constexpr double kStep = 1e-4;
  g2o::Matrix6d by_first;  // how the measured pose moves, in its own frame, with the first camera
  for (int i = 0; i < 6; ++i) {
    const Eigen::Isometry3d moved =
        measured.inverse() * Moved(PoseOf(first), kStep * Vector6d::Unit(i)).inverse() * PoseOf(second);
    const Eigen::AngleAxisd turn(Eigen::Quaterniond(moved.linear()));
    by_first.col(i) << moved.translation() / kStep, turn.angle() * turn.axis() / kStep;
  }
  const g2o::Matrix6d covariance =
      InformationByDifferences(atlas, second, first.id).inverse() +
      by_first * InformationByDifferences(atlas, first, second.id).inverse() * by_first.transpose();
  EXPECT_TRUE((*information * covariance).isApprox(g2o::Matrix6d::Identity(), 0.01)) << *information * covariance;
}

TEST(G2o, EdgesAreThoseOfTheEssentialGraph) {
  Map map;
  map.keyframes.resize(5);
  for (std::uint64_t i = 0; i < 5; ++i) map.keyframes[i].id = KeyFrameId(10 - i);
  map.keyframes[0].parent = KeyFrameId(9);
  map.keyframes[1].connections = {{KeyFrameId(10), 120}, {KeyFrameId(8), 99}, {KeyFrameId(7), 100}};
  map.keyframes[2].loop_edges = {KeyFrameId(6), KeyFrameId(99)};
  map.keyframes[3].merge_edges = {KeyFrameId(6)};
  map.keyframes[4].bad = false;
  std::vector<std::tuple<std::uint64_t, std::uint64_t, int>> edges;
  for (const g2o::Edge& edge : g2o::EssentialGraphOf(map).edges)
    edges.emplace_back(map.keyframes[edge.first].id.value(), map.keyframes[edge.second].id.value(), edge.weight);
  EXPECT_THAT(edges,
              ElementsAre(std::tuple(6, 7, 0), std::tuple(6, 8, 0), std::tuple(7, 9, 100), std::tuple(9, 10, 120)));
}

TEST(G2o, ReadsAPoseGraph) {
  Notices notices;
  const Atlas atlas = ReadGraph(
      "# a comment\nVERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 2 3 0 0 0 2\n"
      "VERTEX_SE3:QUAT 2 4 0 0 0 0 1 0\nVERTEX_TRACKXYZ 5 1 2 3\nFIX 0\n"
      "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n"
      "EDGE_SE3:QUAT 1 2 1 0 0 0 0 0 1\nEDGE_SE3:QUAT 2 0 1 0 0 0 0 0 1\nEDGE_SE3:QUAT 2 77 1 0 0 0 0 0 1\n",
      notices);
  ASSERT_EQ(atlas.maps.size(), 1U);
  const Map& map = atlas.maps[0];
  ASSERT_EQ(map.keyframes.size(), 3U);
  EXPECT_EQ(CameraCenter(map.keyframes[1]), Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(map.keyframes[2].parent, KeyFrameId(1));
  EXPECT_THAT(map.keyframes[0].loop_edges, ElementsAre(KeyFrameId(2)));
  EXPECT_EQ(map.initial_keyframe, KeyFrameId(0));
  EXPECT_THAT(notices.items(), Contains(Field(&Notice::text, HasSubstr("1 lines VERTEX_TRACKXYZ"))));
  EXPECT_THAT(notices.items(), Contains(Field(&Notice::text, HasSubstr("1 edge left out"))));
  EXPECT_THAT(notices.items(), Contains(Field(&Notice::text, HasSubstr("g2o has no times"))));
}

TEST(G2o, ReadsTimesAndSeveralMaps) {
  const Atlas atlas = ReadGraph(Encoded(G2o(), SmallAtlas()));
  ASSERT_EQ(atlas.maps.size(), 2U);
  EXPECT_EQ(atlas.maps[1].keyframes[0].id, KeyFrameId(7));
  EXPECT_EQ(atlas.maps[1].keyframes[0].timestamp, 2);
}

TEST(G2o, BadLinesAreErrorsWithTheirPlace) {
  EXPECT_THAT(Refusal("VERTEX_SE3:QUAT 0 0 0 0 0 0 0\n"), HasSubstr("line 1: expected a number"));
  EXPECT_THAT(Refusal("\nVERTEX_SE3:QUAT a 0 0 0 0 0 0 1\n"), HasSubstr("line 2: expected the id of a vertex"));
  EXPECT_THAT(Refusal("VERTEX_SE3:QUAT -1 0 0 0 0 0 0 1\n"), HasSubstr("expected the id of a vertex"));
  EXPECT_THAT(Refusal("VERTEX_SE3:QUAT 1 0 0 0 0 0 0 0\n"), HasSubstr("line 1: the quaternion 0 0 0 0"));
  EXPECT_THAT(Refusal("VERTEX_SE3:QUAT 1 0 nan 0 0 0 0 1\n"), HasSubstr("line 1: the position 0 nan 0 is not finite"));
  EXPECT_THAT(Refusal("VERTEX_SE3:QUAT 1 0 0 1e39 0 0 0 1\n"), HasSubstr("line 1: the position 0 0 1e+39"));
  EXPECT_THAT(Refusal("VERTEX_SE3:QUAT 1 0 0 0 0 nan 0 inf\n"), HasSubstr("line 1: the quaternion 0 nan 0 inf"));
  EXPECT_THAT(Refusal("VERTEX_SIM3:EXPMAP 1 0 0 0 0 0 0 1e9\n"), HasSubstr("line 1: the scale inf"));
  EXPECT_THAT(Refusal("VERTEX_SIM3:EXPMAP 1 0 0 0 0 0 0 -1e9\n"), HasSubstr("line 1: the scale 0 is not above 0"));
  EXPECT_THAT(Refusal("VERTEX_SIM3:EXPMAP 1 0 0 0 inf 0 0 0\n"), HasSubstr("line 1: the position"));
  EXPECT_THAT(Refusal("FIX\nEDGE_SE3:QUAT 1\n"), HasSubstr("line 2"));
  EXPECT_THAT(Refusal("VERTEX_SE2 0 0 0 0\n"), HasSubstr("has no vertices of the kinds"));
}

TEST(G2o, VerticesThatAreThereTwiceAreRefused) {
  const std::string vertex = "VERTEX_SE3:QUAT 4 0 0 0 0 0 0 1\n";
  EXPECT_EQ(Refusal(vertex + vertex), "line 2: vertex 4 is in line 1 already");
  EXPECT_THAT(Refusal(vertex + "#\nVERTEX_SIM3:EXPMAP 4 0 0 0 1 2 3 0 1 1 1 1\n"),
              HasSubstr("line 3: vertex 4 is in line 1 already"));
}

TEST(G2o, AnyCutOrFlipIsReadOrRefused) {
  const std::string graph = Encoded(G2o(), SmallAtlas()) + "VERTEX_SIM3:EXPMAP 8 0.1 0.2 0.3 1 2 3 0.5 1 1 1 1\n";
  for (std::size_t at = 0; at < graph.size(); ++at) {
    Refusal(graph.substr(0, at));
    std::string flipped = graph;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x11);
    Refusal(flipped);
  }
}

TEST(G2o, ReadsIdsUpToTheLast) {
  const Atlas atlas = ReadGraph(
      "VERTEX_SE3:QUAT 18446744073709551614 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 0 1 0 0 0 0 0 1\n"
      "EDGE_SE3:QUAT 18446744073709551614 0 1 0 0 0 0 0 1\n");
  EXPECT_EQ(atlas.maps[0].keyframes[1].id.value(), 18446744073709551614U);
  EXPECT_EQ(atlas.maps[0].keyframes[1].parent, KeyFrameId(0));
  EXPECT_THAT(Refusal("VERTEX_SE3:QUAT 18446744073709551615 0 0 0 0 0 0 1\n"), HasSubstr("the id of a vertex"));
}

TEST(G2o, IdsOfSeveralMapsAreUnique) {
  Atlas atlas = SmallAtlas();
  atlas.maps[1].keyframes[0].id = KeyFrameId(3);
  atlas.maps[1].initial_keyframe = KeyFrameId(3);
  Notices notices;
  const std::string text = Encoded(G2o(), atlas, {}, notices);
  EXPECT_THAT(text, HasSubstr("FIX 7\n"));
  EXPECT_THAT(notices.items(), Contains(Field(&Notice::text, HasSubstr("written with 4 added"))));
  atlas.maps[0].keyframes[0].id = KeyFrameId(std::uint64_t{1} << 40U);
  EXPECT_THROW(Encoded(G2o(), atlas), Error);
}

TEST(G2o, BadKeyFramesAreNoVertices) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].keyframes[0].bad = true;
  EXPECT_THAT(Encoded(G2o(), atlas), Not(HasSubstr("VERTEX_SE3:QUAT 3")));
}

// Each for its own reason.
TEST(G2o, NamesKeyFramesThatAreNoVertices) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 12, .points = 300, .features = 150});
  Column<KeyFrame>& keyframes = atlas.maps[0].keyframes;
  keyframes[2].bad = true;
  keyframes[3].camera_from_world.rotation.coeffs().setZero();
  keyframes[4].camera_from_world.translation.x() = std::nanf("");
  keyframes[5].id = KeyFrameId();
  keyframes[7].id = keyframes[6].id;
  Notices notices;
  Encoded(G2o(), atlas, {}, notices);
  EXPECT_THAT(notices.written(), ::testing::StartsWith("7 keyframes, 1 bad one left out, "));
  EXPECT_EQ(notices.counts()->keyframes, 7U);
  for (const char* said :
       {"left out because the pose is none, or not finite: 2 keyframes", "left out because they have no id: 1 keyframe",
        "left out because another keyframe has their id: 1 keyframe", "to keyframes that are not written with these: "})
    EXPECT_THAT(notices.items(), Contains(Field(&Notice::text, HasSubstr(said))));
}

// ---- onto an atlas

std::vector<KeyFramePose> PosesOf(const std::string& text) {
  return ReadKeyFramePoses(HeldSource(Source(std::as_bytes(std::span(text)), "graph")));
}

void ExpectSameBytesWithItsOwnPoses(const Atlas& atlas) {
  const std::string bytes = EncodeOrbslam3(atlas);
  for (const bool similarities : {false, true}) {
    Atlas put = atlas;
    const std::string graph = Encoded(G2o(), atlas, WriteOptions{}.With(G2oWriteOptions{.similarities = similarities}));
    const PutPosesReport report = PutPoses(put, PosesOf(graph));
    EXPECT_EQ(report.unknown_poses, 0U);
    EXPECT_GT(report.keyframes, 0U);
    EXPECT_TRUE(EncodeOrbslam3(put) == bytes) << "similarities: " << similarities;
  }
}

TEST(G2o, PosesThatNobodyMovedGiveTheSameBytes) {
  for (const Sensor sensor : {Sensor::kMonocular, Sensor::kFisheyeStereo})
    ExpectSameBytesWithItsOwnPoses(SynthesizeAtlas(
        {.sensor = sensor, .inertial = true, .maps = 2, .keyframes = 20, .points = 300, .features = 150}));
}

TEST(G2o, PosesOfRealMapsThatNobodyMovedGiveTheSameBytes) {
  for (const std::string name : {"mono_small", "session_small_a", "stereo_inertial", "multimap_rgbd"}) {
    const std::string path = RealAtlas(name);
    Notices notices;
    if (!path.empty()) ExpectSameBytesWithItsOwnPoses(ReadOrbslam3(path, {}, notices));
  }
}

TEST(G2o, ScalesComeBackFromSimilarities) {
  const std::vector<KeyFramePose> poses = PosesOf("VERTEX_SIM3:EXPMAP 4 0 0 0 0 0 0 0.5 1 1 1 1\n");
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_EQ(poses[0].keyframe, KeyFrameId(4));
  EXPECT_DOUBLE_EQ(poses[0].world_from_camera.scale, std::exp(0.5));
}

}  // namespace
}  // namespace slamdb
