// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/formats/sqlite/detail/salvage.h"
#include "slamdb/model/digest.h"
#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class StoreLandmarks : public ::testing::Test {
 protected:
  StoreLandmarks() : atlas_(SoundAtlas()) {
    for (std::uint64_t i = 0; i < 50; ++i) {
      Landmark& landmark = atlas_.maps[1].landmarks.emplace_back();
      landmark.id = LandmarkId(i);
      landmark.mean.x() = static_cast<double>(i);
      landmark.last_seen = TicksOfSeconds(1e9);
      landmark.CreateOneFeature().descriptors = {{DescriptorKind::kOrb, std::vector<std::uint8_t>(32, 5)}};
    }
  }
  static TableChanges ChangesOf(const SaveReport& report) {
    for (const TableChanges& changes : report.tables)
      if (changes.table == "landmark") return changes;
    return {};
  }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
  Atlas atlas_;
};

TEST_F(StoreLandmarks, SavingWritesWhatDiffers) {
  EXPECT_EQ(ChangesOf(SaveIn(path_, atlas_)).inserted, 50U);
  std::vector<Landmark>& landmarks = atlas_.maps[1].landmarks;
  landmarks[7].features[0].descriptors[0].bytes[31] = 6;
  landmarks[8].cov_33 = 1;
  landmarks.erase(landmarks.begin() + 3);
  landmarks.push_back(landmarks[0]);
  const SaveReport report = SaveIn(path_, atlas_);
  const TableChanges changes = ChangesOf(report);
  EXPECT_EQ(changes.updated, 2U);
  EXPECT_EQ(changes.deleted, 1U);
  EXPECT_EQ(changes.inserted, 1U);
  EXPECT_EQ(changes.unchanged, 47U);
  EXPECT_EQ(FirstDifference(LoadFrom(path_), atlas_), "");
  EXPECT_EQ(report.hash, HashOf(atlas_));
}

TEST_F(StoreLandmarks, CountInTheHash) {
  Atlas without = atlas_;
  without.maps[1].landmarks.clear();
  EXPECT_EQ(HashOf(without), HashOf(SoundAtlas()));
  EXPECT_NE(HashOf(without), HashOf(atlas_));
}

TEST_F(StoreLandmarks, CanBeSelected) {
  SaveIn(path_, atlas_);
  ReadOptions options;
  options.selection.box = Eigen::AlignedBox3f(Eigen::Vector3f(9.5F, -1, -1), Eigen::Vector3f(12.5F, 1, 1));
  EXPECT_EQ(LoadFrom(path_, "a", options).maps[1].landmarks.size(), 3U);
}

TEST_F(StoreLandmarks, DamageIsFound) {
  SaveIn(path_, atlas_);
  Sql(path_, "UPDATE landmark SET seen_count = 7 WHERE id = 9");
  EXPECT_THAT(ErrorOf([&] { LoadFrom(path_); }), HasSubstr("table landmark, row "));
  SaveIn(path_, SoundAtlas());
  SaveIn(path_, atlas_);
  Sql(path_, "UPDATE landmark SET features = x'01ffffffff' WHERE id = 9");
  EXPECT_THAT(ErrorOf([&] { LoadFrom(path_); }), HasSubstr("table landmark, row "));
}

TEST_F(StoreLandmarks, AreSalvagedAroundDamage) {
  SaveIn(path_, atlas_);
  EXPECT_THAT(detail::SalvageStore(path_, "a", {}).damage, IsEmpty());
  Sql(path_, "UPDATE landmark SET seen_count = 7 WHERE id = 9");
  Sql(path_, "DELETE FROM landmark WHERE id = 30");
  const Salvage salvage = detail::SalvageStore(path_, "a", {});
  EXPECT_THAT(salvage.damage, SizeIs(3));
  EXPECT_EQ(salvage.maps[1].landmarks.listed, 50U);
  EXPECT_EQ(salvage.maps[1].landmarks.read, 48U);
  std::erase_if(atlas_.maps[1].landmarks,
                [](const Landmark& landmark) { return landmark.id.value() == 9 || landmark.id.value() == 30; });
  EXPECT_EQ(FirstDifference(salvage.atlas, atlas_), "");
}

// The steps of version 2, as a slamdb of that version takes them.
class StoreLandmarksStep : public StoreLandmarks {
 protected:
  MigrateReport Back() { return sqlite::Migrate(path_, {.back = true}, sqlite::Migrations().first(2)); }
  void SaveAsVersion2(const Atlas& atlas) {
    SaveIn(path_, atlas);
    MigrateBackTo(path_, 2);
  }
};

TEST_F(StoreLandmarksStep, BackAndForth) {
  SaveAsVersion2(SoundAtlas());
  const MigrateReport back = Back();
  EXPECT_EQ(back.from, 2);
  EXPECT_EQ(back.to, 1);
  EXPECT_THAT(back.steps, ElementsAre("0002_landmarks.back"));
  EXPECT_EQ(back.backup, path_ + ".v2.bak");
  EXPECT_EQ(Sql(path_, "SELECT count(*) FROM sqlite_schema WHERE name LIKE '%landmark%'"), "0");
  EXPECT_THAT(ErrorOf([&] { Store::Open(path_); }), HasSubstr("store version 1, this program needs 7"));
  EXPECT_THAT(ErrorOf([&] { Back(); }), HasSubstr("cannot go further back"));
  EXPECT_THAT(MigrateStore(path_).steps, ElementsAre("0002_landmarks", "0003_tracking", "0004_summary", "0005_places",
                                                     "0006_carried", "0007_revisions"));
  EXPECT_EQ(FirstDifference(LoadFrom(path_), SoundAtlas()), "");
}

TEST_F(StoreLandmarksStep, BackLosesNone) {
  SaveAsVersion2(atlas_);
  EXPECT_THAT(ErrorOf([&] { Back(); }), HasSubstr("holds landmarks"));
  MigrateStore(path_);
  EXPECT_EQ(FirstDifference(LoadFrom(path_), atlas_), "");
}

}  // namespace
}  // namespace slamdb::store_test
