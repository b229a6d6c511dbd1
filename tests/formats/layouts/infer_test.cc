// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/infer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "slamdb/formats/orbslam3/detail/salvage.h"
#include "slamdb/formats/orbslam3/infer_layout.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/layouts/invented_layouts.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/message_of.h"

namespace slamdb::testing {
namespace {

using ::testing::HasSubstr;

std::string WrittenIn(const Atlas& atlas, const std::string& layout) {
  Notices notices;
  WriteOptions options;
  options.of<Orbslam3WriteOptions>().layout = layout;
  std::string bytes;
  const auto append = [&](Bytes more) { bytes.append(reinterpret_cast<const char*>(more.data()), more.size()); };
  WriteOrbslam3(atlas, Target(append, "written"), options, notices);
  return bytes;
}

class RealAtlas13 : public ::testing::TestWithParam<const char*> {};
TEST_P(RealAtlas13, IsOfV1) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  const InferredLayout inferred = InferLayout(path);
  EXPECT_TRUE(inferred.known);
  EXPECT_EQ(inferred.layout.id, "v1.0");
  EXPECT_TRUE(inferred.same_bytes);
  EXPECT_TRUE(inferred.sure());
}
INSTANTIATE_TEST_SUITE_P(InferLayout, RealAtlas13, ::testing::ValuesIn(kRealAtlases));

class KnownLayout : public ::testing::TestWithParam<std::string> {};
TEST_P(KnownLayout, IsTold) {
  const std::string bytes = WrittenIn(RealSession(), GetParam());
  const InferredLayout inferred = InferLayout(In(bytes));
  EXPECT_TRUE(inferred.known);
  EXPECT_EQ(inferred.layout.id, GetParam());
  EXPECT_TRUE(inferred.same_bytes);
}
std::vector<std::string> Ids() {
  std::vector<std::string> ids;
  for (const Layout& layout : KnownLayouts()) ids.push_back(layout.id);
  return ids;
}
INSTANTIATE_TEST_SUITE_P(InferLayout, KnownLayout, ::testing::ValuesIn(Ids()));

// Of layouts that nobody knows: what is found reads the file as its own layout does, or tells look-alikes apart where
// nothing does, and gives the same bytes.
class InventedLayout : public ::testing::TestWithParam<int> {};
TEST_P(InventedLayout, IsReadAndGivenBack) {
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()));
  const Invention fork = InventLayout(
      random, {.insertions = 1, .removals = GetParam() % 4 == 3 ? 1 : 0, .classes = {"MapPoint", "KeyFrame"}});
  const std::string bytes = Forge(RealSession(), fork.layout, random);
  const InferredLayout inferred = InferLayout(In(bytes));
  EXPECT_TRUE(inferred.same_bytes) << ::testing::PrintToString(fork.changes);
  EXPECT_TRUE(SameCore(ReadAs(bytes, ToJson(inferred.layout)), ReadAs(bytes, ToJson(fork.layout))))
      << ::testing::PrintToString(fork.changes);
}
INSTANTIATE_TEST_SUITE_P(InferLayout, InventedLayout, ::testing::Range(0, 12));

Layout WithMember(const char* of, const char* behind, LayoutMember member) {
  Layout layout = KnownLayouts().front();
  layout.id = "";
  std::vector<LayoutMember>& members = layout.Find(of)->members;
  const auto at = std::ranges::find(members, behind, &LayoutMember::name);
  members.insert(at + 1, std::move(member));
  return layout;
}

TEST(InferLayout, NamesWhatIsDifferent) {
  std::mt19937_64 random(1);
  const Layout fork = WithMember("MapPoint", "nObs", {"x1", "arr<f64,7>"});
  const InferredLayout inferred = InferLayout(In(Forge(RealSession(), fork, random)));
  EXPECT_FALSE(inferred.known);
  ASSERT_EQ(inferred.differences.size(), 1U);
  EXPECT_EQ(inferred.differences[0], "MapPoint: unknown1, 56 bytes, between nObs and mWorldPos");
}

TEST(InferLayout, SaysWhatWouldFitAsWell) {
  // A flag among flags may be any of them.
  std::mt19937_64 random(1);
  const Layout fork = WithMember("KeyFrame", "mbNotErase", {"x1", "bool"});
  const InferredLayout inferred = InferLayout(In(Forge(RealSession(), fork, random)));
  EXPECT_FALSE(inferred.sure());
  EXPECT_TRUE(inferred.same_bytes);
}

// A fork with one byte more behind mBackupRefKFId, next to which mbBad stands; `one` in so many of a hundred points.
std::string WithFlags(int percent) {
  Atlas atlas = RealSession();
  atlas.layout = ToJson(WithMember("MapPoint", "mBackupRefKFId", {"x1", "u8"}));
  int row = 0;
  for (MapPoint& point : atlas.maps[0].points)
    point.carried.Make().members.push_back(static_cast<std::byte>(row++ % 100 < percent));
  return EncodeOrbslam3(atlas);
}
std::uint64_t Bad(const Atlas& atlas) {
  return static_cast<std::uint64_t>(
      std::ranges::count_if(atlas.maps[0].points, [](const MapPoint& point) { return bool(point.bad); }));
}

class FlagBesideBad : public ::testing::TestWithParam<int> {};
TEST_P(FlagBesideBad, IsNotTakenForIt) {
  const std::string bytes = WithFlags(GetParam());
  const InferredLayout inferred = InferLayout(In(bytes));
  EXPECT_TRUE(inferred.same_bytes);
  EXPECT_EQ(Bad(ReadAs(bytes, ToJson(inferred.layout))), 0U);
}
INSTANTIATE_TEST_SUITE_P(InferLayout, FlagBesideBad, ::testing::Values(1, 3, 50, 90, 100));

TEST(InferLayout, AnotherLayoutThatFitsCanBeChosen) {
  const std::string bytes = WithFlags(1);
  const InferredLayout first = InferLayout(In(bytes)), second = InferLayout(In(bytes), {.choice = 2});
  ASSERT_FALSE(first.alternatives.empty());
  ASSERT_EQ(second.differences.size(), 1U);
  EXPECT_EQ(second.differences[0], first.alternatives[0]);
  EXPECT_EQ(second.alternatives[0], first.differences[0]);
  EXPECT_TRUE(second.same_bytes);
  EXPECT_GT(Bad(ReadAs(bytes, ToJson(second.layout))), 0U);
  for (const std::size_t choice : {std::size_t{0}, first.alternatives.size() + 2})
    EXPECT_THAT(MessageOf([&] { (void)InferLayout(In(bytes), {.choice = choice}); }), HasSubstr("to choose"));
  EXPECT_THAT(MessageOf([] { (void)InferLayout(In(EncodeOrbslam3(RealSession())), {.choice = 2}); }),
              HasSubstr("1 layout fits"));
}

TEST(InferLayout, FindsAMissingCounter) {
  Layout fork = KnownLayouts().front();
  std::vector<LayoutMember>& members = fork.Find("Atlas")->members;
  std::erase_if(members, [](const LayoutMember& member) { return member.name == "KeyFrame::nNextId"; });
  std::mt19937_64 random(1);
  const InferredLayout inferred = InferLayout(In(Forge(RealSession(), fork, random)));
  ASSERT_EQ(inferred.differences.size(), 1U);
  EXPECT_EQ(inferred.differences[0], "Atlas: no KeyFrame::nNextId");
}

// ---- What is written in another form, in another order or not at all

// Whether both say the same of where keyframes and map points are.
void ExpectSamePlaces(const Atlas& found, const Atlas& truth) {
  ASSERT_EQ(found.maps.size(), truth.maps.size());
  const Map &a = found.maps[0], &b = truth.maps[0];
  ASSERT_EQ(a.keyframes.size(), b.keyframes.size());
  ASSERT_EQ(a.points.size(), b.points.size());
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < a.keyframes.size(); ++i) {
    const KeyFrame &x = a.keyframes[i], &y = b.keyframes[i];
    const bool same = x.id == y.id && std::abs(x.timestamp - y.timestamp) < 1e-5 &&
                      x.camera_from_world.rotation.coeffs().isApprox(y.camera_from_world.rotation.coeffs(), 1e-4F) &&
                      (x.camera_from_world.translation - y.camera_from_world.translation).norm() < 1e-4F &&
                      x.features.map_points == y.features.map_points;
    wrong += !same;
  }
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    const MapPoint &x = a.points[i], &y = b.points[i];
    wrong += !(x.id == y.id && x.position == y.position && x.normal == y.normal && x.observations == y.observations &&
               x.observation_count == y.observation_count && x.max_distance == y.max_distance);
  }
  EXPECT_EQ(wrong, 0U);
}

struct Fork {
  const char* name;
  const char* changes;
};
void PrintTo(const Fork& fork, std::ostream* out) { *out << fork.name; }
const Fork kForks[] = {
    {"PositionsOfDoubles", "~MapPoint.mWorldPos mWorldPos:arr<f64,3>"},
    {"PositionsAndNormalsOfDoubles",
     "~MapPoint.mWorldPos mWorldPos:arr<f64,3>\n~MapPoint.mNormalVector mNormalVector:arr<f64,3>"},
    {"PosesOfDoubles", "~KeyFrame.mTcw mTcw:arr<f64,7>"},
    {"AllPosesOfDoubles",
     "~KeyFrame.mTcp mTcp:arr<f64,7>\n~KeyFrame.mTcw mTcw:arr<f64,7>\n~KeyFrame.mTlr mTlr:arr<f64,7>"},
    {"DistancesOfDoubles", "~MapPoint.mfMinDistance mfMinDistance:f64\n~MapPoint.mfMaxDistance mfMaxDistance:f64"},
    {"ShortIds", "~KeyFrame.mnId mnId:u32\n~MapPoint.mnId mnId:u32"},
    {"LongCounts", "~MapPoint.nObs nObs:i64"},
    {"LongRows",
     "~MapPoint.mBackupObservationsId1 mBackupObservationsId1:map<u64,u64>\n"
     "~MapPoint.mBackupObservationsId2 mBackupObservationsId2:map<u64,u64>"},
    {"ShortMatches", "~KeyFrame.mvBackupMapPointsId mvBackupMapPointsId:vec<i32>"},
    {"ShortGrid", "~KeyFrame.mGrid mGrid:vec<vec<vec<u32>>>"},
    {"Nanoseconds", "~KeyFrame.mTimeStamp mTimeStamp.nanoseconds:u64"},
    {"QuaternionsFromX",
     "~KeyFrame.mTcw mTcw.xyzw:arr<f32,7>\n~KeyFrame.mTcp mTcp.xyzw:arr<f32,7>\n~KeyFrame.mTlr mTlr.xyzw:arr<f32,7>"},
    {"OneQuaternionFromX", "~KeyFrame.mTcw mTcw.xyzw:arr<f32,7>"},
    {"DoubleQuaternionsFromX", "~KeyFrame.mTcw mTcw.xyzw:arr<f64,7>"},
    {"WorldFromCamera", "~KeyFrame.mTcw mTcw.inverse:arr<f32,7>"},
    {"MatricesByRows", "~KeyFrame.mTcw mTcw.rows:arr<f32,16>"},
    {"MatricesByColumns", "~KeyFrame.mTcw mTcw.columns:arr<f64,16>"},
    {"PositionsAsMatrices", "~MapPoint.mWorldPos mWorldPos:mat"},
    {"NormalInFront", "^MapPoint.mNormalVector"},
    {"DistancesTheOtherWay", "^MapPoint.mfMaxDistance"},
    {"TimeInFront", "^KeyFrame.mTimeStamp"},
    {"FirstFramesInFront", "^MapPoint.mnFirstFrame"},
    {"Microseconds", "~KeyFrame.mTimeStamp mTimeStamp.microseconds:u64"},
    {"DoublesAndALabel", "~MapPoint.mWorldPos mWorldPos:arr<f64,3>\n+MapPoint.nObs x1:i32"},
    {"DoublesAndTwoMore",
     "~MapPoint.mWorldPos mWorldPos:arr<f64,3>\n+MapPoint.mbBad x1:u8\n+MapPoint.mfMaxDistance x2:f32"},
    {"DoublesAndAnIdAndAScore",
     "~MapPoint.mWorldPos mWorldPos:arr<f64,3>\n+MapPoint.mfMaxDistance x1:u64\n+KeyFrame.mbHasVelocity x2:f32"},
    {"DoublesWithoutAParent", "-KeyFrame.mTcp\n~MapPoint.mWorldPos mWorldPos:arr<f64,3>\n+MapPoint.mbBad x1:bool"},
    {"NanosecondsAndALabel", "~KeyFrame.mTimeStamp mTimeStamp.nanoseconds:u64\n+MapPoint.nObs x1:i32"},
    {"AMatrixBehindDescriptors", "+KeyFrame.mDescriptors x1:mat"},
    {"NoRightCamera",
     "-KeyFrame.mnBackupIdCamera2\n-KeyFrame.mvLeftToRightMatch\n-KeyFrame.mvRightToLeftMatch\n-KeyFrame.NLeft\n"
     "-KeyFrame.NRight\n-KeyFrame.mTlr\n-KeyFrame.mvKeysRight\n-KeyFrame.mGridRight"},
    {"NoInertialState",
     "-KeyFrame.mImuBias\n-KeyFrame.mBackupImuPreintegrated\n-KeyFrame.mImuCalib\n-KeyFrame.mBackupPrevKFId\n"
     "-KeyFrame.mBackupNextKFId\n-KeyFrame.bImu\n-KeyFrame.mVw\n-KeyFrame.mOwb\n-KeyFrame.mbHasVelocity"},
    {"FourClasses",
     "+KeyFrame.mbHasVelocity x1:f32\n+MapPoint.mfMaxDistance x2:f32\n+Map.mbIMU_BA2 x3:f64\n"
     "+Atlas.mnLastInitKFidMap x4:u64"},
    {"MapAndAtlas", "+Map.mnId x1:string\n+Atlas.mvpCameras x2:u64"},
    {"VectorsInAMap", "+KeyFrame.mvBackupMergeEdgesId x1:map<i32,vec<u32>>"},
};

class ForkOfOtherForm : public ::testing::TestWithParam<Fork> {};
TEST_P(ForkOfOtherForm, IsReadRight) {
  std::mt19937_64 random(2);
  const std::string bytes = Forge(RealSession(), Changed(GetParam().changes), random);
  const InferredLayout inferred = InferLayout(In(bytes));
  EXPECT_TRUE(inferred.same_bytes);
  EXPECT_EQ(inferred.doubts, std::vector<std::string>());
  ExpectSamePlaces(ReadAs(bytes, ToJson(inferred.layout)), RealSession());
}

// A file that is cut behind nearly all points is read record by record.
TEST_P(ForkOfOtherForm, IsRecoveredRight) {
  std::mt19937_64 random(2);
  std::string bytes = Forge(RealSession(), Changed(GetParam().changes), random);
  bytes.resize(bytes.size() * 99 / 100);
  const Salvage salvage = detail::SalvageOrbslam3(In(bytes), {});
  ASSERT_EQ(salvage.atlas.maps.size(), 1U);
  std::size_t wrong = 0, whole = 0;
  std::map<MapPointId, const MapPoint*> truth;
  for (const MapPoint& point : RealSession().maps[0].points) truth[point.id] = &point;
  for (const MapPoint& point : salvage.atlas.maps[0].points) {
    const auto found = truth.find(point.id);
    ++whole;
    wrong += found == truth.end() || found->second->position != point.position;
  }
  EXPECT_EQ(wrong, 0U);
  EXPECT_GT(whole, truth.size() * 9 / 10);
  const Column<KeyFrame>&read = salvage.atlas.maps[0].keyframes, &written = RealSession().maps[0].keyframes;
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].id, written[i].id);
    EXPECT_TRUE(
        read[i].camera_from_world.rotation.coeffs().isApprox(written[i].camera_from_world.rotation.coeffs(), 1e-4F));
  }
}
INSTANTIATE_TEST_SUITE_P(InferLayout, ForkOfOtherForm, ::testing::ValuesIn(kForks),
                         [](const auto& fork) { return std::string(fork.param.name); });

// Of two eyes: right ones tell whether the pose between both is written as that of the keyframe is.
class InverseOfTwoEyes : public ::testing::TestWithParam<Fork> {};
TEST_P(InverseOfTwoEyes, IsReadRight) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, "fisheye_stereo");
  Notices notices;
  const Atlas truth = ReadOrbslam3(path, {}, notices);
  std::mt19937_64 random(2);
  const std::string bytes = Forge(truth, Changed(GetParam().changes), random);
  const InferredLayout inferred = InferLayout(In(bytes));
  EXPECT_TRUE(inferred.sure());
  const Atlas read = ReadAs(bytes, ToJson(inferred.layout));
  ExpectSamePlaces(read, truth);
  for (std::size_t i = 0; i < truth.maps[0].keyframes.size(); ++i)
    EXPECT_TRUE(read.maps[0].keyframes[i].left_from_right.translation.isApprox(
        truth.maps[0].keyframes[i].left_from_right.translation, 1e-4F));
}
INSTANTIATE_TEST_SUITE_P(InferLayout, InverseOfTwoEyes,
                         ::testing::Values(Fork{"One", "~KeyFrame.mTcw mTcw.inverse:arr<f32,7>"},
                                           Fork{"All",
                                                "~KeyFrame.mTcp mTcp.inverse:arr<f32,7>\n"
                                                "~KeyFrame.mTcw mTcw.inverse:arr<f32,7>\n"
                                                "~KeyFrame.mTlr mTlr.inverse:arr<f32,7>"}),
                         [](const auto& of) { return std::string(of.param.name); });

// Damage amid the points of a fork costs those that it hits, and none behind it.
TEST(InferLayout, PointsBehindAGapAreRecovered) {
  std::mt19937_64 random(2);
  std::string bytes = Forge(RealSession(), Changed("+MapPoint.nObs x1:f64"), random);
  constexpr std::size_t kHole = 16'000;  // some thirty points
  const std::size_t begin = bytes.size() * 95 / 100;
  for (std::size_t i = 0; i < kHole; ++i) bytes[begin + i] = static_cast<char>(random());
  const Salvage salvage = detail::SalvageOrbslam3(In(bytes), {});
  ASSERT_EQ(salvage.atlas.maps.size(), 1U);
  const Column<MapPoint>&read = salvage.atlas.maps[0].points, &written = RealSession().maps[0].points;
  EXPECT_GT(read.size() + 150, written.size());
  EXPECT_LT(read.size() + 20, written.size());
  EXPECT_EQ(read.back().id, written.back().id);
  for (const MapPoint& point : read)
    EXPECT_TRUE(std::ranges::any_of(written, [&](const MapPoint& of) { return of.position == point.position; }));
}

// Of members in a form that no layout can say: that it is not like it is said.
TEST(InferLayout, SaysWhatItDoesNotBelieve) {
  Atlas broken = RealSession();
  for (MapPoint& point : broken.maps[0].points) point.position = {point.position.z(), point.position.x(), 7};
  const InferredLayout inferred = InferLayout(In(EncodeOrbslam3(broken)));
  EXPECT_FALSE(inferred.sure());
  EXPECT_TRUE(inferred.known);
  EXPECT_EQ(inferred.layout.id, "v1.0");
  EXPECT_EQ(inferred.alternatives, std::vector<std::string>());
  EXPECT_THAT(inferred.doubts, ::testing::Contains(HasSubstr("not where keyframes see them")));
  Notices notices;
  const std::string bytes = EncodeOrbslam3(broken);
  (void)ReadOrbslam3(In(bytes), {}, notices);
  ASSERT_EQ(notices.items().size(), 1U);
  EXPECT_THAT(notices.items()[0].text, HasSubstr("`InferLayout`"));
  EXPECT_THAT(
      detail::SalvageOrbslam3(In(bytes), {}).losses,
      ::testing::Contains(HasSubstr("the layout v1.0 is in doubt: map points are not where keyframes see them")));
}

// What a file has the same bytes with, or no member for: the doubt that is said.
struct Doubted {
  const char *name, *changes, *doubt;
};
void PrintTo(const Doubted& of, std::ostream* out) { *out << of.name; }
const Doubted kDoubted[] = {
    {"DepthsInFront", "^KeyFrame.mvDepth", "depths and columns in the right image do not fit"},
    {"PosesAtTheEnd", "-KeyFrame.mTcw\n+KeyFrame.mbHasVelocity x1:arr<f32,7>", "no member is KeyFrame.mTcw"},
    {"NoDescriptors", "-MapPoint.mDescriptor", "no member is MapPoint.mDescriptor"},
};
class ForkInDoubt : public ::testing::TestWithParam<Doubted> {};
TEST_P(ForkInDoubt, IsDoubtedOrReadRight) {
  std::mt19937_64 random(2);
  const std::string bytes = Forge(RealSession(), Changed(GetParam().changes), random);
  const InferredLayout inferred = InferLayout(In(bytes));
  if (inferred.sure()) return ExpectSamePlaces(ReadAs(bytes, ToJson(inferred.layout)), RealSession());
  EXPECT_THAT(inferred.doubts, ::testing::Contains(HasSubstr(GetParam().doubt)));
}
INSTANTIATE_TEST_SUITE_P(InferLayout, ForkInDoubt, ::testing::ValuesIn(kDoubted),
                         [](const auto& of) { return std::string(of.param.name); });

// Which have fewer digits than the truth.
TEST(InferLayout, FindsMilliseconds) {
  std::mt19937_64 random(2);
  const std::string bytes = Forge(RealSession(), Changed("~KeyFrame.mTimeStamp mTimeStamp.milliseconds:u64"), random);
  const InferredLayout inferred = InferLayout(In(bytes));
  EXPECT_TRUE(inferred.sure());
  EXPECT_THAT(inferred.differences, ::testing::ElementsAre("KeyFrame: u64 mTimeStamp.milliseconds for mTimeStamp"));
}

TEST(InferLayout, LayoutsWithoutPosesAreWarnedOf) {
  std::mt19937_64 random(2);
  const Layout without = Changed("-KeyFrame.mTcw");
  const std::string bytes = Forge(RealSession(), without, random);
  ReadOptions options;
  options.of<Orbslam3ReadOptions>().layout = ToJson(without);
  Notices notices;
  (void)ReadOrbslam3(In(bytes), options, notices);
  EXPECT_THAT(notices.items(), ::testing::Contains(::testing::Field(
                                   &Notice::text, HasSubstr("no member is KeyFrame.mTcw: all keyframes are at"))));
}

TEST(InferLayout, KnowsArchivesOfWindows) {
  Atlas atlas = RealSession();
  atlas.encoding.long_bytes = 4;
  const InferredLayout inferred = InferLayout(In(EncodeOrbslam3(atlas)));
  EXPECT_EQ(inferred.layout.id, "v1.0");
  EXPECT_TRUE(inferred.same_bytes && inferred.sure());
}

TEST(InferLayout, TextIsDoubtedLikeBytes) {
  Atlas broken = RealSession();
  broken.encoding.text = true;
  for (MapPoint& point : broken.maps[0].points) point.position = {point.position.z(), point.position.x(), 7};
  EXPECT_THAT(InferLayout(In(EncodeOrbslam3(broken))).doubts,
              ::testing::Contains(HasSubstr("not where keyframes see them")));
}

// ---- What is no file of any layout

TEST(InferLayout, RefusesWhatIsCut) {
  const std::string bytes = EncodeOrbslam3(RealSession());
  for (const std::size_t part : {1, 3, 5, 7})
    EXPECT_THAT(MessageOf([&] { (void)InferLayout(In(bytes.substr(0, bytes.size() * part / 8))); }),
                HasSubstr("no layout found"));
}

TEST(InferLayout, RefusesAnArchiveOfNothing) {
  const std::string bytes = EncodeOrbslam3(RealSession());
  EXPECT_THAT(MessageOf([&] { (void)InferLayout(In(bytes.substr(0, 40) + std::string(5000, '\0'))); }),
              HasSubstr("no keyframe was found"));
}

// Grids everywhere, each a keyframe to look at.
TEST(InferLayout, EndsWhereEverythingLooksLikeAKeyframe) {
  std::string bytes = EncodeOrbslam3(RealSession()).substr(0, 40);
  std::mt19937_64 random(1);
  const std::string grid("\x40\0\0\0\x30\0\0\0", 8), first("\5\0\1\0\0\0\0", 7);
  for (int i = 0; i < 200'000; ++i)
    bytes += i % 7 == 0 ? grid : i % 7 == 3 ? first : std::string(1, static_cast<char>(random()));
  EXPECT_THAT(MessageOf([&] { (void)InferLayout(In(bytes)); }), HasSubstr("no layout found"));
}

// Counts and bytes that are changed anywhere lead to a layout or an error, never to the end of memory.
TEST(InferLayout, SurvivesChangedBytes) {
  const Atlas atlas = SynthesizeAtlas({.keyframes = 6, .points = 60, .features = 80, .threads = 1});
  std::mt19937_64 random(1);
  const std::string whole = Forge(atlas, WithMember("KeyFrame", "mnId", {"x1", "vec<f32>"}), random);
  for (int i = 0; i < 5; ++i) {
    std::string bytes = whole;
    for (int change = 0; change <= i % 4; ++change) bytes[random() % bytes.size()] = static_cast<char>(random());
    try {
      EXPECT_GE(InferLayout(In(bytes)).keyframes, 1U);
    } catch (const Error& error) {
      EXPECT_NE(error.kind(), ErrorKind::kInternal) << error.what();
    }
  }
}

TEST(InferLayout, TextOfAnotherLayoutNeedsTheSources) {
  Atlas atlas = RealSession();
  atlas.encoding.text = true;
  const std::string bytes = WrittenIn(atlas, ToJson(WithMember("KeyFrame", "mnId", {"x1", "u64"})));
  const std::string message = MessageOf([&] { (void)InferLayout(In(bytes)); });
  EXPECT_THAT(message, HasSubstr("`DeriveLayoutOfFolder`"));
  EXPECT_THAT(message, ::testing::Not(HasSubstr("`InferLayout`")));
}

TEST(InferLayout, TextIsOfAKnownLayout) {
  Atlas atlas = RealSession();
  atlas.encoding.text = true;
  const InferredLayout inferred = InferLayout(In(WrittenIn(atlas, "visible-found")));
  EXPECT_EQ(inferred.layout.id, "visible-found");
  EXPECT_TRUE(inferred.same_bytes);
}

}  // namespace
}  // namespace slamdb::testing
