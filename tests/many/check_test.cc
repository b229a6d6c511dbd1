// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/check.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Each with other findings: one has none, one has errors, notes and large ids.
Atlas Made(std::uint64_t seed) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 4, .points = 40, .features = 60, .seed = seed});
  for (std::uint64_t i = 0; i + 1 < seed; ++i) {
    atlas.maps[0].points[i].position.x() = std::numeric_limits<float>::quiet_NaN();
    atlas.maps[0].keyframes[i % 4].parent = KeyFrameId(std::uint64_t{1} << 60);
  }
  return atlas;
}

class CheckJournalTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (std::uint64_t seed = 1; seed <= kAtlases; ++seed) {
      const std::string name = "map" + std::to_string(seed);
      if (seed % 2 == 0)
        WriteAtlas(Made(seed), folder_ / (name + ".osa"));
      else
        WriteAtlas(Made(seed), Location(folder_ / "s.db", name), {.sync = false});
    }
    folder_.Make("broken.osa", "no archive");
  }

  CheckAtlasesOptions Journaled() const {
    CheckAtlasesOptions options;
    options.journal = folder_ / "checks.journal";
    return options;
  }
  std::string Check(const CheckAtlasesOptions& options, std::uint64_t* known = nullptr) const {
    std::vector<CheckedFile> files;
    const std::vector<std::string> named = {folder_.path().string()};
    const std::uint64_t of_journal = CheckAtlases(
        FindAtlases(named), options, [&](Outcome<CheckReport>&& outcome) { files.push_back(CheckedFileOf(outcome)); });
    if (known != nullptr) *known = of_journal;
    return ToJson(files) + TextReport(files, {.show_notes = true}) + JUnitReport(files, true) +
           SarifReport(files, "1", true);
  }
  std::string ReadJournal() const {
    std::ifstream file(folder_ / "checks.journal", std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  void WriteJournal(const std::string& text) const {
    std::ofstream(folder_ / "checks.journal", std::ios::binary) << text;
  }

  static constexpr std::uint64_t kAtlases = 6;
  TemporaryFolder folder_;
};

TEST_F(CheckJournalTest, GoesOnWhereverItWasInterruptedWithTheSameReport) {
  const std::string whole = Check({});
  std::uint64_t known = 0;
  EXPECT_EQ(Check(Journaled(), &known), whole);
  EXPECT_EQ(known, 0U);
  const std::string journal = ReadJournal();
  EXPECT_EQ(std::ranges::count(journal, '\n'), kAtlases + 1) << "what cannot be read is tried again";
  EXPECT_EQ(Check(Journaled(), &known), whole);
  EXPECT_EQ(known, kAtlases);
  EXPECT_EQ(ReadJournal(), journal) << "nothing was done again";
  for (std::size_t cut = 0; cut < journal.size(); cut += 1 + journal.size() / 20) {
    SCOPED_TRACE(cut);
    WriteJournal(journal.substr(0, cut));
    const auto lines = static_cast<std::uint64_t>(std::ranges::count(journal.substr(0, cut), '\n'));
    EXPECT_EQ(Check(Journaled(), &known), whole);
    EXPECT_EQ(known, lines == 0 ? 0 : lines - 1);
    EXPECT_EQ(ReadJournal().size(), journal.size());
  }
}

TEST_F(CheckJournalTest, WhatHasChangedIsCheckedAgain) {
  (void)Check(Journaled());
  WriteAtlas(Made(1), folder_ / "map2.osa", {.overwrite = true});
  WriteAtlas(Made(5), Location(folder_ / "s.db", "map1"), {.overwrite = true});
  std::uint64_t known = 0;
  const std::string report = Check(Journaled(), &known);
  EXPECT_EQ(known, kAtlases - 2);
  EXPECT_EQ(report, Check({}));
  EXPECT_EQ(Check(Journaled(), &known), report) << "of two lines the later one counts";
  EXPECT_EQ(known, kAtlases);
}

// What it was when it was looked at, before it was read, is not what was read.
TEST_F(CheckJournalTest, WhatChangesWhileItIsReadIsNotKnown) {
  const std::filesystem::path file = folder_ / "map2.osa";
  CheckAtlasesOptions changing = Journaled();
  changing.read.threads = 1;
  changing.read.progress = [&](std::string_view, double) {
    std::filesystem::last_write_time(file, std::filesystem::file_time_type::clock::now() + std::chrono::hours(1));
  };
  (void)Check(changing);
  std::uint64_t known = 0;
  (void)Check(Journaled(), &known);
  EXPECT_EQ(known, kAtlases - 1);
}

TEST_F(CheckJournalTest, RevisionsAreKnownByTheirContent) {
  WriteAtlas(Made(5), Location(folder_ / "s.db", "map1"), {.overwrite = true});
  const std::vector<std::string> named = {folder_ / "s.db"};
  const AtlasInputs inputs = FindAtlases(named, {.revisions = true});
  std::vector<std::string> names;
  for (const AtlasInput& input : inputs.atlases) names.push_back(input.location.name);
  EXPECT_THAT(names, ::testing::ElementsAre("map1@1", "map1@2", "map3@1", "map5@1"));
  const auto check = [&] { return CheckAtlases(inputs, Journaled(), [](Outcome<CheckReport>&&) {}); };
  EXPECT_EQ(check(), 0U);
  EXPECT_EQ(check(), inputs.atlases.size());
}

TEST_F(CheckJournalTest, IsOfOneCheckAlone) {
  (void)Check(Journaled());
  CheckAtlasesOptions strict = Journaled();
  strict.check.strict = true;
  const Error other = ErrorOf([&] { (void)Check(strict); });
  EXPECT_EQ(other.kind(), ErrorKind::kUsage);
  EXPECT_THAT(other.what(), HasSubstr("checks.journal: is the journal of a check with other options"));
}

TEST_F(CheckJournalTest, NoOtherFileIsTouched) {
  for (const std::string text : {"notes\n", "notes", "{\"report\":\"slamdb-list-2\"}\n"}) {
    WriteJournal(text);
    EXPECT_EQ(ErrorOf([&] { (void)Check(Journaled()); }).kind(), ErrorKind::kAlreadyExists) << text;
    EXPECT_EQ(ReadJournal(), text);
  }
  CheckAtlasesOptions folder;
  folder.journal = folder_.path().string();
  EXPECT_NE(ErrorOf([&] { (void)Check(folder); }).kind(), ErrorKind::kInternal);
}

TEST_F(CheckJournalTest, ADamagedLineIsNamed) {
  (void)Check(Journaled());
  std::string journal = ReadJournal();
  journal.replace(journal.find('\n') + 1, 3, "???");
  WriteJournal(journal);
  const Error error = ErrorOf([&] { (void)Check(Journaled()); });
  EXPECT_EQ(error.kind(), ErrorKind::kDamaged);
  EXPECT_EQ(error.place(), "line 2");
}

TEST_F(CheckJournalTest, HasOnlyWhatWasReadUnderItsName) {
  CheckAtlasesOptions options = Journaled();
  options.read.threads = 1;
  const std::vector<std::string> named = {folder_ / "s.db"};
  // While the first is taken, somebody saves another one under the name of the last, and takes it back later.
  CheckAtlases(FindAtlases(named), options, [&](Outcome<CheckReport>&& outcome) {
    if (outcome.path.ends_with("map1")) WriteAtlas(Made(1), Location(folder_ / "s.db", "map5"), {.overwrite = true});
  });
  Store::OpenForWriting(folder_ / "s.db").Restore("map5@1");
  EXPECT_EQ(Check(Journaled()), Check({}));
}

TEST_F(CheckJournalTest, IsOfOneSetOfGatesAndVocabulary) {
  (void)Check(Journaled());
  CheckAtlasesOptions gated = Journaled();
  gated.check.gates = {{.gate = "min-maps", .limit = 1}};
  EXPECT_EQ(ErrorOf([&] { (void)Check(gated); }).kind(), ErrorKind::kUsage);
}

TEST_F(CheckJournalTest, OutcomesComeInOrderAsSoonAsTheyAreThere) {
  std::vector<std::string> names;
  std::vector<std::string> named = {folder_.path().string()};
  CheckAtlasesOptions options;
  options.read.threads = 4;
  CheckAtlases(FindAtlases(named), options, [&](Outcome<CheckReport>&& outcome) {
    names.push_back(std::filesystem::path(outcome.path).filename());
  });
  EXPECT_THAT(names,
              ElementsAre("broken.osa", "map2.osa", "map4.osa", "map6.osa", "s.db#map1", "s.db#map3", "s.db#map5"));
}

TEST_F(CheckJournalTest, WhatTakesThemMayEndIt) {
  std::vector<std::string> named = {folder_.path().string()};
  int taken = 0;
  EXPECT_EQ(ErrorOf([&] {
              CheckAtlases(FindAtlases(named), Journaled(), [&](Outcome<CheckReport>&&) {
                if (++taken == 4) throw Error(ErrorKind::kOutOfResources, "full");
              });
            }).kind(),
            ErrorKind::kOutOfResources);
  EXPECT_EQ(taken, 4);
  std::uint64_t known = 0;
  EXPECT_EQ(Check(Journaled(), &known), Check({}));
  EXPECT_EQ(known, 3U) << "one of the four could not be read";
}

}  // namespace
}  // namespace slamdb
