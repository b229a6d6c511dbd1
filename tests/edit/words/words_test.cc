// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/words/words.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "slamdb/base/error.h"
#include "slamdb/formats/dbow2/vocabulary.h"
#include "slamdb/formats/formats.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const LoadedVocabulary& Small() {
  static const LoadedVocabulary vocabulary = LoadVocabulary(SLAMDB_FIXTURES "/vocabulary/small.txt");
  return vocabulary;
}

// The descriptor of the word that children a, b, c lead to, of the small vocabulary: fixtures/README.md.
Descriptor Leaf(std::size_t a, std::size_t b, std::size_t c) {
  constexpr std::array<std::uint8_t, 3> kCodes{0x00, 0x0f, 0xff};
  Descriptor descriptor;
  descriptor.fill(0xaa);
  const std::array path{a, b, c};
  for (std::size_t i = 0; i < 24; ++i) descriptor[i] = kCodes[path[i / 8]];
  return descriptor;
}

// Word 13 = (1, 1, 1) weighs nothing.
const Column<Descriptor> kDescriptors{Leaf(0, 0, 0), Leaf(2, 2, 2), Leaf(0, 0, 0), Leaf(1, 1, 1), Leaf(0, 1, 2)};

TEST(ComputeWords, AsComputedByHand) {
  const Words words = ComputeWords(Small().tree, kDescriptors);
  EXPECT_THAT(words.bag_of_words.words, ElementsAre(0, 5, 26));
  EXPECT_THAT(words.bag_of_words.weights, ElementsAre(0.5 / 8.75, 1.5 / 8.75, 6.75 / 8.75));
  EXPECT_THAT(words.feature_vector.nodes, ElementsAre(0));  // a tree of 3 levels has none 4 levels up
  EXPECT_THAT(words.feature_vector.sizes, ElementsAre(4));
  EXPECT_THAT(words.feature_vector.features, ElementsAre(0, 1, 2, 4));
}

// It would be stamped with a vocabulary of which it has no word.
TEST(RecomputeWords, RefusesAnAtlasWithoutDescriptors) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 3, .points = 30, .features = 40});
  for (KeyFrame& keyframe : atlas.maps[0].keyframes) keyframe.features.descriptors.clear();
  const Vocabulary before = atlas.vocabulary;
  try {
    static_cast<void>(RecomputeWords(atlas, Small().tree, Small().identity));
    FAIL() << "recomputed";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kNotPossible);
    EXPECT_THAT(error.what(), HasSubstr("no keyframe has a descriptor"));
  }
  EXPECT_EQ(atlas.vocabulary, before);
  atlas.maps.clear();
  EXPECT_EQ(RecomputeWords(atlas, Small().tree, Small().identity).recomputed, 0U);
}

TEST(ComputeWords, GroupsByTheNodeLevelsUp) {
  const FeatureVector coarse = ComputeWords(Small().tree, kDescriptors, 2).feature_vector;
  EXPECT_THAT(coarse.nodes, ElementsAre(1, 3));
  EXPECT_THAT(coarse.sizes, ElementsAre(3, 1));
  EXPECT_THAT(coarse.features, ElementsAre(0, 2, 4, 1));
  const FeatureVector fine = ComputeWords(Small().tree, kDescriptors, 1).feature_vector;
  EXPECT_THAT(fine.nodes, ElementsAre(4, 5, 30));
  EXPECT_THAT(fine.features, ElementsAre(0, 2, 4, 1));
}

TEST(ComputeWords, TheFirstOfEquallyNearChildrenWins) {
  Descriptor between = Leaf(0, 0, 0);
  for (std::size_t i = 0; i < 8; ++i) between[i] = 0x03;  // two bits from 0x00 and two from 0x0f in every byte
  EXPECT_THAT(ComputeWords(Small().tree, {between}).bag_of_words.words, ElementsAre(0));
}

TEST(ComputeWords, WeighsAndDividesAsTheVocabularySays) {
  VocabularyTree tree = Small().tree;
  const auto weights = [&](WordWeighting weighting, WordScoring scoring) {
    tree.weighting = weighting;
    tree.scoring = scoring;
    return ComputeWords(tree, kDescriptors).bag_of_words.weights;
  };
  const double length = std::sqrt(0.5 * 0.5 + 1.5 * 1.5 + 6.75 * 6.75);
  EXPECT_THAT(weights(WordWeighting::kTf, WordScoring::kL2), ElementsAre(0.5 / length, 1.5 / length, 6.75 / length));
  EXPECT_THAT(weights(WordWeighting::kIdf, WordScoring::kKullbackLeibler),
              ElementsAre(0.25 / 8.5, 1.5 / 8.5, 6.75 / 8.5));
  EXPECT_THAT(weights(WordWeighting::kTfIdf, WordScoring::kDotProduct), ElementsAre(0.5 / 3, 1.5 / 3, 6.75 / 3));
  EXPECT_THAT(weights(WordWeighting::kBinary, WordScoring::kDotProduct), ElementsAre(0.25, 1.5, 6.75));
}

TEST(ComputeWords, NothingGivesNothing) {
  EXPECT_EQ(ComputeWords(Small().tree, {}), Words{});
  EXPECT_EQ(ComputeWords(Small().tree, {Leaf(1, 1, 1)}), Words{});
}

TEST(RecomputeWords, StampsAndDoesNotDependOnThreads) {
  const Atlas before = SynthesizeAtlas({.sensor = Sensor::kFisheyeStereo, .maps = 2, .keyframes = 5, .points = 100});
  Atlas one = before, many = before;
  const RecomputeWordsReport report = RecomputeWords(one, Small().tree, Small().identity, {.threads = 1});
  RecomputeWords(many, Small().tree, Small().identity, {.threads = 4});
  EXPECT_THAT(many, EqualsAtlas(one));
  EXPECT_EQ(report.keyframes, 10U);
  EXPECT_EQ(report.recomputed, 10U);
  EXPECT_EQ(report.equal, 0U);
  EXPECT_EQ(one.vocabulary, Small().identity);
  EXPECT_EQ(RecomputeWords(many, Small().tree, Small().identity, {}).equal, 10U);
  many.vocabulary = before.vocabulary;
  for (std::size_t m = 0; m < 2; ++m)
    for (std::size_t i = 0; i < 5; ++i) {
      Features& features = many.maps[m].keyframes[i].features;
      features.bag_of_words = before.maps[m].keyframes[i].features.bag_of_words;
      features.feature_vector = before.maps[m].keyframes[i].features.feature_vector;
    }
  EXPECT_THAT(many, EqualsAtlas(before));  // nothing else was touched
}

TEST(RecomputeWords, RestoresOnlyWhatIsMissing) {
  Atlas whole = SynthesizeAtlas({.keyframes = 5, .points = 100});
  RecomputeWords(whole, Small().tree, Small().identity, {});
  Atlas holes = whole;
  holes.maps[0].keyframes[1].features.bag_of_words = {};
  holes.maps[0].keyframes[3].features.feature_vector = {};
  const RecomputeWordsReport report = RecomputeWords(holes, Small().tree, Small().identity, {.only_missing = true});
  EXPECT_EQ(report.recomputed, 2U);
  EXPECT_EQ(report.missing, 2U);
  EXPECT_EQ(report.equal, 0U);
  EXPECT_THAT(holes, EqualsAtlas(whole));
}

TEST(RecomputeWords, DoesNotMixVocabularies) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 3, .points = 100});
  atlas.maps[0].keyframes[1].features.bag_of_words = {};
  const Atlas before = atlas;
  try {
    RecomputeWords(atlas, Small().tree, Small().identity, {.only_missing = true});
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("another vocabulary"));
  }
  EXPECT_THAT(atlas, EqualsAtlas(before));
  for (KeyFrame& keyframe : atlas.maps[0].keyframes) keyframe.features.bag_of_words = {};
  EXPECT_EQ(RecomputeWords(atlas, Small().tree, Small().identity, {.only_missing = true}).missing, 3U);
}

class RealWords : public testing::TestWithParam<const char*> {};

// ORB-SLAM3 computed the words in these files.
TEST_P(RealWords, ComeOutToTheLastBit) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  const char* folder = std::getenv("SLAMDB_ATLASES");
  const std::string file = folder == nullptr ? "" : std::string(folder) + "/labvoc.txt";
  if (file.empty() || !std::filesystem::exists(file)) GTEST_SKIP() << "SLAMDB_ATLASES names no folder with labvoc.txt";
  static const LoadedVocabulary vocabulary = LoadVocabulary(file);
  const Atlas before = ReadAtlas(path);
  Atlas atlas = before;
  const RecomputeWordsReport report = RecomputeWords(atlas, vocabulary.tree, vocabulary.identity, {});
  EXPECT_EQ(report.recomputed, report.keyframes);
  EXPECT_EQ(report.equal, report.keyframes);
  EXPECT_THAT(atlas, EqualsAtlas(before));  // by bits, the name and checksum of the vocabulary too
}

INSTANTIATE_TEST_SUITE_P(Files, RealWords, testing::ValuesIn(kRealAtlases),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace slamdb
