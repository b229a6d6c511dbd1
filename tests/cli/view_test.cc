// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <gmock/gmock.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "slamdb/view/page.h"
#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class View : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!HasViewPage()) GTEST_SKIP() << "built without esbuild";
    for (const char* name : {"a", "b"})
      RunSlamdb({"synthesize", In(std::string(name) + ".osa"), "--keyframes", "8", "--points", "200", "--features",
                 "200", "--maps", "2", "-q"});
  }
  std::string In(const std::string& name) const { return folder_ / name; }
  ProcessResult RunHere(const std::string& command) const {
    return RunProgram({"bash", "-c", "cd '" + In("") + "' && '" SLAMDB_COMMAND "' " + command});
  }

  TemporaryFolder folder_;
};

TEST_F(View, WritesAPageNamedAsTheAtlas) {
  const ProcessResult result = RunHere("view a.osa");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, StartsWith("wrote a.html: 2 maps, 16 keyframes, 400 points; "));
  EXPECT_THAT(ReadWholeFile(In("a.html")), StartsWith("<!DOCTYPE html>"));
  RunSlamdb({"convert", In("a.osa"), In("m.db#hall"), "-q"});
  EXPECT_EQ(RunHere("view m.db").exit_code, 0);
  EXPECT_TRUE(fs::exists(In("m.html")));
  RunHere("view 'm.db#hall'");
  EXPECT_TRUE(fs::exists(In("hall.html")));
}

TEST_F(View, ReplacesOnlyWhenAsked) {
  WriteWholeFile(In("a.html"), "mine");
  const ProcessResult refused = RunHere("view a.osa");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("a.html: is there already; -O/--overwrite replaces it"));
  EXPECT_EQ(ReadWholeFile(In("a.html")), "mine");
  EXPECT_EQ(RunHere("view a.osa -O").exit_code, 0);
  const std::string atlas = ReadWholeFile(In("a.osa"));
  EXPECT_EQ(RunHere("view a.osa -O -o a.osa").exit_code, 1) << "an input is no output";
  EXPECT_EQ(ReadWholeFile(In("a.osa")), atlas);
}

TEST_F(View, JsonSaysWhatWasWritten) {
  const ProcessResult result = RunSlamdb({"view", In("a.osa"), In("b.osa"), "-o", In("x.html"), "--json"});
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "view.schema.json"), "");
  EXPECT_EQ(report.at("bytes"), fs::file_size(In("x.html")));
  EXPECT_EQ(report.at("maps"), 4);
  EXPECT_EQ(report.at("inputs").size(), 2U);
}

// As convert and evaluate do it: what goes to standard output is the page alone.
TEST_F(View, JsonIsOnStandardErrorBesideAPage) {
  const ProcessResult result = RunSlamdb({"view", In("a.osa"), "-o", "-", "--json"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(result.out.ends_with("</html>\n"));
  const json report = json::parse(result.err);
  EXPECT_EQ(BreachOf(report, "view.schema.json"), "");
  EXPECT_EQ(report.at("bytes"), result.out.size());
}

TEST_F(View, TellsWhatIsLeftOutInTheWordsOfTheCommand) {
  ASSERT_EQ(RunSlamdb({"landmarks", "from-points", In("a.osa"), In("m.db"), "-q"}).exit_code, 0);
  const ProcessResult result = RunSlamdb({"view", In("m.db"), "-o", In("x.html"), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string left_out = json::parse(result.out).at("left_out").at(0).get<std::string>();
  EXPECT_THAT(left_out, HasSubstr("`slamdb landmarks to-points` makes points of them"));
  EXPECT_THAT(result.err, HasSubstr(left_out));
}

TEST_F(View, CallsAnAtlasWhatAListCallsIt) {
  fs::copy_file(In("a.osa"), In("lab.osa.txt"));
  EXPECT_EQ(RunHere("view lab.osa.txt").exit_code, 0);
  EXPECT_TRUE(fs::exists(In("lab.html")));
}

TEST_F(View, GoesToStandardOutput) {
  const ProcessResult result = RunSlamdb({"view", In("a.osa"), "-o", "-"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, StartsWith("<!DOCTYPE html>"));
  EXPECT_TRUE(result.out.ends_with("</html>\n"));
  const ProcessResult piped = RunSlamdb({"view", "-", "-o", "-"}, ReadWholeFile(In("a.osa")));
  EXPECT_EQ(piped.exit_code, 0) << piped.err;
  EXPECT_EQ(RunSlamdb({"view", "-"}, ReadWholeFile(In("a.osa"))).exit_code, 2) << "nothing names the page";
}

TEST_F(View, FindingsOfAnotherAtlasAreToldToBe) {
  for (const char* kind : {"map", "keyframe", "point", "camera", "landmark"}) {
    std::ofstream(In("merge.json")) << R"({"report":"slamdb-merge-2","branches":{"conflicts":[{"aspect":"flags",)"
                                    << R"("message":"both","place":{")" << kind << R"(":987654}}]}})";
    const ProcessResult result = RunHere("view a.osa --findings merge.json -O -o x.html");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("1 of 1 finding of merge.json is of what a.osa does not have")) << kind;
  }
}

TEST_F(View, APartIsNotChecked) {
  const ProcessResult result = RunSlamdb({"view", In("a.osa"), "--map", "1", "-o", In("x.html"), "--json"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(json::parse(result.out).at("maps"), 1);
  EXPECT_EQ(json::parse(result.out).at("findings"), 0);
  EXPECT_THAT(result.err, HasSubstr("findings"));
}

TEST_F(View, OfAPartShowsWhatItsKeyframesSaw) {
  const ProcessResult start = RunSlamdb({"view", In("a.osa"), "--time", ":+0", "-o", In("x.html"), "--json"});
  ASSERT_EQ(start.exit_code, 0) << start.err;
  const json report = json::parse(start.out);
  EXPECT_GT(report.at("keyframes"), 0);
  EXPECT_LT(report.at("keyframes"), 16);
  EXPECT_GT(report.at("points"), 0);
  EXPECT_LT(report.at("points"), 400);
}

TEST_F(View, RefusesAPartOfNothing) {
  const std::pair<std::vector<std::string>, const char*> misses[] = {{{"--map", "7"}, "has no map 7"},
                                                                     {{"--time", "5:7"}, "has no keyframe from"},
                                                                     {{"--keyframes", "99:"}, "has no keyframe of"},
                                                                     {{"--box", "90,90,90:91,91,91"}, "in the box"}};
  for (const auto& [words, problem] : misses) {
    std::vector<std::string> line{"view", In("a.osa"), "-o", In("x.html")};
    line.insert(line.end(), words.begin(), words.end());
    const ProcessResult result = RunSlamdb(line);
    EXPECT_EQ(result.exit_code, 1) << problem;
    EXPECT_THAT(result.err, HasSubstr(problem));
    EXPECT_FALSE(fs::exists(In("x.html")));
  }
}

TEST_F(View, WrongUseIsSaidAtOnce) {
  EXPECT_EQ(RunSlamdb({"view"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"view", In("a.osa"), "--keypoints", "some"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"view", In("a.osa"), "--port", "80"}).exit_code, 2) << "without --serve";
  EXPECT_EQ(RunSlamdb({"view", In("a.osa"), "--diff", "-o", In("x.html")}).exit_code, 2) << "of one atlas";
  const ProcessResult picture = RunSlamdb({"view", In("a.osa"), "-o", In("x.png")});
  EXPECT_EQ(picture.exit_code, 2);
  EXPECT_THAT(picture.err, HasSubstr("x.png does not say; name it " + In("x.html")));
  EXPECT_FALSE(fs::exists(In("x.png")));
  EXPECT_EQ(RunSlamdb({"view", In("none.osa"), "-o", In("x.html")}).exit_code, 1);
  EXPECT_EQ(RunSlamdb({"view", In("a.osa"), "-o", In("none/x.html")}).exit_code, 1);
  EXPECT_FALSE(fs::exists(In("x.html")));
}

TEST_F(View, OpensTheBrowserThatIsNamed) {
  WriteWholeFile(In("browser"), "#!/bin/sh\necho \"$1\" >'" + In("opened.part") + "'\nmv '" + In("opened.part") +
                                    "' '" + In("opened") + "'\n");
  fs::permissions(In("browser"), fs::perms::owner_all);
  EXPECT_EQ(
      RunProgram({"env", "BROWSER=" + In("browser"), SLAMDB_COMMAND, "view", In("a.osa"), "-o", In("x.html"), "--open"})
          .exit_code,
      0);
  for (int i = 0; i < 200 && !fs::exists(In("opened")); ++i) ::usleep(50'000);
  EXPECT_EQ(ReadWholeFile(In("opened")), In("x.html") + "\n");
}

TEST_F(View, SaysWhatItOpensAndWhatItCannot) {
  const auto open = [&](const std::string& browser) {
    return RunProgram({"env", "BROWSER=" + browser, "PATH=/nowhere", SLAMDB_COMMAND, "view", In("a.osa"), "-o",
                       In("x.html"), "-O", "--open"});
  };
  const ProcessResult missing = open("/nonexistent");
  EXPECT_EQ(missing.exit_code, 0);
  EXPECT_THAT(missing.err, HasSubstr("warning: /nonexistent, which BROWSER names, cannot be run"));
  EXPECT_THAT(missing.err, HasSubstr("warning: no browser was found that opens it"));
  const ProcessResult failing = open("/bin/false");
  EXPECT_THAT(failing.err, HasSubstr("note: opening " + In("x.html") + " with /bin/false"));
  EXPECT_THAT(failing.err, HasSubstr("warning: /bin/false ended with status 1"));
  WriteWholeFile(In("stays"), "#!/bin/sh\nexec /bin/sleep 5\n");
  fs::permissions(In("stays"), fs::perms::owner_all);
  const ProcessResult staying = open(In("stays"));
  EXPECT_EQ(staying.err, "slamdb: note: opening " + In("x.html") + " with " + In("stays") + "\n");
}

TEST_F(View, ServesUntilCtrlC) {
  const std::string out = In("out");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT, 0600);
  const std::string atlas = In("a.osa");
  const char* words[] = {SLAMDB_COMMAND, "view", atlas.c_str(), "--serve", nullptr};
  pid_t process = 0;
  ASSERT_EQ(::posix_spawn(&process, words[0], &actions, nullptr, const_cast<char**>(words), environ), 0);
  posix_spawn_file_actions_destroy(&actions);
  std::string said;
  for (int i = 0; i < 400 && said.find('\n') == std::string::npos; ++i) {
    ::usleep(25'000);
    if (fs::exists(out)) said = ReadWholeFile(out);
  }
  EXPECT_THAT(said, ContainsRegex("^serving at http://127.0.0.1:[0-9]+/ until Ctrl-C\n$"));
  EXPECT_FALSE(fs::exists(In("a.html")));
  ::kill(process, SIGINT);
  int status = 0;
  ::waitpid(process, &status, 0);
  EXPECT_TRUE(WIFEXITED(status)) << status;
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace slamdb::testing
