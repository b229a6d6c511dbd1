// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/colmap/detail/database.h"

#include <gmock/gmock.h>
#include <sqlite3.h>

#include <Eigen/Core>
#include <cstring>

#include "slamdb/formats/colmap/detail/colmap.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// What a query gives, a line a row, columns between bars.
std::string Ask(const std::string& path, const std::string& sql) {
  sqlite3* database = nullptr;
  sqlite3_open(path.c_str(), &database);
  std::string text;
  const auto add = [](void* out, int columns, char** values, char**) {
    for (int column = 0; column < columns; ++column)
      static_cast<std::string*>(out)->append(values[column] == nullptr ? "NULL" : values[column]).append("|");
    static_cast<std::string*>(out)->back() = '\n';
    return 0;
  };
  char* message = nullptr;
  if (sqlite3_exec(database, sql.c_str(), add, &text, &message) != SQLITE_OK) text = message;
  sqlite3_free(message);
  sqlite3_close(database);
  return text;
}

std::string Written(const TemporaryFolder& folder, const Atlas& atlas, ColmapSchema schema = ColmapSchema::kOld) {
  Notices notices;
  detail::kColmapDatabaseFormat.write(atlas, folder.Path("a.db"),
                                      WriteOptions{.sync = false}.With(ColmapWriteOptions{.schema = schema}), notices);
  return folder.Path("a.db");
}

TEST(ColmapDatabase, HoldsWhatTheMapImplies) {
  const TemporaryFolder folder;
  const std::string path = Written(folder, SmallAtlas());
  EXPECT_EQ(Ask(path, "PRAGMA user_version"), "3800\n");
  EXPECT_EQ(Ask(path, "PRAGMA integrity_check"), "ok\n");
  EXPECT_EQ(Ask(path, "PRAGMA foreign_key_check"), "");
  EXPECT_EQ(Ask(path, "SELECT camera_id, model, prior_focal_length, length(params) FROM cameras"), "1|1|1|32\n");
  EXPECT_EQ(Ask(path, "SELECT image_id, name, camera_id FROM images"), "2|0.5.png|1\n4|1.5.png|1\n8|2.png|1\n");
  EXPECT_EQ(Ask(path, "SELECT image_id, rows, cols, hex(data) FROM keypoints WHERE image_id = 4"),
            "4|1|4|00008C41000052420000803F00000000\n");  // 17.5, 52.5, 1, 0
  EXPECT_EQ(Ask(path, "SELECT image_id, rows, cols, substr(hex(data), 1, 6) FROM descriptors WHERE image_id = 4"),
            "4|1|32|03AB00\n");
  const std::string pair = std::to_string(2147483647LL * 2 + 4);
  EXPECT_EQ(Ask(path, "SELECT pair_id, rows, cols, hex(data) FROM matches"), pair + "|1|2|0000000000000000\n");
  // Second from first: -1 along x, so E = [-x] and F is not NULL.
  EXPECT_EQ(Ask(path, "SELECT pair_id, rows, config, length(F), H IS NULL, hex(tvec) FROM two_view_geometries"),
            pair + "|1|2|72|1|000000000000F0BF00000000000000000000000000000000\n");
}

TEST(ColmapDatabase, OfTheNewSchemaHasRigsAndFrames) {
  const TemporaryFolder folder;
  const Atlas atlas =
      SynthesizeAtlas({.sensor = Sensor::kFisheyeStereo, .keyframes = 3, .points = 100, .features = 250});
  const std::string path = Written(folder, atlas, ColmapSchema::kNew);
  EXPECT_EQ(Ask(path, "PRAGMA foreign_key_check"), "");
  EXPECT_EQ(Ask(path, "SELECT * FROM rigs"), "1|1|0\n");
  EXPECT_EQ(Ask(path, "SELECT rig_id, sensor_id, sensor_type, length(sensor_from_rig) FROM rig_sensors"), "1|2|0|56\n");
  EXPECT_EQ(Ask(path, "SELECT count(*), min(rig_id), max(rig_id) FROM frames"), "3|1|1\n");
  EXPECT_EQ(Ask(path, "SELECT count(DISTINCT frame_id), count(*), count(DISTINCT data_id) FROM frame_data"), "3|6|6\n");
  EXPECT_EQ(Ask(path, "SELECT DISTINCT type, cols FROM descriptors"), "-1|32\n");
}

// x2' E x1 = 0, up to the noise of keypoints; and F likewise, in pixels.
TEST(ColmapDatabase, GeometriesFitTheirMatches) {
  const TemporaryFolder folder;
  const Atlas atlas = SynthesizeAtlas({.keyframes = 5, .points = 300, .features = 400, .pixel_noise = 0});
  const std::string path = Written(folder, atlas);
  sqlite::Database database(path, sqlite::Access::kRead, 0);
  sqlite::Statement geometries(database, "SELECT pair_id, rows, data, F, E FROM two_view_geometries");
  sqlite::Statement keypoints(database, "SELECT data FROM keypoints WHERE image_id = ?1");
  const auto places = [&](std::int64_t image) {
    keypoints.Reset();
    keypoints.Bind(1, image).Step();
    std::vector<float> values(keypoints.Blob(0).size() / 4);
    std::memcpy(values.data(), keypoints.Blob(0).data(), keypoints.Blob(0).size());
    return values;
  };
  const std::vector<float>& p = atlas.cameras[0].parameters;
  int pairs = 0;
  for (; geometries.Step(); ++pairs) {
    const std::int64_t id = geometries.Integer(0);
    const std::vector<float> first = places(id / 2147483647), second = places(id % 2147483647);
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor> fundamental, essential;
    std::memcpy(fundamental.data(), geometries.Blob(3).data(), 72);
    std::memcpy(essential.data(), geometries.Blob(4).data(), 72);
    std::vector<std::uint32_t> matches(2 * static_cast<std::size_t>(geometries.Integer(1)));
    std::memcpy(matches.data(), geometries.Blob(2).data(), geometries.Blob(2).size());
    for (std::size_t at = 0; at < matches.size(); at += 2) {
      const Eigen::Vector3d one(first[4 * matches[at]], first[4 * matches[at] + 1], 1);
      const Eigen::Vector3d two(second[4 * matches[at + 1]], second[4 * matches[at + 1] + 1], 1);
      const Eigen::Vector3d line = fundamental * one;
      EXPECT_LT(std::abs(two.dot(line)) / line.head<2>().norm(), 0.05);
      const auto ray = [&](const Eigen::Vector3d& at_pixel) {
        return Eigen::Vector3d((at_pixel.x() - 0.5 - p[2]) / p[0], (at_pixel.y() - 0.5 - p[3]) / p[1], 1);
      };
      EXPECT_LT(std::abs(ray(two).dot(essential * ray(one))), 2e-4);
    }
  }
  EXPECT_GT(pairs, 3);
}

TEST(ColmapDatabase, IsTheSameForTheSameAtlas) {
  const TemporaryFolder folder, other;
  EXPECT_EQ(ReadFile(Written(folder, SmallAtlas())), ReadFile(Written(other, SmallAtlas())));
}

// ---- beside a model

void MakeModel(const TemporaryFolder& folder) {
  Notices notices;
  detail::kColmapFormat.write(OneMapAtlas(), folder.Path("sparse/0"), {.sync = false}, notices);
}

std::string SaidOf(const TemporaryFolder& folder, Atlas& atlas, const std::string& database = {}) {
  Notices notices;
  atlas =
      detail::kColmapFormat.read(folder.Path(""), ReadOptions{}.With(ColmapReadOptions{.database = database}), notices);
  std::string said;
  for (const Notice& notice : notices.items()) said += notice.text + "\n";
  return said;
}

TEST(ColmapDatabase, AboveAModelGivesItsDescriptors) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.Path("sparse"));
  MakeModel(folder);
  Atlas atlas;
  EXPECT_THAT(SaidOf(folder, atlas), HasSubstr("have no ORB descriptors"));
  EXPECT_FALSE(atlas.maps[0].points[0].has_descriptor());
  std::filesystem::rename(Written(folder, OneMapAtlas()), folder.Path("database.db"));
  EXPECT_THAT(SaidOf(folder, atlas), ::testing::Not(HasSubstr("have no ORB descriptors")));
  EXPECT_EQ(atlas.maps[0].keyframes[0].features.descriptors, OneMapAtlas().maps[0].keyframes[0].features.descriptors);
  EXPECT_TRUE(atlas.maps[0].points[0].has_descriptor());
}

// Both schemas, whatever pictures are called: names are bytes.
TEST(ColmapDatabase, OfEverySchemaAndNameGivesItsDescriptors) {
  for (const ColmapSchema schema : {ColmapSchema::kOld, ColmapSchema::kNew}) {
    const TemporaryFolder folder;
    const KeyFramePictures pictures{
        .files = {{"..\n'\";DROP TABLE images;--\xff.png", 0.5, true}, {"\xe2\x82.png", 1.5, true}}, .folder = ""};
    Notices notices;
    const Format& format = detail::kColmapFormat;
    format.write(OneMapAtlas(), folder.Path("model"),
                 WriteOptions{.sync = false}.With(
                     ColmapWriteOptions{.pictures = pictures, .with_database = true, .schema = schema}),
                 notices);
    const Atlas back = format.read(folder.Path("model"), {}, notices);
    EXPECT_EQ(Ask(folder.Path("model/database.db"), "SELECT count(*) FROM images"), "2\n");
    EXPECT_EQ(back.maps[0].keyframes[0].features.descriptors, OneMapAtlas().maps[0].keyframes[0].features.descriptors);
    EXPECT_EQ(back.maps[0].keyframes[1].features.keypoints[0].octave, 0);  // OneMapAtlas() has no pyramid
  }
}

TEST(ColmapDatabase, OfOtherDescriptorsIsKeptWithTheKeyFrame) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.Path("sparse"));
  MakeModel(folder);
  const std::string path = Written(folder, OneMapAtlas());
  Ask(path, "UPDATE descriptors SET cols = 128, data = zeroblob(128)");
  Atlas atlas;
  EXPECT_THAT(SaidOf(folder, atlas, path), HasSubstr("2 keypoints have descriptors that are not the 32 bytes of ORB"));
  EXPECT_EQ(atlas.maps[0].keyframes[0].carried->descriptors.columns, 128);
}

TEST(ColmapDatabase, ThatDoesNotFitIsRefusedOrSaid) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.Path("sparse"));
  MakeModel(folder);
  const std::string path = Written(folder, OneMapAtlas());
  const auto said = [&](const std::string& change) {
    Atlas atlas;
    const std::string changed = folder.Make("changed.db", ReadFile(path));
    EXPECT_EQ(Ask(changed, change), "");
    try {
      return SaidOf(folder, atlas, changed);
    } catch (const Error& error) {
      return std::string(error.what());
    }
  };
  EXPECT_THAT(said("UPDATE images SET name = name || 'x'"), HasSubstr("or nothing for 2 images"));
  EXPECT_THAT(said("UPDATE keypoints SET rows = 2"), HasSubstr("says 2 rows of 4 and has 16 bytes"));
  EXPECT_THAT(said("UPDATE keypoints SET rows = -1"), HasSubstr("says -1 rows of 4"));
  EXPECT_THAT(said("UPDATE keypoints SET data = NULL"), HasSubstr("has 0 bytes"));
  EXPECT_THAT(said("DROP TABLE descriptors"), HasSubstr("has no table descriptors"));
  EXPECT_THAT(
      said("DROP TABLE keypoints; CREATE VIEW keypoints AS SELECT 1 AS image_id, 1 AS rows, 4 AS cols, NULL AS data"),
      HasSubstr("keypoints"));
}

}  // namespace
}  // namespace slamdb
