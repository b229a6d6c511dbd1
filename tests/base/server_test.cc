// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/server.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "slamdb/base/atomic_file.h"
#include "slamdb/base/detail/hidden_passwords.h"
#include "slamdb/base/detail/json.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/error.h"
#include "slamdb/base/file.h"
#include "slamdb/base/output_name.h"
#include "tests/support/temporary_folder.h"

namespace slamdb::detail {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kSecret = "S3cret";

TEST(Server, IsWhatBeginsWithItsScheme) {
  EXPECT_TRUE(IsServer("postgresql://u@h/db"));
  EXPECT_TRUE(IsServer("postgres://h"));
  EXPECT_TRUE(IsServer("postgresql:///maps"));
  for (const char* file : {"postgresql:/h/db", "postgres:maps", "postgres", "./postgresql://h/db", "lab.db", "-", ""})
    EXPECT_FALSE(IsServer(file)) << file;
}

TEST(Server, HasANameBehindItsLastHash) {
  const auto name = [](const std::string& uri) {
    const std::size_t hash = NameBehind(uri);
    return hash == std::string::npos ? "none" : uri.substr(hash + 1);
  };
  EXPECT_EQ(name("postgresql://h/db"), "none");
  EXPECT_EQ(name("postgresql://h/db#a"), "a");
  EXPECT_EQ(name("postgresql://h/db#a@3"), "a@3");
  EXPECT_EQ(name("postgresql://u:p@h:1/db?sslmode=require#a"), "a");
  EXPECT_EQ(name("postgresql://h/db#a#b"), "b");
  EXPECT_EQ(name("postgresql:///#a"), "a");
  EXPECT_EQ(name("postgresql://h#a@3"), "a@3");
  EXPECT_EQ(name("postgresql://u:p%23w@h/db"), "none");
  EXPECT_EQ(name("postgresql://u:p#w@h/db"), "none") << "a password whose # is not percent-encoded is shown nowhere";
}

// Of each the text that people may see.
const std::vector<std::pair<std::string, std::string>> kShown = {
    {"postgresql://u:S3cret@h/db", "postgresql://u@h/db"},
    {"postgres://u:S3cret@h:5433/db?sslmode=require", "postgres://u@h:5433/db?sslmode=require"},
    {"postgresql://u:a%23S3cret@h", "postgresql://u@h"},
    {"postgresql://u:a#S3cret@h/db", "postgresql://u@h/db"},
    {"postgresql://h/db?password=S3cret", "postgresql://h/db"},
    {"postgresql://h/db?user=u&password=S3cret&connect_timeout=1", "postgresql://h/db?user=u&connect_timeout=1"},
    {"postgresql://u:S3cret@a,b:1/db", "postgresql://u@a,b:1/db"},
    {"postgresql:/u:S3cret@h/db", "postgresql:/u@h/db"},
    {"postgres:u:S3cret@h/db", "postgres:u@h/db"},
    {"POSTGRESQL://u:S3cret@h/db", "POSTGRESQL://u@h/db"},
    {"postgressql://u:S3cret@h/db", "postgressql://u@h/db"},
    {"pg://u:S3cret@h/db", "pg://u@h/db"},
    {"postgresql://u@h/db?pasword=S3cret", "postgresql://u@h/db"},
    {"postgresql://u:S3cret%21x/db", "postgresql://u/db"},
    {"postgresql://u:S3cret,1:2:3/db", "postgresql://u/db"},
    {"postgresql://a:1,b:S3cret/db", "postgresql://a:1,b/db"},
};

TEST(Server, IsShownWithoutItsPassword) {
  for (const auto& [uri, shown] : kShown) {
    EXPECT_EQ(WithoutPassword(uri), shown);
    EXPECT_EQ(WithoutPasswords("cannot read '" + uri + "#a', nor " + uri),
              "cannot read '" + shown + "#a', nor " + shown);
    EXPECT_EQ(WithoutPasswords("{\"input\":\"" + uri + "#a\",\"n\":\"a@b\"}"),
              "{\"input\":\"" + shown + "#a\",\"n\":\"a@b\"}");
  }
  for (const char* same :
       {"postgresql://u@h/db", "postgresql:///maps", "a:b@c.osa", "no postgres here: a:b@c", "postgresql://h:5432",
        "postgresql://a:1,b:2/db", "postgresql://a,b:2", "postgresql://[::1]:5432/db", "postgresql://[::1]/db",
        "postgresql://[fe80::1%25eth0]:1,h:2/db", "postgresql://fe80::1/db", "postgresql://h:/db",
        "postgresql://%2Ftmp:5432/db", "postgresql://h:1/db?host=a:b", "http://127.0.0.1:8080/a:b"}) {
    EXPECT_EQ(WithoutPassword(same), same);
    EXPECT_EQ(WithoutPasswords(same), same);
  }
}

// Without a database, what stands behind a # and before an @ may be of the password as well.
TEST(Server, APasswordWithoutAHostIsHidden) {
  EXPECT_EQ(WithoutPassword("postgresql://u:S3cret"), "postgresql://u");
  EXPECT_EQ(WithoutPassword("postgresql://u:12S3cret?sslmode=require"), "postgresql://u?sslmode=require");
  EXPECT_EQ(WithoutPasswords("of 'postgresql://u:S3cret#a': no"), "of 'postgresql://u#a': no");
  EXPECT_THAT(HidePassword("--onto=postgresql://u:S3cret#a@3"), Not(HasSubstr(kSecret)));
}

// Nor does it take what is behind the URI for a part of it.
TEST(Server, TextsAroundAUriStay) {
  const Json json = {{"failure", "postgresql://h:5432\nand \"postgresql://u:S3cret\", postgresql://h:1: gone"}};
  EXPECT_EQ(Json::parse(Dumped(json)).at("failure"),
            "postgresql://h:5432\nand \"postgresql://u\", postgresql://h:1: gone");
}

TEST(Server, ErrorsAndReportsShowNoPassword) {
  for (const auto& [uri, shown] : kShown) {
    const Error error(ErrorKind::kLocked, uri, "table " + uri, "is " + uri + "#a");
    EXPECT_EQ(error.path(), shown);
    EXPECT_EQ(error.place(), "table " + shown);
    EXPECT_EQ(error.problem(), "is " + shown + "#a");
    EXPECT_THAT(error.what(), Not(HasSubstr(kSecret)));
    for (const int indent : {-1, 2})
      EXPECT_THAT(JsonText(ReportHead("info", ReportFiles{uri + "#a", uri}), indent), Not(HasSubstr(kSecret)));
  }
}

TEST(Server, WordsLoseTheirPasswordAndConnectionsHaveIt) {
  const auto connects = [](const std::string& path) { return WithHiddenPassword(path); };
  for (const auto& [uri, shown] : kShown) {
    EXPECT_EQ(HidePassword(uri), shown);
    EXPECT_EQ(connects(shown), uri);
    EXPECT_EQ(HidePassword("--onto=" + uri + "#a@3"), "--onto=" + shown + "#a@3");
    EXPECT_EQ(connects(shown), uri);
  }
  EXPECT_EQ(HidePassword("postgresql://u:other@h/db"), "postgresql://u@h/db");
  EXPECT_EQ(connects("postgresql://u@h/db"), "postgresql://u:other@h/db") << "the last one counts";
  for (const char* plain : {"postgresql://nobody@h/db#a", "lab.db#a", "-o", "postgres"}) {
    EXPECT_EQ(HidePassword(plain), plain);
    EXPECT_EQ(connects(plain), plain);
  }
}

TEST(Server, TellsWhichDatabaseItIs) {
  const std::string database = DatabaseOfServer("postgresql://h/db");
  for (const char* same : {"postgres://u:S3cret@h:5432/db", "postgresql://other@H/db?sslmode=require",
                           "postgresql:///db?host=h", "postgresql://u@h/?dbname=db", "postgresql://h/d%62"})
    EXPECT_EQ(DatabaseOfServer(same), database) << same;
  for (const char* other : {"postgresql://h:5433/db", "postgresql://h/maps", "postgresql://g/db", "postgresql:///db",
                            "postgresql://h,g/db", "postgresql://h/db?port=5433"})
    EXPECT_NE(DatabaseOfServer(other), database) << other;
  EXPECT_EQ(DatabaseOfServer("postgresql://db@h"), database) << "without a name it is called as its user";
  EXPECT_EQ(DatabaseOfServer("postgresql://[::1]/db"), DatabaseOfServer("postgresql://[::1]:5432/db"));
  EXPECT_EQ(NameOfDatabase("postgresql://u@h/maps?sslmode=require"), "maps");
}

TEST(Server, IsOneFileWithItselfAndNoOther) {
  const std::string one = "postgresql://u@h/db", again = "postgres://v:S3cret@h:5432/db";
  EXPECT_TRUE(IsSameFile(one, "a", again, "a"));
  EXPECT_FALSE(IsSameFile(one, "a", again, "b"));
  EXPECT_TRUE(IsSameFile(one, std::nullopt, again, "b"));
  EXPECT_FALSE(IsSameFile(one, "a", "postgresql://u@h/maps", "a"));
  EXPECT_FALSE(IsSameFile(one, "a", "lab.db", "a"));
}

TEST(Server, IsNoFile) {
  const std::string server = "postgresql://u:S3cret@h/db";
  const TemporaryFolder folder;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  const auto refused = [](const auto& work) {
    try {
      work();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kUsage);
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string why = "postgresql://u@h/db: is a database of a server, where a file is expected; name a file";
  EXPECT_EQ(refused([&] { WholeFile file(server); }), why);
  EXPECT_EQ(refused([&] { (void)Probe::Of(server); }), why);
  EXPECT_EQ(refused([&] { AtomicFile file(server); }), why);
  EXPECT_FALSE(IsSpecialFile(server));
  EXPECT_FALSE(NamesFolder(server));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  std::filesystem::current_path(before);
}

TEST(Server, IsToldFromWhatIsMistyped) {
  for (const char* mistyped :
       {"postgresql:/h/db", "postgresql:h/db", "postgres:maps", "Postgresql://u:S3cret@h/db", "pg://u:S3cret@h/db"}) {
    try {
      RefuseMistypedServer(mistyped);
      ADD_FAILURE() << mistyped;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kUsage);
      EXPECT_THAT(error.what(), HasSubstr("postgresql://USER@HOST/DATABASE#NAME"));
      EXPECT_THAT(error.what(), Not(HasSubstr(kSecret)));
    }
  }
  for (const char* sound : {"postgresql://h/db", "postgres:///maps", "postgres.osa", "maps/postgres:a.osa"})
    EXPECT_NO_THROW(RefuseMistypedServer(sound)) << sound;
  const TemporaryFolder folder;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  folder.Make("postgres:a.osa", "x");
  EXPECT_NO_THROW(RefuseMistypedServer("postgres:a.osa"));
  std::filesystem::current_path(before);
}

// What psql takes besides is no location, and is told so without the password.
TEST(Server, TheFormOfKeywordsIsRefusedWithoutItsPassword) {
  for (const std::string path :
       {"host=lab dbname=maps password=S3cret", "dbname = maps  password = 'S3 cret'", "password=S3cret host=lab",
        "user=robot password='S3cret", "password='S3\\'S3' port=5432", "sslmode=require password=S3\\ S3 user=a"}) {
    try {
      RefuseMistypedServer(path);
      FAIL() << path;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), Not(HasSubstr("S3"))) << path;
      EXPECT_THAT(error.what(), HasSubstr("postgresql://USER@HOST/DATABASE#NAME"));
    }
    EXPECT_THAT(HidePassword("--onto=" + path), Not(HasSubstr("S3")));
  }
  for (const std::string path : {"ghost=1.osa", "hostile.osa", "user.osa", "maps/host", "password=k.osa"}) {
    EXPECT_NO_THROW(RefuseMistypedServer(path));
    EXPECT_EQ(HidePassword(path), path);
  }
  EXPECT_EQ(WithoutKeywordPasswords("host=a password=x user=b"), "host=a password=... user=b");
}

// In names of files and atlases it is a word as any other.
TEST(Server, ReportsHoldNamesWithTheWordPassword) {
  const Json json = {{"name", "password=x"}, {"where", "host=a password='x"}};
  EXPECT_EQ(Json::parse(Dumped(json)), json);
}

}  // namespace
}  // namespace slamdb::detail
