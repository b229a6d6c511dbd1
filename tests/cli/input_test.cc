// SPDX-License-Identifier: BSD-3-Clause
//
// What an input may be, what is said of others, and how what is in them is shown.
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <thread>

#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using std::string_literals::operator""s;

const std::string kTiny = SLAMDB_FIXTURES "/tiny/tiny.osa";
const std::string kSmall = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa";

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

// An atlas as a transfer in text mode leaves it.
std::string WithCarriageReturns(const std::string& bytes) { return Replaced(bytes, "\n", "\r\n"); }

// Bytes taken for Latin-1 text and written as UTF-8.
std::string AsUtf8(const std::string& bytes) {
  std::string text;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80)
      text += c;
    else
      text += {static_cast<char>(0xc0 | byte >> 6), static_cast<char>(0x80 | (byte & 0x3f))};
  }
  return text;
}

// Bytes taken for UTF-8, with U+FFFD for those that are none, as decoders that replace errors leave them.
std::string Decoded(const std::string& bytes) {
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const auto byte = static_cast<unsigned char>(bytes[i]);
    const bool pair = byte >= 0xc2 && byte < 0xe0 && i + 1 < bytes.size() &&
                      (static_cast<unsigned char>(bytes[i + 1]) & 0xc0) == 0x80;
    if (byte < 0x80 || pair)
      text += bytes.substr(i, pair ? 2 : 1);
    else
      text += "\xef\xbf\xbd";
    i += pair;
  }
  return text;
}

// A FIFO with a program that writes a file into it.
class Fifo {
 public:
  Fifo(const TemporaryFolder& folder, const std::string& file)
      : path_(folder / "fifo"),
        made_(::mkfifo(path_.c_str(), 0600)),
        writer_([this, file] { std::ofstream(path_, std::ios::binary) << ReadWholeFile(file); }) {}
  ~Fifo() { writer_.join(); }
  const std::string& path() const { return path_; }

 private:
  const std::string path_;
  const int made_;
  std::thread writer_;
};

TEST(Inputs, StandardInputTellsItsFormat) {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"info", "-"}, {"show", "-", "map/0"}, {"vocabulary", "show", "-"}}) {
    const ProcessResult result = RunSlamdb(words, ReadWholeFile(kTiny));
    EXPECT_EQ(result.exit_code, 0) << words[0] << result.err;
  }
  const TemporaryFolder folder;
  EXPECT_EQ(RunSlamdb({"convert", "-", folder / "out.osa"}, ReadWholeFile(kTiny)).exit_code, 0);
  EXPECT_EQ(ReadWholeFile(folder / "out.osa"), ReadWholeFile(kTiny));
}

TEST(Inputs, MayBeFifos) {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"info"}, {"vocabulary", "show"}, {"dump"}}) {
    const TemporaryFolder folder;
    const Fifo fifo(folder, kTiny);
    std::vector<std::string> command = words;
    command.push_back(fifo.path());
    const ProcessResult result = RunSlamdb(command);
    EXPECT_EQ(result.exit_code, 0) << words[0] << result.err;
  }
}

TEST(Inputs, FifosMayBeTablesAndVocabulariesToo) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "move.txt", "1 2 3 0 0 0 1\n");
  {
    const Fifo fifo(folder, folder / "move.txt");
    EXPECT_EQ(RunSlamdb({"transform", kTiny, folder / "moved.osa", "--by", fifo.path()}).exit_code, 0);
  }
  std::filesystem::remove(folder / "fifo");
  WriteWholeFile(folder / "voc.txt", "10 6  0 0\n0 1" + Replaced(std::string(32, 'x'), "x", " 7") + " 0.5\n");
  const Fifo fifo(folder, folder / "voc.txt");
  EXPECT_EQ(RunSlamdb({"vocabulary", "set", kTiny, folder / "set.osa", "--vocabulary", fifo.path()}).exit_code, 0);
}

TEST(Inputs, AFifoWithoutAWriterIsAnError) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "fifo").c_str(), 0600), 0);
  for (const char* verb : {"info", "list"}) {
    const ProcessResult result = RunSlamdb({verb, folder / "fifo"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, HasSubstr("is a FIFO that nothing writes into"));
  }
  for (const char* verb : {"stats", "vacuum"})
    EXPECT_THAT(RunSlamdb({verb, folder / "fifo"}).err, HasSubstr("a store is a file; it cannot be a FIFO")) << verb;
}

TEST(Inputs, EndlessOnesAreRefusedByTheirBeginning) {
  const TemporaryFolder folder;
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"info", "/dev/zero"},
           {"check", "/dev/urandom"},
           {"recover", "/dev/zero", folder / "out.osa"},
           {"vocabulary", "show", "/dev/zero"},
           {"vocabulary", "set", kTiny, folder / "out.osa", "--vocabulary", "/dev/zero"},
           {"transform", kTiny, folder / "out.osa", "--by", "/dev/zero"},
           {"convert", "/dev/zero", folder / "out.osa", "--from", "orbslam3"}}) {
    const ProcessResult result = RunSlamdb(words);
    EXPECT_EQ(result.exit_code, 1) << words[0];
    EXPECT_THAT(result.err, StartsWith("slamdb: error: /dev/")) << words[0];
    EXPECT_THAT(result.err, Not(HasSubstr("GiB"))) << words[0];
  }
}

TEST(Inputs, EmptyOnesAreRefusedAsEmpty) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "empty.txt", "");
  for (const char* format : {"tum", "euroc", "orbslam3", "orbslam3-text", "store", "mrpt"})
    EXPECT_THAT(RunSlamdb({"info", folder / "empty.txt", "--from", format}).err, HasSubstr("empty.txt: is empty"))
        << format;
  EXPECT_THAT(RunSlamdb({"info", "-", "--from", "tum"}).err, HasSubstr("-: is empty"));
  EXPECT_THAT(RunSlamdb({"info", "/dev/null"}).err, HasSubstr("/dev/null: is empty"));
  EXPECT_THAT(RunSlamdb({"repair", "--undo", folder / "empty.txt", kTiny, folder / "out.osa"}).err,
              HasSubstr("empty.txt: is empty"));
}

// A pipe may take a few times its bytes, whatever the machine has.
TEST(Inputs, PipesWorkUnderALimitOfAddresses) {
  const std::string kilobytes = std::to_string(ReadWholeFile(kSmall).size() * 4 / 1024 + 300'000);
  const ProcessResult result = RunProgram(
      {"sh", "-c", "ulimit -v " + kilobytes + "; exec " SLAMDB_COMMAND " info - --threads 2"}, ReadWholeFile(kSmall));
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST(Inputs, TrajectoriesAreNoAtlases) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "poses.tum", "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n");
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"check", folder / "poses.tum"},
                                             {"repair", folder / "poses.tum", folder / "out.osa"},
                                             {"cull", folder / "poses.tum", folder / "out.osa"},
                                             {"vocabulary", "show", folder / "poses.tum"}}) {
    const ProcessResult result = RunSlamdb(words);
    EXPECT_EQ(result.exit_code, 1) << words[0];
    EXPECT_THAT(result.err, HasSubstr("is a TUM trajectory; an atlas is needed")) << words[0];
  }
  EXPECT_EQ(RunSlamdb({"info", folder / "poses.tum"}).exit_code, 0);
}

// They have no repair, so nobody is told to repair them.
TEST(Inputs, TrajectoriesAreNotToldToBeRepaired) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunSlamdb({"convert", kTiny, folder / "poses.tum"}).exit_code, 0);
  const std::string poses = folder / "poses.tum";
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"transform", poses, folder / "out.tum", "-O", "--by", "1 0 0 0 0 0 1"},
                                             {"extract", poses, folder / "out.tum", "-O", "--every", "2"},
                                             {"renumber", poses, folder / "out.tum", "-O"},
                                             {"merge", poses, poses, "-o", folder / "out.tum", "-O"}}) {
    const ProcessResult result = RunSlamdb(words);
    EXPECT_EQ(result.exit_code, 0) << words[0] << result.err;
    EXPECT_THAT(result.err, Not(HasSubstr("slamdb repair"))) << words[0];
  }
}

TEST(Inputs, WhatIsNoVocabularyIsNotStamped) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "pointer.txt", "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12\n");
  WriteWholeFile(folder / "page.txt", "<!DOCTYPE html>\n<html>");
  WriteWholeFile(folder / "empty.txt", "");
  WriteWholeFile(folder / "packed.txt", "\x1f\x8b\x08");
  const auto set = [&](const std::string& file, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"vocabulary", "set", kTiny, folder / "out.osa", "-O", "--vocabulary", file};
    words.insert(words.end(), more.begin(), more.end());
    return RunSlamdb(words);
  };
  for (const auto& [file, says] : {std::pair{"pointer.txt", "this is a Git LFS pointer"},
                                   {"page.txt", "this is a web page"},
                                   {"empty.txt", "is empty"},
                                   {"packed.txt", "this is gzip-compressed"}}) {
    const ProcessResult refused = set(folder / file, {});
    EXPECT_EQ(refused.exit_code, 1) << file;
    EXPECT_THAT(refused.err, HasSubstr(says));
    EXPECT_THAT(RunSlamdb({"vocabulary", "verify", kTiny, "--vocabulary", folder / file}).err, HasSubstr(says));
    EXPECT_THAT(RunSlamdb({"vocabulary", "recompute", kTiny, folder / "r.osa", "--vocabulary", folder / file}).err,
                HasSubstr(says));
    EXPECT_EQ(set(folder / file, {"--force"}).exit_code, 0) << file;
  }
  EXPECT_THAT(set(kTiny, {}).err, HasSubstr("this is an atlas of ORB-SLAM3"));
}

TEST(Inputs, JournalsAndReportsAreNoAtlases) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "report.json", RunSlamdb({"info", kTiny, "--json"}).out);
  EXPECT_THAT(RunSlamdb({"info", folder / "report.json"}).err, HasSubstr("this is a report of slamdb (slamdb-info-2)"));
  EXPECT_THAT(RunSlamdb({"repair", "--undo", folder / "report.json", kTiny, folder / "out.osa"}).err,
              HasSubstr("not a journal: this is a report of slamdb"));
  EXPECT_THAT(RunSlamdb({"transform", kTiny, folder / "out.osa", "--by", kTiny}).err,
              HasSubstr("not a transform: this is an atlas of ORB-SLAM3"));
}

// ---- damaged by what takes a binary file for text

TEST(TextMode, IsUndoneExactly) {
  const TemporaryFolder folder;
  for (const auto& change : {WithCarriageReturns, AsUtf8}) {
    WriteWholeFile(folder / "text.osa", change(ReadWholeFile(kSmall)));
    EXPECT_THAT(RunSlamdb({"info", folder / "text.osa"}).err, HasSubstr("; `slamdb recover` undoes it"));
    const ProcessResult result = RunSlamdb({"recover", folder / "text.osa", folder / "out.osa", "-O"});
    EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
    EXPECT_THAT(result.out, StartsWith("undone: every "));
    EXPECT_TRUE(ReadWholeFile(folder / "out.osa") == ReadWholeFile(kSmall));
  }
}

TEST(TextMode, IsUndoneExactlyThoughItHappenedTwice) {
  const TemporaryFolder folder;
  const std::string atlas = ReadWholeFile(kSmall);
  for (const std::string& text : {AsUtf8(WithCarriageReturns(atlas)), WithCarriageReturns(AsUtf8(atlas)),
                                  AsUtf8(AsUtf8(atlas)), WithCarriageReturns(WithCarriageReturns(atlas))}) {
    WriteWholeFile(folder / "text.osa", text);
    EXPECT_THAT(RunSlamdb({"info", folder / "text.osa"}).err, HasSubstr("; `slamdb recover` undoes it"));
    const ProcessResult result = RunSlamdb({"recover", folder / "text.osa", folder / "out.osa", "-O"});
    EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
    EXPECT_THAT(result.out, HasSubstr("; then every "));
    EXPECT_TRUE(ReadWholeFile(folder / "out.osa") == atlas);
  }
}

// As .NET and browsers read bytes, and what they have no character for stays.
TEST(TextMode, IsUndoneOfWindows1252) {
  const TemporaryFolder folder;
  const std::string atlas = ReadWholeFile(kSmall);
  std::string text = AsUtf8(atlas);
  for (const auto& [latin1, windows] : {std::pair("\xc2\x80", "\xe2\x82\xac"), std::pair("\xc2\x9f", "\xc5\xb8")})
    text = Replaced(text, latin1, windows);
  WriteWholeFile(folder / "text.osa", text);
  EXPECT_EQ(RunSlamdb({"recover", folder / "text.osa", folder / "out.osa"}).exit_code, 0);
  EXPECT_TRUE(ReadWholeFile(folder / "out.osa") == atlas);
}

// The descriptors of a real atlas hold sequences that are UTF-8 by chance, which decoders leave as they are.
TEST(TextMode, IsNamedWhereBytesBecameReplacements) {
  const TemporaryFolder folder;
  const std::string replaced = Decoded(ReadWholeFile(kSmall));
  for (const std::string& text : {replaced, replaced.substr(0, replaced.size() / 2 + 1), AsUtf8(replaced)}) {
    WriteWholeFile(folder / "text.osa", text);
    const std::string error = RunSlamdb({"info", folder / "text.osa"}).err;
    EXPECT_THAT(error, HasSubstr("replaced by U+FFFD"));
    EXPECT_THAT(error, Not(HasSubstr("undoes it")));
    const ProcessResult result = RunSlamdb({"recover", folder / "text.osa", folder / "out.osa", "-O"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, HasSubstr("replaced by U+FFFD"));
  }
}

TEST(TextMode, IsNamedWhereItCannotBeUndone) {
  const TemporaryFolder folder;
  const std::string atlas = ReadWholeFile(kSmall);
  WriteWholeFile(folder / "text.osa", AsUtf8(Replaced(atlas, "\r", "")));
  EXPECT_THAT(
      RunSlamdb({"info", folder / "text.osa"}).err,
      AllOf(HasSubstr("encoded in UTF-8"), HasSubstr("carriage returns are missing"), Not(HasSubstr("undoes it"))));
  WriteWholeFile(folder / "text.osa", Replaced(atlas, "\r", ""));
  EXPECT_THAT(RunSlamdb({"info", folder / "text.osa"}).err, HasSubstr("carriage returns are missing"));
  WriteWholeFile(folder / "text.osa", Replaced(atlas, "\n", "\r"));
  EXPECT_THAT(RunSlamdb({"info", folder / "text.osa"}).err, Not(HasSubstr("undoes it")));
}

TEST(TextMode, IsNotSeenInFilesThatAreOnlyCut) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "cut.osa", ReadWholeFile(kSmall).substr(0, 1'000'000));
  EXPECT_THAT(RunSlamdb({"info", folder / "cut.osa"}).err, Not(HasSubstr("text")));
}

// ---- shown to people

TEST(Names, NeverSteerTheTerminal) {
  const TemporaryFolder folder;
  const std::string evil = "\x1b[31mHACK\n";
  WriteWholeFile(folder / "evil.osa", Replaced(ReadWholeFile(kSmall), "labvoc.txt", evil));
  const ProcessResult info = RunSlamdb({"info", folder / "evil.osa"});
  EXPECT_THAT(info.out, HasSubstr("\\e[31mHACK\\n  MD5"));
  EXPECT_THAT(info.out, Not(HasSubstr("\x1b")));
  EXPECT_THAT(RunSlamdb({"info", folder / "evil.osa", "--json"}).out, HasSubstr("\\u001b[31mHACK\\n"));
  EXPECT_THAT(RunSlamdb({"vocabulary", "show", folder / "evil.osa"}).out, HasSubstr("name       \\e[31mHACK\\n\n"));
  EXPECT_EQ(RunSlamdb({"convert", folder / "evil.osa", folder / "same.osa"}).exit_code, 0);
  EXPECT_TRUE(ReadWholeFile(folder / "same.osa") == ReadWholeFile(folder / "evil.osa"));
}

TEST(Names, OfFilesDoNotEither) {
  const TemporaryFolder folder;
  const std::string path = folder / "a\x1b[2Jb\nslamdb: error: c\xe2\x80\xae.osa";
  EXPECT_THAT(RunSlamdb({"info", path}).err, HasSubstr("a\\e[2Jb\\nslamdb: error: c\\u202e.osa: cannot open"));
  const ProcessResult written = RunSlamdb({"convert", kTiny, path});
  EXPECT_EQ(written.exit_code, 0);
  EXPECT_THAT(written.out, HasSubstr("a\\e[2Jb\\nslamdb: error: c\\u202e.osa (orbslam3)"));
  EXPECT_THAT(RunSlamdb({"info", path}).out, Not(HasSubstr("\x1b")));
  EXPECT_THAT(RunSlamdb({"check", path}).out, Not(HasSubstr("\x1b")));
  EXPECT_THAT(RunSlamdb({"\x1b[31m"}).err, Not(HasSubstr("\x1b")));
}

TEST(Names, GivenByUsersHaveARule) {
  const TemporaryFolder folder;
  for (const std::string& name : {"a\nb"s, "a\x1b[m"s, std::string(256, 'a'), "\xff"s, "\xe2\x80\xae"s})
    EXPECT_EQ(RunSlamdb({"vocabulary", "set", kTiny, folder / "out.osa", "--name", name}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"vocabulary", "set", kTiny, folder / "out.osa", "--name", "Labor 地图.txt"}).exit_code, 0);
}

// ---- damaged beyond reading

TEST(Recover, OfAFewBytesIsAnError) {
  const TemporaryFolder folder;
  const std::string atlas = ReadWholeFile(kTiny), text = ReadWholeFile(SLAMDB_FIXTURES "/tiny/tiny_text.osa");
  for (std::size_t bytes = 1; bytes <= 60; ++bytes)
    for (const std::string& content : {std::string(bytes, 'x'), atlas.substr(0, bytes), text.substr(0, bytes),
                                       std::string(bytes, '\0'), std::string(bytes, '\n'), std::string(bytes, '1')}) {
      WriteWholeFile(folder / "cut.osa", content);
      const ProcessResult result = RunSlamdb({"recover", folder / "cut.osa", folder / "out.osa", "-O"});
      EXPECT_EQ(result.exit_code, 1) << bytes << " bytes: " << result.err;
    }
}

}  // namespace
}  // namespace slamdb::testing
