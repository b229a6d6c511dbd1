// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kTiny = SLAMDB_FIXTURES "/tiny/tiny.osa";
// A root with two words: parent, leaf?, 32 descriptor bytes, weight.
const std::string kVocabulary =
    "2 1 0 0\n"
    "0 1 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32 0.5\n"
    "0 1 9 8 7 6 5 4 3 2 1 0 9 8 7 6 5 4 3 2 1 0 9 8 7 6 5 4 3 2 1 0 9 8 0.25\n";

TEST(Vocabulary, ShowsAtlasesAndVocabularyFiles) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "voc.txt", kVocabulary);
  const ProcessResult result = RunSlamdb({"vocabulary", "show", kTiny, folder / "voc.txt", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "vocabulary.schema.json"), "");
  EXPECT_EQ(report["inputs"][0]["kind"], "atlas");
  EXPECT_EQ(report["inputs"][1]["kind"], "vocabulary");
  EXPECT_EQ(report["inputs"][1]["vocabulary"]["name"], "voc.txt");
  EXPECT_EQ(report["inputs"][1]["shape"]["words"], 2);
  EXPECT_THAT(RunSlamdb({"vocabulary", "show", folder / "voc.txt"}).out, HasSubstr("words      2\n"));
}

TEST(Vocabulary, SetThenVerify) {
  const TemporaryFolder folder;
  const std::string vocabulary = folder / "voc.txt", stamped = folder / "stamped.osa";
  WriteWholeFile(vocabulary, kVocabulary);
  const ProcessResult before = RunSlamdb({"vocabulary", "verify", kTiny, "--vocabulary", vocabulary});
  EXPECT_EQ(before.exit_code, 1);
  EXPECT_THAT(before.out, HasSubstr("checksum"));
  ASSERT_EQ(RunSlamdb({"vocabulary", "set", kTiny, stamped, "--vocabulary", vocabulary}).exit_code, 0);
  const ProcessResult after = RunSlamdb({"vocabulary", "verify", stamped, "--vocabulary", vocabulary});
  EXPECT_EQ(after.exit_code, 0) << after.out;
  EXPECT_THAT(after.out, HasSubstr("matches voc.txt"));
}

TEST(Vocabulary, SetChangesNothingElse) {
  const TemporaryFolder folder;
  const json report = json::parse(RunSlamdb({"info", "--json", kTiny}).out);
  const std::string name = report["vocabulary"]["name"], checksum = report["vocabulary"]["checksum"];
  for (const std::string& source : {kTiny, std::string(SLAMDB_FIXTURES "/tiny/tiny_text.osa")}) {
    ASSERT_EQ(RunSlamdb({"vocabulary", "set", source, folder / "other.osa", "-O", "--name", "x", "--checksum",
                         "0123456789abcdef0123456789abcdef"})
                  .exit_code,
              0);
    EXPECT_NE(ReadWholeFile(folder / "other.osa"), ReadWholeFile(source));
    ASSERT_EQ(RunSlamdb({"vocabulary", "set", folder / "other.osa", folder / "back.osa", "-O", "--name", name,
                         "--checksum", checksum})
                  .exit_code,
              0);
    EXPECT_EQ(ReadWholeFile(folder / "back.osa"), ReadWholeFile(source));
  }
}

TEST(Vocabulary, SetNeedsSomethingToSet) {
  EXPECT_EQ(RunSlamdb({"vocabulary", "set", kTiny, "out.osa"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"vocabulary", "set", kTiny, "out.osa", "--checksum", "XYZ"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"vocabulary", "verify", kTiny}).exit_code, 2);
}

TEST(Vocabulary, MissingVocabularyFile) {
  const ProcessResult result = RunSlamdb({"vocabulary", "verify", kTiny, "--vocabulary", "/nowhere/voc.txt"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("/nowhere/voc.txt"));
}

TEST(Vocabulary, RecomputeMovesAMapToAnotherVocabulary) {
  const TemporaryFolder folder;
  const std::string vocabulary = SLAMDB_FIXTURES "/vocabulary/small.txt", moved = folder / "moved.osa";
  const ProcessResult result =
      RunSlamdb({"vocabulary", "recompute", kTiny, moved, "--vocabulary", vocabulary, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "vocabulary-recompute.schema.json"), "");
  EXPECT_EQ(report["recomputed"], 2);
  EXPECT_EQ(report["vocabulary"]["after"]["name"], "small.txt");
  EXPECT_EQ(RunSlamdb({"vocabulary", "verify", moved, "--vocabulary", vocabulary}).exit_code, 0);
  const ProcessResult again = RunSlamdb({"vocabulary", "recompute", moved, "--vocabulary", vocabulary, "--dry-run"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("as they were  2"));
}

// Maps of other programs have descriptors, and no words: what helps is said where they are missing, and is no repair.
TEST(Vocabulary, RecomputeMakesTheWordsOfImportedMaps) {
  const TemporaryFolder folder;
  const std::string vocabulary = SLAMDB_FIXTURES "/vocabulary/small.txt";
  const std::string atlas = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa";
  ASSERT_EQ(RunSlamdb({"convert", atlas, folder / "a.msg", "-q"}).exit_code, 3);
  EXPECT_THAT(RunSlamdb({"convert", folder / "a.msg", folder / "b.osa"}).err,
              HasSubstr("bags of words stay empty until `slamdb vocabulary recompute` makes them"));
  for (const char* input : {"a.msg", "b.osa"}) {
    SCOPED_TRACE(input);
    const std::string output = folder / (std::string(input) + ".osa");
    const ProcessResult result =
        RunSlamdb({"vocabulary", "recompute", folder / input, output, "--vocabulary", vocabulary});
    EXPECT_NE(result.exit_code, 1) << result.err;
    EXPECT_THAT(result.err, Not(HasSubstr("`slamdb repair` it first")));
    EXPECT_EQ(RunSlamdb({"check", output, "-q"}).exit_code, 0);
  }
}

TEST(Vocabulary, RecomputeRefusesBadVocabulariesAndWritesNothing) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "bad.txt", "2 1 0 0\n0 1 1 2 3\n");
  const std::string out = folder / "out.osa";
  const ProcessResult bad = RunSlamdb({"vocabulary", "recompute", kTiny, out, "--vocabulary", folder / "bad.txt"});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_THAT(bad.err, HasSubstr("bad.txt: line 2: "));
  const ProcessResult mixed = RunSlamdb(
      {"vocabulary", "recompute", kTiny, out, "--missing", "--vocabulary", SLAMDB_FIXTURES "/vocabulary/small.txt"});
  EXPECT_EQ(mixed.exit_code, 1);
  EXPECT_THAT(mixed.err, HasSubstr("another vocabulary"));
  EXPECT_EQ(RunSlamdb({"vocabulary", "recompute", kTiny, out}).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace slamdb::testing
