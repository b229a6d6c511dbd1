// SPDX-License-Identifier: BSD-3-Clause
#include "tests/formats/orbslam3/meaning.h"

#include <gtest/gtest.h>

#include <cmath>

#include "slamdb/formats/orbslam3/orbslam3.h"
#include "tests/formats/orbslam3/real_atlases.h"

// Our reader sees in every real file what ORB-SLAM3's own loader saw, number by number.
namespace slamdb {
namespace {

using nlohmann::json;

// What ORB-SLAM3's loader saw: from the folder SLAMDB_MEANING, the folder `meaning` beside the atlases, or the
// fixtures; null when it is in none.
json RecordedMeaning(const std::string& name) {
  std::vector<std::filesystem::path> folders;
  if (const char* folder = std::getenv("SLAMDB_MEANING")) folders.emplace_back(folder);
  if (const char* folder = std::getenv("SLAMDB_ATLASES")) folders.push_back(std::filesystem::path(folder) / "meaning");
  folders.push_back(std::filesystem::path(SLAMDB_FIXTURES) / name);
  for (const std::filesystem::path& folder : folders)
    if (std::ifstream stream(folder / (name + ".json")); stream) return json::parse(stream);
  return {};
}

// Whether `found` is `recorded`, which prints large integers as strings and measured ranges with six digits.
bool Agrees(const json& found, const json& recorded, double tolerance) {
  if (recorded.is_string() && found.is_number_integer()) return found.dump() == recorded.get<std::string>();
  if (recorded.is_array() || recorded.is_object()) {
    if (found.size() != recorded.size()) return false;
    for (const auto& [key, value] : recorded.items()) {
      const json* twin = recorded.is_array() ? &found[std::stoul(key)] : found.contains(key) ? &found[key] : nullptr;
      if (!twin || !Agrees(*twin, value, tolerance)) return false;
    }
    return true;
  }
  if (!found.is_number() || !recorded.is_number()) return found == recorded;
  if (found.is_number_integer() && recorded.is_number_integer()) return found == recorded;
  const double a = found.get<double>(), b = recorded.get<double>();
  return a == b || std::abs(a - b) <= tolerance * std::max(std::abs(a), std::abs(b));
}

// Rotations and centres come after float arithmetic that may round otherwise; the rest are sums in double.
double Tolerance(const std::string& key) {
  if (key.starts_with("range_") || key == "imu_dT_minus_ts_diff") return 5e-6;
  if (key == "kf_tcw_q_wxyz_sum" || key == "kf_ow_sum") return 1e-6;
  return 1e-12;
}

void ExpectAgreement(const std::string& what, const json& found, const json& recorded) {
  for (const auto& [key, value] : recorded.items()) {
    ASSERT_TRUE(found.contains(key)) << what << " " << key;
    EXPECT_TRUE(Agrees(found[key], value, Tolerance(key)))
        << what << " " << key << ": found " << found[key] << ", recorded " << value;
  }
}

// Three files hold one state, of which ORB-SLAM3's own loader can read one: it fails on `nan` in a text archive, and
// wipes a map that is listed twice once it has seen what is stored.
std::string StoredTwin(const std::string& name) { return name == "mono_small_text" ? "mono_small" : name; }
std::string LoadedTwin(const std::string& name) {
  return name == "mono_small_text" || name == "mono_small_twice" ? "mono_small" : name;
}

class Meaning : public ::testing::TestWithParam<const char*> {
 protected:
  Atlas atlas_;
  json recorded_;
};

// Reads the atlas and what is recorded of its twin, or skips.
#define SLAMDB_REQUIRE_MEANING(twin)                                                                           \
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());                                                                 \
  recorded_ = RecordedMeaning(twin(GetParam()));                                                               \
  if (recorded_.is_null())                                                                                     \
    GTEST_SKIP() << twin(GetParam()) << ".json: no fixture, and SLAMDB_MEANING names no folder that holds it"; \
  Notices notices;                                                                                             \
  atlas_ = ReadOrbslam3(path, {}, notices)

TEST_P(Meaning, Header) {
  SLAMDB_REQUIRE_MEANING(StoredTwin);
  EXPECT_EQ(atlas_.vocabulary.name, recorded_["voc_name"]);
  EXPECT_EQ(atlas_.vocabulary.checksum, recorded_["voc_checksum"]);
  const Counters& next = atlas_.next_ids;
  ExpectAgreement("counter",
                  {{"Map", next.map},
                   {"Frame", next.frame},
                   {"KeyFrame", next.keyframe},
                   {"MapPoint", next.map_point},
                   {"GeometricCamera", next.camera},
                   {"mnLastInitKFidMap", next.initial_keyframe}},
                  recorded_["nNextId"]);
  ASSERT_EQ(atlas_.cameras.size(), recorded_["cameras"].size());
  for (std::size_t i = 0; i < atlas_.cameras.size(); ++i) {
    const Camera& camera = atlas_.cameras[i];
    const json& expected = recorded_["cameras"][i];
    EXPECT_EQ(camera.id.value(), expected["id"]);
    EXPECT_EQ(camera.recorded_type, expected["type"]);
    EXPECT_EQ(camera.model == CameraModel::kPinhole ? "Pinhole" : "KannalaBrandt8", expected["class"]);
    EXPECT_TRUE(Agrees(json(camera.parameters), expected["params"], 1e-8)) << expected;
  }
}

TEST_P(Meaning, CensusAsStored) {
  SLAMDB_REQUIRE_MEANING(StoredTwin);
  const json& maps = recorded_["raw"]["maps"];
  ASSERT_EQ(atlas_.maps.size(), maps.size());
  for (std::size_t i = 0; i < maps.size(); ++i)
    ExpectAgreement("map " + std::to_string(i), Census(atlas_, atlas_.maps[i]), maps[i]["census"]);
}

TEST_P(Meaning, SumsAsLoaded) {
  SLAMDB_REQUIRE_MEANING(LoadedTwin);
  json maps = recorded_["maps"];
  ASSERT_EQ(atlas_.maps.size(), maps.size());
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const json nulls = maps[i]["null_after_postload"];  // the other kinds are dangling ids, which the census counts
    maps[i]["null_after_postload"] = {{"mp_ref_kf", nulls["mp_ref_kf"]}, {"kf_slot_mp", nulls["kf_slot_mp"]}};
    ExpectAgreement("map " + std::to_string(i), Sums(atlas_.maps[i]), maps[i]);
  }
}

INSTANTIATE_TEST_SUITE_P(OrbSlam3, Meaning, ::testing::ValuesIn(kRealAtlases),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace slamdb
