// SPDX-License-Identifier: BSD-3-Clause
// Words beyond the vocabulary, which make ORB-SLAM3 crash when it loads an atlas, in every verb that may meet them.
#include <gmock/gmock.h>

#include "slamdb/formats/formats.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const std::string kVocabulary = SLAMDB_FIXTURES "/vocabulary/small.txt";

class DamagedWords : public ::testing::Test {
 protected:
  std::string In(const std::string& name) const { return folder_ / name; }

  // An atlas whose words are of the small vocabulary, but for one.
  void SetUp() override {
    ASSERT_EQ(RunSlamdb({"synthesize", In("sound.osa"), "--vocabulary", kVocabulary}).exit_code, 0);
    Atlas atlas = ReadAtlas(In("sound.osa"));
    atlas.maps[0].keyframes[5].features.bag_of_words.words.back() = 537095194;
    WriteAtlas(atlas, In("damaged.osa"));
    EXPECT_EQ(RunSlamdb({"check", In("damaged.osa")}).exit_code, 1);
  }
  void ExpectSound(const std::string& name) const {
    EXPECT_EQ(RunSlamdb({"check", In(name), "--vocabulary", kVocabulary}).exit_code, 0);
  }
  void ExpectAsBefore(const std::string& name) const {
    EXPECT_TRUE(ReadWholeFile(In(name)) == ReadWholeFile(In("sound.osa")));
  }

  TemporaryFolder folder_;
};

TEST_F(DamagedWords, AreDroppedAndNamedByRecover) {
  const ProcessResult result = RunSlamdb({"recover", In("damaged.osa"), In("out.osa")});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_THAT(result.out, HasSubstr("the words of 1 keyframe (kf 5) dropped"));
  EXPECT_THAT(result.out, HasSubstr("`slamdb vocabulary recompute`"));
  ExpectSound("out.osa");
  EXPECT_EQ(
      RunSlamdb({"vocabulary", "recompute", In("out.osa"), In("again.osa"), "--missing", "--vocabulary", kVocabulary})
          .exit_code,
      0);
  ExpectAsBefore("again.osa");
}

TEST_F(DamagedWords, ComeBackWithTheVocabulary) {
  EXPECT_EQ(RunSlamdb({"recover", In("damaged.osa"), In("out.osa"), "--vocabulary", kVocabulary}).exit_code, 3);
  ExpectAsBefore("out.osa");
  EXPECT_EQ(RunSlamdb({"recover", In("sound.osa"), In("copy.osa"), "--vocabulary", kVocabulary}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"repair", In("damaged.osa"), In("repaired.osa"), "--vocabulary", kVocabulary, "--journal",
                       In("fix.json")})
                .exit_code,
            0);
  ExpectAsBefore("repaired.osa");
  EXPECT_EQ(RunSlamdb({"repair", "--undo", In("fix.json"), In("repaired.osa"), In("undone.osa")}).exit_code, 0);
  EXPECT_TRUE(ReadWholeFile(In("undone.osa")) == ReadWholeFile(In("damaged.osa")));
}

TEST_F(DamagedWords, AreDroppedByRepairAndSanitize) {
  EXPECT_EQ(RunSlamdb({"repair", In("damaged.osa"), In("repaired.osa")}).exit_code, 0);
  ExpectSound("repaired.osa");
  const ProcessResult result = RunSlamdb({"convert", In("damaged.osa"), In("safe.osa"), "--sanitize"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("repaired: words are in the vocabulary (1 change)"));
  ExpectSound("safe.osa");
}

TEST_F(DamagedWords, AreToldByVerbsThatChangeAnAtlas) {
  const ProcessResult told =
      RunSlamdb({"merge", In("damaged.osa"), In("sound.osa"), "-o", In("both.osa"), "--on-conflict", "renumber"});
  EXPECT_THAT(told.err, HasSubstr("damaged.osa has 1 error, the first of word-range; `slamdb repair`"));
  EXPECT_THAT(told.err, Not(HasSubstr("sound.osa has")));
  const ProcessResult mended = RunSlamdb(
      {"shrink", In("damaged.osa"), In("small.osa"), "--target-keyframes", "10", "--vocabulary", kVocabulary});
  EXPECT_EQ(mended.exit_code, 0) << mended.err;
  ExpectSound("small.osa");
  EXPECT_EQ(
      RunSlamdb({"merge", In("damaged.osa"), In("sound.osa"), "-o", In("both.osa"), "-O", "--vocabulary", kVocabulary})
          .exit_code,
      0);
  ExpectSound("both.osa");
}

TEST_F(DamagedWords, OfAnotherVocabularyAreRefused) {
  const std::string other = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa";
  const ProcessResult result = RunSlamdb({"repair", other, In("out.osa"), "--vocabulary", kVocabulary});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("of another vocabulary"));
  const ProcessResult made_up = RunSlamdb({"synthesize", In("made_up.osa")});
  EXPECT_THAT(made_up.err, HasSubstr("note: its words are of no vocabulary"));
  EXPECT_EQ(made_up.out.find('\\'), std::string::npos) << made_up.out;
}

}  // namespace
}  // namespace slamdb::testing
