// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/words/mend.h"

#include <gmock/gmock.h>

#include "slamdb/checks/check.h"
#include "slamdb/edit/words/words.h"
#include "slamdb/formats/dbow2/vocabulary.h"
#include "slamdb/model/vocabulary.h"
#include "tests/support/corrupt.h"
#include "tests/support/kind_of.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const LoadedVocabulary& Small() {
  static const LoadedVocabulary vocabulary = LoadVocabulary(std::string(SLAMDB_FIXTURES) + "/vocabulary/small.txt");
  return vocabulary;
}

MendWordsOptions WithSmall(bool damaged = false) {
  return {.tree = &Small().tree, .identity = Small().identity, .damaged = damaged, .threads = 2};
}

// A sound atlas whose words are of the small vocabulary.
Atlas WithWords() {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  RecomputeWords(atlas, Small().tree, Small().identity);
  return atlas;
}

Features& SomeFeatures(Atlas& atlas) { return atlas.maps[0].keyframes[4].features; }
KeyFrameId SomeId(const Atlas& atlas) { return atlas.maps[0].keyframes[4].id; }

TEST(MendWords, LeavesSoundWordsAlone) {
  Atlas atlas = WithWords();
  EXPECT_FALSE(MendWords(atlas, WithSmall()).changed());
  EXPECT_FALSE(MendWords(atlas, WithSmall(true)).changed());
  EXPECT_FALSE(MendWords(atlas, {.damaged = true}).changed());
  Atlas synthetic = SoundAtlas(Base::kRgbd);
  EXPECT_FALSE(MendWords(synthetic, {.damaged = true}).changed());
}

using Damage = void (*)(Features&);
constexpr Damage kDamages[] = {
    [](Features& features) { std::swap(features.bag_of_words.words[0], features.bag_of_words.words[1]); },
    [](Features& features) { features.bag_of_words.words.back() = 537095194; },
    [](Features& features) { features.bag_of_words.words.back() = 27; },
    [](Features& features) { features.bag_of_words.weights[0] += 0.25; },
    [](Features& features) { features.bag_of_words.weights[0] = std::numeric_limits<double>::quiet_NaN(); },
    [](Features& features) { features.bag_of_words.weights[0] = -features.bag_of_words.weights[0]; },
    [](Features& features) { features.bag_of_words = {}; },
    [](Features& features) { features.feature_vector.features[0] = 1 << 20; },
    [](Features& features) { features.feature_vector.features[1] = features.feature_vector.features[0]; },
    [](Features& features) { ++features.feature_vector.sizes[0]; },
};

class DamagedWords : public ::testing::TestWithParam<std::size_t> {};

TEST_P(DamagedWords, AreComputedAnewWithTheVocabulary) {
  const Atlas original = WithWords();
  Atlas atlas = original;
  kDamages[GetParam()](SomeFeatures(atlas));
  const MendWordsReport report = MendWords(atlas, WithSmall());
  EXPECT_THAT(report.recomputed, ElementsAre(SomeId(atlas)));
  EXPECT_TRUE(SomeFeatures(atlas).bag_of_words == original.maps[0].keyframes[4].features.bag_of_words);
  EXPECT_TRUE(SomeFeatures(atlas).feature_vector == original.maps[0].keyframes[4].features.feature_vector);
}

TEST_P(DamagedWords, AreDroppedAndNamedWithoutIt) {
  Atlas atlas = WithWords();
  kDamages[GetParam()](SomeFeatures(atlas));
  const MendWordsReport report = MendWords(atlas, {.damaged = true});
  EXPECT_THAT(report.dropped, ElementsAre(SomeId(atlas)));
  EXPECT_THAT(SomeFeatures(atlas).bag_of_words.words, IsEmpty());
  EXPECT_THAT(SomeFeatures(atlas).feature_vector.nodes, IsEmpty());
  EXPECT_THAT(SentencesOf(report), ElementsAre(HasSubstr("(" + ToString(SomeId(atlas)) + ") dropped")));
}

INSTANTIATE_TEST_SUITE_P(Kinds, DamagedWords, ::testing::Range(std::size_t{0}, std::size(kDamages)));

TEST(MendWords, DropsAWordFarAboveAllOthersOfAnUnknownVocabulary) {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  atlas.vocabulary = {"other.txt", "00112233445566778899aabbccddeeff"};
  EXPECT_FALSE(MendWords(atlas, {.damaged = true}).changed());
  SomeFeatures(atlas).bag_of_words.words.back() = 3'000'000;
  EXPECT_FALSE(CheckAtlas(atlas).ok());
  EXPECT_THAT(MendWords(atlas, {.damaged = true}).dropped, ElementsAre(SomeId(atlas)));
  EXPECT_TRUE(CheckAtlas(atlas).ok());
}

// `shrink --for localization` drops features, and keeps the words that they had.
TEST(MendWords, KeepsWordsOfFeaturesThatWereDropped) {
  Atlas atlas = WithWords();
  SomeFeatures(atlas).descriptors.pop_back();
  const std::size_t words = SomeFeatures(atlas).bag_of_words.words.size();
  SomeFeatures(atlas).feature_vector = ComputeWords(Small().tree, SomeFeatures(atlas).descriptors).feature_vector;
  EXPECT_FALSE(MendWords(atlas, WithSmall()).changed());
  EXPECT_EQ(SomeFeatures(atlas).bag_of_words.words.size(), words);
}

TEST(MendWords, RestoresADamagedChecksum) {
  Atlas atlas = WithWords();
  atlas.vocabulary.checksum[7] = atlas.vocabulary.checksum[7] == '0' ? '1' : '0';
  Atlas known = atlas;
  EXPECT_TRUE(MendWords(atlas, WithSmall(true)).restored_vocabulary);
  EXPECT_EQ(atlas.vocabulary, Small().identity);
  EXPECT_TRUE(MendWords(known, {.damaged = true}).restored_vocabulary);
  EXPECT_EQ(known.vocabulary, Small().identity);
}

TEST(MendWords, RefusesAnotherVocabulary) {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  const Vocabulary before = atlas.vocabulary;
  EXPECT_EQ(KindOf([&] { MendWords(atlas, WithSmall()); }), ErrorKind::kNotPossible);
  EXPECT_EQ(atlas.vocabulary, before);
}

TEST(KnownVocabularies, AreFoundByTheirChecksum) {
  EXPECT_EQ(KnownWords({"any name", "5420bad0713bc97034dd2a9b2f0cc387"}), 971'815u);
  EXPECT_EQ(KnownWords(Small().identity), Small().tree.word_count);
  EXPECT_EQ(KnownWords({"ORBvoc.txt", "d41d8cd98f00b204e9800998ecf8427e"}), std::nullopt);
}

}  // namespace
}  // namespace slamdb
