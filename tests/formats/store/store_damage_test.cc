// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <fstream>
#include <random>

#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

using ::testing::HasSubstr;

class StoreDamage : public ::testing::Test {
 protected:
  std::string LoadErrorAfter(const std::string& sql) {
    std::filesystem::remove(path_);
    SaveIn(path_, atlas_);
    Sql(path_, sql);
    return ErrorOf([this] { LoadFrom(path_); });
  }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
  Atlas atlas_ = SoundAtlas();
};

TEST_F(StoreDamage, ChangedValuesAreFoundWithTableAndRow) {
  EXPECT_THAT(LoadErrorAfter("UPDATE map_point SET x = x + 1 WHERE row = (SELECT min(row) FROM map_point)"),
              HasSubstr("table map_point, row 4294967296: differs from its hash"));
  EXPECT_THAT(LoadErrorAfter("UPDATE keyframe SET qw = qw + 0.25 WHERE row = (SELECT min(row) FROM keyframe)"),
              HasSubstr("table keyframe, row 4294967296: "));
  EXPECT_THAT(LoadErrorAfter("UPDATE map SET inertial = 1 WHERE row = 2"), HasSubstr("table map, row 2"));
  EXPECT_THAT(LoadErrorAfter("UPDATE observation SET left_keypoint = 99999 WHERE position = 0"),
              HasSubstr("table observation, row "));
  EXPECT_THAT(LoadErrorAfter("UPDATE keyframe_link SET weight = weight + 1"), HasSubstr("table keyframe_link, row "));
  EXPECT_THAT(LoadErrorAfter("UPDATE camera SET parameters = '[1,2,3,4]'"), HasSubstr("table atlas, row 1"));
  EXPECT_THAT(LoadErrorAfter("UPDATE camera SET parameters = '[1,2'"), HasSubstr("parameters are no list of numbers"));
}

TEST_F(StoreDamage, MissingAndAdditionalRows) {
  EXPECT_THAT(LoadErrorAfter("DELETE FROM map_point WHERE row = 4294967299"), HasSubstr("table atlas, row 1"));
  EXPECT_THAT(
      LoadErrorAfter("DELETE FROM map_point WHERE row = 4294967299; DELETE FROM observation WHERE point = 4294967299"),
      HasSubstr("table atlas, row 1"));
  EXPECT_THAT(LoadErrorAfter("DELETE FROM keyframe_features WHERE keyframe = 4294967298"),
              HasSubstr("table keyframe_features, row 4294967298"));
  EXPECT_THAT(LoadErrorAfter("DELETE FROM observation WHERE point = 4294967300"), HasSubstr("row 4294967300"));
  EXPECT_THAT(LoadErrorAfter("UPDATE map SET row = -5 WHERE row = 1"), HasSubstr("table map, row -5"));
}

TEST_F(StoreDamage, BlobsOfWrongLength) {
  const std::string first = " WHERE row = (SELECT picture FROM keyframe_features ORDER BY keyframe LIMIT 1)";
  for (const int length : {0, 1, 2, 5, 6, 100, 1000, 5000}) {
    const std::string error =
        LoadErrorAfter("UPDATE picture SET columns = substr(columns, 1, " + std::to_string(length) + ")" + first);
    EXPECT_THAT(error, HasSubstr("table keyframe_features, row 4294967296: blob too short"));
  }
  EXPECT_THAT(LoadErrorAfter("UPDATE picture SET columns = CAST(columns || x'00' AS BLOB)" + first),
              HasSubstr("blob too long"));
  EXPECT_THAT(LoadErrorAfter("UPDATE picture SET columns = x'63'" + first), HasSubstr("features of layout 99"));
  EXPECT_THAT(LoadErrorAfter("DELETE FROM picture" + first), HasSubstr("table keyframe_features, row 4294967296"));
  EXPECT_THAT(LoadErrorAfter("UPDATE keyframe_features SET points = substr(points, 1, 7)"),
              HasSubstr("blob too short"));
  EXPECT_THAT(LoadErrorAfter("UPDATE keyframe_features SET points = x'0000000003'"), HasSubstr("ids of 3 bytes"));
  EXPECT_THAT(LoadErrorAfter("UPDATE keyframe SET details = substr(details, 1, 300)"),
              HasSubstr("table keyframe, row"));
  EXPECT_THAT(LoadErrorAfter("UPDATE keyframe SET details = x''"), HasSubstr("table keyframe, row"));
  EXPECT_THAT(LoadErrorAfter("UPDATE map_point SET descriptor = x'00'"), HasSubstr("table map_point, row"));
  EXPECT_THAT(LoadErrorAfter("UPDATE map_point SET exact = x'0011'"), HasSubstr("table map_point, row"));
  EXPECT_THAT(LoadErrorAfter("UPDATE keyframe SET exact = x'0011'"), HasSubstr("table keyframe, row"));
}

// Counts that claim gigabytes are compared with the bytes that are there before memory is spent on them.
TEST_F(StoreDamage, HugeCountsAllocateNothing) {
  const std::string huge = LoadErrorAfter("UPDATE picture SET columns = x'02ffffffff07'");
  EXPECT_THAT(huge, HasSubstr("blob too short"));
}

TEST_F(StoreDamage, RandomBlobsNeverCrash) {
  SaveIn(path_, atlas_);
  std::mt19937 random(3);
  const std::string good = Sql(path_, "SELECT hex(columns) FROM picture WHERE row = 1");
  for (int i = 0; i < 80; ++i) {
    std::string bad = good;
    for (int flips = 0; flips < 3; ++flips)
      bad[random() % (i % 2 == 0 ? 200 : bad.size())] = "0123456789ABCDEF"[random() % 16];
    Sql(path_, "UPDATE picture SET columns = x'" + bad + "' WHERE row = 1");
    const std::string error = ErrorOf([this] { LoadFrom(path_); });
    EXPECT_TRUE(bad == good || error.find("table keyframe_features, row 4294967296") != std::string::npos) << error;
  }
}

// Bytes of the file itself: an Error, or an atlas that is unharmed.
TEST_F(StoreDamage, FlippedBytesNeverCrashAndNeverLie) {
  SaveIn(path_, atlas_);
  const std::string good = FileBytes(path_);
  std::mt19937 random(11);
  int found = 0;
  for (int i = 0; i < 120; ++i) {
    std::string bad = good;
    const std::size_t at = random() % (i < 60 ? 20000 : bad.size());
    for (std::size_t k = at; k < std::min(at + 1 + random() % 16, bad.size()); ++k)
      bad[k] = static_cast<char>(random());
    std::ofstream(path_, std::ios::binary) << bad;
    const std::string error =
        ErrorOf([&] { EXPECT_EQ(FirstDifference(LoadFrom(path_), atlas_), "") << "changed at byte " << at; });
    if (!error.empty()) ++found;
  }
  EXPECT_GT(found, 20);
}

TEST_F(StoreDamage, TruncatedFiles) {
  SaveIn(path_, atlas_);
  const std::string good = FileBytes(path_);
  for (const std::size_t size :
       {std::size_t{50}, std::size_t{99}, std::size_t{4096}, good.size() / 2, good.size() - 1}) {
    std::ofstream(path_, std::ios::binary) << good.substr(0, size);
    EXPECT_NE(ErrorOf([&] { LoadFrom(path_); }), "") << size;
  }
}

void SaveOverAndDieHalfway(const std::string& path) {
  Atlas atlas = OddAtlas();
  atlas.maps.push_back(SoundAtlas().maps[0]);
  Store store = Store::OpenForWriting(path, {.sync = false});
  SaveOptions options;
  options.threads = 1;
  options.progress = [](std::string_view, double fraction) {
    if (fraction > 0.5) ::raise(SIGKILL);
  };
  store.Save("a", atlas, options);
}

TEST_F(StoreDamage, KilledWriterLeavesTheOldContentWhole) {
  SaveIn(path_, atlas_);
  const int status = InChild(&SaveOverAndDieHalfway, path_);
  ASSERT_TRUE(WIFSIGNALED(status));
  const std::string before = FileBytes(path_);
  EXPECT_EQ(FirstDifference(LoadFrom(path_), atlas_), "");
  EXPECT_EQ(FileBytes(path_), before) << "reading changed the file";
  SaveIn(path_, OddAtlas());
  EXPECT_EQ(FirstDifference(LoadFrom(path_), OddAtlas()), "");
}

// A limit on file sizes stands for a full disk.
void SaveOverOnAFullDisk(const std::string& path) {
  ::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{std::filesystem::file_size(path) / 2, RLIM_INFINITY};
  ::setrlimit(RLIMIT_FSIZE, &limit);
  const std::string error = ErrorOf([&] {
    Store store = Store::OpenForWriting(path);
    store.Save("big", SoundAtlas());
  });
  ::_exit(error.empty() ? 1 : 0);
}

TEST_F(StoreDamage, FullDiskLeavesTheOldContentWhole) {
  SaveIn(path_, atlas_);
  EXPECT_EQ(InChild(&SaveOverOnAFullDisk, path_), 0);
  EXPECT_EQ(FirstDifference(LoadFrom(path_), atlas_), "");
  EXPECT_EQ(Store::Open(path_).List().size(), 1U);
}

TEST_F(StoreDamage, CancelledSaveLeavesTheOldContentWhole) {
  SaveIn(path_, atlas_);
  Store store = Store::OpenForWriting(path_);
  SaveOptions options;
  options.progress = [](std::string_view, double) { throw Error(ErrorKind::kUsage, "cancelled"); };
  EXPECT_EQ(ErrorOf([&] { store.Save("a", OddAtlas(), options); }), "cancelled");
  EXPECT_EQ(FirstDifference(store.Load("a"), atlas_), "");
}

}  // namespace
}  // namespace slamdb::store_test
