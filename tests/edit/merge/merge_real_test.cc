// SPDX-License-Identifier: BSD-3-Clause
// Merging and renumbering files that ORB-SLAM3 itself wrote. The true poses are in the folder ground_truth beside the
// one that SLAMDB_MEANING names.
#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "slamdb/edit/ids/renumber.h"
#include "slamdb/edit/merge/merge.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/umeyama.h"
#include "tests/edit/soundness.h"
#include "tests/edit/worlds.h"
#include "tests/formats/orbslam3/real_atlases.h"

namespace slamdb::testing {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

Atlas ReadReal(const std::string& path) {
  Notices notices;
  return ReadOrbslam3(path, {}, notices);
}

// True camera centres by time in nanoseconds.
std::map<std::int64_t, Eigen::Vector3d> TruePlaces(const std::string& name) {
  std::map<std::int64_t, Eigen::Vector3d> places;
  const char* meaning = std::getenv("SLAMDB_MEANING");
  if (meaning == nullptr) return places;
  std::ifstream file(std::filesystem::path(meaning).parent_path() / "ground_truth" / (name + "_frames.txt"));
  double time = 0;
  Eigen::Vector3d place;
  for (std::string line; std::getline(file, line);)
    if (std::istringstream(line) >> time >> place.x() >> place.y() >> place.z())
      places[std::llround(time * 1e6)] = place;
  return places;
}

struct Trajectory {
  std::vector<Eigen::Vector3d> estimated, truth;
};

Trajectory Associate(const Map& map, std::uint32_t origin, const std::map<std::int64_t, Eigen::Vector3d>& truth) {
  Trajectory trajectory;
  for (const KeyFrame& keyframe : map.keyframes) {
    const auto found = truth.find(std::llround(keyframe.timestamp * 1e6));
    if (keyframe.origin_map != origin || found == truth.end()) continue;
    trajectory.estimated.emplace_back(CameraCenter(keyframe).cast<double>());
    trajectory.truth.push_back(found->second);
  }
  return trajectory;
}

// The median distance from the truth after the best rigid alignment of both.
double MedianError(const Trajectory& trajectory) {
  auto residuals = SolveUmeyama(trajectory.estimated, trajectory.truth, {.with_scale = false}).residuals;
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::ranges::nth_element(residuals, middle);
  return *middle;
}

void Append(const Trajectory& part, Trajectory& whole) {
  whole.estimated.insert(whole.estimated.end(), part.estimated.begin(), part.estimated.end());
  whole.truth.insert(whole.truth.end(), part.truth.begin(), part.truth.end());
}

Similarity3d Rigid(double x, double y, double z, double qx, double qy, double qz, double qw) {
  return {1, Eigen::Quaterniond(qw, qx, qy, qz), {x, y, z}};
}

// Pairs of maps whose true transform is known (ground_truth/transforms.json).
struct RealPair {
  const char* name;
  std::vector<std::string> files;
  std::vector<std::string> frames;  // ground truth of the first and the second map
  Similarity3d first_from_second;
};

const RealPair kPairs[] = {
    {"sessions",
     {"session_a", "session_b"},
     {"session_a", "session_b"},
     Rigid(-11.69810951629362, -0.2009827724789608, -10.395658366939122, 0.012194162122792793, 0.8502494347411883,
           -0.031338989586220146, -0.5253047390459444)},
    {"small_sessions",
     {"session_small_a", "session_small_b"},
     {"session_small_a", "session_small_b"},
     Rigid(-2.5292776480174, 0.01650996260001572, -0.9670909681524318, 0.01714005941561955, 0.7808704330960143,
           -0.01883572468718968, -0.6241736942191497)},
    {"maps_of_one_atlas",
     {"multimap_rgbd"},
     {"multimap_rgbd", "multimap_rgbd"},
     Rigid(-10.593929486153044, -0.0739201820043385, -6.089988142243794, 0.01352163814821371, 0.7362251269543402,
           -0.029210631819227194, -0.6759707587844136)},
};

class RealMerge : public ::testing::TestWithParam<RealPair> {
 protected:
  void SetUp() override {
    for (const std::string& file : GetParam().files) {
      SLAMDB_REQUIRE_REAL_ATLAS(path, file);
      inputs_.push_back(ReadReal(path));
    }
    for (const Atlas& input : inputs_)
      for (const std::string& trouble : Troubles(input)) known_.insert(trouble);
  }

  std::vector<Atlas> inputs_;
  std::set<std::string> known_;
};
INSTANTIATE_TEST_SUITE_P(All, RealMerge, ::testing::ValuesIn(kPairs),
                         [](const auto& pair) { return std::string(pair.param.name); });

TEST_P(RealMerge, UnionIsSound) {
  std::size_t keyframes = 0;
  for (const Atlas& input : inputs_)
    for (const Map& map : input.maps) keyframes += map.keyframes.size();
  const MergeResult merged = MergeAtlases(inputs_, {});
  EXPECT_THAT(NewTroubles(known_, merged.atlas), IsEmpty());
  const TemporaryFolder folder;
  EXPECT_EQ(KeyFramesThatBoostReads(merged.atlas, folder.Path("union.osa")), keyframes);
}

TEST_P(RealMerge, JoinIsAsAccurateAsTheParts) {
  Trajectory parts[2], joined;
  for (std::size_t i = 0; i < 2; ++i) {
    const Map& map = inputs_.size() == 1 ? inputs_[0].maps[i] : inputs_[i].maps[0];
    parts[i] =
        Associate(map, inputs_.size() == 1 ? static_cast<std::uint32_t>(i) : 0, TruePlaces(GetParam().frames[i]));
  }
  if (parts[0].truth.empty()) GTEST_SKIP() << "set SLAMDB_MEANING beside the folder ground_truth";
  const MergeResult result =
      MergeAtlases(std::move(inputs_),
                   {.join = JoinOptions{.first_from_second = GetParam().first_from_second, .fuse = FuseOptions()}});
  ASSERT_THAT(result.atlas.maps, SizeIs(1));
  EXPECT_THAT(NewTroubles(known_, result.atlas), IsEmpty());
  const std::size_t keyframes = result.atlas.maps[0].keyframes.size();
  for (std::size_t i = 0; i < 2; ++i)
    Append(Associate(result.atlas.maps[0], static_cast<std::uint32_t>(i), TruePlaces(GetParam().frames[i])), joined);
  EXPECT_EQ(joined.truth.size(), parts[0].truth.size() + parts[1].truth.size());
  const double apart = std::max(MedianError(parts[0]), MedianError(parts[1])), together = MedianError(joined);
  EXPECT_LE(together, std::max(apart + 0.001, apart * 1.01));
  const FuseReport& fused = *result.report.join->fused;
  std::printf("%s: median error %.1f mm and %.1f mm apart, %.1f mm joined; %llu points fused, %llu kept apart\n",
              GetParam().name, 1e3 * MedianError(parts[0]), 1e3 * MedianError(parts[1]), 1e3 * together,
              static_cast<unsigned long long>(fused.fused), static_cast<unsigned long long>(fused.seen_together));
  const TemporaryFolder folder;
  EXPECT_EQ(KeyFramesThatBoostReads(result.atlas, folder.Path("joined.osa")), keyframes);
}

TEST_P(RealMerge, UndoneRenumberingGivesTheSameBytes) {
  for (Atlas& input : inputs_) {
    const std::string before = EncodeOrbslam3(input);
    const IdMap ids = Renumber(input, {.start = 77, .order = IdOrder::kTime});
    EXPECT_THAT(NewTroubles(known_, input), IsEmpty());
    EXPECT_NE(EncodeOrbslam3(input), before);
    ApplyIdMap(input, Inverse(ids));
    EXPECT_TRUE(EncodeOrbslam3(input) == before);
  }
}

class RealFile : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, RealFile, ::testing::ValuesIn(kRealAtlases));

TEST_P(RealFile, IsRenumberedAndBack) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  Atlas atlas = ReadReal(path);
  const std::string before = EncodeOrbslam3(atlas);
  const auto known = Troubles(atlas);
  const IdMap ids = Renumber(atlas, {.kinds = {IdKind::kMap, IdKind::kKeyFrame, IdKind::kPoint, IdKind::kFrame}});
  EXPECT_THAT(NewTroubles(known, atlas), IsEmpty());
  ApplyIdMap(atlas, Inverse(ids));
  EXPECT_TRUE(EncodeOrbslam3(atlas) == before);
}

TEST(RealFiles, TheSameMapIsRecognised) {
  SLAMDB_REQUIRE_REAL_ATLAS(small, "mono_small");
  SLAMDB_REQUIRE_REAL_ATLAS(again, "mono_small_newmap");
  const MergeResult merged = MergeAtlases({ReadReal(small), ReadReal(again)}, {.same_map = SameMap::kKeepFirst});
  EXPECT_THAT(merged.report.same_maps, SizeIs(1));
  EXPECT_THAT(merged.atlas.maps, SizeIs(2));  // and the empty one
}

}  // namespace
}  // namespace slamdb::testing
