// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/osmap/detail/osmap.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>
#include <map>

#include "slamdb/base/error.h"
#include "slamdb/formats/export/detail/protobuf.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/formats/osmap/detail/header.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using detail::ProtoAppender;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

constexpr std::string_view kHeader =
    "%YAML:1.0\n---\nmappointsFile: \"m.mappoints\"\nnMappoints: 1\nkeyframesFile: m.keyframes\nnKeyframes: 2\n"
    "featuresFile: /home/them/maps/m.features\nnFeatures: 2\nOptions: 0\ncameraMatrices:\n"
    "   - { fx:5.0e+02, fy:501.,\n       cx:320., cy:2.4e+02 }\n";

std::string HeaderOf(int keyframes, int features) {
  std::string header(kHeader);
  header.replace(header.find("nKeyframes: ") + 12, 1, std::to_string(keyframes));
  header.replace(header.find("nFeatures: ") + 11, 1, std::to_string(features));
  return header;
}

std::string Message(const std::function<void(ProtoAppender&)>& fill) {
  std::string bytes;
  ProtoAppender message(bytes);
  fill(message);
  return bytes;
}

void AppendDescriptor(ProtoAppender& message, int field, char byte) {
  message.Message(field, [&](ProtoAppender& words) { words.Text(1, std::string(32, byte)); });
}

std::string Points() {
  return Message([](ProtoAppender& array) {
    array.Message(1, [](ProtoAppender& point) {
      point.Varint(1, 7);
      point.Message(2, [](ProtoAppender& position) {
        position.Float(1, 1.5F);
        position.Float(3, 4);
      });
      point.Float(3, 9);
      point.Float(4, 5);
      AppendDescriptor(point, 5, '\x11');
    });
  });
}

std::string KeyFrames() {
  return Message([](ProtoAppender& array) {
    for (std::uint64_t id = 3; id <= 4; ++id)
      array.Message(1, [&](ProtoAppender& keyframe) {
        keyframe.Varint(1, id);
        keyframe.Message(2, [&](ProtoAppender& pose) {
          pose.Head(1, 48);
          const std::array<float, 12> identity = {1, 0, 0, static_cast<float>(id), 0, 1, 0, 0, 0, 0, 1, 0};
          pose.Raw(std::as_bytes(std::span(identity)));
        });
        if (id == 4) keyframe.Text(5, "\x03");
        keyframe.Double(6, 0.5 * static_cast<double>(id));
      });
  });
}

std::string FeaturesOf(std::uint64_t keyframe, bool descriptor = true) {
  return Message([&](ProtoAppender& array) {
    array.Message(1, [&](ProtoAppender& features) {
      features.Varint(1, keyframe);
      features.Message(2, [&](ProtoAppender& feature) {
        feature.Varint(2, 7);
        feature.Message(3, [](ProtoAppender& keypoint) {
          keypoint.Float(1, 100.25F);
          keypoint.Float(2, 50);
          keypoint.Float(3, 90);
          keypoint.Float(4, 2);
        });
        if (descriptor) AppendDescriptor(feature, 4, '\x22');
      });
    });
  });
}

class Osmap : public ::testing::Test {
 protected:
  // The files of a map, and what reading it gives.
  Atlas Read(const std::string& features, std::string header = std::string(kHeader)) {
    return Read(Points(), KeyFrames(), features, std::move(header));
  }
  Atlas Read(const std::string& points, const std::string& keyframes, const std::string& features,
             std::string header = std::string(kHeader)) {
    for (const auto& [name, bytes] :
         {std::pair{"m.mappoints", points}, {"m.keyframes", keyframes}, {"m.features", features}, {"m.yaml", header}}) {
      std::filesystem::remove(folder_.Path(name));
      folder_.Make(name, bytes);
    }
    notices_ = {};
    return osmap::Read(folder_.Path("m.yaml"), {}, notices_);
  }
  template <class... Files>
  std::string Refusal(const Files&... files) {
    try {
      Read(files...);
    } catch (const Error& error) {
      return error.path().substr(error.path().find_last_of('/') + 1) + ": " + error.place() + ": " + error.problem();
    }
    return "read";
  }

  TemporaryFolder folder_;
  Notices notices_;
};

TEST_F(Osmap, ReadsWhatItsMessagesSay) {
  const Atlas atlas = Read(FeaturesOf(3) + FeaturesOf(4));
  const Map& map = atlas.maps[0];
  ASSERT_EQ(map.points.size(), 1U);
  const MapPoint& point = map.points[0];
  EXPECT_EQ(point.id, MapPointId(7));
  EXPECT_EQ(point.position, Eigen::Vector3f(1.5F, 0, 4));
  EXPECT_EQ(point.visible_count, 9);
  EXPECT_EQ(point.found_count, 5);
  EXPECT_EQ(point.descriptor[31], 0x11);
  EXPECT_THAT(point.observations, ElementsAre(Observation{KeyFrameId(3), 0, -1}, Observation{KeyFrameId(4), 0, -1}));
  ASSERT_EQ(map.keyframes.size(), 2U);
  const KeyFrame& keyframe = map.keyframes[1];
  EXPECT_EQ(keyframe.timestamp, 2);
  EXPECT_EQ(keyframe.camera_from_world.translation, Eigen::Vector3f(4, 0, 0));
  EXPECT_EQ(keyframe.intrinsics.fx, 500);
  EXPECT_EQ(keyframe.intrinsics.fy, 501);
  EXPECT_EQ(keyframe.intrinsics.cy, 240);
  EXPECT_THAT(keyframe.loop_edges, ElementsAre(KeyFrameId(3)));
  EXPECT_THAT(map.keyframes[0].loop_edges, ElementsAre(KeyFrameId(4)));
  EXPECT_EQ(keyframe.features.undistorted[0], (Keypoint{90, 0, 44, 100.25F, 50, -1, 2}));
  EXPECT_EQ(keyframe.features.descriptors[0][0], 0x22);
  EXPECT_THAT(keyframe.features.map_points, ElementsAre(MapPointId(7)));
  EXPECT_EQ(atlas.cameras.size(), 1U);
  EXPECT_EQ(atlas.next_ids.map_point, 8U);
}

TEST_F(Osmap, ReadsMessagesBehindTheirLengths) {
  std::string features;
  for (const std::uint64_t id : {3, 4}) {
    const std::string message = FeaturesOf(id);
    ProtoAppender::AppendVarint(features, message.size());
    features += message;
  }
  std::string header(kHeader);
  header.replace(header.find("Options: 0"), 10, "Options: 1");
  EXPECT_EQ(Read(features, header).maps[0].points[0].observations.size(), 2U);
}

TEST_F(Osmap, ReadsCamerasOfKeyFramesAndFieldsOfOthers) {
  const std::string keyframes = Message([](ProtoAppender& array) {
    array.Message(1, [](ProtoAppender& keyframe) {
      keyframe.Varint(1, 3);
      keyframe.Message(3, [](ProtoAppender& k) {
        for (int member = 1; member <= 4; ++member) k.Float(member, 10.F * static_cast<float>(member));
      });
      keyframe.Text(77, "what another program adds");
    });
  });
  std::string header = HeaderOf(1, 1);
  header.replace(header.find("Options: 0"), 10, "Options: 256");
  header.resize(header.find("cameraMatrices"));
  EXPECT_EQ(Read(Points(), keyframes, FeaturesOf(3), header).maps[0].keyframes[0].intrinsics.cy, 40);
}

TEST_F(Osmap, ReadsMapsWithoutDescriptorsOfFeatures) {
  const Atlas atlas = Read(FeaturesOf(3, false), HeaderOf(2, 1));
  EXPECT_TRUE(atlas.maps[0].keyframes[0].features.descriptors.empty());
  EXPECT_EQ(atlas.maps[0].points[0].descriptor[0], 0x11);
}

// An atlas has a descriptor for each keypoint of a keyframe, or none.
TEST_F(Osmap, NamesDescriptorsThatOthersOfTheirKeyFrameLack) {
  const std::string features = Message([](ProtoAppender& array) {
    array.Message(1, [](ProtoAppender& keyframe) {
      keyframe.Varint(1, 3);
      for (int i = 0; i < 3; ++i)
        keyframe.Message(2, [i](ProtoAppender& feature) {
          feature.Varint(2, 7);
          if (i > 0) AppendDescriptor(feature, 4, '\x22');
        });
    });
  });
  EXPECT_TRUE(Read(features, HeaderOf(2, 3)).maps[0].keyframes[0].features.descriptors.empty());
  EXPECT_THAT(notices_.items(),
              Contains(Field(&Notice::text, HasSubstr("left out: descriptors of features whose keyframes have other "
                                                      "features without one (2)"))));
  EXPECT_TRUE(notices_.lossy());
}

TEST_F(Osmap, SaysWhichFeaturesHaveNoKeyFrame) {
  Read(FeaturesOf(3) + FeaturesOf(99) + FeaturesOf(4), HeaderOf(2, 3));
  EXPECT_THAT(notices_.items(), Contains(Field(&Notice::text, HasSubstr("keyframes that are not there"))));
  EXPECT_TRUE(notices_.lossy());
}

TEST_F(Osmap, SidesHoldWhatTheHeaderCounts) {
  const std::string features = FeaturesOf(3) + FeaturesOf(4);
  EXPECT_EQ(Refusal(features), "read");
  EXPECT_THAT(Refusal(features + FeaturesOf(5)), HasSubstr("m.features: : holds 3 features, its header says 2"));
  EXPECT_THAT(Refusal(std::string(), KeyFrames(), features), HasSubstr("m.mappoints: : holds 0 map points"));
  EXPECT_THAT(Refusal(Points(), std::string(), features), HasSubstr("m.keyframes: : holds 0 keyframes"));
  EXPECT_THAT(Refusal(Points(), KeyFrames(), std::string()), HasSubstr("m.features: : holds 0 features"));
  // The file of another kind.
  std::string header = HeaderOf(2, 5);
  header.replace(header.find("/home/them/maps/m.features"), 26, "m.keyframes");
  EXPECT_THAT(Refusal(features, header), HasSubstr("m.keyframes: : holds 2 features, its header says 5"));
}

TEST_F(Osmap, HeadersNameAllSides) {
  const std::string features = FeaturesOf(3) + FeaturesOf(4);
  for (const std::string_view name : {"mappointsFile", "keyframesFile", "featuresFile"}) {
    const std::string header(kHeader);
    const std::size_t at = header.find(name), end = header.find('\n', at);
    const std::string expected = "m.yaml: " + std::string(name) + ": names no file";
    EXPECT_THAT(Refusal(features, header.substr(0, at)), HasSubstr(": names no file"));
    EXPECT_THAT(Refusal(features, header.substr(0, at) + header.substr(end + 1)), HasSubstr(expected));
    EXPECT_THAT(Refusal(features, header.substr(0, at + name.size()) + ": \"\"" + header.substr(end)),
                HasSubstr(expected));
  }
  // Of nothing there need be no file.
  std::string header = HeaderOf(2, 0);
  header.replace(header.find("/home/them/maps/m.features"), 26, "\"\"");
  EXPECT_EQ(Refusal(features, header), "read");
  header = HeaderOf(2, 2);
  header.replace(header.find("featuresFile"), header.find("nFeatures") - header.find("featuresFile"), "");
  header.replace(header.find("Options: 0"), 10, "Options: 16");
  EXPECT_EQ(Refusal(features, header), "read");
}

TEST_F(Osmap, EveryCutOfASideIsRefused) {
  const std::string points = Points(), keyframes = KeyFrames(), features = FeaturesOf(3) + FeaturesOf(4);
  for (std::size_t size = 0; size < features.size(); ++size)
    EXPECT_NE(Refusal(points, keyframes, features.substr(0, size)), "read") << size;
  for (std::size_t size = 0; size < keyframes.size(); ++size)
    EXPECT_NE(Refusal(points, keyframes.substr(0, size), features), "read") << size;
  for (std::size_t size = 1; size < points.size(); ++size)
    EXPECT_THAT(Refusal(points.substr(0, size), keyframes, features),
                AllOf(HasSubstr("m.mappoints: byte "), HasSubstr("truncated")));
}

TEST_F(Osmap, AnyFlipIsReadOrRefused) {
  const std::string keyframes = KeyFrames(), features = FeaturesOf(3) + FeaturesOf(4);
  for (std::string flipped = keyframes; char& byte : flipped) {
    byte = static_cast<char>(byte ^ 0x85);
    Refusal(Points(), flipped, features);
    byte = static_cast<char>(byte ^ 0x85);
  }
}

TEST_F(Osmap, ListsOfAnotherLengthAreRefused) {
  const std::string short_descriptor = Message([](ProtoAppender& array) {
    array.Message(
        1, [](ProtoAppender& point) { point.Message(5, [](ProtoAppender& words) { words.Text(1, "12345678"); }); });
  });
  EXPECT_THAT(Refusal(short_descriptor, KeyFrames(), FeaturesOf(3)), HasSubstr("a descriptor of 2 words, expected 8"));
  const std::string pose = Message([](ProtoAppender& array) {
    array.Message(
        1, [](ProtoAppender& keyframe) { keyframe.Message(2, [](ProtoAppender& floats) { floats.Float(1, 1); }); });
  });
  EXPECT_THAT(Refusal(Points(), pose, FeaturesOf(3)), HasSubstr("a pose of 1 numbers, expected 12"));
}

TEST_F(Osmap, CamerasThatAreNotThereAreRefused) {
  std::string header(kHeader);
  header.resize(header.find("cameraMatrices"));
  EXPECT_THAT(Refusal(FeaturesOf(3), header), HasSubstr("camera 0 of the 0 in "));
  EXPECT_THAT(Refusal(FeaturesOf(3), header + "cameraMatrices:\n   - { fx:1., fy:1., cx:2. }\n"),
              HasSubstr("without all of fx, fy, cx and cy"));
  EXPECT_THAT(Refusal(FeaturesOf(3), header + "cameraMatrices:\n   - { fx:many }\n"),
              HasSubstr("line 11: `fx` must be a number"));
}

TEST_F(Osmap, CamerasWithoutFocalLengthsAreRefused) {
  for (const char* length : {"0", "-450", "nan", "inf"}) {
    std::string header(kHeader);
    header.replace(header.find("5.0e+02"), 7, length);
    EXPECT_THAT(Refusal(FeaturesOf(3), header), HasSubstr("m.yaml: line 12: the focal lengths")) << length;
  }
}

TEST_F(Osmap, PosesAndPositionsAreNumbers) {
  const std::string point = Message([](ProtoAppender& array) {
    array.Message(1, [](ProtoAppender& one) {
      one.Message(2, [](ProtoAppender& axes) { axes.Float(1, std::numeric_limits<float>::infinity()); });
    });
  });
  EXPECT_THAT(Refusal(point, KeyFrames(), FeaturesOf(3)), HasSubstr("the position inf 0 0 is not finite"));
  for (const float number : {0.F, 2.F, std::numeric_limits<float>::quiet_NaN()}) {
    const std::string keyframe = Message([&](ProtoAppender& array) {
      array.Message(1, [&](ProtoAppender& one) {
        one.Message(2, [&](ProtoAppender& pose) {
          pose.Head(1, 48);
          const std::array<float, 12> numbers = {number, 0, 0, 0, 0, number, 0, 0, 0, 0, number, 0};
          pose.Raw(std::as_bytes(std::span(numbers)));
        });
      });
    });
    EXPECT_THAT(Refusal(Points(), keyframe, FeaturesOf(3)), HasSubstr("(row by row) is no rotation")) << number;
  }
}

TEST_F(Osmap, SidesThatAreMissingAreNamed) {
  folder_.Make("m.yaml", std::string(kHeader));
  try {
    osmap::Read(folder_.Path("m.yaml"), {}, notices_);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kNotFound);
    EXPECT_THAT(error.path(), HasSubstr("m.mappoints"));
  }
}

// ---- both ways

// That what osmap has of a map is the same to the last bit; rotations, which are matrices there, but for the last ones.
void ExpectSame(const Map& expected, const Map& actual) {
  ASSERT_EQ(actual.keyframes.size(), expected.keyframes.size());
  for (std::size_t row = 0; row < expected.keyframes.size(); ++row) {
    const KeyFrame& a = expected.keyframes[row];
    const KeyFrame& b = actual.keyframes[row];
    ASSERT_EQ(a.id, b.id);
    EXPECT_EQ(a.timestamp, b.timestamp);
    EXPECT_EQ(a.camera_from_world.translation, b.camera_from_world.translation);
    EXPECT_LT(Eigen::Quaternionf(a.camera_from_world.rotation)
                  .angularDistance(Eigen::Quaternionf(b.camera_from_world.rotation)),
              1e-3F);
    EXPECT_EQ(a.intrinsics.fx, b.intrinsics.fx);
    EXPECT_EQ(a.features.descriptors, b.features.descriptors);
    EXPECT_EQ(a.features.map_points, b.features.map_points);
    std::vector<KeyFrameId> loops(a.loop_edges.begin(), a.loop_edges.end());
    std::sort(loops.begin(), loops.end());
    EXPECT_EQ(loops, std::vector<KeyFrameId>(b.loop_edges.begin(), b.loop_edges.end()));
    ASSERT_EQ(a.features.undistorted.size(), b.features.undistorted.size());
    for (std::size_t i = 0; i < a.features.undistorted.size(); ++i) {
      const Keypoint &k = a.features.undistorted[i], &l = b.features.undistorted[i];
      EXPECT_TRUE(k.x == l.x && k.y == l.y && k.angle == l.angle && k.octave == l.octave);
    }
  }
  ASSERT_EQ(actual.points.size(), expected.points.size());
  for (std::size_t row = 0; row < expected.points.size(); ++row) {
    const MapPoint &a = expected.points[row], &b = actual.points[row];
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.descriptor, b.descriptor);
    EXPECT_EQ(a.visible_count, b.visible_count);
    EXPECT_EQ(a.observations, b.observations) << a.id.value();
  }
}

// Real maps have observations that one side alone records; osmap has the keyframes' side.
void TakeKeyFramesSide(Map& map) {
  std::map<MapPointId, MapPoint*> points;
  for (MapPoint& point : map.points) points[point.id] = &point, point.observations.clear();
  for (KeyFrame& keyframe : map.keyframes)
    for (std::size_t row = 0; row < keyframe.features.map_points.size(); ++row) {
      MapPointId& id = keyframe.features.map_points[row];
      if (!id || !points.contains(id)) continue;
      Column<Observation>& observations = points[id]->observations;
      if (!observations.empty() && observations.back().keyframe == keyframe.id)
        id = {};
      else
        observations.push_back({.keyframe = keyframe.id, .left = static_cast<std::int32_t>(row)});
    }
}

void Prepare(Map& map) {
  for (KeyFrame& keyframe : map.keyframes)
    for (MapPointId& id : keyframe.features.map_points)
      if (id) id = MapPointId(id.value() + 1);  // 0 is none
  for (MapPoint& point : map.points) {
    point.id = MapPointId(point.id.value() + 1);
    point.visible_count = 5;
    point.found_count = 3;
  }
  std::ranges::sort(map.keyframes, {}, &KeyFrame::id);
  std::ranges::sort(map.points, {}, &MapPoint::id);
  TakeKeyFramesSide(map);
}

TEST_F(Osmap, GivesBackWhatItHolds) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 15, .points = 300, .features = 150});
  Prepare(atlas.maps[0]);
  for (const int threads : {1, 3}) {
    osmap::Write(atlas, folder_.Path("map.yaml"), {.overwrite = true, .threads = threads}, notices_);
    EXPECT_THAT(folder_.Names(), UnorderedElementsAre("map.yaml", "map.mappoints", "map.keyframes", "map.features"));
    ExpectSame(atlas.maps[0], osmap::Read(folder_.Path("map.yaml"), {}, notices_).maps[0]);
  }
}

TEST_F(Osmap, LeavesOutWhatItWouldNotRead) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 6, .points = 100, .features = 100});
  Map& map = atlas.maps[0];
  map.keyframes[2].camera_from_world.rotation.coeffs().setZero();
  map.keyframes[3].camera_from_world.translation.x() = std::numeric_limits<float>::quiet_NaN();
  map.points[4].position.x() = std::numeric_limits<float>::infinity();
  osmap::Write(atlas, folder_.Path("map.yaml"), {}, notices_);
  for (const char* said : {"keyframes whose pose is none, or not finite (2)", "position is not finite (1)"})
    EXPECT_THAT(notices_.items(), Contains(Field(&Notice::text, HasSubstr(said))));
  const Map back = osmap::Read(folder_.Path("map.yaml"), {}, notices_).maps[0];
  EXPECT_EQ(back.keyframes.size(), map.keyframes.size() - 2);
  EXPECT_EQ(back.points.size(), map.points.size() - 1);
}

TEST_F(Osmap, GivesBackRealMaps) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, "session_small_a");
  Atlas atlas = ReadOrbslam3(path, {}, notices_);
  atlas.maps.resize(1);
  std::erase_if(atlas.maps[0].points, [](const MapPoint& point) { return bool(point.bad); });
  Prepare(atlas.maps[0]);
  osmap::Write(atlas, folder_.Path("map.yaml"), {}, notices_);
  ExpectSame(atlas.maps[0], osmap::Read(folder_.Path("map.yaml"), {}, notices_).maps[0]);
}

TEST_F(Osmap, ReplacesSidesOnlyWhenTold) {
  const Atlas atlas = SynthesizeAtlas({.keyframes = 4, .points = 50, .features = 100});
  folder_.Make("map.features", "mine");
  EXPECT_THROW(osmap::Write(atlas, folder_.Path("map.yaml"), {}, notices_), Error);
  EXPECT_THAT(folder_.Names(), ElementsAre("map.features"));
  EXPECT_EQ(ReadFile(folder_.Path("map.features")), "mine");
  osmap::Write(atlas, folder_.Path("map.yaml"), {.overwrite = true}, notices_);
  EXPECT_NE(ReadFile(folder_.Path("map.features")), "mine");
}

// An older header would be read with the new files, whatever it is called.
TEST_F(Osmap, IsNotWrittenUnderAHeaderOfOthers) {
  const Atlas atlas = SynthesizeAtlas({.keyframes = 4, .points = 50, .features = 100});
  osmap::Write(atlas, folder_.Path("map.yaml"), {}, notices_);
  const std::string header = ReadFile(folder_.Path("map.yaml")), points = ReadFile(folder_.Path("map.mappoints"));
  folder_.Make("settings.yml", "%YAML:1.0\nCamera.fx: 1\n");
  folder_.Make("cut.yml", header.substr(0, header.find("mappoints\"")));
  const Atlas other = SynthesizeAtlas({.keyframes = 5, .points = 60, .features = 100});
  const auto problem = [&](const char* output) {
    try {
      osmap::Write(other, folder_.Path(output), {.overwrite = true}, notices_);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("written");
  };
  for (const char* older : {"map.yml", "copy.yaml", "map"}) {
    folder_.Make(older, header);
    EXPECT_THAT(problem("map.yaml"), HasSubstr(std::string(older) + ": is a header of map.mappoints")) << older;
    EXPECT_EQ(ReadFile(folder_.Path("map.mappoints")), points);
    EXPECT_EQ(problem("other.yaml"), "written");
    std::filesystem::remove(folder_.Path(older));
  }
  std::filesystem::create_symlink("map.yaml", folder_.Path("link.yaml"));
  EXPECT_EQ(problem("map.yaml"), "written") << "a link to the header is the same one";
  EXPECT_NE(ReadFile(folder_.Path("map.mappoints")), points);
}

TEST_F(Osmap, RefusesIdsThatItCannotHold) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 4, .points = 50, .features = 100});
  atlas.maps[0].points[0].id = MapPointId(std::uint64_t{1} << 33U);
  EXPECT_THROW(osmap::Write(atlas, folder_.Path("map.yaml"), {}, notices_), Error);
  EXPECT_TRUE(folder_.Names().empty());
}

TEST_F(Osmap, NamesMapsThatItLeavesOut) {
  const Atlas atlas = SynthesizeAtlas({.maps = 2, .keyframes = 5, .points = 60, .features = 100});
  osmap::Write(atlas, folder_.Path("map.yaml"), {}, notices_);
  EXPECT_THAT(notices_.items(), Contains(Field(&Notice::text, HasSubstr("left out is map "))));
}

TEST(OsmapHeader, NamesAreQuoted) {
  osmap::Header header;
  header.points.file = "a \"b\\.mappoints";
  EXPECT_EQ(osmap::ParseHeader(osmap::HeaderText(header), "x").points.file, header.points.file);
}

}  // namespace
}  // namespace slamdb
