// SPDX-License-Identifier: BSD-3-Clause
// What is recovered of a file with changed bytes loads in ORB-SLAM3: nothing is null, no word beyond the vocabulary.
#include <gmock/gmock.h>

#include <random>
#include <span>

#include "slamdb/base/error.h"
#include "slamdb/edit/repair/recover.h"
#include "slamdb/formats/dbow2/vocabulary.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/formats/salvage.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/corrupt.h"
#include "tests/support/postload.h"

namespace slamdb {
namespace {

using ::testing::IsEmpty;

constexpr std::uint64_t kLabWords = 405'448, kSyntheticWords = 1'000'000;
constexpr const char* kLabChecksum = "6cfd24abfaccea29d49a8d99d874d41d";

Bytes BytesOf(const std::string& text) { return std::as_bytes(std::span(text)); }

std::string WithChangedBytes(std::string file, std::mt19937_64& random) {
  for (std::size_t i = 1 + random() % 40; i > 0; --i) file[random() % file.size()] = static_cast<char>(random());
  return file;
}

// Recovers `file`; what comes out has no error and no trouble, with the vocabulary's number of words too.
SalvageReport ExpectLoads(const std::string& file, const RecoverOptions& options, std::uint64_t words) {
  Salvage salvage = SalvageBytes(BytesOf(file), {.format = "orbslam3", .threads = 1});
  const SalvageReport report = RecoverSalvage(salvage, options);
  if (report.recovery.sound()) {
    EXPECT_TRUE(CheckAtlas(salvage.atlas, {.vocabulary_words = words, .threads = 1}).ok());
    EXPECT_THAT(LoadTroubles(salvage.atlas, words), IsEmpty());
  } else {
    for (const Unrepaired& rule : report.recovery.left) {
      if (rule.severity != Severity::kError) continue;
      EXPECT_THAT(rule.rule, ::testing::AnyOf("vocabulary-checksum", "atlas-not-empty")) << rule.first.message;
    }
  }
  return report;
}

TEST(LoadsAfterRecover, RealFileOfAKnownVocabulary) {
  const std::string file = ReadWhole(RealAtlas("session_small_a"));
  std::mt19937_64 random(11);
  for (int i = 0; i < 120; ++i) {
    SCOPED_TRACE(i);
    ExpectLoads(WithChangedBytes(file, random), {.threads = 1}, kLabWords);
  }
}

TEST(LoadsAfterRecover, RealFileOfAnUnknownVocabulary) {
  std::string file = ReadWhole(RealAtlas("session_small_a"));
  file.replace(file.find(kLabChecksum), 32, "00112233445566778899aabbccddeeff");
  std::mt19937_64 random(12);
  std::uint64_t dropped = 0;
  for (int i = 0; i < 240; ++i) {
    SCOPED_TRACE(i);
    dropped += ExpectLoads(WithChangedBytes(file, random), {.threads = 1}, kLabWords).recovery.words.dropped.size();
  }
  EXPECT_GT(dropped, 0u);
}

TEST(LoadsAfterRecover, RealFileWithItsVocabulary) {
  const char* folder = std::getenv("SLAMDB_ATLASES");
  if (folder == nullptr) GTEST_SKIP() << "set SLAMDB_ATLASES to the folder that has labvoc.txt";
  const LoadedVocabulary vocabulary = LoadVocabulary(std::string(folder) + "/labvoc.txt");
  const std::string file = ReadWhole(RealAtlas("session_small_a"));
  const RecoverOptions options = {
      .vocabulary = &vocabulary.tree, .vocabulary_identity = vocabulary.identity, .threads = 1};
  EXPECT_TRUE(ExpectLoads(file, options, kLabWords).untouched);
  std::mt19937_64 random(13);
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE(i);
    const SalvageReport report = ExpectLoads(WithChangedBytes(file, random), options, kLabWords);
    EXPECT_THAT(report.recovery.words.dropped, IsEmpty());
  }
}

class LoadsAfterRecoverOf : public ::testing::TestWithParam<std::tuple<Base, bool>> {};

TEST_P(LoadsAfterRecoverOf, SyntheticFile) {
  const auto [base, text] = GetParam();
  Atlas atlas = SoundAtlas(base);
  atlas.encoding.text = text;
  const std::string file = EncodeOrbslam3(atlas);
  std::mt19937_64 random(static_cast<std::uint64_t>(base) * 2 + text);
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    try {
      ExpectLoads(WithChangedBytes(file, random), {.threads = 1}, kSyntheticWords);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kDamaged) << error.what();  // nothing was whole
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Bases, LoadsAfterRecoverOf,
                         ::testing::Combine(::testing::Values(Base::kMonocular, Base::kRgbd, Base::kFisheyeStereo,
                                                              Base::kInertial, Base::kTwoMaps),
                                            ::testing::Bool()));

// Whole to the last byte, and no error: what ORB-SLAM3 leaves null all the same does not stay.
TEST(LoadsAfterRecover, ASlotThatLeadsNowhere) {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  atlas.maps[0].keyframes[3].features.map_points[0] = MapPointId(atlas.next_ids.map_point - 1);
  std::erase_if(atlas.maps[0].points,
                [&](const MapPoint& point) { return point.id.value() + 1 == atlas.next_ids.map_point; });
  const SalvageReport report = ExpectLoads(EncodeOrbslam3(atlas), {.threads = 1}, kSyntheticWords);
  EXPECT_TRUE(report.whole());
  EXPECT_FALSE(report.untouched);
  EXPECT_THAT(report.recovery.triangulated_points, IsEmpty()) << "no bytes are damaged: the point was culled";
}

}  // namespace
}  // namespace slamdb
