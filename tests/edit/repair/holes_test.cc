// SPDX-License-Identifier: BSD-3-Clause
// Files with holes at random places: what is whole between them comes back, and nothing that comes back is wrong.
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <span>
#include <unordered_map>

#include "slamdb/base/error.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/formats/salvage.h"
#include "slamdb/model/detail/row_hash.h"
#include "tests/edit/repair/entity_ranges.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/corrupt.h"

namespace slamdb {
namespace {

Bytes BytesOf(const std::string& text) { return std::as_bytes(std::span(text)); }

struct Hole {
  std::size_t begin, end;
};

// One to eight stretches of a byte to 64 kB, of zeros or of noise; a third of them among points and cameras.
std::vector<Hole> Puncture(std::mt19937_64& random, std::size_t points_begin, std::string& file) {
  std::vector<Hole> holes(1 + random() % 8);
  const bool zeros = random() % 2 == 0;
  for (Hole& hole : holes) {
    const std::size_t from = random() % 3 == 0 ? points_begin : 0;
    hole.begin = from + random() % (file.size() - from);
    hole.end = std::min(file.size(), hole.begin + (std::size_t{1} << random() % 17));
    for (std::size_t i = hole.begin; i < hole.end; ++i) file[i] = zeros ? '\0' : static_cast<char>(random());
  }
  return holes;
}

bool IsHit(const EntityRange& range, const std::vector<Hole>& holes) {
  return std::ranges::any_of(holes, [&](const Hole& hole) { return hole.begin < range.end && range.begin < hole.end; });
}

bool IsSame(const KeyFrame& a, const KeyFrame& b) {
  return detail::HashOfRow(a) == detail::HashOfRow(b) && detail::HashOfLinks(a) == detail::HashOfLinks(b) &&
         detail::HashOfFeatures(a) == detail::HashOfFeatures(b);
}
bool IsSame(const MapPoint& a, const MapPoint& b) {
  return detail::HashOfRow(a) == detail::HashOfRow(b) &&
         detail::HashOf(a.observations) == detail::HashOf(b.observations);
}
bool IsSame(const Camera& a, const Camera& b) { return detail::HashOf(a) == detail::HashOf(b); }

struct Count {
  std::uint64_t whole = 0, found = 0, wrong = 0;
  double share() const { return whole == 0 ? 1 : static_cast<double>(found) / static_cast<double>(whole); }
};

// `was(range)`: the entity in the undamaged file; `lists`: of what came back.
template <class Entity, class Was>
void Compare(const std::vector<EntityRange>& ranges, const std::vector<Hole>& holes, const Was& was,
             const std::vector<std::span<const Entity>>& lists, Count& count) {
  std::unordered_map<std::uint64_t, const Entity*> came_back;
  for (const auto list : lists)
    for (const Entity& entity : list) came_back.emplace(entity.id.value(), &entity);
  for (const EntityRange& range : ranges) {
    if (IsHit(range, holes)) continue;
    ++count.whole;
    const Entity& original = was(range);
    const auto found = came_back.find(original.id.value());
    if (found == came_back.end()) continue;
    ++count.found;
    count.wrong += !IsSame(*found->second, original);
  }
}

struct Counts {
  Count keyframes, points, cameras;
};

Counts PunctureMany(const std::string& file, int trials, std::uint64_t seed) {
  Notices notices;
  const Atlas whole = ReadOrbslam3(Source(BytesOf(file), "whole"), {}, notices);
  const EntityRanges ranges = RangesOf(file);
  std::mt19937_64 random(seed);
  Counts counts;
  for (int trial = 0; trial < trials; ++trial) {
    std::string damaged = file;
    const std::vector<Hole> holes = Puncture(random, ranges.points.empty() ? 0 : ranges.points.front().begin, damaged);
    const Salvage salvage = SalvageBytes(BytesOf(damaged), {.format = "orbslam3", .threads = 1});
    std::vector<std::span<const KeyFrame>> keyframes;
    std::vector<std::span<const MapPoint>> points;
    for (const Map& map : salvage.atlas.maps) {
      keyframes.emplace_back(map.keyframes);
      points.emplace_back(map.points);
    }
    const auto keyframe_was = [&](const EntityRange& range) -> const KeyFrame& {
      return whole.maps[range.map].keyframes[range.row];
    };
    const auto point_was = [&](const EntityRange& range) -> const MapPoint& {
      return whole.maps[range.map].points[range.row];
    };
    const auto camera_was = [&](const EntityRange& range) -> const Camera& { return whole.cameras[range.row]; };
    Compare<KeyFrame>(ranges.keyframes, holes, keyframe_was, keyframes, counts.keyframes);
    Compare<MapPoint>(ranges.points, holes, point_was, points, counts.points);
    Compare<Camera>(ranges.cameras, holes, camera_was, {std::span<const Camera>(salvage.atlas.cameras)},
                    counts.cameras);
  }
  return counts;
}

void ExpectAllBack(const Counts& counts, double share) {
  for (const auto& [what, count] :
       {std::pair("keyframes", counts.keyframes), {"points", counts.points}, {"cameras", counts.cameras}}) {
    EXPECT_GE(count.share(), share) << what << ": " << count.found << " of " << count.whole;
    EXPECT_EQ(count.wrong, 0u) << what;
  }
}

class SyntheticHoles : public ::testing::TestWithParam<std::tuple<Base, bool>> {};

TEST_P(SyntheticHoles, GiveBackWhatIsWholeBetweenThem) {
  const auto [base, text] = GetParam();
  Atlas atlas = SoundAtlas(base);
  atlas.encoding.text = text;
  ExpectAllBack(PunctureMany(EncodeOrbslam3(atlas), 60, static_cast<std::uint64_t>(base) * 2 + text), 0.97);
}

INSTANTIATE_TEST_SUITE_P(Bases, SyntheticHoles,
                         ::testing::Combine(::testing::Values(Base::kMonocular, Base::kRgbd, Base::kFisheyeStereo,
                                                              Base::kInertial, Base::kTwoMaps),
                                            ::testing::Bool()));

class RealHoles : public ::testing::TestWithParam<const char*> {};

TEST_P(RealHoles, GiveBackWhatIsWholeBetweenThem) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  const Counts counts = PunctureMany(ReadWhole(path), 40, 7);
  ExpectAllBack(counts, 0.99);
  RecordProperty("keyframes", std::to_string(counts.keyframes.found) + "/" + std::to_string(counts.keyframes.whole));
  RecordProperty("points", std::to_string(counts.points.found) + "/" + std::to_string(counts.points.whole));
  RecordProperty("cameras", std::to_string(counts.cameras.found) + "/" + std::to_string(counts.cameras.whole));
}

INSTANTIATE_TEST_SUITE_P(Files, RealHoles, ::testing::ValuesIn(kRealAtlases));

// Points and lenses stand whole behind the last hole, whose first keyframe and whose list of points are hit.
TEST(RealHole, FourOfFourKilobytes) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, "fisheye_stereo");
  std::string file = ReadWhole(path);
  for (const std::size_t at : {245248, 4448256, 7051264, 7738880}) file.replace(at, 4096, 4096, '\0');
  const Salvage salvage = SalvageBytes(BytesOf(file));
  ASSERT_EQ(salvage.atlas.maps.size(), 1u);
  EXPECT_GE(salvage.atlas.maps[0].keyframes.size(), 24u);
  EXPECT_GE(salvage.atlas.maps[0].points.size(), 1961u);
  ASSERT_EQ(salvage.atlas.cameras.size(), 2u);
  EXPECT_EQ(salvage.atlas.cameras[1].parameters.size(), 8u);
  EXPECT_NE(salvage.atlas.cameras[1].parameters[4], 0.0F);
}

}  // namespace
}  // namespace slamdb
