// SPDX-License-Identifier: BSD-3-Clause
// Files exchanged with MRPT itself, in both directions. Built only where MRPT 2 is installed.
#include <gmock/gmock.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/io/CFileInputStream.h>
#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/maps/CLandmark.h>
#include <mrpt/maps/CLandmarksMap.h>
#include <mrpt/serialization/CArchive.h>

#include "slamdb/formats/mrpt/detail/mrpt.h"
#include "slamdb/formats/mrpt/options.h"
#include "tests/formats/formats/small_atlas.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using mrpt::maps::CLandmark;
using mrpt::maps::CLandmarksMap;
using ::testing::SizeIs;

// A map as an MRPT program makes it: two features, every descriptor that is an array of numbers, a patch.
CLandmarksMap MadeByMrpt() {
  CLandmarksMap map;
  for (int i = 0; i < 20; ++i) {
    CLandmark landmark;
    landmark.ID = 100 + i;
    landmark.pose_mean = {0.5 * i, -1.25, 3};
    landmark.normal = {0, 0, 1};
    landmark.pose_cov_11 = 0.01F;
    landmark.pose_cov_23 = -0.002F;
    landmark.timestampLastSeen = mrpt::Clock::fromDouble(1.7e9 + i);
    landmark.seenTimesCount = static_cast<std::uint32_t>(i);
    landmark.features.resize(i % 3);
    for (auto& feature : landmark.features) {
      feature.type = i % 2 == 0 ? mrpt::vision::featORB : mrpt::vision::featSIFT;
      feature.keypoint.pt.x = static_cast<float>(i);
      feature.keypoint.ID = 7;
      feature.orientation = 0.5F;
      feature.initialDepth = 2;
      feature.descriptors.SIFT = std::vector<std::uint8_t>{1, 2, 3};
      feature.descriptors.SURF = std::vector<float>{0.5F, -1};
      feature.descriptors.ORB = std::vector<std::uint8_t>(32, static_cast<std::uint8_t>(i));
      if (i % 5 == 1) feature.descriptors.PolarImg = mrpt::math::CMatrixF(3, 4);
      if (i % 7 == 1) {
        feature.patch = mrpt::img::CImage(21, 21, mrpt::img::CH_GRAY);
        feature.patch->filledRectangle(0, 0, 20, 20, mrpt::img::TColor(9, 9, 9));
      }
    }
    map.landmarks.push_back(landmark);
  }
  return map;
}

void SaveByMrpt(const CLandmarksMap& map, mrpt::io::CStream& stream) {
  auto archive = mrpt::serialization::archiveFrom(stream);
  archive << map;
}

void LoadByMrpt(mrpt::io::CStream& stream, CLandmarksMap& map) {
  auto archive = mrpt::serialization::archiveFrom(stream);
  archive >> map;
}

Atlas Read(const std::string& path) {
  Notices notices;
  return detail::kMrptFormat.read({path, ""}, {}, notices);
}

TEST(Exchange, MrptsFilesComeBackByteForByte) {
  const TemporaryFolder folder;
  {
    mrpt::io::CFileOutputStream plain(folder.Path("by_mrpt"));
    SaveByMrpt(MadeByMrpt(), plain);
    mrpt::io::CFileGZOutputStream compressed(folder.Path("by_mrpt.gz"));
    SaveByMrpt(MadeByMrpt(), compressed);
  }
  const Atlas atlas = Read(folder.Path("by_mrpt"));
  EXPECT_THAT(Read(folder.Path("by_mrpt.gz")), EqualsAtlas(atlas));
  ASSERT_THAT(atlas.maps.at(0).landmarks, SizeIs(20));
  const Landmark& landmark = atlas.maps[0].landmarks[16];
  EXPECT_EQ(landmark.id, LandmarkId(116));
  EXPECT_EQ(landmark.mean.x(), 8);
  EXPECT_EQ(SecondsOfTicks(landmark.last_seen), 1.7e9 + 16);
  ASSERT_THAT(landmark.features, SizeIs(1));
  EXPECT_EQ(landmark.features[0].FindDescriptor(DescriptorKind::kOrb)->bytes, std::vector<std::uint8_t>(32, 16));
  Notices notices;
  detail::kMrptFormat.write(atlas, {folder.Path("by_us"), ""}, WriteOptions{}.With(MrptWriteOptions{.own_slots = true}),
                            notices);
  EXPECT_EQ(ReadFile(folder.Path("by_us")), ReadFile(folder.Path("by_mrpt")));
}

TEST(Exchange, MrptReadsWhatWeWrite) {
  const TemporaryFolder folder;
  Atlas atlas = LandmarkAtlas();
  atlas.maps.pop_back();
  Notices notices;
  for (const char* name : {"by_us", "by_us.gz"}) {
    detail::kMrptFormat.write(atlas, {folder.Path(name), ""}, {}, notices);
    mrpt::io::CFileGZInputStream stream(folder.Path(name));  // reads plain files, too
    CLandmarksMap map;
    LoadByMrpt(stream, map);
    ASSERT_EQ(map.size(), 2U);
    const CLandmark& landmark = *map.landmarks.get(0);
    EXPECT_EQ(landmark.ID, 10);
    EXPECT_EQ(landmark.pose_mean.z, 2);
    EXPECT_EQ(landmark.pose_cov_33, 0.5F);
    EXPECT_EQ(mrpt::Clock::toDouble(landmark.timestampLastSeen), 1.5);
    EXPECT_EQ(landmark.seenTimesCount, 2U);
    EXPECT_EQ(landmark.getType(), mrpt::vision::featORB);
    ASSERT_TRUE(landmark.features[0].descriptors.ORB.has_value());
    EXPECT_EQ(*landmark.features[0].descriptors.ORB, (std::vector<std::uint8_t>{1, 2, 3}));
    EXPECT_FALSE(landmark.features[0].descriptors.BLD.has_value());
    EXPECT_EQ(map.landmarks.get(1)->ID, -1);
  }
}

TEST(Exchange, TextIsTheSame) {
  const TemporaryFolder folder;
  CLandmarksMap map = MadeByMrpt();
  for (auto& landmark : map.landmarks)
    if (landmark.features.empty()) {  // of which MRPT can write no text
      landmark.createOneFeature();
      landmark.features[0].type = mrpt::vision::featKLT;
    }
  map.saveToTextFile(folder.Path("by_mrpt.txt"));
  {
    mrpt::io::CFileOutputStream plain(folder.Path("by_mrpt"));
    SaveByMrpt(map, plain);
  }
  Notices notices;
  detail::kMrptTextFormat.write(Read(folder.Path("by_mrpt")), {folder.Path("by_us.txt"), ""}, {}, notices);
  EXPECT_EQ(ReadFile(folder.Path("by_us.txt")), ReadFile(folder.Path("by_mrpt.txt")));
}

}  // namespace
}  // namespace slamdb
