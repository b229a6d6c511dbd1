// SPDX-License-Identifier: BSD-3-Clause
// The verbs plot and report at the process boundary.
#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "slamdb/base/detail/concat.h"
#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const std::string kAtlas = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa";
const std::string kBroken = SLAMDB_FIXTURES "/mono_small_twice/mono_small_twice.osa";

class Pictures : public ::testing::Test {
 protected:
  void SetUp() override {
    const ProcessResult tried = RunSlamdb({"plot", kAtlas, "-o", folder_ / "try.svg"});
    if (tried.err.find("built without Cairo") != std::string::npos) GTEST_SKIP() << "needs Cairo";
    fs::remove(folder_ / "try.svg");
  }

  const TemporaryFolder folder_;
};

TEST_F(Pictures, PlotWritesAnOverviewNamedAsTheAtlas) {
  const ProcessResult result = RunProgram(
      {"bash", "-c", "cd '" + folder_.path().string() + "' && '" + SLAMDB_COMMAND + "' plot '" + kAtlas + "'"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out,
            "wrote session_small_a.svg: overview of 1 map, 14 keyframes, 3,162 points, 5.25 m in 17.9 s; 1 point "
            "outside of the frame\n");
  EXPECT_THAT(folder_.Names(), ElementsAre("session_small_a.svg"));
}

TEST_F(Pictures, AreNamedAsAListNamesTheAtlas) {
  fs::copy_file(kAtlas, folder_.path() / "lab.osa.txt");
  const ProcessResult result =
      RunProgram({"bash", "-c",
                  "cd '" + folder_.path().string() + "' && '" + SLAMDB_COMMAND + "' plot lab.osa.txt --kind tracks"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(fs::exists(folder_ / "lab.svg"));
  ASSERT_EQ(RunSlamdb({"report", folder_.path().string(), "-o", folder_ / "out"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "out/lab.html"));
}

TEST_F(Pictures, PlotWaitsForStoresAsOtherVerbsDo) {
  ASSERT_EQ(RunSlamdb({"convert", kAtlas, folder_ / "m.db#a"}).exit_code, 0);
  EXPECT_EQ(
      RunSlamdb({"plot", folder_ / "m.db#a", "--with", folder_ / "m.db#a", "--wait", "0", "-o", folder_ / "a.svg"})
          .exit_code,
      0);
}

TEST_F(Pictures, PlotTakesTheFormatFromTheSuffix) {
  EXPECT_EQ(RunSlamdb({"plot", kAtlas, "--kind", "plan", "-o", folder_ / "a.png"}).exit_code, 0);
  EXPECT_THAT(ReadWholeFile(folder_ / "a.png"), StartsWith("\x89PNG"));
  const ProcessResult other = RunSlamdb({"plot", kAtlas, "-o", folder_ / "a.pdf"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr(".svg or a .png"));
  const ProcessResult piped = RunSlamdb({"plot", kAtlas, "--kind", "tracks", "-o", "-"});
  EXPECT_EQ(piped.exit_code, 0);
  EXPECT_THAT(piped.out, StartsWith("<?xml"));
}

TEST_F(Pictures, PlotReplacesNothingUnasked) {
  ASSERT_EQ(RunSlamdb({"plot", kAtlas, "--kind", "side", "-o", folder_ / "a.svg"}).exit_code, 0);
  const ProcessResult again = RunSlamdb({"plot", kAtlas, "--kind", "side", "-o", folder_ / "a.svg"});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_EQ(RunSlamdb({"plot", kAtlas, "--kind", "side", "-O", "-o", folder_ / "a.svg"}).exit_code, 0);
}

TEST_F(Pictures, PlotOfAPartShowsWhatItsKeyframesSaw) {
  const ProcessResult part = RunSlamdb({"plot", kAtlas, "--time", ":+0", "-o", folder_ / "a.svg"});
  ASSERT_EQ(part.exit_code, 0) << part.err;
  EXPECT_THAT(part.out, HasSubstr("1 keyframe, "));
  EXPECT_THAT(part.out, Not(HasSubstr("3,162 points")));
}

TEST_F(Pictures, PlotOfAPartOfNothingIsRefused) {
  const std::pair<std::vector<std::string>, const char*> misses[] = {{{"--map", "7"}, "has no map 7"},
                                                                     {{"--time", "0:10"}, "its keyframes are from"},
                                                                     {{"--keyframes", "99999:"}, "has no keyframe of"}};
  for (const auto& [words, problem] : misses) {
    std::vector<std::string> line{"plot", kAtlas, "-o", folder_ / "a.svg"};
    line.insert(line.end(), words.begin(), words.end());
    const ProcessResult result = RunSlamdb(line);
    EXPECT_EQ(result.exit_code, 1) << problem;
    EXPECT_THAT(result.err, HasSubstr(problem));
    EXPECT_FALSE(fs::exists(folder_ / "a.svg"));
  }
}

TEST_F(Pictures, PlotHoldsATrajectoryAgainstATruth) {
  const std::string truth = SLAMDB_FIXTURES "/session_small_a/truth.txt";
  const ProcessResult result = RunSlamdb({"plot", kAtlas, "--with", truth, "-o", folder_ / "error.svg"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("trajectory of 1 map"));
  EXPECT_EQ(RunSlamdb({"plot", kAtlas, "--with", truth, "--kind", "plan", "-o", folder_ / "x.svg"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"plot", kAtlas, "--body", "-o", folder_ / "x.svg"}).exit_code, 2);
}

// Where the truth has no pose at the time of a keyframe, as well: both take the nearest.
TEST_F(Pictures, PlotTellsTheErrorOfEvaluate) {
  const std::string truth = SLAMDB_FIXTURES "/session_small_a/truth.txt";
  for (const std::string align : {"se3", "sim3"}) {
    const std::vector<std::string> how{kAtlas, "--time-offset", "0.007", "--align", align};
    std::vector<std::string> evaluate{"evaluate", truth, "--json"}, plot{"plot", "--with", truth, "-O", "-o", "-"};
    evaluate.insert(evaluate.begin() + 1, how.begin(), how.end());
    plot.insert(plot.end(), how.begin(), how.end());
    const auto json = nlohmann::json::parse(RunSlamdb(evaluate).out);
    const auto rmse = json.at("evaluations").at(0).at("absolute").at("translation").at("rmse").get<double>();
    EXPECT_THAT(RunSlamdb(plot).out, HasSubstr("; rmse " + detail::Digits(rmse, 4) + " m<"));
  }
  // A trajectory has its scale, though nothing in its atlas tells one.
  ASSERT_EQ(RunSlamdb({"convert", kAtlas, folder_ / "path.tum"}).exit_code, 0);
  EXPECT_THAT(RunSlamdb({"plot", folder_ / "path.tum", "--with", truth, "-o", "-"}).out,
              HasSubstr("; rmse 0.01763 m<"));
}

TEST_F(Pictures, ReportWritesOnePageOfOneAtlas) {
  const ProcessResult result = RunSlamdb({"report", kAtlas, "-o", folder_ / "lab.html"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("wrote " + (folder_ / "lab.html")));
  EXPECT_THAT(ReadWholeFile(folder_ / "lab.html"), HasSubstr("<svg "));
}

TEST_F(Pictures, ReportOfAGateThatIsNotPassedEndsWithOne) {
  EXPECT_EQ(RunSlamdb({"report", kAtlas, "-o", folder_ / "lab.html", "--min-keyframes", "10"}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"report", kAtlas, "-O", "-o", folder_ / "lab.html", "--min-keyframes", "100"}).exit_code, 1);
  EXPECT_THAT(ReadWholeFile(folder_ / "lab.html"), HasSubstr("not passed"));
}

TEST_F(Pictures, ReportOfAFolderHasARowForWhatCannotBeRead) {
  const fs::path maps = folder_.path() / "maps";
  fs::create_directory(maps);
  fs::copy_file(kAtlas, maps / "good.osa");
  fs::copy_file(kBroken, maps / "twice.osa");
  WriteWholeFile((maps / "cut.osa").string(), ReadWholeFile(kAtlas).substr(0, 100'000));
  fs::copy_file(kAtlas, maps / "<b>bold<b>.osa");
  const ProcessResult result = RunSlamdb({"report", maps.string(), "-o", folder_ / "out", "--json"});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(BreachOf(json, "report.schema.json"), "");
  ASSERT_EQ(json.at("inputs").size(), 4U);
  EXPECT_THAT(json.at("inputs").at(1).at("failure").get<std::string>(), HasSubstr("truncated"));
  EXPECT_EQ(json.at("inputs").at(3).at("sound"), false);
  EXPECT_TRUE(fs::exists(folder_ / "out/index.html"));
  EXPECT_TRUE(fs::exists(folder_ / "out/good.html"));
  EXPECT_TRUE(fs::exists(folder_ / "out/_b_bold_b_.html"));
  const std::string index = ReadWholeFile(folder_ / "out/index.html");
  EXPECT_THAT(index, HasSubstr("&lt;b&gt;bold"));
  EXPECT_THAT(index, HasSubstr("truncated"));
  EXPECT_THAT(index, HasSubstr("<h1>maps</h1>")) << "as the folder is called";
  EXPECT_THAT(ReadWholeFile(folder_ / "out/good.html"), HasSubstr("<a href=\"index.html\">"));
  EXPECT_EQ(RunSlamdb({"report", maps.string(), "-o", folder_ / "out"}).exit_code, 1);  // pages are there
}

TEST_F(Pictures, ReportOfAStoreHasAPageForEachAtlas) {
  const std::string store = folder_ / "maps.db";
  ASSERT_EQ(RunSlamdb({"convert", kAtlas, store + "#lab"}).exit_code, 0);
  ASSERT_EQ(RunSlamdb({"convert", kAtlas, store + "#index"}).exit_code, 0);
  const ProcessResult result = RunSlamdb({"report", store, "-o", folder_ / "out"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(fs::exists(folder_ / "out/lab.html"));
  EXPECT_TRUE(fs::exists(folder_ / "out/index_.html"));
  const std::string index = ReadWholeFile(folder_ / "out/index.html");
  EXPECT_THAT(index, HasSubstr(" MB</td>")) << "about what each takes in the store";
}

TEST_F(Pictures, ReportShowsNamesInOneLine) {
  fs::create_directory(folder_ / "maps");
  fs::copy_file(kAtlas, folder_ / "maps/a\nb.osa: sound.osa");
  const ProcessResult result = RunSlamdb({"report", folder_ / "maps", "-o", folder_ / "out"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(std::ranges::count(result.out, '\n'), 2) << result.out;
  EXPECT_THAT(result.out, HasSubstr("a\\nb.osa"));
}

// Some file systems and archives take capitals for small letters.
TEST_F(Pictures, ReportPagesDifferByMoreThanCapitals) {
  const std::string store = folder_ / "maps.db";
  for (const char* name : {"#lab", "#Lab", "#Index"})
    ASSERT_EQ(RunSlamdb({"convert", kAtlas, store + name}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"report", store, "-o", folder_ / "out"}).exit_code, 0);
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_ / "out")) {
    std::string name = entry.path().filename().string();
    std::ranges::transform(name, name.begin(), [](unsigned char letter) { return std::tolower(letter); });
    names.insert(name);
  }
  EXPECT_THAT(names, ElementsAre("index.html", "index_.html", "lab-2.html", "lab.html"));
}

TEST_F(Pictures, PlotRefusesNumbersThatAreNone) {
  EXPECT_EQ(RunSlamdb({"plot", kAtlas, "--scale", "nan", "-o", folder_ / "x.png"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"plot", kAtlas, "--width", "200", "-o", folder_ / "x.png"}).exit_code, 2);
}

TEST_F(Pictures, ReportNamesItsPagesAsTheyAre) {
  EXPECT_EQ(RunSlamdb({"report", kAtlas, "-o", folder_ / "lab.png"}).exit_code, 2);
  const ProcessResult several = RunSlamdb({"report", kAtlas, kBroken, "-o", folder_ / "two.html"});
  EXPECT_EQ(several.exit_code, 2);
  EXPECT_THAT(several.err, HasSubstr("two.html names a file; name a folder, as " + (folder_ / "two/")));
  EXPECT_THAT(folder_.Names(), ElementsAre());
  for (const char* folder : {"one/", "two"}) {
    EXPECT_EQ(RunSlamdb({"report", kAtlas, "-o", folder_ / folder}).exit_code, 0);
    EXPECT_TRUE(fs::exists(folder_.path() / folder / "session_small_a.html")) << folder;
  }
}

// It is the page that cannot be written, not the atlas that cannot be read.
TEST_F(Pictures, ReportThatIsThereIsRefusedAtOnce) {
  const auto refused = [&](const std::string& output, const std::string& there) {
    const ProcessResult result = RunSlamdb({"report", kAtlas, "-o", folder_ / output});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.err, "slamdb: error: " + (folder_ / there) + ": is there already; -O/--overwrite replaces it\n");
  };
  ASSERT_EQ(RunSlamdb({"report", kAtlas, "-o", folder_ / "lab.html"}).exit_code, 0);
  refused("lab.html", "lab.html");
  fs::create_directory(folder_ / "pages");
  WriteWholeFile(folder_ / "pages/index.html", "mine");
  const ProcessResult pages = RunSlamdb({"report", kAtlas, "-o", folder_ / "pages"});
  EXPECT_EQ(pages.exit_code, 1);
  EXPECT_EQ(pages.out, "");
  EXPECT_THAT(pages.err,
              HasSubstr("is there already and holds files; -O/--overwrite replaces those of the same names"));
  EXPECT_EQ(fs::exists(folder_ / "pages/session_small_a.html"), false);
}

TEST_F(Pictures, ReportThatCannotBeWrittenSaysSo) {
  const ProcessResult result = RunSlamdb({"report", kAtlas, "-o", folder_ / "none/lab.html"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err, HasSubstr("none"));
}

TEST_F(Pictures, ReportIsNamedAsTheAtlas) {
  const std::string here = "cd '" + folder_.path().string() + "' && '" + SLAMDB_COMMAND + "' report '";
  const ProcessResult one = RunProgram({"bash", "-c", here + kAtlas + "'"});
  EXPECT_EQ(one.exit_code, 0) << one.err;
  EXPECT_THAT(one.out, HasSubstr("wrote session_small_a.html"));
  RunProgram({"bash", "-c", here + kAtlas + "' '" + kBroken + "'"});
  EXPECT_THAT(folder_.Names(), ElementsAre("report", "session_small_a.html"));
  EXPECT_TRUE(fs::exists(folder_ / "report/index.html"));
}

TEST_F(Pictures, ReportOfAnEmptyFolderSaysSo) {
  fs::create_directory(folder_ / "none");
  const ProcessResult result = RunSlamdb({"report", folder_ / "none", "-o", folder_ / "out"});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr("no atlas"));
}

}  // namespace
}  // namespace slamdb::testing
