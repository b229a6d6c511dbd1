// SPDX-License-Identifier: BSD-3-Clause
// Files cut and flipped at many places: whatever is left becomes a sound atlas, and how much is left follows the bytes.
#include "slamdb/edit/repair/recover.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <span>

#include "slamdb/base/error.h"
#include "slamdb/formats/orbslam3/detail/salvage.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/formats/salvage.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/boost_reference/boost_reference.h"
#include "tests/support/corrupt.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::IsEmpty;
using ::testing::Not;

std::uint64_t KeyFramesOf(const Atlas& atlas) {
  std::uint64_t count = 0;
  for (const Map& map : atlas.maps) count += map.keyframes.size();
  return count;
}
std::uint64_t PointsOf(const Atlas& atlas) {
  std::uint64_t count = 0;
  for (const Map& map : atlas.maps) count += map.points.size();
  return count;
}

class Recover : public ::testing::Test {
 protected:
  void Write(std::string_view bytes) {
    std::ofstream file(path_, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  Salvage SalvageBytes(std::string_view bytes) {
    Write(bytes);
    return detail::SalvageOrbslam3(path_, {.threads = 1});
  }
  // Salvages and recovers; nothing when the header is gone. The vocabulary's name and checksum have no twin in the
  // file.
  std::optional<Atlas> RecoverBytes(std::string_view bytes) {
    Salvage salvage;
    try {
      salvage = SalvageBytes(bytes);
    } catch (const Error&) {
      return std::nullopt;
    }
    RecoverAtlas(salvage.atlas, {.triangulate = false, .threads = 1});  // whose points do not follow the bytes
    for (const RuleResult& result : CheckAtlas(salvage.atlas, {.threads = 1}).results)
      if (result.severity == Severity::kError && result.id != "vocabulary-checksum" && result.id != "atlas-not-empty")
        ADD_FAILURE() << result.id << ": " << ToString(result.findings[0].place) << ": " << result.findings[0].message;
    return std::move(salvage.atlas);
  }
  void ExpectBoostReads(const Atlas& atlas) {
    Notices notices;
    WriteOrbslam3(atlas, path_, {.overwrite = true, .sync = false}, notices);
    const Atlas loaded =
        reference::Load(path_, atlas.encoding.text ? reference::Encoding::kText : reference::Encoding::kBinary);
    EXPECT_EQ(KeyFramesOf(loaded), KeyFramesOf(atlas));
    EXPECT_EQ(PointsOf(loaded), PointsOf(atlas));
  }

  const TemporaryFolder folder_;
  const std::string path_ = folder_ / "damaged.osa";
};

std::string Encoded(Atlas atlas, bool text) {
  atlas.encoding.text = text;
  return EncodeOrbslam3(atlas);
}

// Where the points of the only map begin, about: keyframes stand in front of them.
std::size_t KeyFrameBytes(Atlas atlas) {
  for (Map& map : atlas.maps) map.points.clear();
  return EncodeOrbslam3(atlas).size();
}

// An atlas with a record for every keyframe that the cut leaves whole, and for every point.
void ExpectShareFollowsBytes(const Atlas& whole, const Atlas& recovered, std::size_t bytes, std::size_t keyframe_bytes,
                             std::size_t cut) {
  const auto share = [](std::size_t part, std::size_t all) {
    return std::min(1.0, static_cast<double>(part) / static_cast<double>(all));
  };
  const double keyframes = static_cast<double>(KeyFramesOf(whole)), points = static_cast<double>(PointsOf(whole));
  EXPECT_NEAR(static_cast<double>(KeyFramesOf(recovered)), keyframes * share(cut, keyframe_bytes), 0.1 * keyframes + 2);
  if (cut < keyframe_bytes) {
    EXPECT_EQ(PointsOf(recovered), 0u);
    return;
  }
  EXPECT_NEAR(static_cast<double>(PointsOf(recovered)), points * share(cut - keyframe_bytes, bytes - keyframe_bytes),
              0.1 * points + 5);
}

class RecoverBase : public Recover, public ::testing::WithParamInterface<std::tuple<Base, bool>> {};

TEST_P(RecoverBase, WholeFilesStayAsTheyAre) {
  const auto [base, text] = GetParam();
  const std::string bytes = Encoded(SoundAtlas(base), text);
  const Salvage salvage = SalvageBytes(bytes);
  EXPECT_THAT(salvage.damage, IsEmpty());
  EXPECT_TRUE(EncodeOrbslam3(salvage.atlas) == bytes);
}

TEST_P(RecoverBase, CutFiles) {
  const auto [base, text] = GetParam();
  const Atlas& whole = SoundAtlas(base);
  const std::string bytes = Encoded(whole, text);
  Atlas copy = whole;
  copy.encoding.text = text;
  const std::size_t keyframe_bytes = KeyFrameBytes(copy);
  std::uint64_t entities = 0;
  constexpr std::size_t kCuts = 40;
  for (std::size_t i = 1; i < kCuts; ++i) {
    const std::size_t cut = bytes.size() * i / kCuts + i;
    SCOPED_TRACE("cut at byte " + std::to_string(cut) + " of " + std::to_string(bytes.size()));
    const std::optional<Atlas> recovered = RecoverBytes(std::string_view(bytes).substr(0, cut));
    ASSERT_TRUE(recovered);
    EXPECT_GE(KeyFramesOf(*recovered) + PointsOf(*recovered), entities);
    entities = KeyFramesOf(*recovered) + PointsOf(*recovered);
    if (whole.maps.size() == 1) ExpectShareFollowsBytes(whole, *recovered, bytes.size(), keyframe_bytes, cut);
    if (i % 8 == 0 && entities > 0) ExpectBoostReads(*recovered);
  }
}

TEST_P(RecoverBase, FlippedBytes) {
  const auto [base, text] = GetParam();
  const Atlas& whole = SoundAtlas(base);
  const std::string bytes = Encoded(whole, text);
  std::mt19937_64 random(static_cast<std::uint64_t>(base) * 2 + text);
  std::vector<std::uint64_t> recovered;
  for (int i = 0; i < 40; ++i) {
    std::string damaged = bytes;
    const std::size_t at = random() % bytes.size();
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << random() % 8));
    SCOPED_TRACE("flipped byte " + std::to_string(at));
    const std::optional<Atlas> atlas = RecoverBytes(damaged);
    if (!atlas) continue;
    recovered.push_back(KeyFramesOf(*atlas));
    if (i % 8 == 0 && !atlas->maps.empty()) ExpectBoostReads(*atlas);
  }
  // Most flips cost nothing or one keyframe.
  std::ranges::sort(recovered);
  ASSERT_THAT(recovered, Not(IsEmpty()));
  EXPECT_GE(recovered[recovered.size() / 4], KeyFramesOf(whole) - 1);
}

// A stretch in the middle of a keyframe is lost: the others are found again, and so are all points.
TEST_P(RecoverBase, ReadsOnBehindDamage) {
  const auto [base, text] = GetParam();
  const Atlas& whole = SoundAtlas(base);
  std::string bytes = Encoded(whole, text);
  Atlas first_map = whole;
  first_map.maps.resize(1);
  first_map.encoding.text = text;
  const std::size_t keyframe = KeyFrameBytes(first_map) / whole.maps[0].keyframes.size();
  bytes.erase(keyframe * 7 / 2, 1001);
  const Salvage salvage = SalvageBytes(bytes);
  EXPECT_THAT(salvage.damage, Not(IsEmpty()));
  EXPECT_GE(KeyFramesOf(salvage.atlas) + 2, KeyFramesOf(whole));
  EXPECT_EQ(PointsOf(salvage.atlas), PointsOf(whole));
  EXPECT_EQ(salvage.atlas.cameras.size(), whole.cameras.size());
  EXPECT_EQ(salvage.atlas.next_ids, whole.next_ids);
}

TEST_P(RecoverBase, ReadsOnBehindADamagedFirstKeyFrame) {
  const auto [base, text] = GetParam();
  const Atlas& whole = SoundAtlas(base);
  std::string bytes = Encoded(whole, text);
  Atlas first_map = whole;
  first_map.maps.resize(1);
  first_map.encoding.text = text;
  bytes.erase(KeyFrameBytes(first_map) / whole.maps[0].keyframes.size() / 2, 501);
  const Salvage salvage = SalvageBytes(bytes);
  EXPECT_GE(KeyFramesOf(salvage.atlas) + 2, KeyFramesOf(whole));
  EXPECT_EQ(PointsOf(salvage.atlas), PointsOf(whole));
}

// A stretch at the beginning of a file, or behind its header, up to its first keyframes, holds zeros.
TEST_P(RecoverBase, FilesWithoutTheirBeginning) {
  const auto [base, text] = GetParam();
  const Atlas& whole = SoundAtlas(base);
  const std::string bytes = Encoded(whole, text);
  Atlas first_map = whole;
  first_map.maps.resize(1);
  first_map.encoding.text = text;
  const std::size_t keyframe = KeyFrameBytes(first_map) / whole.maps[0].keyframes.size();
  for (const std::size_t lost :
       {std::size_t{1}, std::size_t{45}, std::size_t{100}, std::size_t{200}, keyframe / 2, keyframe * 3 / 2}) {
    SCOPED_TRACE("zeros up to byte " + std::to_string(lost));
    std::string damaged = bytes;
    damaged.replace(0, lost, lost, '\0');
    const Salvage salvage = SalvageBytes(damaged);
    EXPECT_THAT(salvage.damage, Not(IsEmpty()));
    EXPECT_GE(KeyFramesOf(salvage.atlas) + lost / keyframe + 1, KeyFramesOf(whole));
    EXPECT_EQ(salvage.maps[0].keyframes.listed, whole.maps[0].keyframes.size());
    EXPECT_EQ(PointsOf(salvage.atlas), PointsOf(whole));
    EXPECT_EQ(salvage.atlas.cameras.size(), whole.cameras.size());
    EXPECT_EQ(salvage.atlas.next_ids, whole.next_ids);
    EXPECT_EQ(salvage.lost_beginning, lost > 1) << "a damaged header is all that is lost";
    const std::optional<Atlas> recovered = RecoverBytes(damaged);
    ASSERT_TRUE(recovered);
    EXPECT_GE(KeyFramesOf(*recovered) + lost / keyframe + 2, KeyFramesOf(whole));
  }
}

INSTANTIATE_TEST_SUITE_P(Bases, RecoverBase,
                         ::testing::Combine(::testing::Values(Base::kMonocular, Base::kRgbd, Base::kFisheyeStereo,
                                                              Base::kInertial, Base::kTwoMaps),
                                            ::testing::Bool()));

TEST_F(Recover, RebuildsWhatStandsAtTheEnd) {
  const Atlas& whole = SoundAtlas(Base::kRgbd);
  const std::string bytes = EncodeOrbslam3(whole);
  const std::optional<Atlas> recovered = RecoverBytes(std::string_view(bytes).substr(0, bytes.size() - 200));
  ASSERT_TRUE(recovered);
  ASSERT_EQ(recovered->cameras.size(), 1u);
  EXPECT_EQ(recovered->cameras[0].id, whole.cameras[0].id);
  EXPECT_EQ(recovered->cameras[0].parameters, whole.cameras[0].parameters);
  EXPECT_EQ(recovered->maps[0].first_keyframe, whole.maps[0].first_keyframe);
  EXPECT_GE(recovered->next_ids.keyframe, whole.maps[0].max_keyframe_id + 1);
}

TEST_F(Recover, TakesCamerasFromAnotherAtlas) {
  const Atlas& whole = SoundAtlas(Base::kFisheyeStereo);
  const std::string bytes = EncodeOrbslam3(whole);
  const std::string_view cut = std::string_view(bytes).substr(0, bytes.size() - 250);
  Salvage salvage = SalvageBytes(cut);
  ASSERT_THAT(salvage.atlas.cameras, IsEmpty());
  Atlas alone = salvage.atlas;
  const RecoverReport guessed = RecoverAtlas(alone);
  EXPECT_EQ(guessed.guessed_lenses.size(), 2u);
  EXPECT_EQ(guessed.rebuilt_cameras, std::vector{whole.cameras[0].id});
  EXPECT_EQ(guessed.guessed_cameras, std::vector{whole.cameras[1].id}) << "of which keyframes keep nothing";
  const RecoverReport report = RecoverAtlas(salvage.atlas, {.rig = &whole});
  EXPECT_EQ(report.taken_cameras.size(), 2u);
  EXPECT_EQ(salvage.atlas.cameras[1].parameters, whole.cameras[1].parameters);
}

// The keyframes of a monocular camera do not tell whether it is a fisheye one, unless its distortion was removed.
TEST_F(Recover, SaysWhichModelsAreGuessed) {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  atlas.cameras.clear();
  Atlas distorted = atlas;
  distorted.maps[0].keyframes[0].features.undistorted[0].x += 1;
  EXPECT_EQ(RecoverAtlas(atlas).guessed_models.size(), 1u);
  EXPECT_THAT(RecoverAtlas(distorted).guessed_models, IsEmpty());
  Atlas depth = SoundAtlas(Base::kRgbd);
  depth.cameras.clear();
  EXPECT_THAT(RecoverAtlas(depth).guessed_models, IsEmpty());
}

TEST_F(Recover, KeyFramesWithoutPointsAreNotSound) {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  const std::uint64_t keyframes = KeyFramesOf(atlas);
  atlas.maps[0].points.clear();
  const RecoverReport report = RecoverAtlas(atlas, {.triangulate = false});
  EXPECT_FALSE(report.sound());
  EXPECT_TRUE(report.pointless());
  EXPECT_FALSE(CheckAtlas(atlas).ok());
  EXPECT_EQ(KeyFramesOf(atlas), keyframes);
}

TEST_F(Recover, DropsWhatBreaksARuleWithoutRepair) {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  const std::uint64_t keyframes = KeyFramesOf(atlas);
  atlas.maps[0].keyframes[5].camera_from_world.translation.setConstant(std::numeric_limits<float>::quiet_NaN());
  atlas.maps[0].keyframes[7].features.keypoints[0].octave = 99;
  const RecoverReport report = RecoverAtlas(atlas);
  EXPECT_TRUE(report.sound());
  EXPECT_EQ(report.dropped_keyframes, 2u);
  EXPECT_EQ(KeyFramesOf(atlas), keyframes - 2);
}

// Damage gave a keyframe and a point the ids of others, which stand behind them: those stay, whom others know by it.
TEST_F(Recover, KeepsTheOneThatHasItsIdByRight) {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  Map& map = atlas.maps[0];
  const KeyFrame keyframe = map.keyframes[6];
  const MapPoint point = map.points[6];
  map.keyframes[2].id = keyframe.id;
  map.points[2].id = point.id;
  const RecoverReport report = RecoverAtlas(atlas, {.triangulate = false});
  EXPECT_EQ(report.dropped_keyframes, 1u);
  EXPECT_GE(report.dropped_points, 1u);
  const auto kept = std::ranges::find(map.keyframes, keyframe.id, &KeyFrame::id);
  ASSERT_NE(kept, map.keyframes.end());
  EXPECT_EQ(kept->frame_id, keyframe.frame_id);
  EXPECT_EQ(std::ranges::find(map.points, point.id, &MapPoint::id)->position, point.position);
}

TEST_F(Recover, KeepsLandmarksAtFinitePlaces) {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  Map& alone = atlas.maps.emplace_back();
  alone.id = MapId(atlas.next_ids.map++);
  alone.landmarks.resize(3);
  alone.landmarks[1].mean.x() = std::numeric_limits<double>::quiet_NaN();
  const RecoverReport report = RecoverAtlas(atlas);
  EXPECT_TRUE(report.sound());
  EXPECT_EQ(report.dropped_landmarks, 1u);
  ASSERT_EQ(atlas.maps.size(), 2u);
  EXPECT_EQ(atlas.maps[1].landmarks.size(), 2u);
}

TEST_F(Recover, RealFileCutAtManyPlaces) {
  const auto path = std::filesystem::path(SLAMDB_FIXTURES) / "session_small_a" / "session_small_a.osa";
  Notices notices;
  const Atlas whole = ReadOrbslam3(path.string(), {}, notices);
  const std::string bytes = EncodeOrbslam3(whole);
  const std::size_t keyframe_bytes = KeyFrameBytes(whole);
  constexpr std::size_t kCuts = 60;
  for (std::size_t i = 1; i < kCuts; ++i) {
    const std::size_t cut = bytes.size() * i / kCuts;
    SCOPED_TRACE("cut at byte " + std::to_string(cut));
    const std::optional<Atlas> recovered = RecoverBytes(std::string_view(bytes).substr(0, cut));
    ASSERT_TRUE(recovered);
    ExpectShareFollowsBytes(whole, *recovered, bytes.size(), keyframe_bytes, cut);
    if (i % 10 == 0) ExpectBoostReads(*recovered);
  }
}

// Of few keyframes most bring classes, and of the last one nothing says where it ends.
class CutOfFewKeyFrames : public ::testing::TestWithParam<std::tuple<std::size_t, std::size_t>> {};
TEST_P(CutOfFewKeyFrames, GivesAllThatAreWhole) {
  const auto [keyframes, cut] = GetParam();
  const Atlas whole =
      SynthesizeAtlas({.sensor = Sensor::kMonocular, .inertial = true, .keyframes = keyframes, .points = 200});
  const std::string bytes = EncodeOrbslam3(whole);
  const Salvage salvage = SalvageBytes(std::as_bytes(std::span(bytes)).first(bytes.size() - cut));
  ASSERT_EQ(salvage.atlas.maps.size(), 1u);
  const Column<KeyFrame>& read = salvage.atlas.maps[0].keyframes;
  ASSERT_EQ(read.size(), keyframes);
  for (std::size_t i = 0; i < keyframes; ++i) EXPECT_EQ(read[i].id, whole.maps[0].keyframes[i].id);
  EXPECT_TRUE(salvage.atlas.layout.empty());
}
INSTANTIATE_TEST_SUITE_P(Recover, CutOfFewKeyFrames,
                         ::testing::Combine(::testing::Range<std::size_t>(2, 6),
                                            ::testing::Values<std::size_t>(10, 3000)));

}  // namespace
}  // namespace slamdb
