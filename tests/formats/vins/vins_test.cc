// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/vins/detail/vins.h"

#include <gmock/gmock.h>

#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/digest.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::Not;

// index, time, position and optimised position, rotation and optimised rotation, loop, what was measured of it,
// number of keypoints.
const std::string kGraph =
    " 0 100.5 9 9 9 1 2 3 1 0 0 0 1 0 0 0 -1 0 0 0 0 0 0 0 0 2\n"
    " 1 101.5 9 9 9 4 5 6 1 0 0 0 0 0 0 1 -1 0 0 0 0 0 0 0 0 0\n"
    " 2 102.5 9 9 9 1 2 4 1 0 0 0 1 0 0 0 0 0.1 0 0 1 0 0 0 5 0\n";

std::string Bits(std::size_t lowest) {
  std::string bits(256, '0');
  bits[255 - lowest] = '1';
  return bits + "\n";
}

class Vins : public ::testing::Test {
 protected:
  Atlas Read(const std::string& graph) {
    std::filesystem::remove(folder_.Path("pose_graph.txt"));
    folder_.Make("pose_graph.txt", graph);
    notices_ = {};
    return detail::kVinsFormat.read(folder_.path().string(), {}, notices_);
  }
  std::string Refusal(const std::string& graph) {
    return RefusalOf([&] { Read(graph); });
  }

  TemporaryFolder folder_;
  Notices notices_;
};

TEST_F(Vins, ReadsPosesLoopsAndKeypoints) {
  folder_.Make("0_keypoints.txt", "10.5 20 0.1 0.2\n30 40 0.3 0.4\n");
  folder_.Make("0_briefdes.dat", Bits(0) + Bits(9));
  const Atlas atlas = Read(kGraph);
  const Map& map = atlas.maps[0];
  ASSERT_EQ(map.keyframes.size(), 3U);
  EXPECT_EQ(map.keyframes[0].timestamp, 100.5);
  EXPECT_EQ(CameraCenter(map.keyframes[0]), Eigen::Vector3f(1, 2, 3));
  EXPECT_TRUE(CameraCenter(map.keyframes[1]).isApprox(Eigen::Vector3f(4, 5, 6)));
  EXPECT_EQ(map.keyframes[1].camera_from_world.rotation.z(), -1);
  EXPECT_EQ(map.keyframes[2].parent, KeyFrameId(1));
  EXPECT_THAT(map.keyframes[0].loop_edges, ElementsAre(KeyFrameId(2)));
  EXPECT_THAT(map.keyframes[2].loop_edges, ElementsAre(KeyFrameId(0)));
  const Features& features = map.keyframes[0].features;
  ASSERT_EQ(features.keypoints.size(), 2U);
  EXPECT_EQ(features.keypoints[0].x, 10.5F);
  EXPECT_EQ(features.descriptors[0][0], 1);
  EXPECT_EQ(features.descriptors[1][1], 2);
}

TEST_F(Vins, SaysWhatIsMissing) {
  Read(kGraph + " 3 103 9 9 9 1 2 4 1 0 0 0 1 0 0 0 77 0 0 0 1 0 0 0 0 0\n");
  EXPECT_THAT(notices_.items(),
              Contains(Field(&Notice::text, HasSubstr("1 keyframe without the file of its keypoints"))));
  EXPECT_THAT(notices_.items(), Contains(Field(&Notice::text, HasSubstr("1 loop left out"))));
}

// In its last number, of two digits, it is a graph, too.
TEST_F(Vins, SaysThatItMayBeCut) {
  const std::string graph = kGraph.substr(0, kGraph.size() - 2) + "12\n";
  const auto warning = Contains(Field(
      &Notice::text, folder_.Path("pose_graph.txt") + ": the last line has no end of line: the file may be cut there"));
  Read(graph);
  EXPECT_THAT(notices_.items(), Not(warning));
  Read(graph.substr(0, graph.size() - 2));
  EXPECT_THAT(notices_.items(), warning);
}

TEST_F(Vins, IsToldByItsGraph) {
  EXPECT_FALSE(detail::kVinsFormat.sniff(Probe::Of(folder_.path().string())));
  folder_.Make("pose_graph.txt", kGraph);
  EXPECT_TRUE(detail::kVinsFormat.sniff(Probe::Of(folder_.path().string())));
}

TEST_F(Vins, IsReadByTheFileOfItsGraph) {
  folder_.Make("pose_graph.txt", kGraph);
  folder_.Make("0_keypoints.txt", "10.5 20 0.1 0.2\n30 40 0.3 0.4\n");
  const Atlas atlas = ReadAtlas(folder_.Path("pose_graph.txt"));
  EXPECT_EQ(atlas.maps[0].keyframes.at(0).features.keypoints.size(), 2U);
  ReadOptions options;
  options.format = "vins";
  EXPECT_EQ(HashOf(ReadAtlas(folder_.Path("pose_graph.txt"), options)), HashOf(atlas));
  // Of another name, or what another program calls so.
  folder_.Make("graph.txt", kGraph);
  EXPECT_FALSE(detail::kVinsFormat.sniff(Probe::Of(folder_.Path("graph.txt"))));
  EXPECT_THROW(detail::kVinsFormat.read(folder_.Path("graph.txt"), {}, notices_), Error);
  std::filesystem::remove(folder_.Path("pose_graph.txt"));
  folder_.Make("pose_graph.txt", "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n");
  EXPECT_FALSE(detail::kVinsFormat.sniff(Probe::Of(folder_.Path("pose_graph.txt"))));
}

TEST_F(Vins, BadLinesAreErrorsWithTheirPlace) {
  EXPECT_THAT(Refusal("0 1 2\n"), HasSubstr("line 1: expected 26 numbers, found in place of number 4"));
  EXPECT_THAT(Refusal("0.5" + kGraph.substr(2)), HasSubstr("line 1: number 1 must be a whole one"));
  std::string no_turn = kGraph;
  no_turn.replace(no_turn.find(" 1 0 0 0 -1"), 8, " 0 0 0 0");
  EXPECT_THAT(Refusal(no_turn), HasSubstr("line 1: the quaternion 0 0 0 0"));
  std::string far = kGraph;
  far.replace(far.find(" 1 2 3"), 6, " 1 2 1e39");
  EXPECT_THAT(Refusal(far), HasSubstr("line 1: the position 1 2 1e+39 is not finite"));
  folder_.Make("0_keypoints.txt", "1 2 3 4\n");
  folder_.Make("0_briefdes.dat", "0101\n");
  EXPECT_THAT(Refusal(kGraph), HasSubstr("expected a descriptor of 256 digits"));
}

TEST_F(Vins, IndicesAreThereOnce) {
  EXPECT_THAT(Refusal(kGraph + kGraph), HasSubstr("line 4: keyframe 0 is there already"));
  EXPECT_THAT(Refusal("-1" + kGraph.substr(2)), HasSubstr("line 1: keyframe -1 has no index"));
}

// As both programs print them: six decimals.
TEST_F(Vins, ReadsWhatItsProgramsPrint) {
  const Atlas atlas = Read(
      " 7 1403636579.763555 0.100000 0.200000 0.300000 -0.500000 0.250000 0.125000 1.000000 0.000000 0.000000 0.000000"
      " 0.500000 -0.500000 0.500000 -0.500000 -1 0.000000 0.000000 0.000000 0.000000 0.000000 0.000000 0.000000"
      " 0.000000 0\n");
  const KeyFrame& keyframe = atlas.maps[0].keyframes.at(0);
  EXPECT_EQ(keyframe.id, KeyFrameId(7));
  EXPECT_EQ(keyframe.timestamp, 1403636579.763555);
  EXPECT_TRUE(CameraCenter(keyframe).isApprox(Eigen::Vector3f(-0.5F, 0.25F, 0.125F), 1e-6F));
  const Quaternionf& rotation = keyframe.camera_from_world.rotation;  // turned back
  EXPECT_EQ(Eigen::Vector4f(rotation.x(), rotation.y(), rotation.z(), rotation.w()),
            Eigen::Vector4f(0.5F, -0.5F, 0.5F, 0.5F));
}

TEST_F(Vins, AnyFlipIsReadOrRefused) {
  for (std::string flipped = kGraph; char& byte : flipped)
    for (const char flip : {'\x01', '\x10', '\x80'}) {
      byte = static_cast<char>(byte ^ flip);
      Refusal(flipped);
      byte = static_cast<char>(byte ^ flip);
    }
}

TEST_F(Vins, AnyCutIsReadOrRefused) {
  for (std::size_t size = 0; size < kGraph.size(); ++size) Refusal(kGraph.substr(0, size));
}

}  // namespace
}  // namespace slamdb
