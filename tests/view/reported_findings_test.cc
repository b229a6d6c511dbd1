// SPDX-License-Identifier: BSD-3-Clause
// What reports in JSON found, shown in place.
#include <gmock/gmock.h>

#include "slamdb/checks/report.h"
#include "slamdb/edit/merge/merge.h"
#include "slamdb/edit/merge/three_way.h"
#include "tests/support/corrupt.h"
#include "tests/support/error_of.h"
#include "tests/support/kind_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/view/page_data.h"

namespace slamdb::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Atlas BrokenAtlas() {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  for (std::size_t i = 0; i < 3; ++i) atlas.maps[0].points[i].reference = KeyFrameId(4711);
  return atlas;
}

std::string ReportOf(const std::vector<std::string>& names, const Atlas& atlas) {
  std::vector<CheckedFile> files;
  for (const std::string& name : names)
    files.push_back({.name = name, .report = CheckAtlas(atlas), .failure = {}, .file = {}});
  return ToJson(files);
}

// A merge of which both sides changed two points' flags and a parent, and one deleted what the other extended.
std::string MergeOf(const Atlas& atlas) {
  const Map& map = atlas.maps[0];
  ThreeWayReport report;
  const auto changed = [&](Place place, std::string_view what) {
    place.map = map.id;
    report.conflicts.push_back({place, what, BranchSide::kTheirs});
  };
  changed({.point = map.points[7].id}, "flags");
  changed({.keyframe = map.keyframes[1].id}, "deletion");
  changed({.point = map.points[5].id}, "flags");
  changed({.keyframe = map.keyframes[2].id}, "parent");
  return ToJson(report);
}

TEST(ReportedFindings, AreThoseOfTheCheck) {
  const Atlas atlas = BrokenAtlas();
  const std::vector<RuleResult> found = ParseFindings(ReportOf({"a.osa"}, atlas)), own = CheckAtlas(atlas).results;
  ASSERT_EQ(found.size(), own.size());
  for (std::size_t i = 0; i < own.size(); ++i) {
    EXPECT_EQ(found[i].id, own[i].id);
    EXPECT_EQ(found[i].consequence, own[i].consequence);
    EXPECT_EQ(found[i].count, own[i].count);
    EXPECT_EQ(found[i].findings, own[i].findings);
  }
}

TEST(ReportedFindings, OfSeveralAtlasesAreThoseOfTheOneNamed) {
  const std::string both = ReportOf({"a.osa", "b.osa"}, BrokenAtlas());
  EXPECT_FALSE(ParseFindings(both, "b.osa").empty());
  EXPECT_EQ(KindOf([&] { (void)ParseFindings(both, "c.osa"); }), ErrorKind::kNotFound);
  EXPECT_FALSE(ParseFindings(ReportOf({"a.osa"}, BrokenAtlas()), "elsewhere/a.osa").empty()) << "it has no other";
}

TEST(ReportedFindings, ConflictsAreAKindEach) {
  const std::vector<RuleResult> found = ParseFindings(MergeOf(BrokenAtlas()));
  std::vector<std::string> ids;
  for (const RuleResult& result : found) ids.push_back(result.id + " " + std::to_string(result.count));
  EXPECT_THAT(ids, ElementsAre("conflict: flags 2", "conflict: deletion 1", "conflict: parent 1"));
  EXPECT_EQ(found[1].findings[0].message, "deleted by ours, extended by theirs: kept");
  EXPECT_EQ(found[0].severity, Severity::kWarning) << "so that they are shown";
}

TEST(ReportedFindings, RefusesWhatHasNone) {
  for (const auto& [text, kind] :
       {std::pair<std::string, ErrorKind>{"{\"report\": \"slamdb-info-2\"}", ErrorKind::kUsage},
        {ToJson(MergeReport()), ErrorKind::kNotFound},
        {"{\"report\": \"slamdb-check-2\"}", ErrorKind::kDamaged},
        {"{\"report\": \"slamdb-check-2\", \"inputs\": [{\"input\": \"a\", \"failure\": \"cut\"}]}",
         ErrorKind::kNotFound},
        {"{\"report\": \"slamdb-check-2\", \"inputs\": 7}", ErrorKind::kDamaged},
        {"{\"report\": \"slamdb-merge-2\", \"branches\": {\"conflicts\": [{\"aspect\": 7}]}}", ErrorKind::kDamaged},
        {"[]", ErrorKind::kDamaged},
        {"", ErrorKind::kDamaged}})
    EXPECT_EQ(KindOf([&, &json = text] { (void)ParseFindings(json); }), kind) << text;
}

TEST(ReportedFindings, SayWhereTheyAreDamaged) {
  const auto merge = [](const std::string& conflicts) {
    return "{\"report\": \"slamdb-merge-2\", \"branches\": {\"conflicts\": " + conflicts + "}}";
  };
  const auto conflict = [&](const std::string& place) {
    return merge("[{\"aspect\": \"flags\", \"message\": \"\", \"place\": " + place + "}]");
  };
  const auto check = [](const std::string& inputs) {
    return "{\"report\": \"slamdb-check-2\", \"inputs\": " + inputs + "}";
  };
  const std::pair<std::string, std::string> cases[] = {
      {merge("null"), "branches.conflicts: is null, and no list"},
      {merge("{\"a\": 1}"), "branches.conflicts: is {\"a\":1}, and no list"},
      {merge("[{\"aspect\": \"flags\"}]"), "branches.conflicts[0]: "},
      {conflict("null"), "branches.conflicts[0].place: "},
      {conflict("{\"map\": 0, \"keyframe\": \"3\"}"),
       "branches.conflicts[0].place.keyframe: \"3\" is no number; expected 3"},
      {conflict("{\"keyframe\": 3.5}"), "branches.conflicts[0].place.keyframe: 3.5 is no whole number"},
      {conflict("{\"feature\": -2}"), "branches.conflicts[0].place.feature: -2 is no whole number"},
      {conflict("{\"keyframes\": 3}"), "branches.conflicts[0].place.keyframes: is none of map, keyframe, point"},
      {check("null"), "inputs: is null, and no list"},
      {check("[{\"input\": \"a\", \"results\": null}]"), "inputs[0].results: is null, and no list"},
      {check("[{\"input\": \"a\", \"results\": [7]}]"), "inputs[0].results[0]: "},
  };
  for (const auto& [text, says] : cases) {
    const Error error = ErrorOf([&, &json = text] { (void)ParseFindings(json); });
    EXPECT_EQ(error.kind(), ErrorKind::kDamaged) << text;
    EXPECT_THAT(error.what(), HasSubstr(says));
  }
  EXPECT_EQ(ParseFindings(conflict("{\"point\": \"18014398509481984\"}"))[0].findings[0].place.point,
            MapPointId(18014398509481984))
      << "as text beyond what every reader of JSON holds";
}

TEST(ReportedFindings, StandInThePageWhereTheyAre) {
  if (!HasViewPage()) GTEST_SKIP() << "built without esbuild";
  const Atlas atlas = BrokenAtlas();
  const Map& map = atlas.maps[0];
  const ViewInput input{
      .atlas = &atlas, .name = "a", .format = {}, .facts = {}, .findings = ParseFindings(MergeOf(atlas))};
  const PageData page(MakeViewPage({&input, 1}, {.check = false}).html);
  std::vector<std::string> places;
  for (const auto& finding : page.header.at("findings")) {
    const std::string kind = finding.at("kind");
    places.push_back(finding.at("rule").get<std::string>() + ": " + kind + " " + finding.at("id").get<std::string>());
    const std::vector<std::uint64_t> ids = kind == "point" ? page.PointIds() : page.KeyFrameIds();
    EXPECT_EQ(std::to_string(ids.at(finding.at("row"))), finding.at("id"));
  }
  const auto id = [](auto row) { return std::to_string(row.id.value()); };
  EXPECT_THAT(places,
              ElementsAre("conflict: flags: point " + id(map.points[7]), "conflict: flags: point " + id(map.points[5]),
                          "conflict: deletion: keyframe " + id(map.keyframes[1]),
                          "conflict: parent: keyframe " + id(map.keyframes[2])));
}

TEST(ReportedFindings, OfAFileThatIsNoneNameIt) {
  TemporaryFolder folder;
  const std::string path = folder.Make("report.json", "{");
  try {
    (void)ReadFindings(path);
    FAIL() << "read";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("report.json: is not a report of a check or a merge"));
  }
}

}  // namespace
}  // namespace slamdb::testing
