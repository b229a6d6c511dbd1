// SPDX-License-Identifier: BSD-3-Clause
// The journal as a file: every repair of every twin, written, read and taken back; and what is refused.
#include "slamdb/edit/repair/journal.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "slamdb/base/error.h"
#include "slamdb/edit/repair/repair.h"
#include "slamdb/model/digest.h"
#include "tests/support/corrupt.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/kind_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;

TEST(JournalFile, KeepsEveryRepair) {
  const TemporaryFolder folder;
  for (const Twin& twin : Twins()) {
    if (!FindRule(twin.rule)->fix) continue;
    SCOPED_TRACE(twin.rule);
    Atlas original = SoundAtlas(twin.base);
    original.encoding.boost_version = 12;
    twin.corrupt(original);
    Atlas atlas = original;
    const Journal journal = RepairAtlas(atlas, {.threads = 1}).journal;
    EXPECT_EQ(journal.original, HashWithoutEncoding(original));
    EXPECT_EQ(journal.repaired, HashWithoutEncoding(atlas));
    EXPECT_EQ(journal.encoding, original.encoding);
    WriteJournal(journal, folder.Path("fix.json"), {.overwrite = true});
    const Journal read = ReadJournal(folder.Path("fix.json"));
    EXPECT_EQ(ToJson(read), ToJson(journal));
    atlas.encoding.boost_version = 18;  // as if it was written for another Boost in between
    EXPECT_EQ(UndoRepair(atlas, read, {.threads = 1}).edits, journal.edits.size());
    EXPECT_THAT(atlas, EqualsAtlas(original));
  }
}

TEST(JournalFile, IsNotOverwrittenUnasked) {
  const TemporaryFolder folder;
  WriteJournal({}, folder.Path("fix.json"));
  EXPECT_EQ(KindOf([&] { WriteJournal({}, folder.Path("fix.json")); }), ErrorKind::kAlreadyExists);
}

TEST(JournalFile, RefusesWhatIsNone) {
  const std::string head = R"({"format":"slamdb-journal-1","original":"0","repaired":"0","encoding":{"text":false,)"
                           R"("boost_version":18,"long_bytes":8,"size_bytes":8},"edits":[)";
  EXPECT_EQ(ParseJournal(head + "]}").edits.size(), 0U) << "what the others differ from";
  for (
      const std::string& text :
      {std::string(), std::string("[]"), std::string("{\"format\":\"other\"}"), head, head + "{}]}",
       head + R"({"rule":"x","entity":"moon","fields":[]}]})",
       head +
           R"({"rule":"x","entity":"atlas","fields":[{"field":"next_ids.map","kinds":"","at":0,"before":[],"after":[]}]}]})",
       head +
           R"({"rule":"x","entity":"atlas","fields":[{"field":"a","kinds":"f","at":0,"before":["nan"],"after":[]}]}]})"}) {
    try {
      static_cast<void>(ParseJournal(text));
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kDamaged);
      EXPECT_THAT(error.what(), HasSubstr("is no journal of a repair")) << text;
    }
  }
}

// A flipped bit is noticed, or changes nothing that the journal says.
TEST(JournalFile, NoticesEveryFlippedBit) {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  atlas.next_ids = {};
  const std::string text = ToJson(RepairAtlas(atlas).journal);
  ASSERT_LT(text.size(), 20000U);
  std::size_t noticed = 0;
  for (std::size_t bit = 0; bit < 8 * text.size(); ++bit) {
    std::string flipped = text;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << bit % 8));
    try {
      EXPECT_EQ(ToJson(ParseJournal(flipped)), text) << "bit " << bit;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kDamaged);
      ++noticed;
    }
  }
  EXPECT_GT(noticed, 7 * text.size());
}

TEST(JournalFile, RefusesAnEncodingThatNoArchiveHas) {
  for (const char* encoding :
       {R"("boost_version":18,"long_bytes":8,"size_bytes":0)", R"("boost_version":18,"long_bytes":3,"size_bytes":8)",
        R"("boost_version":18.7,"long_bytes":8,"size_bytes":8)", R"("boost_version":-1,"long_bytes":8,"size_bytes":8)",
        R"("boost_version":18,"long_bytes":264,"size_bytes":8)"}) {
    const std::string text = std::string(R"({"format":"slamdb-journal-1","original":"0","repaired":"0","encoding":)") +
                             R"({"text":false,)" + encoding + R"(},"edits":[]})";
    EXPECT_EQ(KindOf([&] { return ParseJournal(text); }), ErrorKind::kDamaged) << encoding;
  }
}

TEST(JournalFile, IsMadeOfWhatCanBeReadBack) {
  Journal journal;
  journal.edits.push_back({.rule = "not \xff UTF-8"});
  EXPECT_EQ(ParseJournal(ToJson(journal)).edits.size(), 1U);
  journal.edits[0].fields.push_back({.field = "next_ids.map", .kinds = "", .before = {1}, .after = {2}});
  EXPECT_EQ(KindOf([&] { return ToJson(journal); }), ErrorKind::kUsage);
}

TEST(JournalFile, NamesTheFileAndTheKind) {
  const TemporaryFolder folder;
  EXPECT_EQ(KindOf([&] { return ReadJournal(folder.Path("none.json")); }), ErrorKind::kNotFound);
  const std::string newer = folder.Make("newer.json", "{\"format\":\"slamdb-journal-2\"}");
  EXPECT_EQ(KindOf([&] { return ReadJournal(newer); }), ErrorKind::kUnsupported);
  const std::string path = folder.Make("cut.json", "{");
  try {
    static_cast<void>(ReadJournal(path));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kDamaged);
    EXPECT_EQ(error.path(), path);
  }
}

// A journal of three edits of one number, of which each stands on the one before.
TEST(Journal, EditsAreTakenBackLastFirst) {
  const Atlas original = SoundAtlas(Base::kMonocular);
  std::vector<Atlas> states = {original};
  Journal journal;
  for (const std::uint64_t next : {1000, 2000, 1000, 3000}) {
    states.push_back(states.back());
    states.back().next_ids.frame += next;
    AppendChanges(states[states.size() - 2], states.back(), "test", journal);
  }
  ASSERT_EQ(journal.edits.size(), 4U);
  Atlas atlas = states.back();
  TakeBack(journal, atlas);
  EXPECT_THAT(atlas, EqualsAtlas(original));

  Journal reversed = journal;
  std::ranges::reverse(reversed.edits);
  atlas = states.back();
  EXPECT_EQ(KindOf([&] { TakeBack(reversed, atlas); }), ErrorKind::kNotPossible);
}

// Removals name rows of the list as it is at that moment, before and after other edits of the same list.
TEST(Journal, RemovalsBetweenChangesAreTakenBackInOrder) {
  const Atlas original = SoundAtlas(Base::kMonocular);
  Atlas first = original;
  first.maps[0].points.erase(first.maps[0].points.begin() + 3);
  first.maps[0].points.erase(first.maps[0].points.begin());
  Atlas second = first;
  second.maps[0].points[0].position.x() += 1;
  second.maps[0].points[2].position.x() += 2;
  Atlas third = second;
  third.maps[0].points.erase(third.maps[0].points.begin() + 1);
  Journal journal;
  AppendChanges(original, first, "a", journal);
  AppendChanges(first, second, "b", journal);
  AppendChanges(second, third, "c", journal);
  Atlas atlas = third;
  TakeBack(ParseJournal(ToJson(journal)), atlas);
  EXPECT_THAT(atlas, EqualsAtlas(original));
}

TEST(UndoRepair, RefusesAnotherAtlasAndAChangedJournal) {
  Atlas original = SoundAtlas(Base::kMonocular);
  original.next_ids = {};
  Atlas repaired = original;
  Journal journal = RepairAtlas(repaired).journal;
  ASSERT_FALSE(journal.edits.empty());
  Atlas other = repaired;
  other.maps[0].points[0].position.x() += 1;
  const Atlas same = other;
  EXPECT_EQ(KindOf([&] { UndoRepair(other, journal); }), ErrorKind::kNotPossible);
  EXPECT_THAT(other, EqualsAtlas(same));
  Journal changed = journal;
  ++changed.edits[0].fields[0].before[0];
  Atlas atlas = repaired;
  EXPECT_EQ(KindOf([&] { UndoRepair(atlas, changed); }), ErrorKind::kDamaged);
  atlas = repaired;
  UndoRepair(atlas, journal);
  EXPECT_THAT(atlas, EqualsAtlas(original));
}

// ---- reports

TEST(RepairReport, AsJsonNamesFilesAndFindings) {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  atlas.next_ids = {};
  const std::string json = ToJson(RepairAtlas(atlas), {.input = "a.osa", .output = "b.osa"});
  EXPECT_THAT(json, HasSubstr("\"report\": \"slamdb-repair-2\""));
  EXPECT_THAT(json, HasSubstr("\"input\": \"a.osa\""));
  EXPECT_THAT(json, HasSubstr("\"output\": \"b.osa\""));
  EXPECT_THAT(json, HasSubstr("\"rule\": \"counters-above-ids\""));
  EXPECT_THAT(ToJson(RepairReport(), {.input = "a.osa"}), HasSubstr("\"output\": null"));
}

}  // namespace
}  // namespace slamdb
