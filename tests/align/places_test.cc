// SPDX-License-Identifier: BSD-3-Clause
// Recognising places: the inverted file, vocabularies that are trained, and candidates.
#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "slamdb/align/detail/train_vocabulary.h"
#include "slamdb/align/place_index.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/vocabulary_tree.h"
#include "tests/align/worlds.h"

namespace slamdb::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::FloatEq;
using ::testing::FloatNear;

BagOfWords RandomBag(std::mt19937& draws) {
  BagOfWords bag;
  const auto below = [&](std::uint32_t end) { return static_cast<std::uint32_t>(draws()) % end; };
  for (std::uint32_t word = below(5); word < 200; word += 1 + below(20)) {
    bag.words.push_back(word * 1'000'003);
    bag.weights.push_back(1 + below(9));
  }
  double sum = 0;
  for (const double weight : bag.weights) sum += weight;
  for (double& weight : bag.weights) weight /= sum;
  return bag;
}

// DBoW2's L1 score: 1 - |a - b| / 2 over all words.
double L1Score(const BagOfWords& a, const BagOfWords& b) {
  double difference = 0;
  const auto weight = [](const BagOfWords& bag, std::uint32_t word) {
    const auto at = std::ranges::find(bag.words, word);
    return at == bag.words.end() ? 0 : bag.weights[static_cast<std::size_t>(at - bag.words.begin())];
  };
  for (std::uint32_t number = 0; number < 200; ++number) {
    const std::uint32_t word = number * 1'000'003;
    difference += std::abs(weight(a, word) - weight(b, word));
  }
  return 1 - difference / 2;
}

TEST(PlaceIndex, ScoresAsBruteForceDoes) {
  std::mt19937 draws(3);
  std::vector<BagOfWords> bags;
  for (int i = 0; i < 40; ++i) bags.push_back(RandomBag(draws));
  std::vector<const BagOfWords*> pointers{nullptr};
  for (const BagOfWords& bag : bags) pointers.push_back(&bag);
  const PlaceIndex index{std::span(pointers)};
  ASSERT_EQ(index.size(), 41U);
  for (int i = 0; i < 20; ++i) {
    const BagOfWords asked = i == 0 ? bags[7] : RandomBag(draws);
    const std::vector<float> scores = index.Query(asked);
    EXPECT_EQ(scores[0], 0) << "no words, nothing in common";
    for (std::size_t row = 0; row < bags.size(); ++row)
      EXPECT_THAT(scores[row + 1], FloatNear(static_cast<float>(L1Score(asked, bags[row])), 1e-5F));
    if (i == 0) {
      EXPECT_THAT(scores[8], FloatNear(1, 1e-5F)) << "its own picture";
    }
  }
}

TEST(PlaceIndex, ColumnsOfDifferentLengthsAndNothingAtAll) {
  const BagOfWords torn{.words = {1, 2, 3}, .weights = {0.5}}, whole{.words = {1, 2}, .weights = {0.25, 0.75}};
  EXPECT_THAT(PlaceIndex(std::array{&torn, &whole}).Query(torn), ElementsAre(FloatEq(0.5F), FloatEq(0.25F)));
  EXPECT_THAT(PlaceIndex(std::array<const BagOfWords*, 1>{nullptr}).Query(whole), ElementsAre(0));
  EXPECT_THAT(PlaceIndex(std::span<const BagOfWords* const>()).Query(whole), ElementsAre());
}

// So many clusters of so many descriptors that differ from the cluster's own in a few bits.
std::vector<Descriptor> Clusters(std::size_t clusters, std::size_t members) {
  std::mt19937 draws(5);
  std::vector<Descriptor> descriptors;
  for (std::size_t cluster = 0; cluster < clusters; ++cluster) {
    Descriptor center;
    for (std::uint8_t& byte : center) byte = static_cast<std::uint8_t>(draws());
    for (std::size_t i = 0; i < members; ++i) {
      descriptors.push_back(center);
      for (int flip = 0; flip < 6; ++flip)
        descriptors.back()[draws() % 32] ^= static_cast<std::uint8_t>(1U << draws() % 8);
    }
  }
  return descriptors;
}

std::uint32_t WordOf(const VocabularyTree& tree, const Descriptor& descriptor) {
  return ComputeWords(tree, {descriptor}).bag_of_words.words.at(0);
}

TEST(TrainVocabulary, LooksOfOneThingAreOneWord) {
  constexpr std::size_t kMembers = 15;
  const std::vector<Descriptor> descriptors = Clusters(8, kMembers);
  const VocabularyTree tree = detail::TrainVocabulary(descriptors);
  std::size_t together = 0;
  for (std::size_t i = 0; i < descriptors.size(); ++i)
    together += WordOf(tree, descriptors[i]) == WordOf(tree, descriptors[i / kMembers * kMembers]) ? 1 : 0;
  EXPECT_GE(together, descriptors.size() * 9 / 10);
  EXPECT_GE(tree.word_count, 4U);
}

TEST(TrainVocabulary, IsATreeAsTheModelSays) {
  const std::vector<Descriptor> descriptors = Clusters(300, 5);
  const VocabularyTree tree = detail::TrainVocabulary(descriptors, 4, 3);
  ASSERT_EQ(tree.first_child.size(), tree.node_count() + 1);
  ASSERT_EQ(tree.descriptors.size(), tree.node_count());
  EXPECT_EQ(tree.children.size(), tree.node_count() - 1) << "all but the root are someone's child";
  std::uint32_t words = 0;
  for (std::size_t node = 0; node < tree.node_count(); ++node) {
    const std::uint32_t children = tree.first_child[node + 1] - tree.first_child[node];
    EXPECT_LE(children, 4U);
    EXPECT_EQ(children == 0, tree.words[node] != VocabularyTree::kNoWord);
    if (children == 0) {
      EXPECT_EQ(tree.words[node], words++);
    }
    for (std::uint32_t i = tree.first_child[node]; i < tree.first_child[node + 1]; ++i)
      EXPECT_GT(tree.children[i], node);
  }
  EXPECT_EQ(words, tree.word_count);
  EXPECT_LE(words, 64U);
}

TEST(TrainVocabulary, OfNothingOneThingAndEqualThings) {
  EXPECT_EQ(detail::TrainVocabulary({}).word_count, 1U);
  EXPECT_EQ(detail::TrainVocabulary(Clusters(1, 1)).word_count, 1U);
  EXPECT_EQ(detail::TrainVocabulary(std::vector<Descriptor>(500, Descriptor{})).word_count, 1U);
}

// Most first guesses are places that the asked keyframe truly sees.
TEST(FindCandidates, FindsPlacesByRecordedAndByTrainedWords) {
  const PreparedPair two(SmallPair());
  for (const bool own : {false, true}) {
    const std::array refs{MapRef{&two.sessions.atlas, 0}, MapRef{&two.sessions.atlas, 1}};
    const detail::PreparedMaps maps(refs, {.own_vocabulary = own, .threads = 1});
    EXPECT_EQ(maps.trained_words(), own);
    const auto candidates = detail::FindCandidates(maps[0].index, maps[0].groups, maps[1].bags, 1);
    ASSERT_GE(candidates.size(), 8U);
    EXPECT_TRUE(std::ranges::is_sorted(candidates, std::greater(), &detail::Candidate::score));
    std::size_t right = 0;
    for (std::size_t i = 0; i < 8; ++i) {
      const detail::View &a = maps[0].views.views()[candidates[i].first],
                         &b = maps[1].views.views()[candidates[i].second];
      right += a.axis().dot(two.truth().rotation * b.axis()) > 0.7 ? 1 : 0;
    }
    EXPECT_GE(right, 7U) << (own ? "trained" : "recorded");
  }
}

}  // namespace
}  // namespace slamdb::testing
