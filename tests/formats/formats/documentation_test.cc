// SPDX-License-Identifier: BSD-3-Clause
// Every format of the list has what docs/formats.md asks of a new one: its row there, its page in schema/, its example
// in fixtures/formats/.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "slamdb/formats/formats.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

namespace fs = std::filesystem;
using ::testing::SizeIs;

const fs::path kProject = fs::path(SLAMDB_FIXTURES) / "..";

std::vector<std::string> Lines(const fs::path& path) {
  std::istringstream text(ReadFile(path.string()));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

std::string Code(std::string_view word) { return "`" + std::string(word) + "`"; }

bool HasWord(std::string_view text, std::string_view word) {
  const auto is_part = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-'; };
  for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1))
    if ((at == 0 || !is_part(text[at - 1])) && (at + word.size() == text.size() || !is_part(text[at + word.size()])))
      return true;
  return false;
}

class DocumentedFormat : public ::testing::TestWithParam<std::string> {
 protected:
  const Format& format() const { return FormatById(GetParam()); }
};

// The title of a page names the formats that it describes: `# tum, kitti, euroc: trajectories`.
TEST_P(DocumentedFormat, HasAPageInSchema) {
  std::vector<std::string> pages;
  for (const auto& entry : fs::directory_iterator(kProject / "schema")) {
    if (entry.path().extension() != ".md") continue;
    const std::vector<std::string> lines = Lines(entry.path());
    if (!lines.empty() && HasWord(lines[0], format().id)) pages.push_back(entry.path().string());
  }
  EXPECT_THAT(pages, SizeIs(1)) << "pages in schema/ whose title names " << format().id;
}

// `| `tum` | `.tum` `.txt` | yes | yes | ...`
TEST_P(DocumentedFormat, HasItsRowInTheTable) {
  std::string start = "| " + Code(format().id) + " |";
  for (const std::string_view suffix : format().suffixes) start += " " + Code(suffix);
  start += format().read != nullptr ? " | yes |" : " | |";
  start += format().write != nullptr ? " yes |" : " |";
  const std::vector<std::string> lines = Lines(kProject / "docs" / "formats.md");
  EXPECT_EQ(std::ranges::count_if(lines, [&](const std::string& line) { return line.starts_with(start); }), 1)
      << "lines of docs/formats.md that start with " << start;
}

// fixtures/formats/ID is what the format makes of LandmarkAtlas(), and must go on doing so; for one that is read alone,
// an example of it. Several files that name each other are fixtures/formats/ID/ID and what stands beside it.
TEST_P(DocumentedFormat, MakesItsFixture) {
  if (format().named) GTEST_SKIP() << "a store records when it was written; its own tests read those of every version";
  const fs::path place = fs::path(SLAMDB_FIXTURES) / "formats" / format().id;
  const auto output_in = [&](const fs::path& given) {
    if (!format().needs_path) return given.string();
    fs::create_directories(given);
    return (given / format().id).string();
  };
  const std::string path = output_in(place);
  if (format().write == nullptr) {
    ASSERT_TRUE(fs::exists(path)) << path << " is missing";
    const bool is_asked_for = format().sniff == nullptr && format().suffixes.empty();  // by its id alone
    EXPECT_EQ(&FormatOfInput(Location(path, {}), is_asked_for ? format().id : ""), &format());
    EXPECT_NE(ReadAtlas(Location(path, {}), {.format = GetParam()}).maps.size(), 0U);
    return;
  }
  const WriteOptions options = ForAnyFormat({.format = GetParam(), .sync = false});
  if (std::getenv("SLAMDB_UPDATE_GOLDEN") != nullptr) {
    fs::remove_all(place);  // databases of other programs are never replaced
    WriteAtlas(LandmarkAtlas(), Location(output_in(place), {}), options);
    fs::remove(path + ".times");
  }
  ASSERT_TRUE(fs::exists(path)) << path << " is missing; SLAMDB_UPDATE_GOLDEN=1 makes it";
  const TemporaryFolder folder;
  const auto written = [&](const Atlas& atlas, const std::string& name) {
    WriteAtlas(atlas, Location(output_in(folder.Path(name)), {}), options);
    return ReadFileOrFolder(folder.Path(name));
  };
  const std::string fixture = ReadFileOrFolder(place.string());
  EXPECT_TRUE(written(LandmarkAtlas(), "a") == fixture) << path << " is not what is written today";
  if (format().read == nullptr) return;
  EXPECT_EQ(&FormatOfInput(Location(path, {})), &format());
  Notices notices;
  const std::string again = written(ReadAtlas(path, {}, &notices), "b");
  // What a reader leaves out, and what clouds tell of keyframes that they do not hold, is missing once.
  const bool lacks = notices.lossy() || TellsOfKeyFrames(format());
  const std::string wanted = lacks ? written(ReadAtlas(output_in(folder.Path("b"))), "c") : fixture;
  EXPECT_TRUE(again == wanted);
}

std::vector<std::string> AllIds() {
  std::vector<std::string> ids;
  for (const Format& format : Formats()) ids.emplace_back(format.id);
  return ids;
}

INSTANTIATE_TEST_SUITE_P(Formats, DocumentedFormat, ::testing::ValuesIn(AllIds()), [](const auto& instance) {
  std::string name = instance.param;
  std::ranges::replace(name, '-', '_');
  return name;
});

TEST(Fixtures, AreOfFormatsThatAreThere) {
  for (const auto& entry : fs::directory_iterator(fs::path(SLAMDB_FIXTURES) / "formats"))
    EXPECT_NO_THROW(FormatById(entry.path().filename().string()));
}

}  // namespace
}  // namespace slamdb
