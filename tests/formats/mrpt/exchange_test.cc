// SPDX-License-Identifier: BSD-3-Clause
// Files exchanged with MRPT itself, in both directions. Built only where MRPT 2 is installed.
#include <gmock/gmock.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/io/CFileInputStream.h>
#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/maps/CLandmark.h>
#include <mrpt/maps/CLandmarksMap.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/poses/CPointPDFGaussian.h>
#include <mrpt/serialization/CArchive.h>
#include <mrpt/vision/types.h>
#include <mrpt/vision/utils.h>

#include <cmath>
#include <filesystem>

#include "slamdb/edit/landmarks/landmarks.h"
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

// ---- the direction of normals

// The landmarks of a map of MRPT's, as slamdb reads them.
std::vector<Landmark> Taken(const CLandmarksMap& map) {
  const TemporaryFolder folder;
  {
    mrpt::io::CFileOutputStream stream(folder.Path("map"));
    SaveByMrpt(map, stream);
  }
  return Read(folder.Path("map")).maps.at(0).landmarks;
}

// They became points: whether a frame at the origin may take each for in view.
void ExpectInView(const CLandmarksMap& map) {
  Atlas atlas;
  atlas.maps.emplace_back().landmarks = Taken(map);
  ASSERT_FALSE(atlas.maps[0].landmarks.empty());
  for (const Landmark& landmark : atlas.maps[0].landmarks) EXPECT_LT(landmark.normal.dot(landmark.mean), 0);
  MakePoints(atlas);
  for (const MapPoint& point : atlas.maps[0].points) EXPECT_GT(point.position.normalized().dot(point.normal), 0.5F);
}

TEST(Normals, OfMrptsMakersPointToTheSensor) {
  CLandmarksMap scanned;
  mrpt::obs::CObservation2DRangeScan scan;
  scan.aperture = 1;
  scan.resizeScan(3);
  for (int i = 0; i < 3; ++i) {
    scan.setScanRange(i, 5);
    scan.setScanRangeValidity(i, true);
  }
  scanned.loadOccupancyFeaturesFrom2DRangeScan(scan, std::nullopt, 1);
  ExpectInView(scanned);

  mrpt::vision::CMatchedFeatureList matches;
  for (int i = 0; i < 2; ++i) {
    mrpt::vision::CFeature left, right;
    left.type = right.type = mrpt::vision::featORB;
    left.keypoint.pt = {340.0F + 20 * static_cast<float>(i), 250};
    right.keypoint.pt = {320.0F + 20 * static_cast<float>(i), 250};
    matches.emplace_back(left, right);
  }
  mrpt::vision::TStereoSystemParams rig;
  rig.K.setZero();
  rig.K(0, 0) = rig.K(1, 1) = 500;
  rig.K(0, 2) = 320;
  rig.K(1, 2) = 240;
  rig.K(2, 2) = 1;
  rig.baseline = 0.2F;
  rig.minZ = 0;
  rig.maxZ = 50;
  CLandmarksMap stereo;
  mrpt::vision::projectMatchedFeatures(matches, rig, stereo);
  ExpectInView(stereo);

  mrpt::obs::CObservationImage seen;
  seen.image = mrpt::img::CImage(320, 240, mrpt::img::CH_GRAY);
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x)
      seen.image.setPixel(
          x, y, (x / 20 + y / 20) % 2 == 0 ? mrpt::img::TColor(20, 20, 20) : mrpt::img::TColor(240, 240, 240));
  seen.cameraParams.setIntrinsicParamsFromValues(300, 300, 160, 120);
  mrpt::vision::CFeatureExtraction::TOptions corners;
  corners.featsType = mrpt::vision::featKLT;
  CLandmarksMap image;
  image.loadSiftFeaturesFromImageObservation(seen, corners);
  ExpectInView(image);
}

TEST(Normals, OfFromPointsAreAsMrptsMakersSetThem) {
  Atlas atlas = SmallAtlas();
  MakeLandmarks(atlas);
  std::size_t facing = 0;
  for (const Map& map : atlas.maps)
    for (const MapPoint& point : map.points) {
      const auto landmark = std::ranges::find(map.landmarks, LandmarkId(point.id.value()), &Landmark::id);
      if (landmark == map.landmarks.end() || landmark->normal.isZero(0)) continue;
      EXPECT_LT(landmark->normal.dot(point.normal.cast<double>()), 0);
      ++facing;
    }
  EXPECT_GT(facing, 0U);
}

// ---- fusing

// A SIFT landmark; `number` decides its place, covariance and descriptor.
CLandmark Sift(int number, double shift) {
  CLandmark landmark;
  landmark.ID = number;
  const double n = number % 1000;
  landmark.pose_mean = {3 * n + shift, 0.5 * std::sin(n), 5 + shift};
  landmark.normal = {0, 0, -1};
  landmark.pose_cov_11 = static_cast<float>(0.1 + 0.01 * std::cos(n));
  landmark.pose_cov_22 = 0.2F;
  landmark.pose_cov_33 = 0.4F;
  landmark.pose_cov_12 = 0.02F;
  landmark.pose_cov_13 = static_cast<float>(0.03 * std::sin(n));
  landmark.timestampLastSeen = mrpt::Clock::fromDouble(1000 + shift);
  landmark.seenTimesCount = 1;
  landmark.features.resize(1);
  landmark.features[0].type = mrpt::vision::featSIFT;
  std::vector<std::uint8_t> bytes(128);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(number % 1000 * 31 + i * 7);
  landmark.features[0].descriptors.SIFT = bytes;
  return landmark;
}

// What MRPT's fuseWith makes of two maps, and what slamdb makes of the same two.
struct Fused {
  std::vector<Landmark> by_mrpt, by_us;
};
Fused FuseBoth(const CLandmarksMap& a, const CLandmarksMap& b) {
  Fused fused;
  fused.by_us = Taken(a);
  const std::size_t second = fused.by_us.size();
  std::ranges::copy(Taken(b), std::back_inserter(fused.by_us));
  FuseAlikeLandmarks(fused.by_us, second);
  CLandmarksMap first = a, other = b;
  first.fuseWith(other);
  fused.by_mrpt = Taken(first);
  return fused;
}

// It leaves a file in the working folder.
class Fusing : public ::testing::Test {
 protected:
  Fusing() : before_(std::filesystem::current_path()) { std::filesystem::current_path(folder_.Path("")); }
  ~Fusing() override { std::filesystem::current_path(before_); }

 private:
  TemporaryFolder folder_;
  std::filesystem::path before_;
};

TEST_F(Fusing, GivesTheNumbersOfMrpt) {
  CLandmarksMap a, b;
  for (int i = 0; i < 40; ++i) a.landmarks.push_back(Sift(1000 + i, 0));
  for (int i = 20; i < 60; ++i) {  // half of them there, moved by growing distances, of which some are too far
    CLandmark landmark = Sift(2000 + i, 0.05 * (i - 20));
    landmark.features[0].descriptors.SIFT->at(3) += static_cast<std::uint8_t>(i);
    b.landmarks.push_back(landmark);
  }
  const auto [by_mrpt, by_us] = FuseBoth(a, b);
  ASSERT_EQ(by_us.size(), by_mrpt.size());
  EXPECT_GT(by_us.size(), 60U);
  EXPECT_LT(by_us.size(), 80U);
  for (std::size_t i = 0; i < by_us.size(); ++i) {
    const Landmark &ours = by_us[i], &theirs = by_mrpt[i];
    EXPECT_EQ(ours.id, theirs.id);
    EXPECT_TRUE(ours.mean.isApprox(theirs.mean, 1e-6)) << ours.mean.transpose() << " and " << theirs.mean.transpose();
    EXPECT_TRUE(ours.pose().covariance.isApprox(theirs.pose().covariance, 1e-5));
    EXPECT_EQ(ours.seen_count, theirs.seen_count) << "the same where the other was seen once";
    EXPECT_EQ(ours.last_seen, theirs.last_seen) << "the same where the other is newer";
    EXPECT_TRUE(ours.normal.isApprox(theirs.normal));
    ASSERT_EQ(ours.features.size(), theirs.features.size());
  }
}

TEST_F(Fusing, MatchesUpToTheSameDistance) {
  int id = 100'000;  // MRPT keeps distances of descriptors by id for as long as the program runs
  const auto fuses = [&](double apart, int byte) {
    CLandmarksMap a, b;
    for (CLandmarksMap* map : {&a, &b}) {
      CLandmark landmark = Sift(5, 0);
      landmark.ID = ++id;
      landmark.pose_mean = {map == &a ? 0 : apart, 0, 5};
      landmark.pose_cov_11 = landmark.pose_cov_22 = landmark.pose_cov_33 = 0.5F;
      landmark.pose_cov_12 = landmark.pose_cov_13 = landmark.pose_cov_23 = 0;
      landmark.features[0].descriptors.SIFT->at(0) = static_cast<std::uint8_t>(map == &a ? 0 : byte);
      map->landmarks.push_back(landmark);
    }
    const auto [by_mrpt, by_us] = FuseBoth(a, b);
    EXPECT_EQ(by_us.size(), by_mrpt.size()) << apart << " apart, byte " << byte;
    return by_mrpt.size() == 1;
  };
  EXPECT_TRUE(fuses(4.7095, 0));
  EXPECT_FALSE(fuses(4.7098, 0));
  EXPECT_TRUE(fuses(0, 117));
  EXPECT_FALSE(fuses(0, 118));
  EXPECT_TRUE(fuses(2, 106));
  EXPECT_FALSE(fuses(2, 107));
}

}  // namespace
}  // namespace slamdb
