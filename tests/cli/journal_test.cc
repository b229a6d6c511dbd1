// SPDX-License-Identifier: BSD-3-Clause
// The journal as text: every repair of every twin, written, read and taken back.
#include "cli/journal.h"

#include <gmock/gmock.h>

#include "slamdb/base/error.h"
#include "slamdb/edit/repair/repair.h"
#include "tests/support/cli.h"
#include "tests/support/corrupt.h"
#include "tests/support/equals_atlas.h"

namespace slamdb::cli {
namespace {

using ::testing::HasSubstr;

TEST(JournalFile, KeepsEveryRepair) {
  const testing::TemporaryFolder folder;
  for (const Twin& twin : Twins()) {
    if (!FindRule(twin.rule)->fix) continue;
    SCOPED_TRACE(twin.rule);
    Atlas original = SoundAtlas(twin.base);
    twin.corrupt(original);
    Atlas atlas = original;
    JournalFile file{.original = 1, .repaired = ~std::uint64_t{0}, .encoding = original.encoding};
    file.journal = RepairAtlas(atlas, {.threads = 1}).journal;
    const std::string text = JournalText(file);
    testing::WriteWholeFile(folder / "fix.json", text);
    const JournalFile read = ReadJournalFile(folder / "fix.json");
    EXPECT_EQ(JournalText(read), text);
    EXPECT_EQ(read.repaired, file.repaired);
    EXPECT_EQ(read.encoding, original.encoding);
    TakeBack(read.journal, atlas);
    EXPECT_THAT(atlas, EqualsAtlas(original));
  }
}

TEST(JournalFile, RefusesWhatIsNone) {
  const testing::TemporaryFolder folder;
  const std::string head = R"({"format":"slamdb-journal-1","original":"0","repaired":"0","encoding":{"text":false,)"
                           R"("boost_version":18,"long_bytes":8,"size_bytes":8},"edits":[)";
  for (
      const std::string& text :
      {std::string(), std::string("[]"), std::string("{\"format\":\"other\"}"), head, head + "{}]}",
       head + R"({"rule":"x","entity":"moon","fields":[]}]})",
       head +
           R"({"rule":"x","entity":"atlas","fields":[{"field":"next_ids.map","kinds":"","at":0,"before":[],"after":[]}]}]})",
       head +
           R"({"rule":"x","entity":"atlas","fields":[{"field":"a","kinds":"f","at":0,"before":["nan"],"after":[]}]}]})"}) {
    testing::WriteWholeFile(folder / "fix.json", text);
    try {
      ReadJournalFile(folder / "fix.json");
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("is no journal of a repair")) << text;
    }
  }
}

}  // namespace
}  // namespace slamdb::cli
