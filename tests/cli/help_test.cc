// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <sstream>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using ::testing::HasSubstr;

std::vector<std::string> Lines(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// The verbs that `slamdb --help` lists.
std::vector<std::string> ListedVerbs() {
  std::vector<std::string> verbs;
  bool in_list = false;
  for (const std::string& line : Lines(RunSlamdb({"--help"}).out)) {
    if (in_list && line.empty()) break;
    if (in_list && line.size() > 2 && line[2] != ' ') verbs.push_back(line.substr(2, line.find(' ', 2) - 2));
    if (line == "Verbs:") in_list = true;
  }
  return verbs;
}

std::size_t CountOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(Help, ListsEveryVerb) {
  EXPECT_THAT(ListedVerbs(), ::testing::IsSupersetOf({"info", "show", "dump", "check", "convert", "list", "log",
                                                      "remove", "stats", "vacuum", "backup", "migrate", "vocabulary",
                                                      "synthesize", "completion", "version"}));
}

TEST(Help, OfEachVerbHasOptionsExitCodesAndExamples) {
  for (std::string verb : ListedVerbs()) {
    SCOPED_TRACE(verb);
    const ProcessResult result = RunSlamdb({verb, "--help"});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.err, "");
    EXPECT_THAT(result.out, HasSubstr("Usage: slamdb " + verb));
    EXPECT_THAT(result.out, HasSubstr("\nExit codes:\n  0  "));
    const std::size_t examples = CountOf(result.out, "\n  $ ");
    EXPECT_GE(examples, 2U);
    EXPECT_LE(examples, 5U);
    for (const std::string& line : Lines(result.out)) EXPECT_LE(line.size(), 100U) << line;
  }
}

TEST(Help, EveryDescribedOptionHasADescription) {
  for (const std::string& verb : ListedVerbs()) {
    const ProcessResult result = RunSlamdb({verb, "--help"});
    const auto lines = Lines(result.out);
    for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
      if (!lines[i].starts_with("  -")) continue;
      const bool beside = lines[i].find("   ", 2) != std::string::npos || lines[i].size() > 26;
      EXPECT_TRUE(beside || lines[i + 1].starts_with("                ")) << verb << ": " << lines[i];
    }
  }
}

TEST(Help, ShowsHowValuesAreWritten) {
  const std::string text = RunSlamdb({"convert", "--help"}).out;
  for (const char* heading : {"--keyframes FIRST:LAST ", "--time BEGIN:END ", "--box X,Y,Z:X,Y,Z", "--boost-version N ",
                              "--wait SECONDS ", "--threads N ", "--to FORMAT "})
    EXPECT_THAT(text, HasSubstr(std::string("  ") + heading));
}

TEST(Help, VersionListsTheFormats) {
  const nlohmann::json version = nlohmann::json::parse(RunSlamdb({"version", "--json"}).out);
  EXPECT_EQ(BreachOf(version, "version.schema.json"), "");
  EXPECT_EQ(RunSlamdb({"--version"}).out, "slamdb " + version.at("version").get<std::string>() + "\n");
  const std::string text = RunSlamdb({"version"}).out;
  for (const auto& format : version.at("formats")) EXPECT_THAT(text, HasSubstr(format.at("id").get<std::string>()));
}

TEST(Help, ManualPagesRenderWithoutWarnings) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunSlamdb({"man", "--folder", folder / "man"}).exit_code, 0);
  std::size_t pages = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "man")) {
    ++pages;
    const ProcessResult lint = RunProgram({"mandoc", "-T", "lint", "-W", "warning", entry.path().string()});
    if (lint.exit_code == 127) GTEST_SKIP() << "mandoc is not installed";
    EXPECT_EQ(lint.exit_code, 0) << lint.out << lint.err;
  }
  EXPECT_EQ(pages, ListedVerbs().size() + 1);
}

TEST(Help, ManualPageShowsExitCodesAndExamplesAsTheyAre) {
  const ProcessResult page = RunSlamdb({"man", "convert"});
  ASSERT_EQ(page.exit_code, 0);
  const ProcessResult text = RunProgram({"mandoc", "-T", "ascii"}, page.out);
  if (text.exit_code == 127) GTEST_SKIP() << "mandoc is not installed";
  for (const char* heading : {"NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXIT STATUS", "EXAMPLES"})
    EXPECT_THAT(page.out, HasSubstr(std::string(".SH ") + heading));
  EXPECT_EQ(RunSlamdb({"man", "nonsense"}).exit_code, 2);
}

}  // namespace
}  // namespace slamdb::testing
