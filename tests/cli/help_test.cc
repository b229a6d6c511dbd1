// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <algorithm>
#include <map>
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

// The verbs that `slamdb --help` lists, by their heading.
std::map<std::string, std::vector<std::string>> GroupedVerbs() {
  std::map<std::string, std::vector<std::string>> groups;
  std::string heading;
  for (const std::string& line : Lines(RunSlamdb({"--help"}).out)) {
    if (line.ends_with(":") && !line.starts_with(" ")) heading = line.substr(0, line.size() - 1);
    if (heading.empty() || heading == "Common options" || line.size() < 3 || !line.starts_with("  ")) continue;
    if (line[2] != ' ') groups[heading].push_back(line.substr(2, line.find(' ', 2) - 2));
  }
  return groups;
}

std::vector<std::string> ListedVerbs() {
  std::vector<std::string> verbs;
  for (const auto& [heading, names] : GroupedVerbs()) verbs.insert(verbs.end(), names.begin(), names.end());
  return verbs;
}

std::size_t CountOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(Help, ListsEveryVerb) {
  EXPECT_THAT(ListedVerbs(), ::testing::IsSupersetOf(
                                 {"info",    "show",   "dump",   "check",  "convert",    "list",       "log",
                                  "remove",  "stats",  "vacuum", "backup", "migrate",    "vocabulary", "tag",
                                  "restore", "branch", "gc",     "sync",   "synthesize", "completion", "version"}));
}

// A verb without a group would stand among those that are about slamdb itself.
TEST(Help, VerbsStandInGroups) {
  const auto groups = GroupedVerbs();
  for (const char* heading : {"Look", "Check and repair", "Change", "Combine", "Convert", "Store"})
    EXPECT_TRUE(groups.contains(heading)) << heading;
  EXPECT_THAT(groups.at("More"), ::testing::UnorderedElementsAre("help", "completion", "version"));
}

TEST(Help, IsAScreenAndAsWideAsTheTerminal) {
  for (std::string verb : ListedVerbs()) {
    SCOPED_TRACE(verb);
    const std::string screen = RunSlamdb({verb, "-h"}).out, whole = RunSlamdb({verb, "--help"}).out;
    EXPECT_LE(Lines(screen).size(), 60U);
    EXPECT_LT(screen.size(), whole.size());
    EXPECT_THAT(screen, ::testing::EndsWith("--help' tells more.\n"));
    const auto lines = Lines(whole);
    const auto common = std::ranges::find(lines, "Common options:"), exits = std::ranges::find(lines, "Exit codes:");
    ASSERT_TRUE(common < exits && exits != lines.end());
    EXPECT_TRUE(std::none_of(std::next(common), exits, [](const std::string& line) {
      return line.ends_with(":") && !line.starts_with(" ");
    })) << "no options behind those that every verb has";
  }
  const std::string narrow = RunProgram({"env", "COLUMNS=60", SLAMDB_COMMAND, "check", "--help"}).out;
  for (const std::string& line : Lines(narrow)) {
    if (line.starts_with("  $ ")) continue;
    EXPECT_LE(line.size(), 60U) << line;
  }
  EXPECT_LE(Lines(RunSlamdb({"-h"}).out).size(), 24U);
}

TEST(Help, IsAskedForInManyWays) {
  EXPECT_EQ(RunSlamdb({"help", "check"}).out, RunSlamdb({"check", "--help"}).out);
  EXPECT_EQ(RunSlamdb({"help", "vocabulary", "set"}).out, RunSlamdb({"vocabulary", "set", "--help"}).out);
  EXPECT_EQ(RunSlamdb({"help"}).out, RunSlamdb({"--help"}).out);
  const ProcessResult unknown = RunSlamdb({"help", "chekc"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("unknown verb 'chekc'; did you mean 'check'?"));
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
    for (const std::string& line : Lines(result.out)) {
      if (line.starts_with("  $ ")) continue;
      EXPECT_LE(line.size(), 100U) << line;
    }
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
  for (const char* heading : {"--keyframes FIRST:LAST ", "--time BEGIN:END ", "--box X,Y,Z:X,Y,Z",
                              "--boost-version BOOST", "--wait SECONDS ", "--threads N ", "--to FORMAT "})
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
