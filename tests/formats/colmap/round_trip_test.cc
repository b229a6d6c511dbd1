// SPDX-License-Identifier: BSD-3-Clause
// What a model holds of an atlas comes back to the last bit.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/colmap/detail/colmap.h"
#include "slamdb/formats/colmap/options.h"
#include "slamdb/model/index.h"
#include "slamdb/pictures/camera_settings.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/formats/small_atlas.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;

struct Way {
  const Format& format;
  bool database = false;
};

Atlas Through(const Atlas& atlas, const Way& way) {
  const TemporaryFolder folder;
  Notices notices;
  const WriteOptions options = WriteOptions{.sync = false}.With(ColmapWriteOptions{.with_database = way.database});
  way.format.write(atlas, folder.Path("model"), options, notices);
  return way.format.read(folder.Path("model"), {}, notices);
}

void SetDistortion(Atlas& atlas, const std::vector<float>& distortion) {
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes) {
      keyframe.distortion.rows = static_cast<std::int32_t>(distortion.size());
      keyframe.distortion.data.resize(4 * distortion.size());
      std::memcpy(keyframe.distortion.data.data(), distortion.data(), keyframe.distortion.data.size());
    }
}

std::vector<std::pair<float, float>> PlacesOf(const Column<Keypoint>& keypoints) {
  std::vector<std::pair<float, float>> places;
  for (const Keypoint& keypoint : keypoints) places.emplace_back(keypoint.x, keypoint.y);
  return places;
}

void ExpectSamePose(const Rigid3f& a, const Rigid3f& b) {
  EXPECT_EQ(a.rotation.coeffs(), b.rotation.coeffs());
  EXPECT_EQ(a.translation, b.translation);
}

void ExpectSameKeyFrame(const KeyFrame& back, const KeyFrame& keyframe, bool database) {
  EXPECT_EQ(back.id, keyframe.id);
  EXPECT_EQ(back.timestamp, keyframe.timestamp);
  EXPECT_EQ(back.camera, keyframe.camera);
  EXPECT_EQ(back.right_camera, keyframe.right_camera);
  EXPECT_EQ(back.distortion.data, keyframe.distortion.data);
  EXPECT_EQ(back.bounds, keyframe.bounds);
  ExpectSamePose(back.camera_from_world, keyframe.camera_from_world);
  ExpectSamePose(back.left_from_right, keyframe.left_from_right);
  const Features &a = back.features, &b = keyframe.features;
  EXPECT_EQ(a.count, b.count);
  EXPECT_EQ(a.left_count, b.left_count);
  EXPECT_EQ(PlacesOf(a.keypoints), PlacesOf(b.keypoints));
  if (b.is_fisheye_stereo()) {
    EXPECT_EQ(PlacesOf(a.right_keypoints), PlacesOf(b.right_keypoints));
  }
  if (!database) return;
  EXPECT_EQ(a.descriptors, b.descriptors);
  for (std::size_t row = 0; row < std::min(a.keypoints.size(), b.keypoints.size()); ++row) {
    EXPECT_EQ(a.keypoints[row].octave, b.keypoints[row].octave);
    EXPECT_NEAR(a.keypoints[row].angle, b.keypoints[row].angle, 1e-4);
  }
}

// That more than one image sees: of others a model has no track, and an atlas of it not the point.
Column<MapPoint> PointsOf(const Map& map) {
  Column<MapPoint> points;
  for (const MapPoint& point : map.points) {
    std::size_t images = 0;
    for (const Observation& observation : point.observations)
      images += (observation.left >= 0 ? 1U : 0U) + (observation.right >= 0 ? 1U : 0U);
    if (images > 1) points.push_back(point);
  }
  return points;
}

void ExpectSamePoint(const MapPoint& back, const MapPoint& point) {
  EXPECT_EQ(back.id, point.id);
  EXPECT_EQ(back.position, point.position);
  EXPECT_EQ(back.observations, point.observations) << point.id.value();
}

void ExpectSame(const Atlas& back, const Atlas& atlas, bool database) {
  ASSERT_EQ(back.maps.size(), atlas.maps.size());
  ASSERT_EQ(back.cameras.size(), atlas.cameras.size());
  for (std::size_t row = 0; row < atlas.cameras.size(); ++row) {
    EXPECT_EQ(back.cameras[row].id, atlas.cameras[row].id);
    EXPECT_EQ(back.cameras[row].model, atlas.cameras[row].model);
    EXPECT_EQ(back.cameras[row].parameters, atlas.cameras[row].parameters);
  }
  for (std::size_t row = 0; row < atlas.maps.size(); ++row) {
    const Map &a = back.maps[row], &b = atlas.maps[row];
    ASSERT_EQ(a.keyframes.size(), b.keyframes.size());
    const Column<MapPoint> points = PointsOf(b);
    ASSERT_EQ(a.points.size(), points.size());
    for (std::size_t at = 0; at < b.keyframes.size(); ++at)
      ExpectSameKeyFrame(a.keyframes[at], b.keyframes[at], database);
    for (std::size_t at = 0; at < points.size(); ++at) ExpectSamePoint(a.points[at], points[at]);
  }
}

std::vector<Way> Ways() {
  return {{detail::kColmapFormat}, {detail::kColmapTextFormat}, {detail::kColmapFormat, true}};
}

TEST(ColmapRoundTrip, OfEverySensor) {
  for (const Sensor sensor : {Sensor::kMonocular, Sensor::kStereo, Sensor::kRgbd, Sensor::kFisheyeStereo}) {
    const Atlas atlas = SynthesizeAtlas({.sensor = sensor, .maps = 2, .keyframes = 6, .points = 200, .features = 300});
    for (const Way& way : Ways()) ExpectSame(Through(atlas, way), atlas, way.database);
  }
}

TEST(ColmapRoundTrip, OfLensesThatDistort) {
  for (const std::vector<float>& distortion :
       {std::vector<float>{-0.25F, 0.0625F, 0.001F, -0.002F}, std::vector<float>{-0.25F, 0.0625F, 0, 0, 0.01F}}) {
    Atlas atlas = SynthesizeAtlas({.keyframes = 4, .points = 200, .features = 300});
    SetDistortion(atlas, distortion);
    CameraSettings settings{.camera = atlas.cameras[0], .distortion = DistortionOf(atlas.maps[0].keyframes[0])};
    for (KeyFrame& keyframe : atlas.maps[0].keyframes) {
      const ImageBounds bounds = UndistortedBounds(settings, 640, 480);
      keyframe.bounds.min_x = bounds.min_x, keyframe.bounds.max_x = bounds.max_x;
      keyframe.bounds.min_y = bounds.min_y, keyframe.bounds.max_y = bounds.max_y;
      keyframe.bounds.inverse_cell_width = 64 / static_cast<float>(bounds.max_x - bounds.min_x);
      keyframe.bounds.inverse_cell_height = 48 / static_cast<float>(bounds.max_y - bounds.min_y);
    }
    for (const Way& way : Ways()) {
      const Atlas back = Through(atlas, way);
      ExpectSame(back, atlas, way.database);
      const Features& features = back.maps[0].keyframes[0].features;
      const Eigen::Vector2d at = Undistorted(settings, {features.keypoints[0].x, features.keypoints[0].y});
      EXPECT_EQ(features.undistorted[0].x, static_cast<float>(at.x()));
    }
  }
}

// Ids that do not fit, or are there twice, are renumbered; nothing is lost by it.
TEST(ColmapRoundTrip, OfStrangeIds) {
  Atlas atlas = SmallAtlas();
  atlas.maps[1].keyframes[0].id = KeyFrameId(1);
  atlas.maps[0].keyframes[0].id = KeyFrameId(std::uint64_t{1} << 40);
  const Atlas back = Through(atlas, {detail::kColmapFormat});
  EXPECT_EQ(back.maps[0].keyframes[0].id, KeyFrameId(0));
  EXPECT_EQ(back.maps[0].keyframes[1].id, KeyFrameId(1));
  EXPECT_EQ(back.maps[1].keyframes[0].id, KeyFrameId(2));
}

// A lens, a size and a rig of its own for each keyframe: cameras of COLMAP are what was distinct.
TEST(ColmapRoundTrip, OfSeveralCameras) {
  Atlas atlas = SynthesizeAtlas({.sensor = Sensor::kFisheyeStereo, .keyframes = 4, .points = 100, .features = 400});
  const Atlas pinholes = SynthesizeAtlas({.sensor = Sensor::kRgbd, .keyframes = 4, .points = 100, .features = 400});
  for (slamdb::Camera camera : pinholes.cameras) {
    camera.id = CameraId(camera.id.value() + 5);
    atlas.cameras.push_back(camera);
  }
  Map& map = atlas.maps.emplace_back(pinholes.maps[0]);
  map.id = MapId(1);
  for (KeyFrame& keyframe : map.keyframes) {
    keyframe.id = KeyFrameId(keyframe.id.value() + 100);
    keyframe.camera = CameraId(keyframe.camera.value() + 5);
  }
  for (MapPoint& point : map.points) {
    point.id = MapPointId(point.id.value() + 1000);
    for (Observation& observation : point.observations)
      observation.keyframe = KeyFrameId(observation.keyframe.value() + 100);
  }
  for (KeyFrame& keyframe : map.keyframes)
    for (MapPointId& id : keyframe.features.map_points)
      if (id) id = MapPointId(id.value() + 1000);
  for (const Way& way : Ways()) ExpectSame(Through(atlas, way), atlas, way.database);
}

// ---- over what is there

std::string ProblemOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.problem();
  }
  return "";
}

// Files of an earlier run that have other names stay; none of them may take the place of what is written.
TEST(ColmapFolders, RefuseModelsThatWouldBeReadInstead) {
  const TemporaryFolder folder;
  Notices notices;
  const Atlas atlas = SynthesizeAtlas({.maps = 2, .keyframes = 3, .points = 60, .features = 100});
  const auto write = [&](const Format& format, const Atlas& written) {
    return ProblemOf([&] { format.write(written, folder.Path("model"), {.overwrite = true, .sync = false}, notices); });
  };
  EXPECT_EQ(write(detail::kColmapFormat, OneMapAtlas()), "");
  EXPECT_EQ(write(detail::kColmapFormat, OneMapAtlas()), "");
  EXPECT_THAT(write(detail::kColmapTextFormat, OneMapAtlas()), HasSubstr("would be read with what is written"));
  EXPECT_FALSE(std::filesystem::exists(folder.Path("model/cameras.txt")));
  EXPECT_THAT(write(detail::kColmapFormat, atlas), HasSubstr("would be read with what is written"));
  EXPECT_EQ(detail::kColmapFormat.read(folder.Path("model"), {}, notices).maps[0].keyframes.size(), 2U);

  std::filesystem::remove_all(folder.Path("model"));
  const Atlas three = SynthesizeAtlas({.maps = 3, .keyframes = 3, .points = 60, .features = 100});
  EXPECT_EQ(write(detail::kColmapFormat, three), "");
  EXPECT_THAT(write(detail::kColmapFormat, atlas), HasSubstr("model/2"));
  EXPECT_EQ(write(detail::kColmapFormat, three), "");
  EXPECT_THAT(write(detail::kColmapFormat, OneMapAtlas()), HasSubstr("model/0 that would be read"));
  EXPECT_FALSE(std::filesystem::exists(folder.Path("model/cameras.bin")));

  std::filesystem::create_directory(folder.Path("work"));
  std::filesystem::rename(folder.Path("model"), folder.Path("work/sparse"));
  std::filesystem::rename(folder.Path("work"), folder.Path("model"));
  for (const Atlas& written : {atlas, OneMapAtlas()})
    EXPECT_THAT(write(detail::kColmapFormat, written), HasSubstr("model/sparse/0 that would be read"));
}

// Of each kind there is one loss, with its count.
TEST(ColmapRoundTrip, NamesWhatIsLeftOut) {
  Atlas atlas = OneMapAtlas();
  Map& map = atlas.maps[0];
  map.points[2].position.x() = std::numeric_limits<float>::quiet_NaN();
  map.points[0].observations[0].left = 99;
  const TemporaryFolder folder;
  Notices notices;
  detail::kColmapFormat.write(atlas, folder.Path("model"), {.sync = false}, notices);
  std::string said;
  for (const Notice& notice : notices.items()) said += notice.text + "\n";
  EXPECT_EQ(said,
            "left out: 1 point flagged bad\n"
            "left out: 1 point not finite, or with the id of another one\n"
            "left out: 1 observation by a keypoint that is not there, or that another point has\n"
            "left out: 1 observation of points that no other image sees, at which COLMAP's bundle adjustment stops\n"
            "see no point now, since the point does not name them: 1 keypoint\n"
            "colmap cannot hold descriptors without a database (2)\n"
            "colmap cannot hold scales, angles and scores of keypoints (2)\n");
}

TEST(ColmapRoundTrip, CountsLossesOfEachMap) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].points[2].position.x() = std::numeric_limits<float>::quiet_NaN();
  atlas.maps[0].points[0].observations[0].left = 99;
  atlas.maps.resize(3, atlas.maps[0]);
  for (std::uint64_t id = 0; id < 3; ++id) atlas.maps[id].id = MapId(id);
  const TemporaryFolder folder;
  Notices notices;
  detail::kColmapFormat.write(atlas, folder.Path("model"), {.sync = false}, notices);
  std::string said;
  for (const Notice& notice : notices.items()) said += notice.text + "\n";
  EXPECT_THAT(said, HasSubstr("see no point now, since the point does not name them: 3 keypoints\n"));
}

// A match of a fisheye pair comes back where both keypoints see one point; depths never do.
TEST(ColmapRoundTrip, NamesWhatFisheyePairsLose) {
  Atlas atlas = SynthesizeAtlas({.sensor = Sensor::kFisheyeStereo, .keyframes = 4, .points = 100, .features = 400});
  for (KeyFrame& keyframe : atlas.maps[0].keyframes) {
    const auto left = keyframe.features.map_points.begin() + keyframe.features.left_count;
    const auto none = std::find(keyframe.features.map_points.begin(), left, MapPointId());
    if (none != left)
      keyframe.features.right_of_left[static_cast<std::size_t>(none - keyframe.features.map_points.begin())] = 0;
  }
  const TemporaryFolder folder;
  Notices notices;
  detail::kColmapFormat.write(atlas, folder.Path("model"), {.sync = false}, notices);
  const Atlas back = detail::kColmapFormat.read(folder.Path("model"), {}, notices);
  std::size_t depths = 0, matches = 0;
  for (std::size_t row = 0; row < atlas.maps[0].keyframes.size(); ++row) {
    const Features &had = atlas.maps[0].keyframes[row].features, &has = back.maps[0].keyframes[row].features;
    for (std::size_t at = 0; at < had.depth.size(); ++at) depths += had.depth[at] > 0 ? 1 : 0;
    for (std::size_t at = 0; at < had.right_of_left.size(); ++at)
      matches += had.right_of_left[at] >= 0 && has.right_of_left[at] != had.right_of_left[at] ? 1 : 0;
  }
  ASSERT_GT(depths, 0U);
  ASSERT_GT(matches, 0U);
  std::string said;
  for (const Notice& notice : notices.items()) said += notice.text + "\n";
  EXPECT_THAT(said, HasSubstr("depths of stereo and depth cameras (" + detail::Thousands(depths) + ")"));
  EXPECT_THAT(said, HasSubstr("keypoints that see no point (" + detail::Thousands(matches) + ")"));
}

TEST(ColmapRoundTrip, ModelsOfOneNumberingAreMovedApart) {
  const TemporaryFolder folder;
  Notices notices;
  const Atlas atlas = OneMapAtlas();
  for (const char* name : {"0", "1"}) detail::kColmapFormat.write(atlas, folder.Path(name), {.sync = false}, notices);
  const Atlas back = detail::kColmapFormat.read(folder.Path(""), {}, notices);
  ASSERT_EQ(back.maps.size(), 2U);
  EXPECT_EQ(back.cameras.size(), 1U);
  const AtlasIndex index(back);
  EXPECT_TRUE(index.duplicate_keyframes().empty());
  EXPECT_TRUE(index.duplicate_points().empty());
  EXPECT_EQ(back.maps[1].points[0].observations.size(), 2U);
}

}  // namespace
}  // namespace slamdb
