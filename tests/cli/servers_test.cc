// SPDX-License-Identifier: BSD-3-Clause
//
// Databases of servers are named like files: every verb, with a server for each of its files. Nobody listens at that
// port, so that all that would connect fails, and what it says then is seen.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <string_view>

#include "tests/cli/verbs.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
namespace fs = std::filesystem;

constexpr const char* kSecret = "S3cret";
constexpr const char* kServer = "postgresql://u:S3cret@127.0.0.1:1/db";
constexpr const char* kAtlas = "postgresql://u:S3cret@127.0.0.1:1/db#a";
constexpr const char* kWithoutHost = "postgresql://u:S3cret%21x/db";  // libpq takes it for a port
constexpr const char* kShownAtlas = "postgresql://u@127.0.0.1:1/db#a";

// A folder with inputs, in which the command runs.
class Servers : public ::testing::Test {
 protected:
  Servers() {
    FillFolder(folder_.path().string());
    fs::current_path(folder_.path());
  }
  ~Servers() override { fs::current_path(before_); }

  // Of what came out, and of all files.
  void ExpectNoSecret(const ProcessResult& result) {
    EXPECT_THAT(result.out, Not(HasSubstr(kSecret)));
    EXPECT_THAT(result.err, Not(HasSubstr(kSecret)));
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
      EXPECT_THAT(entry.path().string(), Not(HasSubstr("postgres"))) << "a server was taken for a path";
      const bool tells =
          entry.is_regular_file() && ReadWholeFile(entry.path().string()).find(kSecret) != std::string::npos;
      EXPECT_FALSE(tells) << entry.path();
    }
  }

  ProcessResult Run(const std::vector<std::string>& words) {
    const ProcessResult result = RunSlamdb(words);
    ExpectNoSecret(result);
    return result;
  }

  const fs::path before_ = fs::current_path();
  const TemporaryFolder folder_;
};

// The command line with a server for one option, which is added when it is not there.
std::vector<std::string> With(const Verb& verb, const FileOption& option, const std::string& server) {
  std::vector<std::string> line = CommandLine(verb);
  const std::string usual = ValueOf(verb, option);
  const auto named = std::ranges::find(line, option.name);
  if (option.positional)
    *std::ranges::find(line, usual) = server;
  else if (named != line.end())
    *std::next(named) = server;
  else
    line.insert(line.end(), {option.name, server});
  return line;
}

bool TakesStore(const FileOption& option) { return option.name == "STORE"; }

bool TakesAtlas(const FileOption& option) {
  constexpr std::array<std::string_view, 8> kAtlases = {"INPUT", "FILE",       "BEFORE", "AFTER",
                                                        "STORE", "STORE#NAME", "--onto", "--base"};
  return option.writes == cli::Writes::kAtlas || std::ranges::find(kAtlases, option.name) != kAtlases.end();
}

TEST_F(Servers, NoVerbShowsAPassword) {
  int options = 0;
  for (const Verb& verb : AllVerbs())
    for (const FileOption& option : verb.files) {
      SCOPED_TRACE(verb.name() + " " + option.name);
      const std::string name = TakesStore(option) ? "" : "#a";
      EXPECT_THAT(Run(With(verb, option, kWithoutHost + name)).exit_code, AnyOf(1, 2));
      const ProcessResult result = Run(With(verb, option, kServer + name));
      EXPECT_THAT(result.exit_code, AnyOf(1, 2)) << result.out << result.err;
      EXPECT_THAT(result.err, Not(HasSubstr("cannot open: No such file")));
      const bool refused = result.err.find("where a file is expected") != std::string::npos;
      EXPECT_FALSE(TakesAtlas(option) && refused) << result.err;
      ++options;
    }
  EXPECT_GT(options, 80);
}

// Also in what the parser says of them.
TEST_F(Servers, NoWrongCommandLineShowsAPassword) {
  for (const std::vector<std::string>& line :
       std::vector<std::vector<std::string>>{{"info", std::string("--form=") + kAtlas, "a.osa"},
                                             {"info", "a.osa", "--threads", kAtlas},
                                             {"convert", "a.osa", "b.osa", kAtlas},
                                             {"convert", "a.osa", "--to", kAtlas},
                                             {"convert", "a.osa", std::string("-o") + kAtlas, "--from", "tum"},
                                             {"merge", "a.osa", kAtlas},
                                             {"cat", kAtlas},
                                             {kAtlas},
                                             {kAtlas, "--no-such-option"},
                                             {"list", std::string(kServer) + "#"},
                                             {"check", "a.osa", "-o", kServer},
                                             {"restore", kServer}}) {
    SCOPED_TRACE(::testing::PrintToString(line));
    EXPECT_NE(Run(line).exit_code, 0);
  }
}

TEST_F(Servers, AreShownWithoutTheirPassword) {
  EXPECT_THAT(Run({"convert", "a.osa", kAtlas, "--dry-run"}).out, HasSubstr(std::string("would write ") + kShownAtlas));
  EXPECT_THAT(Run({"info", kAtlas}).err, HasSubstr("postgresql://u@127.0.0.1:1/db"));
  EXPECT_THAT(Run({"cat", kAtlas}).err, HasSubstr(std::string("slamdb dump ") + kShownAtlas));
  Run({"check", "a.osa", kAtlas, "--json", "-o", "checked.json"});
  EXPECT_THAT(ReadWholeFile("checked.json"), HasSubstr(kShownAtlas));
  Run({"report", "a.osa", kAtlas, "-o", "pages"});
  EXPECT_THAT(ReadWholeFile("pages/index.html"), HasSubstr(kShownAtlas));
  EXPECT_THAT(Run({"list", "a.osa", kServer}).out, HasSubstr("postgresql://u@127.0.0.1:1/db"));
  EXPECT_EQ(Run({"list", "a.osa", kAtlas, "--json"}).exit_code, 1);
}

// A save fails, and the provenance with it; the one that is made for a file is seen.
TEST_F(Servers, ProvenanceShowsNoPassword) {
  EXPECT_EQ(Run({"merge", "a.osa", kAtlas, "-o", "merged.db#m"}).exit_code, 1);
  EXPECT_EQ(Run({"add", "m.db", "a.osa", kAtlas}).exit_code, 1);
  EXPECT_EQ(Run({"split", "a.osa", kServer, "--dry-run"}).exit_code, 0);
}

TEST_F(Servers, AnOutputIsNoInput) {
  for (const char* again : {"postgres://v@127.0.0.1:1/db#a", "postgresql://127.0.0.1:1/db?sslmode=disable#a"}) {
    const ProcessResult result = Run({"cull", kAtlas, again, "-O"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, HasSubstr("is the input postgresql://u@127.0.0.1:1/db#a, which is never changed"));
  }
  EXPECT_THAT(Run({"cull", kAtlas, "postgresql://127.0.0.1:1/other#a", "-O"}).err, Not(HasSubstr("never changed")));
}

TEST_F(Servers, AreNoFilesToWrite) {
  for (const std::vector<std::string>& line :
       std::vector<std::vector<std::string>>{{"check", "a.osa", "-o", kServer},
                                             {"backup", "m.db", kServer},
                                             {"view", "a.osa", "-o", kAtlas},
                                             {"repair", "a.osa", "out.osa", "--journal", kServer}}) {
    const ProcessResult result = Run(line);
    EXPECT_EQ(result.exit_code, 1) << line[0];
    EXPECT_THAT(result.err, HasSubstr("is a database of a server, where a file is expected")) << line[0];
  }
}

TEST_F(Servers, SayWhatDoesThereWhatIsAskedFor) {
  const auto instead = [&](const std::vector<std::string>& line) { return Run(line).err; };
  EXPECT_THAT(instead({"backup", kServer, "copy.db"}), HasSubstr("pg_dump"));
  EXPECT_THAT(instead({"vacuum", kServer}), HasSubstr("VACUUM"));
  EXPECT_THAT(instead({"recover", kAtlas, "saved.osa"}), HasSubstr("pg_restore"));
  EXPECT_THAT(instead({"info", kAtlas, "--from", "tum"}), HasSubstr("which is a store and no"));
  EXPECT_THAT(instead({"convert", "a.osa", kAtlas, "--to", "ply"}), HasSubstr("which is a store and no"));
}

TEST_F(Servers, SayWhereAPasswordStands) {
  const ProcessResult result = Run({"list", kWithoutHost});
  EXPECT_THAT(result.err, HasSubstr("postgresql://u/db: not a URI that libpq reads"));
  EXPECT_THAT(result.err, HasSubstr("a password stands before @ and the host"));
  Run({"check", "a.osa", std::string(kWithoutHost) + "#a", "--json", "-o", "checked.json"});
  EXPECT_THAT(ReadWholeFile("checked.json"), HasSubstr("postgresql://u/db#a"));
}

TEST_F(Servers, AreToldFromWhatIsMistyped) {
  for (const char* mistyped :
       {"postgresql:/u:S3cret@127.0.0.1/db", "postgres:maps", "Postgresql://u:S3cret@127.0.0.1:1/db#a"})
    for (const std::vector<std::string>& line : std::vector<std::vector<std::string>>{
             {"info", mistyped}, {"convert", "a.osa", mistyped}, {"list", mistyped}, {"stats", mistyped}}) {
      const ProcessResult result = Run(line);
      EXPECT_THAT(result.exit_code, AnyOf(1, 2)) << line[0] << " " << mistyped;
      EXPECT_THAT(result.err, HasSubstr("postgresql://USER@HOST/DATABASE#NAME")) << line[0] << " " << mistyped;
    }
}

// What is to be had there takes a connection, which pressing Tab does not ask for.
TEST_F(Servers, AreNotAskedForCompletion) {
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{{kAtlas}, {kAtlas, "kf/"}}) {
    std::vector<std::string> line = {"complete"};
    line.insert(line.end(), words.begin(), words.end());
    const ProcessResult result = Run(line);
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_THAT(result.out, IsEmpty());
    EXPECT_THAT(result.err, IsEmpty());
  }
}

}  // namespace
}  // namespace slamdb::testing
