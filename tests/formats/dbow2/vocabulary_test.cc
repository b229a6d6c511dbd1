// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/dbow2/vocabulary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slamdb/base/error.h"
#include "tests/formats/orbslam3/real_atlases.h"

namespace slamdb {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

VocabularyFile ReadBytes(const std::string& name, const std::string& bytes) {
  return ReadVocabularyFile({std::as_bytes(std::span(bytes)), name});
}

TEST(ReadVocabularyFile, GivesNameChecksumAndShape) {
  const VocabularyFile file =
      ReadBytes("three.txt", "10 6 0 0 \n0 0 1 2 3 0\n1 1 4 5 6 0.5\n1 1 7 8 9 0.25\n0 1 1 1 1 2\n");
  EXPECT_EQ(file.identity.name, "three.txt");
  EXPECT_EQ(file.identity.checksum.size(), 32U);
  ASSERT_TRUE(file.shape.has_value());
  EXPECT_EQ(file.shape->branching, 10);
  EXPECT_EQ(file.shape->depth, 6);
  EXPECT_EQ(file.shape->scoring, "L1");
  EXPECT_EQ(file.shape->weighting, "TF-IDF");
  EXPECT_EQ(file.shape->words, 3U);
}

TEST(ReadVocabularyFile, ChecksumsOfKnownTexts) {  // RFC 1321, appendix A.5
  EXPECT_EQ(ReadBytes("empty", "").identity.checksum, kChecksumOfNothing);
  EXPECT_EQ(ReadBytes("abc", "abc").identity.checksum, "900150983cd24fb0d6963f7d28e17f72");
}

TEST(ReadVocabularyFile, AnotherKindOfFileHasNoShape) {
  EXPECT_FALSE(ReadBytes("binary", std::string("\x01\x02\0\xff garbage", 12)).shape.has_value());
  EXPECT_FALSE(ReadBytes("prose", "to be or not\nto be\n").shape.has_value());
}

TEST(ReadVocabularyFile, MissingFileIsAnError) {
  EXPECT_THROW(static_cast<void>(ReadVocabularyFile("/nowhere/ORBvoc.txt")), Error);
}

TEST(ReadVocabularyFile, TheRealOneMatchesTheRealAtlases) {
  const char* folder = std::getenv("SLAMDB_ATLASES");
  const std::string path = folder == nullptr ? "" : std::string(folder) + "/labvoc.txt";
  if (path.empty() || !std::filesystem::exists(path))
    GTEST_SKIP() << "labvoc.txt: SLAMDB_ATLASES does not name a folder that holds it";
  const VocabularyFile file = ReadVocabularyFile(path);
  EXPECT_EQ(file.identity.checksum, "6cfd24abfaccea29d49a8d99d874d41d");  // as in the atlases made with it
  EXPECT_EQ(file.shape->words, 405448U);
}

TEST(VocabularyMismatch, ComparesChecksumsAlone) {
  EXPECT_THAT(VocabularyMismatch({"a.txt", "12"}, {"b.txt", "12"}), IsEmpty());
  EXPECT_THAT(VocabularyMismatch({"a.txt", "12"}, {"a.txt", "13"}), HasSubstr("checksum differs"));
  EXPECT_THAT(VocabularyMismatch({"a.txt", ""}, {"a.txt", "13"}), HasSubstr("has no checksum"));
  EXPECT_THAT(VocabularyMismatch({"a.txt", kChecksumOfNothing}, {"a.txt", "13"}), HasSubstr("empty file"));
}

}  // namespace
}  // namespace slamdb
