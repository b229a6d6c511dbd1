// SPDX-License-Identifier: BSD-3-Clause
//
// What every verb does with command lines and inputs that are wrong.
#include <gmock/gmock.h>
#include <unistd.h>

#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const std::string kTiny = SLAMDB_FIXTURES "/tiny/tiny.osa";

// Every way to name one input and nothing else that could be wrong.
std::vector<std::vector<std::string>> CommandsReading(const std::string& path, const std::string& output) {
  return {{"info", path},  {"info", path, "--json"},  {"show", path, "map/0"},     {"dump", path},
          {"check", path}, {"convert", path, output}, {"vocabulary", "show", path}};
}

void ExpectFailure(const std::string& path) {
  const TemporaryFolder folder;
  for (const auto& command : CommandsReading(path, folder / "out.osa")) {
    SCOPED_TRACE(command.front() + " " + path);
    const ProcessResult result = RunSlamdb(command);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, StartsWith("slamdb: error: "));
    EXPECT_THAT(result.err, HasSubstr(path));
    EXPECT_FALSE(std::filesystem::exists(folder / "out.osa"));
  }
}

// The library speaks of its own options; the command names its switches.
TEST(Errors, SpeakOfTheSwitchesOfTheCommand) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "there.osa", "mine");
  WriteWholeFile(folder / "voc.txt", "10 6  0 0 \n0 0 252 188");
  WriteWholeFile(folder / "frames.txt", "# Frame list with one line of data per frame:\n");
  ASSERT_EQ(RunSlamdb({"convert", kTiny, folder / "maps.db#lab"}).exit_code, 0);
  struct Case {
    std::vector<std::string> words;
    std::string says;
  };
  const Case cases[] = {
      {{"convert", kTiny, folder / "there.osa"}, "there.osa: is there already; -O/--overwrite replaces it"},
      {{"convert", kTiny, folder / "maps.db#lab"}, "holds an atlas named 'lab' already; -O/--overwrite replaces it"},
      {{"convert", kTiny, "-"}, "standard output has no suffix to tell the format by; --to names it (orbslam3, "},
      {{"convert", kTiny, folder / "model"}, "its suffix tells no format; perhaps --to colmap is meant; `slamdb"},
      {{"convert", kTiny, folder / "model/"}, "its suffix tells no format; perhaps --to colmap is meant; `slamdb"},
      {{"convert", kTiny, folder / "transforms.json"},
       "its suffix tells no format; perhaps a folder with --to nerf is meant; `slamdb"},
      {{"convert", kTiny, folder / "transforms.json", "--to", "nerf"},
       "a scene for NeRFs is a folder of files; name it " + (folder / "transforms")},
      {{"convert", kTiny, folder / "model.ply", "--to", "COLMAP"}, "name it " + (folder / "model")},
      {{"convert", kTiny, folder / "a.osmap"}, "its suffix tells no format; perhaps --to osmap is meant; `slamdb"},
      {{"convert", kTiny, folder / "map.bin"}, "its suffix tells no format; perhaps --to osmap is meant; `slamdb"},
      {{"convert", kTiny, folder / "a.zzz"},
       "tells no format; others do, such as .osa, .db, .ply, .tum, .csv; `slamdb"},
      {{"convert", kTiny, folder / "a.gltf"}, "a.gltf: its suffix tells no format; the nearest is .glb"},
      {{"convert", kTiny, folder / "a.gltf", "--to", "gltf"},
       "is something else than a glTF scene; name it " + (folder / "a.glb")},
      {{"convert", kTiny, folder / "a.KMZ", "--to", "kml"}, "name it " + (folder / "a.kml")},
      {{"info", "-"}, "-: is empty; was the program that saved it stopped before it could?"},
      {{"convert", kTiny, folder / "a.ply", "--strict"}, "; --strict refuses that"},
      {{"info", folder / "frames.txt"}, "frames.txt of a COLMAP model; give the folder that it is in"},
      {{"info", folder / "voc.txt"}, "`slamdb vocabulary show` tells its name and MD5"},
      {{"convert", kTiny, folder / "a.ply", "--map", "7"}, "has no map 7"},
  };
  for (const auto& [words, says] : cases) {
    const ProcessResult result = RunSlamdb(words);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, HasSubstr(says));
    EXPECT_THAT(result.err, Not(HasSubstr("::")));
  }
}

TEST(Errors, InReportsSpeakOfTheSwitchesToo) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "zeros.osa", std::string(100, '\0'));
  const ProcessResult result = RunSlamdb({"check", folder / "zeros.osa", "--json"});
  EXPECT_THAT(result.out, HasSubstr("`slamdb recover` looks for"));
  EXPECT_THAT(result.out, Not(HasSubstr("::")));
}

TEST(Errors, MissingFile) { ExpectFailure("/nowhere/missing.osa"); }

TEST(Errors, Folder) { ExpectFailure(SLAMDB_FIXTURES); }

TEST(Errors, EmptyFile) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "empty.osa", "");
  ExpectFailure(folder / "empty.osa");
}

TEST(Errors, FileOfAnotherKind) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "notes.txt", "Buy milk.\n");
  for (const char* verb : {"info", "check", "dump"}) {
    const ProcessResult result = RunSlamdb({verb, folder / "notes.txt"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, HasSubstr("notes.txt"));
  }
}

TEST(Errors, TruncatedFile) {
  const TemporaryFolder folder;
  const std::string whole = ReadWholeFile(kTiny);
  WriteWholeFile(folder / "cut.osa", whole.substr(0, whole.size() / 2));
  const ProcessResult result = RunSlamdb({"info", folder / "cut.osa"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("truncated"));
  EXPECT_THAT(result.err, HasSubstr("; `slamdb recover` saves what is whole\n"));
}

TEST(Errors, OfOneInputAreToldOnce) {
  for (const char* verb : {"check", "list"}) {
    const ProcessResult result = RunSlamdb({verb, "/nowhere/none.osa"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.err, "slamdb: error: /nowhere/none.osa: cannot open: No such file or directory\n");
  }
}

TEST(Errors, OfAFileThatIsNotThereTellTheOneMeant) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "mono_small.osa", ReadWholeFile(kTiny));
  WriteWholeFile(folder / "mono_small.html", "<!DOCTYPE html>");
  const std::string meant = "did you mean '" + (folder / "mono_small.osa") + "'?";
  for (const char* typed : {"mono_small", "mono_small.oas"}) {
    const ProcessResult result = RunSlamdb({"info", folder / typed});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, HasSubstr(meant)) << typed;
    const ProcessResult alone = RunSlamdb({folder / typed});
    EXPECT_EQ(alone.exit_code, 2);
    EXPECT_THAT(alone.err, HasSubstr(meant + "\nTry: slamdb " + (folder / "mono_small.osa"))) << typed;
  }
  EXPECT_THAT(RunSlamdb({"info", folder.path().string()}).err, HasSubstr(meant.substr(0, 13)));
  WriteWholeFile(folder / "mono_smalk.osa", ReadWholeFile(kTiny));
  EXPECT_THAT(RunSlamdb({"info", folder / "mono_smal.osa"}).err, Not(HasSubstr("did you mean"))) << "either";
  EXPECT_THAT(RunSlamdb({"info", folder.path().string()}).err, Not(HasSubstr("did you mean"))) << "one of two";
}

TEST(Errors, OfSeveralInputsAreToldOnce) {
  for (const char* verb : {"check", "list"}) {
    const ProcessResult result = RunSlamdb({verb, "/nowhere/none.osa", kTiny});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.out, HasSubstr("cannot open: No such file or directory")) << verb;
    EXPECT_EQ(result.err, "slamdb: error: 1 of 2 could not be read\n") << verb;
  }
  const TemporaryFolder folder;
  const ProcessResult filed = RunSlamdb({"check", "/nowhere/none.osa", kTiny, "-o", folder / "findings.txt"});
  EXPECT_THAT(filed.err, HasSubstr("none.osa: cannot open")) << "where it is not seen";
}

TEST(Errors, OneBadInputOfSeveralDoesNotHideTheOthers) {
  const ProcessResult result = RunSlamdb({"info", "/nowhere/missing.osa", kTiny});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("missing.osa"));
  EXPECT_THAT(result.out, HasSubstr("tiny.osa"));
}

void ExpectUsageError(const std::vector<std::string>& arguments, const std::string& text) {
  const ProcessResult result = RunSlamdb(arguments);
  SCOPED_TRACE(result.err);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err, StartsWith("slamdb: error: "));
  EXPECT_THAT(result.err, HasSubstr(text));
  EXPECT_THAT(result.err, HasSubstr("\nTry: slamdb "));
}

TEST(Usage, NoVerb) {
  const ProcessResult result = RunSlamdb({});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err, StartsWith("slamdb - "));
  EXPECT_THAT(result.err, HasSubstr("slamdb: error: a verb is missing\nTry: slamdb --help\n"));
}
TEST(Usage, MistypedVerb) { ExpectUsageError({"inof", kTiny}, "did you mean 'info'?"); }
TEST(Usage, ShortenedVerb) { ExpectUsageError({"synth"}, "did you mean 'synthesize'?"); }
TEST(Usage, StrangeVerb) { ExpectUsageError({"frobnicate"}, "unknown verb 'frobnicate'"); }
TEST(Usage, MistypedOption) { ExpectUsageError({"info", "--jsno", kTiny}, "did you mean '--json'?"); }
TEST(Usage, UnknownShortOption) { ExpectUsageError({"info", "-Z", kTiny}, "unknown option '-Z'"); }
TEST(Usage, MissingVerbOfVerb) { ExpectUsageError({"vocabulary"}, "a verb is missing"); }
TEST(Usage, MissingOptionValue) { ExpectUsageError({"convert", kTiny, "out.osa", "--to"}, "--to"); }
TEST(Usage, OptionGivenTwice) {
  ExpectUsageError({"view", kTiny, "-o", "a", "-o", "b"}, "--output: it is given more than once");
}
TEST(Usage, UnknownFormat) { ExpectUsageError({"convert", kTiny, "out.osa", "--to", "xml"}, "xml"); }
TEST(Usage, TooManyArguments) { ExpectUsageError({"convert", kTiny, "out.osa", "more.osa"}, "'more.osa'"); }
TEST(Usage, RangeThatIsNone) { ExpectUsageError({"dump", kTiny, "--keyframes", "9:2"}, "FIRST:LAST"); }
TEST(Usage, BoxThatIsNone) { ExpectUsageError({"dump", kTiny, "--box", "1,2:3"}, "X,Y,Z:X,Y,Z"); }
TEST(Usage, BoostVersionOutOfRange) {
  for (const char* version : {"3", "21", "1.86", "1.52", "ubuntu26.04", "1", "1.x", "-1"})
    ExpectUsageError({"convert", kTiny, "out.osa", std::string("--boost-version=") + version},
                     "expected a release of Boost (1.53 to 1.85), a system (ubuntu20.04, debian12, noetic");
  ExpectUsageError({"convert", kTiny, "out.osa", "--boost-version", "ubunut20.04"}, "did you mean 'ubuntu20.04'?");
}

// What CLI11 finds is said as slamdb says it.
TEST(Usage, IsSaidInOneWay) {
  const std::pair<std::vector<std::string>, std::string> cases[] = {
      {{"info"}, "FILE is missing"},
      {{"convert", kTiny}, "the output is missing"},
      {{"convert", kTiny, "a.osa", "--to"}, "--to: a value is missing"},
      {{"convert", kTiny, "a.osa", "--to", "tumm"}, "found 'tumm'; did you mean 'tum'?"},
      {{"convert", kTiny, "a.osa", "--map", "x"}, "--map: expected a whole number, 0 or above, found 'x'"},
      {{"info", kTiny, "--json=x"}, "--json takes no value"},
      {{"view", kTiny, "--serve", "--port", "99999"}, "--port: expected a number from 0 to 65535, found '99999'"},
      {{"convert", kTiny, "a.x", "--to", "foxglove"}, "--to: unknown format 'foxglove'; what it reads is mcap"},
      {{"convert", kTiny, "a.x", "--to", "splat"}, "unknown format 'splat'; what it reads is 3dgs"},
      {{"convert", kTiny, "a.x", "--to", "nerfstudio"}, "unknown format 'nerfstudio'; what it reads is nerf"},
      {{"convert", kTiny, "a.x", "--to", "gaussian"}, "unknown format 'gaussian'; what it reads is 3dgs"},
      {{"convert", kTiny, "a.x", "--to", "openvslam"}, "unknown format 'openvslam'; what it reads is stella"},
      {{"convert", kTiny, "a.x", "--to", "stella_vslam"}, "unknown format 'stella_vslam'; what it reads is stella"},
      {{"convert", kTiny, "a.x", "--to", "colmap-bin"}, "unknown format 'colmap-bin'; what it reads is colmap"},
      {{"info", kTiny, "--threads", "-1"}, "--threads: expected a number from 0 to 1024, found '-1'"},
      {{"merge", kTiny, "-o", "a.osa", "--fuse"}, "--fuse needs --join or --base"},
      {{"convert", kTiny, "a.osa", "-o", "b.osa"}, "exclude each other"},
      {{"convert", kTiny, "a.osa", "--force"}, "unknown option '--force'; here it is --overwrite"},
      {{"check", kTiny, "--ignore", "map-listed-twice"}, "did you mean 'map-listed-once'?"},
  };
  for (const auto& [words, says] : cases) ExpectUsageError(words, says);
}

// CLI11 would take it for the largest number there is.
TEST(Usage, NumbersWithoutSignHaveNone) {
  const std::vector<std::string> cases[] = {
      {"check", kTiny, "--max-findings"},
      {"diff", kTiny, kTiny, "--max-listed"},
      {"evaluate", kTiny, kTiny, "--map"},
      {"evaluate", kTiny, kTiny, "--reference-map"},
      {"extract", kTiny, "--dry-run", "--keyframe"},
      {"extract", kTiny, "--dry-run", "--session"},
      {"plot", kTiny, "--map"},
      {"reassign-origin", kTiny, "--dry-run", "--set"},
      {"synthesize", "none.osa", "--keyframes"},
      {"synthesize", "none.osa", "--seed"},
      {"transform", kTiny, "--dry-run", "--scale", "2", "--map"},
  };
  for (std::vector<std::string> words : cases)
    for (const char* value : {"-1", "1.5"}) {
      const std::string option = words.back();
      std::vector<std::string> line = words;
      line.emplace_back(value);
      ExpectUsageError(line, option + ": expected a whole number, 0 or above, found '" + value + "'");
    }
  ExpectUsageError({"check", kTiny, "--max-reprojection-px", "-1"}, "expected 0 or a number above it, found '-1'");
  EXPECT_THAT(RunSlamdb({"renumber", kTiny, "--dry-run", "--offset", "-1"}).err, HasSubstr("an offset of -1"));
}

TEST(Usage, OfAnOutputWithoutItsOption) {
  const std::pair<std::vector<std::string>, std::string> cases[] = {
      {{"plot", kTiny, "m.png"}, "slamdb plot " + kTiny + " -o m.png"},
      {{"dump", kTiny, "m.csv", "--format", "csv"}, "slamdb dump " + kTiny + " -o m.csv --format csv"},
      {{"view", kTiny, "b.html"}, "slamdb view " + kTiny + " -o b.html"},
      {{"merge", kTiny, kTiny, "none.osa"}, "slamdb merge " + kTiny + " " + kTiny + " -o none.osa"},
  };
  for (const auto& [words, next] : cases) ExpectUsageError(words, "\nTry: " + next + "\n");
  EXPECT_EQ(RunSlamdb({"view", kTiny, "none.osa"}).exit_code, 1) << "that is an input";
}

// As where a container limits processes: the second thread cannot start.
TEST(Threads, WorkGoesOnWithThoseThatStart) {
  const auto limited = [](const std::vector<std::string>& words) {
    std::vector<std::string> command = {"timeout", "60", "prlimit", "--nproc=2"};
    if (::getuid() == 0)  // whom no such limit holds
      command = {
          "timeout", "60",       "setpriv", "--reuid=65533", "--regid=65533", "--clear-groups", "--bounding-set=-all",
          "prlimit", "--nproc=2"};
    command.insert(command.end(), words.begin(), words.end());
    return RunProgram(command);
  };
  const std::string small = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa";
  if (limited({SLAMDB_COMMAND, "info", small}).exit_code != 0) GTEST_SKIP() << "no other account can run the command";
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"check", small, "--json"},
                                             {"convert", small, "-", "--to", "csv"},
                                             {"convert", small, "-", "--to", "g2o"}}) {
    std::vector<std::string> many = {SLAMDB_COMMAND, "--threads", "5"};
    many.insert(many.end(), words.begin(), words.end());
    const ProcessResult few = limited(many);
    EXPECT_EQ(few.exit_code, 0) << few.err;
    EXPECT_TRUE(few.out == RunSlamdb(words).out);
  }
}

TEST(Usage, OptionsMayStandBeforeTheVerb) {
  EXPECT_EQ(RunSlamdb({"--json", "info", kTiny}).out, RunSlamdb({"info", kTiny, "--json"}).out);
  EXPECT_EQ(RunSlamdb({"--threads", "1", "-q", "info", kTiny}).out, RunSlamdb({"info", kTiny}).out);
  EXPECT_EQ(RunSlamdb({"--quiet", kTiny}).out, RunSlamdb({"info", kTiny}).out);
  EXPECT_EQ(RunSlamdb({"-q", "vocabulary", "show", kTiny}).exit_code, 0);
  ExpectUsageError({"vocabulary", "--quiet", "show", kTiny}, "'--quiet' stands before the verb that takes it");
}

TEST(Usage, HelpAnswersAsTheVerbDoes) {
  ExpectUsageError({"help", "export"}, "unknown verb 'export'; here it is 'convert'\nTry: slamdb convert --help\n");
  ExpectUsageError({"help", "exctract"}, "did you mean 'extract'?\nTry: slamdb extract --help\n");
  ExpectUsageError({"help", "vocabulary", "shwo"}, "did you mean 'show'?\nTry: slamdb vocabulary --help\n");
}

TEST(Usage, EveryVerbRefusesAnUnknownOption) {
  for (const char* verb :
       {"info",    "show", "dump", "check",   "convert", "merge",  "renumber", "reassign-origin", "synthesize",
        "add",     "list", "log",  "remove",  "stats",   "vacuum", "backup",   "migrate",         "completion",
        "version", "man",  "tag",  "restore", "branch",  "gc",     "sync"}) {
    SCOPED_TRACE(verb);
    ExpectUsageError({verb, "--no-such-option"}, "unknown option '--no-such-option'");
  }
}

TEST(Output, FullDiskIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "/dev/full is not there";
  const ProcessResult result = RunProgram({"bash", "-c", "exec \"$0\" info \"$1\" > /dev/full", SLAMDB_COMMAND, kTiny});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("No space left"));
}

TEST(Output, BrokenPipeIsQuiet) {
  std::vector<std::string> words = {"bash", "-c", "\"$0\" info \"$@\" | head -n 1; exit ${PIPESTATUS[0]}",
                                    SLAMDB_COMMAND};
  words.insert(words.end(), 200, kTiny);  // more text than a pipe takes
  const ProcessResult result = RunProgram(words);
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(result.exit_code, 128 + 13);
}

TEST(Output, BinaryIsNotWrittenToATerminal) {
  const auto result = RunOnTerminal({SLAMDB_COMMAND, "convert", kTiny, "-", "--to", "orbslam3"});
  if (!result) GTEST_SKIP() << "there are no pseudo-terminals (/dev/pts)";
  EXPECT_EQ(result->exit_code, 1);
  EXPECT_THAT(result->out, HasSubstr("would garble the terminal"));
}

TEST(Output, NothingIsColouredInAPipe) {
  const ProcessResult result = RunSlamdb({"check", kTiny});
  EXPECT_EQ(result.out.find('\033'), std::string::npos);
  EXPECT_EQ(result.err.find('\033'), std::string::npos);
}

TEST(Output, ProgressOnlyWhenAskedFor) {
  EXPECT_EQ(RunSlamdb({"info", kTiny}).err, "");
  EXPECT_THAT(RunSlamdb({"check", "--no-progress", "--quiet", kTiny}).err, "");
}

TEST(Output, VerboseTellsTimeAndMemory) { EXPECT_THAT(RunSlamdb({"info", "-v", kTiny}).err, HasSubstr("memory")); }

// A file that is opened later must not be taken for a standard stream.
TEST(Errors, OfClosedStandardStreams) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "a.osa", ReadWholeFile(std::string(SLAMDB_FIXTURES) + "/tiny/tiny.osa"));
  const auto run = [&](const std::string& command) {
    return RunProgram({"sh", "-c", "cd '" + folder.path().string() + "' && '" SLAMDB_COMMAND "' " + command}).exit_code;
  };
  EXPECT_EQ(run("info a.osa >&-"), 1) << "nothing could be printed";
  EXPECT_EQ(run("convert -q a.osa b.osa >&- 2>&- <&-"), 0);
  EXPECT_EQ(ReadWholeFile(folder / "b.osa"), ReadWholeFile(folder / "a.osa"));
}

}  // namespace
}  // namespace slamdb::testing
