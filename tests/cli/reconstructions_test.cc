// SPDX-License-Identifier: BSD-3-Clause
// Folders of COLMAP and scenes, as the command writes and reads them.
#include <gmock/gmock.h>

#include <filesystem>

#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

const std::string kSession = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa";
const std::string kTiny = SLAMDB_FIXTURES "/tiny/tiny.osa";
const std::string kModel = SLAMDB_FIXTURES "/formats/colmap";

std::vector<std::string> Names(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  return names;
}

class Reconstructions : public ::testing::Test {
 protected:
  std::string In(std::string_view name) const { return folder_ / name; }
  TemporaryFolder folder_;
};

// What COLMAP left as it was goes back onto the atlas without a change.
TEST_F(Reconstructions, GoBackOntoTheirAtlas) {
  ASSERT_EQ(RunSlamdb({"convert", kSession, In("model"), "--to", "colmap", "--with-database"}).exit_code, 3);
  EXPECT_THAT(Names(In("model")), UnorderedElementsAre("cameras.bin", "images.bin", "points3D.bin", "rigs.bin",
                                                       "frames.bin", "database.db"));
  const ProcessResult back = RunSlamdb({"convert", In("model"), In("back.osa"), "--onto", kSession});
  EXPECT_THAT(back.err, HasSubstr("put 14 poses and 2,074 points into"));
  EXPECT_EQ(RunSlamdb({"diff", kSession, In("back.osa"), "--tolerance", "1e-6"}).exit_code, 0);
}

TEST_F(Reconstructions, AreFoldersThatAreReplacedOnlyWhenTold) {
  const auto write = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"convert", kTiny, In("model"), "--to", "colmap"});
    return RunSlamdb(more);
  };
  EXPECT_EQ(write({"--dry-run"}).exit_code, 0);
  EXPECT_FALSE(fs::exists(In("model")));
  EXPECT_EQ(write({}).exit_code, 3);
  const ProcessResult again = write({});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.err, HasSubstr("--overwrite replaces those of the same names"));
  EXPECT_EQ(write({"-O"}).exit_code, 3);
  EXPECT_THAT(RunSlamdb({"convert", kTiny, In("model"), "--to", "colmap-text", "-O"}).err,
              HasSubstr("that would be read with what is written, or in its place"));
  EXPECT_THAT(RunSlamdb({"convert", kTiny, "-", "--to", "colmap"}).err, HasSubstr("is a folder of files"));
  EXPECT_THAT(Names(folder_.path()), ElementsAre("model"));
}

// A model is an input that is never changed, by whatever path it is named.
TEST_F(Reconstructions, AreNotWrittenOverWhatIsRead) {
  fs::copy(kModel, In("model"), fs::copy_options::recursive);
  fs::create_symlink(In("model"), In("link"));
  for (const char* output : {"model", "model/", "link", "./link/../model"}) {
    const ProcessResult result = RunSlamdb({"convert", In("model"), In(output), "--to", "colmap", "-O"});
    EXPECT_EQ(result.exit_code, 1) << output;
    EXPECT_THAT(result.err, HasSubstr("is the input, which is never changed")) << output;
  }
  EXPECT_EQ(ReadWholeFile(In("model/0/images.bin")), ReadWholeFile(kModel + "/0/images.bin"));
  // A folder in it is another one.
  EXPECT_EQ(RunSlamdb({"convert", In("model"), In("model/text"), "--to", "colmap-text"}).exit_code, 3);
  EXPECT_TRUE(fs::exists(In("model/text/1/images.txt")));
}

TEST_F(Reconstructions, AreWrittenWhereALinkLeads) {
  fs::create_directory(In("there"));
  fs::create_directory_symlink(In("there"), In("link"));
  EXPECT_EQ(RunSlamdb({"convert", kTiny, In("link"), "--to", "colmap"}).exit_code, 3);
  EXPECT_TRUE(fs::is_symlink(In("link")));
  EXPECT_TRUE(fs::exists(In("there/points3D.bin")));
}

TEST_F(Reconstructions, RefuseOptionsWithoutEffect) {
  const auto expect = [&](const std::string& to, std::vector<std::string> more, const std::string& says) {
    more.insert(more.begin(), {"convert", kTiny, In("out"), "--to", to});
    const ProcessResult result = RunSlamdb(more);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_THAT(result.err, HasSubstr(says));
  };
  expect("ply", {"--images", "."}, "--images is for COLMAP, NeRF and Gaussian splatting only");
  expect("nerf", {"--with-database"}, "--with-database is for COLMAP models only");
  expect("colmap", {"--colmap-schema", "new"}, "without --with-database");
  expect("colmap", {"--with-database", "--colmap-schema", "3.8"}, "--colmap-schema");
  EXPECT_THAT(RunSlamdb({"convert", kTiny, In("out"), "--to", "3dgs", "--images", In("none")}).err, HasSubstr("none"));
  EXPECT_FALSE(fs::exists(In("out")));
}

}  // namespace
}  // namespace slamdb::testing
