// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/mrpt/detail/mrpt.h"

#include <gmock/gmock.h>

#include <cstring>

#include "slamdb/formats/export/detail/raw.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/formats/mrpt/detail/gzip.h"
#include "slamdb/formats/mrpt/detail/stream.h"
#include "slamdb/formats/mrpt/options.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const std::string kRealMap = SLAMDB_FIXTURES "/mrpt/landmarks.bin";
const std::string kRealLandmark = SLAMDB_FIXTURES "/mrpt/landmark.bin";

Atlas ReadFrom(const std::string& path) {
  Notices notices;
  return detail::kMrptFormat.read({path, ""}, {}, notices);
}

std::string Written(const Format& format, const Atlas& atlas, Notices& notices, const WriteOptions& options = {}) {
  return Encoded(format, atlas, options, notices);
}
std::string Written(const Format& format, const Atlas& atlas, const WriteOptions& options = {}) {
  return Encoded(format, atlas, options);
}
WriteOptions OwnSlots(bool own) { return WriteOptions{}.With(MrptWriteOptions{.own_slots = own}); }

Atlas Read(const std::string& bytes) { return Decoded(detail::kMrptFormat, bytes); }

// A landmark with everything that one can hold.
Landmark FullLandmark() {
  Landmark landmark = ReadFrom(kRealMap).maps[0].landmarks[0];
  LandmarkFeature& feature = landmark.features[0];
  feature.type = FeatureType::kSift;
  feature.has_patch = true;
  feature.patch.assign(100, 7);
  for (const char c : mrpt::kOptionalBytes) feature.patch.push_back(static_cast<std::uint8_t>(c));  // as if it ended
  feature.patch.push_back(0x88);
  feature.spin_image_rows = 3;
  feature.polar_images_without_rotation = true;
  feature.user_flags = 5;
  feature.descriptors = {{DescriptorKind::kSift, {1, 2, 3}},
                         {DescriptorKind::kSurf, {0, 0, 0x80, 0x3f}},
                         {DescriptorKind::kSpinImage, {}},
                         {DescriptorKind::kPolarImage, {7, 8, 0x88}},
                         {DescriptorKind::kLogPolarImage, {0x88}},
                         {DescriptorKind::kOrb, {4, 5}},
                         {DescriptorKind::kBld, {6}},
                         {DescriptorKind::kLatch, {7, 7}}};
  landmark.features.push_back(landmark.features[0]);
  landmark.features[1].type = static_cast<FeatureType>(77);
  return landmark;
}

Atlas AtlasOf(std::vector<Landmark> landmarks) {
  Atlas atlas;
  atlas.maps.emplace_back().id = MapId(0);
  atlas.maps[0].landmarks = std::move(landmarks);
  atlas.next_ids.map = 1;
  for (const Landmark& landmark : atlas.maps[0].landmarks)
    if (landmark.id) atlas.next_ids.map_point = std::max(atlas.next_ids.map_point, landmark.id.value() + 1);
  return atlas;
}

TEST(Mrpt, ReadsWhatMrptWrote) {
  const Atlas atlas = ReadFrom(kRealMap);
  ASSERT_THAT(atlas.maps, SizeIs(1));
  ASSERT_THAT(atlas.maps[0].landmarks, SizeIs(2));
  const Landmark& landmark = atlas.maps[0].landmarks[0];
  EXPECT_EQ(landmark.id, LandmarkId(7));
  EXPECT_EQ(landmark.mean, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(landmark.normal, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(static_cast<float>(landmark.cov_22), 0.02F);
  EXPECT_EQ(static_cast<float>(landmark.cov_23), 0.003F);
  EXPECT_EQ(SecondsOfTicks(landmark.last_seen), 1700000000.25);
  EXPECT_EQ(landmark.seen_count, 5U);
  EXPECT_EQ(landmark.type(), FeatureType::kOrb);
  const LandmarkFeature& feature = landmark.features.at(0);
  EXPECT_EQ(feature.x, 100.5F);
  EXPECT_EQ(feature.keypoint_id, 1000U);
  EXPECT_EQ(feature.orientation, 1.5F);
  EXPECT_EQ(feature.patch_size, 21);
  EXPECT_EQ(feature.position_in_camera, Eigen::Vector3d(0.1, 0.2, 4));
  ASSERT_THAT(feature.descriptors, SizeIs(1));
  EXPECT_EQ(feature.descriptors[0].kind, DescriptorKind::kOrb);
  EXPECT_THAT(feature.descriptors[0].bytes, SizeIs(32));
  EXPECT_EQ(feature.descriptors[0].bytes[5], 0x45);
}

TEST(Mrpt, ReadsBareLandmarks) {
  const std::string one = ReadFile(kRealLandmark);
  EXPECT_THAT(ReadFrom(kRealLandmark).maps.at(0).landmarks, SizeIs(1));
  const Atlas atlas = Read(one + one + ReadFile(kRealMap) + one);
  ASSERT_THAT(atlas.maps, SizeIs(3));
  EXPECT_THAT(atlas.maps[0].landmarks, SizeIs(2));
  EXPECT_THAT(atlas.maps[2].landmarks, SizeIs(1));
  EXPECT_EQ(atlas.maps[2].id, MapId(2));
}

TEST(Mrpt, WritesTheSameBytesAsMrpt) {
  EXPECT_EQ(Written(detail::kMrptFormat, ReadFrom(kRealMap), OwnSlots(true)), ReadFile(kRealMap));
}

TEST(Mrpt, PutsOrbWhereMrptReadsIt) {
  const std::string bytes = Written(detail::kMrptFormat, ReadFrom(kRealMap)), real = ReadFile(kRealMap);
  ASSERT_EQ(bytes.size(), real.size());
  EXPECT_EQ(bytes[0x1e8], 0);  // the first slot, which the real file uses
  EXPECT_EQ(bytes[0x260 - 36], 1);
  EXPECT_EQ(bytes.substr(0x260 - 31, 32), real.substr(0x1ed, 32));
  EXPECT_THAT(Read(bytes), EqualsAtlas(ReadFrom(kRealMap)));
}

TEST(Mrpt, KeepsEverything) {
  const Atlas atlas = AtlasOf({FullLandmark(), Landmark(), FullLandmark()});
  for (const bool own : {false, true}) {
    Notices notices;
    const std::string bytes = Written(detail::kMrptFormat, atlas, notices, OwnSlots(own));
    EXPECT_FALSE(notices.lossy());
    EXPECT_THAT(Read(bytes), EqualsAtlas(atlas));
  }
}

// Version 1 of CFeature has two slots of descriptors instead of three, version 0 no depths either.
TEST(Mrpt, ReadsEarlierFeatures) {
  constexpr std::size_t kVersion = 0x5b, kDepths = 0xa7, kThirdSlot = 0x218;
  std::string bytes = ReadFile(kRealLandmark);
  bytes.erase(kThirdSlot, 42);
  bytes[kVersion] = 1;
  const Landmark first = Read(bytes).maps.at(0).landmarks.at(0);
  EXPECT_EQ(first.features[0].depth, 4);
  bytes.erase(kDepths, 40);
  bytes[kVersion] = 0;
  const Landmark zeroth = Read(bytes).maps.at(0).landmarks.at(0);
  EXPECT_EQ(zeroth.features[0].depth, 0);
  EXPECT_EQ(zeroth.features[0].descriptors, first.features[0].descriptors);
  EXPECT_EQ(zeroth.mean, first.mean);
}

TEST(Mrpt, CompressesWhereTheNameSaysSo) {
  const TemporaryFolder folder;
  Notices notices;
  const Atlas atlas = AtlasOf(std::vector<Landmark>(2000, FullLandmark()));
  detail::kMrptFormat.write(atlas, {folder.Path("a.mrpt.gz"), ""}, {}, notices);
  detail::kMrptFormat.write(atlas, {folder.Path("a.mrpt"), ""}, {}, notices);
  detail::kMrptFormat.write(atlas, {folder.Path("b.mrpt.gz"), ""}, {.threads = 3}, notices);
  EXPECT_LT(ReadFile(folder.Path("a.mrpt.gz")).size(), ReadFile(folder.Path("a.mrpt")).size() / 10);
  EXPECT_EQ(ReadFile(folder.Path("a.mrpt.gz")), ReadFile(folder.Path("b.mrpt.gz")));
  detail::kMrptFormat.write(atlas, {folder.Path("C.MRPT.GZ"), ""}, {}, notices);
  EXPECT_EQ(ReadFile(folder.Path("a.mrpt.gz")), ReadFile(folder.Path("C.MRPT.GZ")));
  detail::kMrptTextFormat.write(atlas, {folder.Path("a.mrpt.txt.gz"), ""}, {}, notices);
  EXPECT_EQ(mrpt::Decompress("a", ReadFile(folder.Path("a.mrpt.txt.gz"))), Written(detail::kMrptTextFormat, atlas));
  EXPECT_TRUE(detail::kMrptFormat.sniff(Probe::Of(folder.Path("a.mrpt.gz"))));
  EXPECT_THAT(ReadFrom(folder.Path("a.mrpt.gz")), EqualsAtlas(atlas));
}

TEST(Mrpt, SeveralMapsAreSeveralObjects) {
  Atlas atlas = AtlasOf({FullLandmark()});
  atlas.maps.push_back(atlas.maps[0]);
  atlas.maps[1].id = MapId(1);
  atlas.next_ids.map = 2;
  EXPECT_THAT(Read(Written(detail::kMrptFormat, atlas)), EqualsAtlas(atlas));
  const Atlas second = Read(Written(detail::kMrptFormat, atlas, WriteOptions{}.With(ExportOptions{.map = MapId(1)})));
  EXPECT_THAT(second.maps, SizeIs(1));
}

// MRPT 3: i64 id, 3 f64 position, 6 f64 covariance, u32 count.
TEST(Mrpt3, HasTheLayoutOfItsDescription) {
  Landmark landmark;
  landmark.id = LandmarkId(9);
  landmark.mean = {1, 2, 3};
  landmark.cov_13 = 0.1;
  landmark.seen_count = 4;
  std::string expected("\x99mrpt::maps::CLandmarksMap\0\x01\0\0\0", 31);
  detail::AppendRaw(expected, std::uint64_t{9});
  for (const double value : {1., 2., 3., 0., 0., 0., 0., 0.1, 0.}) detail::AppendRaw(expected, value);
  detail::AppendRaw(expected, std::uint32_t{4});
  expected += '\x88';
  Notices notices;
  EXPECT_EQ(Written(detail::kMrpt3Format, AtlasOf({landmark}), notices), expected);
  EXPECT_FALSE(notices.lossy());
  EXPECT_THAT(Read(expected), EqualsAtlas(AtlasOf({landmark})));
}

TEST(Mrpt3, IsToldByContent) {
  const TemporaryFolder folder;
  const std::string two = Written(detail::kMrptFormat, AtlasOf({Landmark()})),
                    three = Written(detail::kMrpt3Format, AtlasOf({Landmark()}));
  const Probe probe2 = Probe::Of(folder.Make("2", two)), probe3 = Probe::Of(folder.Make("3", three));
  EXPECT_TRUE(detail::kMrptFormat.sniff(probe2) && !detail::kMrptFormat.sniff(probe3));
  EXPECT_TRUE(!detail::kMrpt3Format.sniff(probe2) && detail::kMrpt3Format.sniff(probe3));
  EXPECT_THAT(Read(Written(detail::kMrpt3Format, AtlasOf({}))), EqualsAtlas(AtlasOf({})));
}

TEST(Mrpt3, NamesWhatItLoses) {
  Notices notices;
  Written(detail::kMrpt3Format, ReadFrom(kRealMap), notices);
  std::vector<std::string> losses;
  for (const Notice& notice : notices.items()) losses.push_back(notice.text);
  EXPECT_THAT(losses,
              ElementsAre("mrpt3 cannot hold features of landmarks (2)", "mrpt3 cannot hold normals of landmarks (2)",
                          "mrpt3 cannot hold times of last sight of landmarks (2)"));
}

TEST(Mrpt, NamesCovariancesThatItRounds) {
  Landmark landmark;
  landmark.cov_11 = 0.1;
  Notices notices;
  Written(detail::kMrptFormat, AtlasOf({landmark}), notices);
  ASSERT_THAT(notices.items(), SizeIs(1));
  EXPECT_EQ(notices.items()[0].text, "mrpt cannot hold 64-bit covariances of landmarks (1)");
}

TEST(Mrpt, NamesLatchThatReadsAsOrb) {
  Landmark landmark;
  LandmarkFeature& feature = landmark.CreateOneFeature();
  feature.type = FeatureType::kOrb;
  feature.descriptors = {{DescriptorKind::kLatch, {1, 2}}};
  Notices notices;
  const Atlas back = Read(Written(detail::kMrptFormat, AtlasOf({landmark}), notices));
  ASSERT_THAT(notices.items(), SizeIs(1));
  EXPECT_THAT(notices.items()[0].text, HasSubstr("LATCH descriptors"));
  EXPECT_NE(back.maps[0].landmarks[0].features[0].FindDescriptor(DescriptorKind::kOrb), nullptr);
}

// MRPT's ids are signed.
TEST(Mrpt, NegativeIdsAreKeptAndNotCounted) {
  Landmark landmark;
  landmark.id = LandmarkId(static_cast<std::uint64_t>(-2));
  EXPECT_FALSE(landmark.is_numbered());
  Atlas atlas = AtlasOf({Landmark(), Landmark()});
  atlas.maps[0].landmarks[0].id = LandmarkId(6);
  atlas.next_ids.map_point = 7;
  atlas.maps[0].landmarks[1] = landmark;
  EXPECT_THAT(Read(Written(detail::kMrptFormat, atlas)), EqualsAtlas(atlas));
}

TEST(MrptText, IsWhatMrptWrites) {
  Landmark landmark = ReadFrom(kRealMap).maps[0].landmarks[0];
  EXPECT_EQ(Written(detail::kMrptTextFormat, AtlasOf({landmark})),
            "  1.000000   2.000000   3.000000   10    5 80000.000000 7 \n");
  landmark.features[0].type = FeatureType::kSift;
  landmark.features[0].descriptors = {{DescriptorKind::kSift, {12, 0, 255}}};
  landmark.id = {};
  landmark.last_seen = 0;
  landmark.mean = {-1234.5, 1e-9, 100000};
  EXPECT_EQ(Written(detail::kMrptTextFormat, AtlasOf({landmark})),
            "-1234.500000   0.000000 100000.000000    3    5   0.000000 12  0  255  -1 \n");
}

}  // namespace
}  // namespace slamdb
