// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cstring>

#include "slamdb/base/error.h"
#include "slamdb/formats/dbow2/vocabulary.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/error_of.h"

namespace slamdb {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kText = SLAMDB_FIXTURES "/vocabulary/small.txt";
const std::string kBinary = SLAMDB_FIXTURES "/vocabulary/small.bin";
const std::string kBytes = " 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 255 ";

// Bytes in memory, which must outlive it.
Source File(const std::string& bytes) { return {std::as_bytes(std::span(bytes)), "vocabulary"}; }

// What loading says of a file that it refuses; "read" when it does not.
std::string Refusal(const std::string& bytes) {
  return RefusalOf([&] { static_cast<void>(LoadVocabulary(File(bytes), 2)); });
}

void ExpectSameTree(const VocabularyTree& a, const VocabularyTree& b) {
  EXPECT_EQ(a.word_count, b.word_count);
  EXPECT_EQ(a.descriptors, b.descriptors);
  EXPECT_EQ(a.weights, b.weights);
  EXPECT_EQ(a.words, b.words);
  EXPECT_EQ(a.first_child, b.first_child);
  EXPECT_EQ(a.children, b.children);
}

TEST(LoadVocabulary, ReadsTheTreeAsItIs) {
  const LoadedVocabulary small = LoadVocabulary(kText);
  EXPECT_EQ(small.identity.name, "small.txt");
  EXPECT_EQ(small.identity, ReadVocabularyFile(kText).identity);
  const VocabularyTree& tree = small.tree;
  EXPECT_EQ(tree.branching, 3);
  EXPECT_EQ(tree.depth, 3);
  EXPECT_EQ(tree.word_count, 27U);
  ASSERT_EQ(tree.node_count(), 40U);
  EXPECT_EQ(tree.words[0], VocabularyTree::kNoWord);
  EXPECT_EQ(tree.words[7], 0U);  // the first leaf: 0 -> 1 -> 4 -> 7
  EXPECT_EQ(tree.words[39], 26U);
  EXPECT_EQ(tree.weights[39], 6.75);
  const auto begin = tree.children.begin();
  EXPECT_THAT(std::vector(begin + tree.first_child[4], begin + tree.first_child[5]), ElementsAre(7, 8, 9));
  EXPECT_EQ(tree.first_child[39], tree.first_child[40]);
  EXPECT_EQ(tree.descriptors[2][7], 0x0f);
}

TEST(LoadVocabulary, BothEncodingsAndAnyThreadsGiveTheSameTree) {
  const VocabularyTree tree = LoadVocabulary(kText, 1).tree;
  ExpectSameTree(LoadVocabulary(kText, 3).tree, tree);
  ExpectSameTree(LoadVocabulary(kBinary, 3).tree, tree);
}

TEST(LoadVocabulary, TakesLineFeedsAtTheEndAndCarriageReturns) {
  const std::string text = ReadWhole(kText);
  const VocabularyTree tree = LoadVocabulary(kText).tree;
  const std::string feed = text + "\n";
  ExpectSameTree(LoadVocabulary(File(feed)).tree, tree);
  std::string windows;
  for (const char c : text) windows.append(c == '\n' ? "\r\n" : std::string(1, c));
  windows += "\r\n";
  ExpectSameTree(LoadVocabulary(File(windows)).tree, tree);
}

TEST(LoadVocabulary, TakesAByteOrderMark) {
  const std::string bytes = "\xef\xbb\xbf" + ReadWhole(kText);
  ExpectSameTree(LoadVocabulary(File(bytes)).tree, LoadVocabulary(kText).tree);
  const VocabularyFile marked = ReadVocabularyFile(File(bytes)), plain = ReadVocabularyFile(kText);
  ASSERT_TRUE(marked.shape && plain.shape);
  EXPECT_EQ(marked.shape->words, plain.shape->words);
  EXPECT_NE(marked.identity.checksum, plain.identity.checksum);  // ORB-SLAM3 hashes the bytes as they are
  EXPECT_THAT(Refusal(std::string("\xff\xfe"
                                  "3\0 \0",
                                  6)),
              HasSubstr("UTF-16"));
}

TEST(LoadVocabulary, ChildrenNeedNotStandTogether) {
  const std::string text =
      "2 2 0 0\n0 0" + kBytes + "0\n0 0" + kBytes + "0\n1 1" + kBytes + "1\n2 1" + kBytes + "2\n1 1" + kBytes + "3";
  const VocabularyTree tree = LoadVocabulary(File(text)).tree;
  EXPECT_THAT(tree.children, ElementsAre(1, 2, 3, 5, 4));
  EXPECT_THAT(tree.first_child, ElementsAre(0, 2, 4, 5, 5, 5, 5));
}

TEST(LoadVocabulary, NamesTheLineThatIsWrong) {
  const std::string head = "2 2 0 0\n0 0" + kBytes + "0\n";
  const std::string word = "1 1" + kBytes + "0.5\n";
  EXPECT_EQ(Refusal(head + word), "read");
  EXPECT_THAT(Refusal(head + "x 1" + kBytes + "0.5"), HasSubstr("line 3: expected the number of a parent"));
  EXPECT_THAT(Refusal(head + "1 2" + kBytes + "0.5\n" + word), HasSubstr("line 3: expected 1 for a word"));
  EXPECT_THAT(Refusal(head + "1 1 256 2 3\n" + word), HasSubstr("line 3: expected a descriptor"));
  EXPECT_THAT(Refusal(head + word + "1 1 1 2 3 4 5 0.5"), HasSubstr("line 4: expected a descriptor"));
  EXPECT_THAT(Refusal(head + word + "\n" + word), HasSubstr("line 4: expected the number of a parent"));
  EXPECT_THAT(Refusal(head + "1 1" + kBytes + "\n"), HasSubstr("line 3: expected a weight"));
  EXPECT_THAT(Refusal(head + "1 1" + kBytes + "0.5 7\n"), HasSubstr("line 3: expected the end"));
  EXPECT_THAT(Refusal(head + "1 1" + kBytes + "nan\n"), HasSubstr("line 3: the weight of node 2"));
  EXPECT_THAT(Refusal(head + "1 1" + kBytes + "inf\n"), HasSubstr("line 3: the weight of node 2"));
  EXPECT_THAT(Refusal(head + "1 1" + kBytes + "-1\n"), HasSubstr("line 3: the weight of node 2"));
}

TEST(LoadVocabulary, RefusesWhatIsNoTree) {
  const std::string inner = " 0" + kBytes + "0\n", word = " 1" + kBytes + "0.5\n";
  EXPECT_THAT(Refusal("2 2 0 0\n2" + inner + "1" + inner + "1" + word), HasSubstr("line 2: the parent of node 1 is 2"));
  EXPECT_THAT(Refusal("2 2 0 0\n1" + inner + "1" + word), HasSubstr("line 2: the parent of node 1 is 1"));
  EXPECT_THAT(Refusal("2 2 0 0\n0" + word + "1" + word),
              HasSubstr("line 3: node 2 is a child of node 1, which is a word"));
  EXPECT_THAT(Refusal("2 2 0 0\n0" + inner + "0" + word), HasSubstr("line 2: node 1 is no word and has no children"));
  EXPECT_THAT(Refusal("2 1 0 0\n0" + inner + "1" + word), HasSubstr("line 3: node 2 is deeper than the 1 levels"));
  EXPECT_EQ(Refusal("2 1 0 0\n0" + word + "0" + word + "0" + word), "read");  // see schema/vocabulary.md
  EXPECT_THAT(Refusal("2 1 0 0\n0" + word + "0" + word + "0" + word + "0" + word),
              HasSubstr("line 5: node 0 has more than the 2 children"));
}

TEST(LoadVocabulary, RefusesOtherFilesByName) {
  EXPECT_THAT(Refusal(""), HasSubstr("is empty"));
  EXPECT_THAT(Refusal("2 1 0 0\n"), HasSubstr("without words"));
  EXPECT_THAT(Refusal("\x1f\x8b\x08 and so on"), HasSubstr("compressed"));
  EXPECT_THAT(Refusal("%YAML:1.0\n---\nvocabulary:\n"), HasSubstr("YAML"));
  EXPECT_THAT(Refusal("to be or not\nto be\n"), HasSubstr("no DBoW2 vocabulary"));
  EXPECT_THAT(Refusal("10 6 9 0\n"), HasSubstr("no DBoW2 vocabulary"));
  EXPECT_THAT(Refusal("10 6 0 0\n" + std::string(100'000, '\n') + "x"), HasSubstr("too short for a node each"));
}

TEST(LoadVocabulary, RefusesDamagedBinaryFiles) {
  const std::string whole = ReadWhole(kBinary);
  EXPECT_THAT(Refusal(whole.substr(0, whole.size() - 41)), HasSubstr("truncated"));
  EXPECT_THAT(Refusal(whole + std::string(41, '\0')), HasSubstr("announces 40 nodes"));
  std::string bad = whole;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(bad.data() + 24 + 41 * 6 + 36, &nan, sizeof nan);
  EXPECT_THAT(Refusal(bad), HasSubstr("byte 270: the weight of node 7"));
  bad = whole;
  bad[24] = '\x7f';
  EXPECT_THAT(Refusal(bad), HasSubstr("byte 24: the parent of node 1 is 127"));
}

TEST(LoadVocabulary, AnyCutAndAnyFlipIsLoadedOrRefused) {
  for (const std::string& path : {kText, kBinary}) {
    const std::string whole = ReadWhole(path);
    for (std::size_t size = 0; size < whole.size(); size += 7) Refusal(whole.substr(0, size));
    for (std::size_t at = 0; at < whole.size(); at += 5) {
      std::string flipped = whole;
      flipped[at] = static_cast<char>(flipped[at] ^ 0x15);
      Refusal(flipped);
    }
  }
}

}  // namespace
}  // namespace slamdb
