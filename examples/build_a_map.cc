// SPDX-License-Identifier: BSD-3-Clause
// build_a_map OUTPUT.osa: makes a map of columns, as an own SLAM or SfM system has them: a camera that goes along a
// wall. ORB-SLAM3 loads it.
#include <cmath>
#include <cstdio>
#include <exception>
#include <random>

#include "slamdb/build/build.h"
#include "slamdb/checks/check.h"
#include "slamdb/formats/formats.h"
#include "slamdb/model/vocabulary.h"

namespace {

constexpr int kWidth = 640, kHeight = 480, kKeyFrames = 12;
constexpr float kFocalLength = 400;

// Points on a wall, 3 m away, and a descriptor for each: of ORB, in a real system.
struct Wall {
  std::vector<Eigen::Vector3f> points;
  std::vector<slamdb::Descriptor> descriptors;
};

Wall MakeWall() {
  std::mt19937 random(1);
  Wall wall;
  for (float x = -1; x < 7; x += 0.25F)
    for (float y = -1.25F; y < 1.5F; y += 0.25F) {
      wall.points.emplace_back(x, y, 3 + 0.1F * std::sin(5 * x + 3 * y));
      for (std::uint8_t& byte : wall.descriptors.emplace_back()) byte = static_cast<std::uint8_t>(random());
    }
  return wall;
}

// What a camera sees of the wall, as keypoints and as observations of the wall's points.
void Look(const Wall& wall, const slamdb::Rigid3f& camera_from_world, slamdb::KeyFrameId id, slamdb::Features& features,
          std::vector<slamdb::NewObservation>& observations) {
  for (std::size_t point = 0; point < wall.points.size(); ++point) {
    const Eigen::Vector3f seen = camera_from_world * wall.points[point];
    slamdb::Keypoint keypoint{.class_id = -1};
    keypoint.x = kFocalLength * seen.x() / seen.z() + kWidth / 2.0F;
    keypoint.y = kFocalLength * seen.y() / seen.z() + kHeight / 2.0F;
    if (keypoint.x < 0 || keypoint.x >= kWidth || keypoint.y < 0 || keypoint.y >= kHeight) continue;
    observations.push_back({point, id, features.keypoints.size()});
    features.keypoints.push_back(keypoint);
    features.descriptors.push_back(wall.descriptors[point]);
  }
}

slamdb::Atlas BuildAMap() {
  slamdb::Atlas atlas;
  const slamdb::KnownVocabulary& own =
      slamdb::KnownVocabularies().front();  // ORB-SLAM3's; it refuses atlases of others
  atlas.vocabulary = {std::string(own.name), std::string(own.checksum)};
  const slamdb::CameraId camera = slamdb::AddCamera(atlas, slamdb::CameraModel::kPinhole,
                                                    {kFocalLength, kFocalLength, kWidth / 2.0F, kHeight / 2.0F});
  const slamdb::MapId map = slamdb::AddMap(atlas);

  const Wall wall = MakeWall();
  slamdb::NewKeyFrames keyframes{.camera = camera, .width = kWidth, .height = kHeight};
  slamdb::NewPoints points{.positions = wall.points};
  for (int i = 0; i < kKeyFrames; ++i) {
    keyframes.timestamps.push_back(1.7e9 + 0.5 * i);
    slamdb::Rigid3f& camera_from_world = keyframes.camera_from_world.emplace_back();
    camera_from_world.translation.x() = -0.5F * static_cast<float>(i);
    keyframes.ids.emplace_back(i);
    Look(wall, camera_from_world, keyframes.ids.back(), keyframes.features.emplace_back(), points.observations);
  }
  slamdb::AddKeyFrames(atlas, map, std::move(keyframes));
  slamdb::AddPoints(atlas, map, std::move(points));
  return atlas;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: build_a_map OUTPUT.osa\n", stderr);
    return 2;
  }
  try {
    const slamdb::Atlas atlas = BuildAMap();
    slamdb::WriteAtlas(atlas, argv[1], {.overwrite = true});
    const slamdb::Map& map = atlas.maps.front();
    std::printf("%zu keyframes, %zu points\n", map.keyframes.size(), map.points.size());
    return slamdb::CheckAtlas(atlas).ok() ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "build_a_map: %s\n", error.what());
    return 1;
  }
}
