// SPDX-License-Identifier: BSD-3-Clause
// Runs every transcript of README.md, from top to bottom in one folder, and compares what is printed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <sstream>

#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

namespace fs = std::filesystem;

// A command of a transcript and the lines that it is said to print.
struct Said {
  std::string command;
  std::vector<std::string> lines;
};

std::vector<Said> TranscriptsOf(const std::string& page) {
  std::vector<Said> transcripts;
  std::istringstream text(page);
  bool inside = false;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("```")) {
      inside = line == "```console";
    } else if (inside && line.starts_with("$ ")) {
      transcripts.push_back({line.substr(2), {}});
    } else if (inside) {
      transcripts.back().lines.push_back(line);
    }
  }
  return transcripts;
}

// What differs from run to run: dates.
std::string WithoutDates(const std::string& line) {
  static const std::regex date("\\d{4}-\\d\\d-\\d\\dT\\d\\d:\\d\\d:\\d\\dZ");
  return std::regex_replace(line, date, "DATE");
}

// `...` stands for any lines.
void ExpectSaid(const Said& said, const std::string& printed) {
  std::vector<std::string> lines;
  std::istringstream text(printed);
  for (std::string line; std::getline(text, line);) lines.push_back(WithoutDates(line));
  std::size_t at = 0;
  bool skipping = false;
  for (const std::string& line : said.lines) {
    if (line == "...") {
      skipping = true;
      continue;
    }
    const auto from = lines.begin() + static_cast<std::ptrdiff_t>(at);
    const auto found = skipping ? std::find(from, lines.end(), WithoutDates(line)) : from;
    ASSERT_TRUE(found != lines.end() && *found == WithoutDates(line))
        << "$ " << said.command << "\nis said to print: " << line << "\nbut prints:\n"
        << printed;
    at = static_cast<std::size_t>(found - lines.begin()) + 1;
    skipping = false;
  }
  EXPECT_TRUE(skipping || at == lines.size()) << "$ " << said.command << "\nprints more:\n" << printed;
}

TEST(Readme, PrintsWhatItSays) {
  const fs::path fixtures = SLAMDB_FIXTURES;
  const TemporaryFolder folder;
  for (const char* file : {"session_small_a/session_small_a.osa", "session_small_b/session_small_b.osa",
                           "mono_small_twice/mono_small_twice.osa", "session_small_a/truth.txt"})
    fs::copy_file(fixtures / file, folder / fs::path(file).filename().string());
  fs::create_symlink(SLAMDB_COMMAND, folder / "slamdb");
  const std::string whole = ReadWholeFile(folder / "session_small_a.osa");
  const std::vector<Said> transcripts = TranscriptsOf(ReadWholeFile((fixtures / ".." / "README.md").string()));
  ASSERT_GT(transcripts.size(), 15U);
  for (const Said& said : transcripts) {
    // The two files that were cut off: one in its keyframes, one in its points.
    if (said.command.find("cut.osa") != std::string::npos)
      WriteWholeFile(folder / "cut.osa", whole.substr(0, said.command.starts_with("slamdb info") ? 2000000 : 2600000));
    const std::string shell = "cd '" + folder.path().string() + "' && PATH=\"$PWD:$PATH\" && " + said.command + " 2>&1";
    ExpectSaid(said, RunProgram({"sh", "-c", shell}).out);
  }
}

}  // namespace
}  // namespace slamdb::testing
