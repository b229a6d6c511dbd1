// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <numeric>

#include "slamdb/base/error.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/model/statistics.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

std::string Fixture(const std::string& name) { return std::string(SLAMDB_FIXTURES) + "/" + name; }

Atlas ReadWith(const Source& source, int threads) {
  Notices notices;
  Atlas atlas = ReadOrbslam3(source, {.threads = threads}, notices);
  EXPECT_TRUE(notices.items().empty());
  return atlas;
}

// Bytes in memory, which must outlive it.
Source Archive(const std::string& bytes) { return {std::as_bytes(std::span(bytes)), "archive.osa"}; }

std::string Written(const Atlas& atlas, const Orbslam3WriteOptions& options) {
  std::string written;
  const auto append = [&written](Bytes bytes) {
    written.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  Notices notices;
  WriteOrbslam3(atlas, Target(append, "memory"), WriteOptions{}.With(options), notices);
  return written;
}

void ExpectSameBytesAfterWriting(const std::string& path) {
  const std::string bytes = ReadWhole(path);
  for (const int threads : {1, 2, 5}) {
    const TemporaryFolder folder;
    const std::string copy = folder.Path("copy.osa");
    Notices notices;
    WriteOrbslam3(ReadWith(path, threads), copy, {.sync = false, .threads = threads}, notices);
    EXPECT_TRUE(ReadWhole(copy) == bytes) << path << " with " << threads << " threads";
    EXPECT_TRUE(EncodeOrbslam3(ReadWith(Archive(bytes), threads)) == bytes) << path << " in memory";
  }
}

class RoundTripOfFixture : public testing::TestWithParam<const char*> {};

TEST_P(RoundTripOfFixture, GivesTheSameBytes) { ExpectSameBytesAfterWriting(Fixture(GetParam())); }

INSTANTIATE_TEST_SUITE_P(Fixtures, RoundTripOfFixture,
                         testing::Values("tiny/tiny.osa", "tiny/tiny_text.osa", "session_small_a/session_small_a.osa",
                                         "session_small_b/session_small_b.osa",
                                         "mono_small_twice/mono_small_twice.osa"));

class RoundTripOfRealAtlas : public testing::TestWithParam<const char*> {};

TEST_P(RoundTripOfRealAtlas, GivesTheSameBytes) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  ExpectSameBytesAfterWriting(path);
}

// Text keeps everything but the payloads of NaN: so text made from text is the same, and binary made from it differs
// only in words that are NaN on both sides.
TEST_P(RoundTripOfRealAtlas, TextLosesOnlyNanPayloads) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  Atlas atlas = ReadWith(path, 0);
  atlas.encoding.text = true;
  const std::string text = EncodeOrbslam3(atlas);
  Atlas back = ReadWith(Archive(text), 0);
  EXPECT_TRUE(EncodeOrbslam3(back) == text);

  atlas.encoding.text = back.encoding.text = false;
  const std::string before = EncodeOrbslam3(atlas), after = EncodeOrbslam3(back);
  ASSERT_EQ(before.size(), after.size());
  std::size_t i = 0;
  while ((i = static_cast<std::size_t>(std::mismatch(before.begin() + static_cast<std::ptrdiff_t>(i), before.end(),
                                                     after.begin() + static_cast<std::ptrdiff_t>(i))
                                           .first -
                                       before.begin())) < before.size()) {
    // The differing byte belongs to some 4-byte word, of unknown alignment, that is NaN before and after.
    bool nan_word = false;
    for (std::size_t begin = i >= 3 ? i - 3 : 0; begin <= i && begin + 4 <= before.size(); ++begin) {
      float a = 0, b = 0;
      std::memcpy(&a, &before[begin], 4);
      std::memcpy(&b, &after[begin], 4);
      nan_word |= std::isnan(a) && std::isnan(b);
    }
    ASSERT_TRUE(nan_word) << "byte " << i;
    ++i;
  }
}

INSTANTIATE_TEST_SUITE_P(RealAtlases, RoundTripOfRealAtlas, testing::ValuesIn(kRealAtlases),
                         [](const auto& instance) { return std::string(instance.param); });

TEST(RoundTripOfSyntheticAtlas, GivesTheSameBytesForEverySensor) {
  for (const Sensor sensor : {Sensor::kMonocular, Sensor::kStereo, Sensor::kRgbd, Sensor::kFisheyeStereo}) {
    for (const bool inertial : {false, true}) {
      for (const bool text : {false, true}) {
        Atlas atlas =
            SynthesizeAtlas({.sensor = sensor, .inertial = inertial, .maps = 2, .keyframes = 12, .points = 400});
        atlas.encoding.text = text;
        const std::string bytes = EncodeOrbslam3(atlas);
        EXPECT_TRUE(EncodeOrbslam3(ReadWith(Archive(bytes), 3)) == bytes);
      }
    }
  }
}

TEST(WriteOrbslam3, ChangesOnlyOneByteForAnotherBoostVersion) {
  const Atlas atlas = ReadWith(Fixture("tiny/tiny.osa"), 1);
  std::string expected = ReadWhole(Fixture("tiny/tiny.osa"));
  ASSERT_EQ(expected[0x1e], 18);
  expected[0x1e] = 12;
  EXPECT_EQ(Written(atlas, {.boost_version = 12}), expected);
}

// What writing throws, into a folder that then is empty.
Error RefusalToWrite(const Atlas& atlas, const Orbslam3WriteOptions& options) {
  const TemporaryFolder folder;
  Notices notices;
  try {
    WriteOrbslam3(atlas, folder.Path("refused.osa"), WriteOptions{}.With(options), notices);
  } catch (const Error& error) {
    EXPECT_THAT(folder.Names(), testing::IsEmpty());
    return error;
  }
  return {ErrorKind::kInternal, "written"};
}

TEST(WriteOrbslam3, RefusesBoostVersionsThatWriteOtherBytes) {
  const Error error = RefusalToWrite(ReadWith(Fixture("tiny/tiny.osa"), 1), {.boost_version = 9});
  EXPECT_EQ(error.kind(), ErrorKind::kUsage);
  EXPECT_THAT(error.what(), testing::HasSubstr("version 9 cannot be written"));
}

TEST(WriteOrbslam3, RefusesLongsThatNoMachineHas) {
  const Error error = RefusalToWrite(ReadWith(Fixture("tiny/tiny.osa"), 1), {.long_bytes = 6});
  EXPECT_EQ(error.kind(), ErrorKind::kUsage);
  EXPECT_THAT(error.what(), testing::HasSubstr("a long of 6 bytes"));
}

TEST(WriteOrbslam3, FourByteLongsComeBackTheSame) {
  const Atlas atlas = ReadWith(Fixture("session_small_a/session_small_a.osa"), 0);
  const std::string sanitized = Written(atlas, {.sanitize = true});
  const std::string narrow = Written(ReadWith(Archive(sanitized), 0), {.long_bytes = 4});
  EXPECT_LT(narrow.size(), sanitized.size());
  const TemporaryFolder folder;
  const std::string path = folder.Make("narrow.osa", narrow);
  for (const int threads : {1, 2}) {
    for (const Source& source : {Archive(narrow), Source(path)}) {
      const Atlas back = ReadWith(source, threads);
      EXPECT_EQ(back.encoding.long_bytes, 4);
      EXPECT_TRUE(Written(back, {.long_bytes = 8}) == sanitized) << source.path << " with " << threads << " threads";
    }
  }
}

TEST(WriteOrbslam3, RefusesAnIdThatDoesNotFitIntoFourBytes) {
  Atlas atlas = ReadWith(Fixture("tiny/tiny.osa"), 1);
  atlas.maps[0].keyframes[0].id = KeyFrameId(std::uint64_t{1} << 40);
  const Error error = RefusalToWrite(atlas, {.long_bytes = 4});
  EXPECT_EQ(error.kind(), ErrorKind::kNotPossible);
  EXPECT_THAT(error.what(), testing::HasSubstr("1099511627776"));
}

TEST(ReadOrbslam3, PartSizesAddUpToTheFile) {
  const std::string path = Fixture("session_small_a/session_small_a.osa");
  std::vector<PartSize> parts;
  Notices notices;
  static_cast<void>(ReadOrbslam3(path, {.part_sizes = &parts}, notices));
  const std::uint64_t sum =
      std::accumulate(parts.begin(), parts.end(), std::uint64_t{0},
                      [](std::uint64_t total, const PartSize& part) { return total + part.bytes; });
  EXPECT_EQ(sum, std::filesystem::file_size(path));
  const auto keypoints =
      std::find_if(parts.begin(), parts.end(), [](const auto& part) { return part.part == "keypoints"; });
  ASSERT_NE(keypoints, parts.end());
  const Atlas atlas = ReadWith(path, 0);
  std::uint64_t bytes = 0;  // three lists a keyframe, each with a count
  for (const KeyFrame& keyframe : atlas.maps[0].keyframes)
    bytes += 3 * 4 + 28 * (keyframe.features.keypoints.size() + keyframe.features.undistorted.size() +
                           keyframe.features.right_keypoints.size());
  EXPECT_EQ(keypoints->bytes, bytes);
}

// Entries that are no new point end what is decoded in one piece.
TEST(ReadOrbslam3, PointsMayBeRepeatedAnywhere) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 8, .points = 2000, .features = 1200});
  atlas.maps[0].repeated_points = {{.position = 0, .owner_map = RepeatedEntry::kNull},
                                   {.position = 100, .owner_map = RepeatedEntry::kNull},
                                   {.position = 300, .owner_map = 0, .row = 5},
                                   {.position = 1027, .owner_map = 0, .row = 1023},
                                   {.position = 2004, .owner_map = RepeatedEntry::kNull}};
  const TemporaryFolder folder;
  const std::string path = folder.Path("repeated.osa");
  Notices notices;
  WriteOrbslam3(atlas, path, {.sync = false}, notices);
  ASSERT_GT(std::filesystem::file_size(path), std::uintmax_t{1} << 20);  // enough for two threads
  EXPECT_EQ(ReadWith(path, 2).maps[0].repeated_points, atlas.maps[0].repeated_points);
  ExpectSameBytesAfterWriting(path);
}

// Cells as no camera makes them, around the size from which on columns do not go through the window.
TEST(ReadOrbslam3, CellsOfTheGridMayBeOfAnySize) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 9, .points = 500, .features = 1200});
  std::uint32_t size = 1021;
  for (KeyFrame& keyframe : atlas.maps[0].keyframes) {
    FeatureGrid& grid = keyframe.features.grid;
    ASSERT_FALSE(grid.cell_sizes.empty());
    const std::uint32_t more = size++ - grid.cell_sizes[0];
    grid.cell_sizes[0] += more;
    const Column<std::uint64_t> before = grid.keypoints;
    grid.keypoints.resize(before.size() + more);
    std::iota(grid.keypoints.begin(), grid.keypoints.begin() + more, 1);
    std::ranges::copy(before, grid.keypoints.begin() + more);
  }
  const TemporaryFolder folder;
  const std::string path = folder.Path("cells.osa");
  Notices notices;
  WriteOrbslam3(atlas, path, {.sync = false}, notices);
  ASSERT_GT(std::filesystem::file_size(path), std::uintmax_t{1} << 20);  // enough for two threads
  ExpectSameBytesAfterWriting(path);
}

TEST(ReadOrbslam3, PartSizesAreTheSameWithAnyThreads) {
  const std::string path = Fixture("session_small_a/session_small_a.osa");
  std::vector<std::uint64_t> alone;
  for (const int threads : {1, 2, 5}) {
    std::vector<PartSize> parts;
    Notices notices;
    static_cast<void>(ReadOrbslam3(path, {.part_sizes = &parts, .threads = threads}, notices));
    std::vector<std::uint64_t> bytes;
    for (const PartSize& part : parts) bytes.push_back(part.bytes);
    if (threads == 1) alone = bytes;
    EXPECT_EQ(bytes, alone) << threads << " threads";
  }
}

TEST(ReadOrbslam3, LeavesFeaturesOutWhenAsked) {
  Notices notices;
  const Atlas atlas =
      ReadOrbslam3(Fixture("session_small_a/session_small_a.osa"), {.features = FeatureColumns::kNone}, notices);
  const Atlas whole = ReadWith(Fixture("session_small_a/session_small_a.osa"), 0);
  const KeyFrame& keyframe = atlas.maps[0].keyframes[3];
  EXPECT_TRUE(keyframe.features.keypoints.empty());
  EXPECT_TRUE(keyframe.features.descriptors.empty());
  EXPECT_EQ(keyframe.features.map_points, whole.maps[0].keyframes[3].features.map_points);
  EXPECT_EQ(keyframe.connections, whole.maps[0].keyframes[3].connections);
}

TEST(ReadOrbslam3, GeometryAloneGivesTheSameStatistics) {
  for (const char* file : {"session_small_a/session_small_a.osa", "mono_small_twice/mono_small_twice.osa"}) {
    Notices notices;
    const Atlas geometry = ReadOrbslam3(Fixture(file), {.features = FeatureColumns::kGeometry}, notices);
    EXPECT_TRUE(geometry.maps[0].keyframes[3].features.descriptors.empty());
    EXPECT_TRUE(geometry.maps[0].keyframes[3].features.grid.empty());
    const MapStatistics part = ComputeStatistics(geometry).maps[0];
    const MapStatistics whole = ComputeStatistics(ReadWith(Fixture(file), 0)).maps[0];
    EXPECT_GT(whole.reprojection_error.count, 0U);
    EXPECT_EQ(part.reprojection_error.count, whole.reprojection_error.count);
    EXPECT_EQ(part.reprojection_error.mean, whole.reprojection_error.mean);
    EXPECT_EQ(part.sensor, whole.sensor);
    EXPECT_EQ(part.features, whole.features);
  }
}

TEST(ReadOrbslam3, SelectsKeyFramesAndPoints) {
  Notices notices;
  ReadOptions options;
  options.selection.first_keyframe = 2;
  options.selection.last_keyframe = 5;
  options.selection.box = Eigen::AlignedBox3f(Eigen::Vector3f(-1, -1, 0), Eigen::Vector3f(1, 1, 3));
  const Atlas atlas = ReadOrbslam3(Fixture("session_small_a/session_small_a.osa"), options, notices);
  ASSERT_EQ(atlas.maps.size(), 1U);
  ASSERT_FALSE(atlas.maps[0].keyframes.empty());
  for (const KeyFrame& keyframe : atlas.maps[0].keyframes) {
    EXPECT_GE(keyframe.id.value(), 2U);
    EXPECT_LE(keyframe.id.value(), 5U);
  }
  ASSERT_FALSE(atlas.maps[0].points.empty());
  for (const MapPoint& point : atlas.maps[0].points) EXPECT_TRUE(options.selection.box->contains(point.position));
}

TEST(ReadOrbslam3, TellsBytesBehindTheEnd) {
  const std::string longer = ReadWhole(Fixture("tiny/tiny.osa")) + "xyz";
  Notices notices;
  static_cast<void>(ReadOrbslam3(Archive(longer), {}, notices));
  ASSERT_EQ(notices.items().size(), 1U);
  EXPECT_TRUE(notices.lossy());
  EXPECT_THAT(notices.items()[0].text, testing::HasSubstr("3 bytes behind the end"));
}

struct Cancelled {};

TEST(ReadOrbslam3, CancelsWhenProgressThrows) {
  Notices notices;
  ReadOptions options;
  options.progress = [](std::string_view, double) { throw Cancelled(); };
  const std::string path = Fixture("session_small_a/session_small_a.osa");
  EXPECT_THROW(static_cast<void>(ReadOrbslam3(path, options, notices)), Cancelled);
}

// Text that does not read is read again with other widths, but not when something else than its bytes is wrong.
TEST(ReadOrbslam3, DoesNotStartAgainWhatWasCancelled) {
  Atlas atlas = ReadWith(Fixture("session_small_a/session_small_a.osa"), 0);
  atlas.encoding.text = true;
  const std::string text = EncodeOrbslam3(atlas);
  int calls = 0;
  ReadOptions options;
  options.progress = [&](std::string_view, double) {
    ++calls;
    throw Error(ErrorKind::kNotPossible, "enough");
  };
  Notices notices;
  EXPECT_THROW(static_cast<void>(ReadOrbslam3(Archive(text), options, notices)), Error);
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace slamdb
