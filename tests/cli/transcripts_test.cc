// SPDX-License-Identifier: BSD-3-Clause
// Runs every transcript of README.md and docs, each page from top to bottom in one folder, and compares what is
// printed. A transcript is a code block that begins with `$ `. What a page needs and does not show stands before it, in
// a line
// <!-- first: COMMAND -->. Blocks of commands alone are run, and must do what they are asked for. Empty lines do not
// count.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <regex>
#include <sstream>

#include "slamdb/optimize/bundle_adjustment.h"
#include "slamdb/pictures/pictures.h"
#include "slamdb/view/page.h"
#include "tests/support/cli.h"
#include "tests/support/kind_of.h"

namespace slamdb::testing {
namespace {

namespace fs = std::filesystem;

// A command of a transcript and the lines that it is said to print; none where only the work counts.
struct Said {
  std::string command;
  std::optional<std::vector<std::string>> lines;
};

std::vector<Said> TranscriptsOf(const std::string& page) {
  constexpr std::string_view kFirst = "<!-- first: ", kEnd = " -->";
  std::vector<Said> transcripts;
  std::istringstream text(page);
  bool in_block = false, in_transcript = false, begins = false, answers = false;
  std::size_t first = 0;  // of this block
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("```")) {
      if (in_transcript && !answers) {  // commands alone
        for (std::size_t i = first; i < transcripts.size(); ++i) transcripts[i].lines.reset();
      }
      begins = in_block = !in_block;
      in_transcript = answers = false;
      first = transcripts.size();
      continue;
    }
    if (line.starts_with(kFirst) && line.ends_with(kEnd))
      transcripts.push_back({line.substr(kFirst.size(), line.size() - kFirst.size() - kEnd.size()), {}});
    if (begins) in_transcript = line.starts_with("$ ");
    begins = false;
    if (!in_transcript || line.empty()) continue;
    if (line.starts_with("$ ")) {
      transcripts.push_back({line.substr(2), std::vector<std::string>()});
    } else {
      answers = true;
      transcripts.back().lines->push_back(line);
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
  for (std::string line; std::getline(text, line);)
    if (!line.empty()) lines.push_back(WithoutDates(line));
  std::size_t at = 0;
  bool skipping = false;
  for (const std::string& line : *said.lines) {
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

// The files that pages speak of: fixtures, and real atlases where there are.
void Fill(const TemporaryFolder& folder) {
  const fs::path fixtures = SLAMDB_FIXTURES;
  const auto link = [&](const fs::path& file) {
    const fs::path name = folder.path() / file.filename();
    if (!fs::exists(name)) fs::copy_file(file, name);
  };
  for (const char* file : {"session_small_a/session_small_a.osa", "session_small_b/session_small_b.osa",
                           "mono_small_twice/mono_small_twice.osa", "session_small_a/truth.txt", "room/corner.osa",
                           "room/a01.jpg", "room/b01.jpg"})
    link(fixtures / file);
  fs::create_directory_symlink(fixtures, folder.path() / "fixtures");
  fs::create_symlink(SLAMDB_COMMAND, folder / "slamdb");
  const char *atlases = std::getenv("SLAMDB_ATLASES"), *meaning = std::getenv("SLAMDB_MEANING"),
             *lab = std::getenv("SLAMDB_LAB2");
  std::vector<fs::path> folders;
  if (atlases != nullptr) folders.emplace_back(atlases);
  if (lab != nullptr) {
    folders.emplace_back(lab);
    folders.push_back(fs::path(lab) / "ground_truth");
  }
  if (meaning != nullptr) folders.push_back(fs::path(meaning).parent_path() / "ground_truth");
  std::error_code none;  // a folder that is not there has no files
  for (const fs::path& real : folders)
    for (const auto& entry : fs::directory_iterator(real, none)) {
      const fs::path name = folder.path() / entry.path().filename();
      if (entry.is_regular_file() && !fs::exists(name)) fs::create_symlink(entry.path(), name);
    }
}

// The real atlas that a command needs and that is not here; empty: none.
std::string MissingAtlas(const std::string& command, const TemporaryFolder& folder) {
  static const std::regex names(
      "(session_[ab]|mono_small|mono_small_newmap|mono_dist|race_mono|stereo_inertial|"
      "fisheye_stereo|multimap_rgbd|l1|p1|b[12])(\\.osa|_frames\\.txt)");
  for (std::sregex_iterator name(command.begin(), command.end(), names), end; name != end; ++name)
    if (!fs::exists(folder.path() / name->str())) return name->str();
  return {};
}

bool CanReadPictures() {
  return KindOf([] { (void)ReadPicture("none.png"); }) == ErrorKind::kNotFound;
}

class Page : public ::testing::TestWithParam<std::string> {};

TEST_P(Page, PrintsWhatItSays) {
  if (GetParam() == "docs/view.md" && !HasViewPage()) GTEST_SKIP() << "built without esbuild";
  const bool is_readme = GetParam() == "README.md";
  if ((is_readme || GetParam() == "docs/optimize.md" || GetParam() == "docs/close-loops.md") && !CanOptimize())
    GTEST_SKIP() << "built without Ceres";
  if (is_readme && !CanReadPictures()) GTEST_SKIP() << "built without pictures";
  const TemporaryFolder folder;
  Fill(folder);
  const std::string page = (fs::path(SLAMDB_FIXTURES) / ".." / GetParam()).string();
  const std::vector<Said> transcripts = TranscriptsOf(ReadWholeFile(page));
  EXPECT_TRUE(!is_readme || transcripts.size() > 15);
  std::string missing;
  for (const Said& said : transcripts) {
    missing = MissingAtlas(said.command, folder);
    if (!missing.empty()) break;
    const std::string shell = "cd '" + folder.path().string() + "' && PATH=\"$PWD:$PATH\" && " + said.command + " 2>&1";
    const ProcessResult result = RunProgram({"bash", "-c", shell});
    if (said.lines)
      ExpectSaid(said, result.out);
    else
      ASSERT_TRUE(result.exit_code == 0 || result.exit_code == 3) << said.command << "\n" << result.out;
  }
  if (!missing.empty()) GTEST_SKIP() << "needs " << missing << " (SLAMDB_ATLASES, SLAMDB_LAB2)";
}

std::vector<std::string> Pages() {
  std::vector<std::string> pages = {"README.md"};
  for (const auto& entry : fs::directory_iterator(fs::path(SLAMDB_FIXTURES) / ".." / "docs"))
    if (entry.path().extension() == ".md") pages.push_back("docs/" + entry.path().filename().string());
  std::ranges::sort(pages);
  return pages;
}

INSTANTIATE_TEST_SUITE_P(Transcripts, Page, ::testing::ValuesIn(Pages()), [](const auto& page) {
  std::string name = fs::path(page.param).stem().string();
  std::ranges::replace(name, '-', '_');  // as names of tests are
  return name;
});

}  // namespace
}  // namespace slamdb::testing
