// SPDX-License-Identifier: BSD-3-Clause
//
// --time by the clock, from the first keyframe and to the last, in every verb that selects.
#include <gmock/gmock.h>

#include <algorithm>

#include "slamdb/formats/formats.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Keyframes at 1403636580, 1403636581, ..., 1403636589 seconds; the odd ones in a second map.
class Times : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(RunSlamdb({"synthesize", In("made.osa"), "--maps", "2", "--keyframes", "5", "--points", "200"}).exit_code,
              0);
    Atlas atlas = ReadAtlas(In("made.osa"));
    for (std::size_t m = 0; m < 2; ++m)
      for (std::size_t i = 0; i < 5; ++i)
        atlas.maps[m].keyframes[i].timestamp = 1403636580.0 + 2.0 * static_cast<double>(i) + static_cast<double>(m);
    WriteAtlas(atlas, In("a.osa"));
  }
  std::string In(const std::string& name) const { return folder_ / name; }

  // The seconds behind 1403636580 of the keyframes that a conversion with these words selects.
  std::vector<double> Selected(std::vector<std::string> words, const std::string& input = "a.osa") {
    words.insert(words.begin(), {"convert", In(input), In("out.osa"), "-O", "-q"});
    if (RunSlamdb(words).exit_code != 0) return {};
    std::vector<double> seconds;
    for (const Map& map : ReadAtlas(In("out.osa")).maps)
      for (const KeyFrame& keyframe : map.keyframes) seconds.push_back(keyframe.timestamp - 1403636580.0);
    std::ranges::sort(seconds);
    return seconds;
  }

  TemporaryFolder folder_;
};

TEST_F(Times, CountFromTheFirstKeyframeAndToTheLast) {
  EXPECT_THAT(Selected({"--time", "+0:+3"}), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(Selected({"--time", "1403636580:+1"}), ElementsAre(0, 1));
  EXPECT_THAT(Selected({"--time", "-2:"}), ElementsAre(7, 8, 9));
  EXPECT_THAT(Selected({"--time", "+2:-5"}), ElementsAre(2, 3, 4));
  EXPECT_THAT(Selected({"--time", "+2:-5", "--keyframes", "0:1"}), ElementsAre(2)) << "ids count too";
  EXPECT_THAT(Selected({"--time", "+0:+2", "--map", "1"}), ElementsAre(1, 3)) << "of that map";
  ASSERT_EQ(RunSlamdb({"convert", In("a.osa"), In("m.db#a")}).exit_code, 0);
  EXPECT_THAT(Selected({"--time", ":+1"}, "m.db#a"), ElementsAre(0, 1));
}

TEST_F(Times, InEveryVerbThatSelects) {
  ASSERT_EQ(RunSlamdb({"extract", In("a.osa"), In("part.osa"), "--time", "+0:+3", "--map", "0"}).exit_code, 0);
  EXPECT_EQ(ReadAtlas(In("part.osa")).maps.at(0).keyframes.size(), 2U);
  const ProcessResult dumped = RunSlamdb({"dump", In("a.osa"), "--format", "csv-keyframes", "--time", "-1:"});
  EXPECT_EQ(std::ranges::count(dumped.out, '\n'), 3) << dumped.out;
  ASSERT_EQ(RunSlamdb({"convert", In("a.osa"), In("poses.tum"), "--map", "0"}).exit_code, 0);
  ASSERT_EQ(RunSlamdb({"convert", In("poses.tum"), In("few.tum"), "--time", "+1:+4"}).exit_code, 0);
  EXPECT_EQ(std::ranges::count(ReadWholeFile(In("few.tum")), '\n'), 3) << "a header and two poses";
  const std::string stream =
      "cat '" + In("a.osa") + "' | '" SLAMDB_COMMAND "' dump - --format csv-keyframes --time :+0";
  EXPECT_EQ(std::ranges::count(RunProgram({"bash", "-c", stream}).out, '\n'), 2);
}

TEST_F(Times, OfAMissTellWhichThereAre) {
  const std::string span =
      "; its keyframes are from 1403636580 to 1403636589 s (9 s from 2014-06-24 19:03:00 UTC); +0:+10 are the first "
      "ten "
      "seconds";
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"convert", In("a.osa"), In("x.osa")}, {"extract", In("a.osa"), In("x.osa")}, {"dump", In("a.osa")}}) {
    std::vector<std::string> line = words;
    line.insert(line.end(), {"--time", "10:20"});
    const ProcessResult result = RunSlamdb(line);
    EXPECT_EQ(result.exit_code, words.front() == "dump" ? 0 : 1);
    EXPECT_THAT(result.err, HasSubstr("a.osa: has no keyframe from 10 s to 20 s" + span));
    EXPECT_FALSE(std::filesystem::exists(In("x.osa")));
  }
  EXPECT_THAT(RunSlamdb({"extract", In("a.osa"), In("x.osa"), "--time", "+0.25:+0.75"}).err, HasSubstr(span))
      << "between two keyframes";
}

// The forms that `list` has too.
TEST_F(Times, HaveOneGrammarInAllVerbs) {
  EXPECT_THAT(Selected({"--time", "+2..-5"}), ElementsAre(2, 3, 4));
  EXPECT_THAT(Selected({"--time", "1403636588.."}), ElementsAre(8, 9));
  EXPECT_THAT(Selected({"--time", "..2014-06-24T19:03:01Z"}), ElementsAre(0, 1));
  EXPECT_THAT(Selected({"--time", "2014-06-24T19:03:02Z:2014-06-24T19:03:04Z"}), ElementsAre(2, 3, 4));
  EXPECT_THAT(Selected({"--time", "2014-06-24T19:03:07Z:-1"}), ElementsAre(7, 8));
  EXPECT_THAT(Selected({"--time", "1403636583"}), ElementsAre(3));
  EXPECT_THAT(Selected({"--time", "+0"}), ElementsAre(0));
  EXPECT_EQ(Selected({"--time", "2014-06-24"}).size(), 10U) << "a day is all of it";
  EXPECT_EQ(Selected({"--time", "2014-06-25:"}).size(), 0U);
  EXPECT_THAT(Selected({"--keyframes", "1..2", "--map", "0"}), ElementsAre(2, 4));
  EXPECT_THAT(Selected({"--keyframes", "..0"}), ElementsAre(0));
  EXPECT_THAT(Selected({"--keyframes", "1", "--map", "0"}), ElementsAre(2));
}

TEST_F(Times, CountInPicturesToo) {
  const ProcessResult plot = RunSlamdb({"plot", In("a.osa"), "-o", In("a.svg"), "--time", "+0:+6", "--map", "0"});
  EXPECT_EQ(plot.exit_code, 0) << plot.err;
  EXPECT_THAT(plot.out, HasSubstr("4 keyframes"));
  const ProcessResult view = RunSlamdb({"view", In("a.osa"), "-o", In("a.html"), "--time", "+0:+6", "--map", "0"});
  if (view.err.find("esbuild") == std::string::npos) {
    EXPECT_EQ(view.exit_code, 0) << view.err;
    EXPECT_THAT(view.out, HasSubstr("4 keyframes"));
  }
}

TEST_F(Times, ThatAreNone) {
  for (const char* time : {"9:2", "9..2", "+9:+2", "-2:-9", ":", "..", "a:b", "1:2:3", "++1:", "+-1:", "nan:", "noon",
                           "2014-06-25:2014-06-24", "2014-13-01"}) {
    const ProcessResult result = RunSlamdb({"dump", In("a.osa"), "--time", time});
    EXPECT_EQ(result.exit_code, 2) << time;
    EXPECT_THAT(result.err, HasSubstr("expected a time, or two as BEGIN:END"));
  }
  for (const char* ids : {"9:2", "9..2", ":", "..", "-1", "1.5", "a", "1:2:3"}) {
    const ProcessResult result = RunSlamdb({"dump", In("a.osa"), "--keyframes", ids});
    EXPECT_EQ(result.exit_code, 2) << ids;
    EXPECT_THAT(result.err, HasSubstr("expected a keyframe id, or two as FIRST:LAST"));
  }
}

}  // namespace
}  // namespace slamdb::testing
