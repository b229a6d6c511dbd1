// SPDX-License-Identifier: BSD-3-Clause
// Real sessions of one room, held against how they truly lie, and of rooms that must not be joined.
// The large ones are in the folders that SLAMDB_LAB2 and SLAMDB_ATLASES name; without these their tests are skipped.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "slamdb/align/align.h"
#include "slamdb/align/align_all.h"
#include "slamdb/edit/frame/similarity_text.h"
#include "slamdb/formats/formats.h"

namespace slamdb::testing {
namespace {

namespace fs = std::filesystem;

// Where an atlas is: in the fixtures, or in a folder that a variable names.
fs::path Find(const std::string& name) {
  std::vector<fs::path> folders{fs::path(SLAMDB_FIXTURES) / name};
  for (const char* variable : {"SLAMDB_LAB2", "SLAMDB_ATLASES"})
    if (const char* folder = std::getenv(variable)) folders.emplace_back(folder);
  for (const fs::path& folder : folders)
    if (fs::exists(folder / (name + ".osa"))) return folder / (name + ".osa");
  return {};
}

// Two maps; `first` and `second` may be one atlas.
struct RealPair {
  const char *first, *second;
  std::size_t first_map = 0, second_map = 0;
};

std::string NameOf(const RealPair& pair) {
  const std::string maps = pair.first_map == pair.second_map ? "" : "_maps";
  return std::string(pair.first) + "_with_" + pair.second + maps;
}

class Real {
 public:
  // Empty when an atlas is not there.
  static std::optional<Real> Read(const RealPair& pair) {
    const fs::path first = Find(pair.first), second = Find(pair.second);
    if (first.empty() || second.empty()) return std::nullopt;
    return Real(pair, ReadAtlas(first.string()), ReadAtlas(second.string()));
  }

  MapRef first_ref() const { return {&first_, pair_.first_map}; }
  MapRef second_ref() const { return {&second_, pair_.second_map}; }
  Alignment Align() const { return AlignMaps(first_ref(), second_ref()); }
  const Map& second() const { return second_.maps[pair_.second_map]; }

 private:
  Real(const RealPair& pair, Atlas first, Atlas second)
      : pair_(pair), first_(std::move(first)), second_(std::move(second)) {}

  RealPair pair_;
  Atlas first_, second_;
};

// How maps of one room truly lie, by where their cameras were; that is itself only good to some tenths of a degree.
struct TruePair {
  RealPair pair;
  const char* truth;
  double degrees, shift;  // at most; the shift in units of the first map
};

class RealOverlap : public ::testing::TestWithParam<TruePair> {};

TEST_P(RealOverlap, IsFoundWhereItTrulyIs) {
  const auto real = Real::Read(GetParam().pair);
  if (!real) GTEST_SKIP() << "set SLAMDB_LAB2 and SLAMDB_ATLASES to the folders that have the atlases";
  const Alignment alignment = real->Align();
  ASSERT_EQ(alignment.verdict, AlignmentVerdict::kAligned) << alignment.reason;
  const Similarity3d truth = ParseSimilarity(GetParam().truth), found = *alignment.first_from_second;
  EXPECT_LT(truth.rotation.angularDistance(found.rotation) * 180 / std::numbers::pi, GetParam().degrees);
  EXPECT_NEAR(found.scale / truth.scale, 1, alignment.scale_is_free ? 0.015 : 1e-4);
  double squares = 0;
  for (const KeyFrame& keyframe : real->second().keyframes) {
    const Eigen::Vector3d center = keyframe.camera_from_world.Inverse().translation.cast<double>();
    squares += (truth * center - found * center).squaredNorm();
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(real->second().keyframes.size())), GetParam().shift);
}

INSTANTIATE_TEST_SUITE_P(
    Rooms, RealOverlap,
    ::testing::Values(
        TruePair{{"session_small_a", "session_small_b"},
                 "-2.52928 0.01651 -0.96709 0.017140 0.780870 -0.018836 -0.624174 1",
                 2,
                 0.06},
        TruePair{{"session_a", "session_b"},
                 "-11.69811 -0.20098 -10.39566 0.012194 0.850249 -0.031339 -0.525305 1",
                 0.5,
                 0.05},
        TruePair{{"p1", "p2"}, "-2.46357 -0.24307 -1.68282 -0.028253 -0.878406 0.039824 0.475414 1", 0.5, 0.015},
        TruePair{{"m1", "m2"}, "-0.83904 0.08621 -0.17657 -0.061970 -0.667883 0.001962 0.741679 0.70499", 0.6, 0.01},
        TruePair{{"p1", "m2"}, "-0.21600 -0.06547 -2.49720 -0.007606 0.767713 0.010301 0.640665 1.87522", 0.5, 0.015},
        TruePair{{"p2", "m1"}, "-0.90109 0.13515 0.61599 -0.010253 -0.442131 0.014880 0.896768 2.65990", 0.7, 0.02},
        TruePair{{"i1", "i2"}, "-2.34432 -1.06670 0.00611 -0.001556 -0.003140 0.900292 0.435272 1", 0.6, 0.02},
        TruePair{{"f1", "f2"}, "-2.94425 -0.07011 -1.07178 -0.076635 -0.833324 0.050741 0.545090 1", 0.4, 0.02},
        TruePair{{"p1", "f1"}, "-0.64655 -0.12632 0.32733 0.027709 -0.312207 0.040050 0.948765 1", 0.5, 0.02},
        TruePair{{"p1", "i1"}, "-0.09855 -0.13555 0.16135 0.693058 -0.015616 0.006821 0.720681 1", 0.4, 0.01},
        TruePair{{"b1", "b2"}, "-0.00319 0.00096 0.00062 0.000075 -0.000113 0.000507 1 1", 0.2, 0.01}),
    [](const auto& each) { return NameOf(each.param.pair); });

class RealStrangers : public ::testing::TestWithParam<RealPair> {};

TEST_P(RealStrangers, AreRefused) {
  const auto real = Real::Read(GetParam());
  if (!real) GTEST_SKIP() << "set SLAMDB_LAB2 and SLAMDB_ATLASES to the folders that have the atlases";
  const Alignment alignment = real->Align();
  EXPECT_EQ(alignment.verdict, AlignmentVerdict::kNoOverlap) << alignment.reason;
}

// q1's room looks like that of p, m, b and i; r1's is another, as are those of the sessions.
INSTANTIATE_TEST_SUITE_P(Rooms, RealStrangers,
                         ::testing::Values(RealPair{"p1", "q1"}, RealPair{"q1", "p2"}, RealPair{"q1", "b1"},
                                           RealPair{"m1", "q1"}, RealPair{"i2", "q1"}, RealPair{"f1", "q1"},
                                           RealPair{"p1", "r1"}, RealPair{"q1", "r1"},
                                           RealPair{"p1", "session_small_a"}, RealPair{"session_a", "mono_small"},
                                           RealPair{"multimap_rgbd", "multimap_rgbd", 0, 1}),
                         [](const auto& each) { return NameOf(each.param); });

// Two metric sessions keep their scale, though links by way of the monocular ones match more points; what the cycles
// are off by is spread, so that the monocular ones come nearer to the truth than the links say.
TEST(RealSessions, OfTwoSensorsComeIntoOneFrame) {
  const auto metric = Real::Read({"p1", "p2"}), monocular = Real::Read({"m1", "m2"});
  if (!metric || !monocular) GTEST_SKIP() << "set SLAMDB_LAB2 to the folder that has the atlases";
  const std::array maps{metric->first_ref(), metric->second_ref(), monocular->first_ref(), monocular->second_ref()};
  const AlignedMaps aligned = AlignAllMaps(maps);
  for (const MapPlace& place : aligned.places) EXPECT_EQ(place.group, 0U);
  EXPECT_EQ(aligned.places[1].group_from_map.scale, 1);
  EXPECT_NEAR(aligned.places[3].group_from_map.scale / 1.87522, 1, 0.004);
}

}  // namespace
}  // namespace slamdb::testing
