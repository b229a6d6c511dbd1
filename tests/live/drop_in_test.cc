// SPDX-License-Identifier: BSD-3-Clause
// A program that is written against ORB-SLAM3's classes finds their names: the table of docs/live.md, the documented
// names, and what the compiler says are held against each other.
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <type_traits>

#include "slamdb/live/bridge.h"
#include "slamdb/model/vocabulary_tree.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/live/world.h"

namespace slamdb::live {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

// Whether a class has a public member of the name, and whether it has any: where a base adds one, the name is
// ambiguous.
#define SLAMDB_PROBE(Class, Name)             \
  namespace probe_##Class##_##Name {          \
    struct Other {                            \
      int Name;                               \
    };                                        \
    template <class M>                        \
    struct Both : M, Other {};                \
    template <class M>                        \
    constexpr bool kAny = !requires {         \
      &Both<M>::Name;                         \
    };                                        \
    template <class M>                        \
    constexpr bool kPublic = requires {       \
      &M::Name;                               \
    }                                         \
    || requires(M & object) { object.Name; }; \
  }
#define SLAMDB_GIVEN SLAMDB_PROBE
#define SLAMDB_OVERLOADED SLAMDB_PROBE
#define SLAMDB_LEFT_OUT SLAMDB_PROBE
#include "tests/live/documented_names.inc"
#undef SLAMDB_GIVEN
#undef SLAMDB_OVERLOADED
#undef SLAMDB_LEFT_OUT

struct Names {
  std::set<std::string> given, left_out;
};

Names DocumentedNames() {
  Names names;
#define SLAMDB_GIVEN(Class, Name)                                                           \
  static_assert(probe_##Class##_##Name::kPublic<Class>, #Class "::" #Name " is not there"); \
  names.given.insert(#Class "::" #Name);
#define SLAMDB_OVERLOADED(Class, Name)                                                   \
  static_assert(probe_##Class##_##Name::kAny<Class>, #Class "::" #Name " is not there"); \
  names.given.insert(#Class "::" #Name);
#define SLAMDB_LEFT_OUT(Class, Name)                                                  \
  static_assert(!probe_##Class##_##Name::kAny<Class>, #Class "::" #Name " is there"); \
  names.left_out.insert(#Class "::" #Name);
#include "tests/live/documented_names.inc"
#undef SLAMDB_GIVEN
#undef SLAMDB_OVERLOADED
#undef SLAMDB_LEFT_OUT
  return names;
}

// Rows `| Class | names in backticks | how, or left out: why |` of the drop-in table.
Names TableOfThePage() {
  std::ifstream page(SLAMDB_FIXTURES "/../docs/live.md");
  const std::regex row(R"(\| (MapPoint|KeyFrame|Map|Atlas) \| (.*) \| (.*) \|)"), name("`(\\w+)`");
  Names names;
  bool is_here = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("## ")) is_here = line == "## Drop-in table";
    std::smatch cells;
    if (!is_here || !std::regex_match(line, cells, row)) continue;
    const std::string of_class = cells[1], words = cells[2], how = cells[3];
    std::set<std::string>& target = how.starts_with("left out: ") ? names.left_out : names.given;
    for (auto word = std::sregex_iterator(words.begin(), words.end(), name); word != std::sregex_iterator(); ++word)
      EXPECT_TRUE(target.insert(of_class + "::" + word->str(1)).second) << word->str(1) << " stands there twice";
  }
  return names;
}

TEST(DropIn, TheTableSaysWhatTheCompilerSays) {
  const Names documented = DocumentedNames(), table = TableOfThePage();
  EXPECT_EQ(table.given, documented.given);
  EXPECT_EQ(table.left_out, documented.left_out);
  EXPECT_GT(documented.given.size(), 300U);
}

// ---- types and signatures, as a client writes them

template <class A, class B>
constexpr bool kSame = std::is_same_v<A, B>;

static_assert(std::is_default_constructible_v<MapPoint>);
static_assert(std::is_constructible_v<KeyFrame, Frame&, Map*, KeyFrameDatabase*>);
static_assert(kSame<decltype(MapPoint::mBackupReplacedId), long long int>);
static_assert(kSame<decltype(MapPoint::mBackupRefKFId), long unsigned int>);
static_assert(kSame<decltype(MapPoint::mBackupObservationsId1), std::map<long unsigned int, int>>);
static_assert(kSame<decltype(KeyFrame::mBackupParentId), long long int>);
static_assert(kSame<decltype(KeyFrame::mvBackupMapPointsId), std::vector<long long int>>);
static_assert(kSame<decltype(KeyFrame::mBackupConnectedKeyFrameIdWeights), std::map<long unsigned int, int>>);
static_assert(kSame<decltype(KeyFrame::mvBackupChildrensId), std::vector<long unsigned int>>);
static_assert(kSame<decltype(KeyFrame::mnBackupIdCamera), unsigned int>);
static_assert(kSame<decltype(KeyFrame::mvScaleFactors), const std::vector<float>&>);
static_assert(kSame<decltype(KeyFrame::mDescriptors), const cv::Mat>);
static_assert(kSame<decltype(&KeyFrame::GetImuRotation), Eigen::Matrix3f (KeyFrame::*)()>);
static_assert(kSame<decltype(&KeyFrame::GetGyroBias), Eigen::Vector3f (KeyFrame::*)()>);
static_assert(
    kSame<decltype(&KeyFrame::ProjectPointDistort), bool (KeyFrame::*)(MapPoint*, cv::Point2f&, float&, float&)>);
static_assert(kSame<decltype(&KeyFrame::lId), bool (*)(KeyFrame*, KeyFrame*)>);
static_assert(kSame<decltype(&Atlas::GetAtlasKeyframes), std::map<long unsigned int, KeyFrame*> (Atlas::*)()>);
static_assert(requires(MapPoint & p, KeyFrame* keyframe, Frame* frame, const float& distance) {
  { p.PredictScale(distance, keyframe) } -> std::same_as<int>;
  { p.PredictScale(distance, frame) } -> std::same_as<int>;
  p.PrintObservations();
});
static_assert(requires(KeyFrame & k, MapPoint* point, const int& row, std::set<KeyFrame*>& keyframes,
                       std::set<MapPoint*>& points, std::set<GeometricCamera*>& cameras,
                       std::map<long unsigned int, KeyFrame*>& keyframe_by_id,
                       std::map<long unsigned int, MapPoint*>& point_by_id,
                       std::map<unsigned int, GeometricCamera*>& camera_by_id) {
  k.ComputeBoW();
  k.EraseMapPointMatch(row);
  k.EraseMapPointMatch(point);
  k.PreSave(keyframes, points, cameras);
  k.PostLoad(keyframe_by_id, point_by_id, camera_by_id);
});

// What DBoW2's classes are made of.
struct BowVector : std::map<unsigned int, double> {};
struct FeatureMap : std::map<unsigned int, std::vector<unsigned int>> {};

double SumOf(const BowVector& bow) {
  double sum = 0;
  for (const auto& [word, weight] : bow) sum += weight;
  return sum;
}

slamdb::Atlas Model(Sensor sensor = Sensor::kStereo) {
  return SynthesizeAtlas({.sensor = sensor, .inertial = sensor == Sensor::kStereo, .keyframes = 8, .points = 260});
}

TEST(DropIn, KeypointsAreThoseOfTheColumns) {
  const slamdb::Atlas model = Model();
  const LiveAtlas live = FromModel(model);
  KeyFrame* pKF = live.atlas->GetAllMaps().front()->GetAllKeyFrames()[2];
  const slamdb::KeyFrame& record = model.maps[0].keyframes[2];
  const Features& features = record.features;
  ASSERT_EQ(pKF->mvKeysUn.size(), features.undistorted.size());
  for (std::size_t i = 0; i < pKF->mvKeysUn.size(); ++i) {
    const cv::KeyPoint& kp = pKF->mvKeysUn[i];
    ASSERT_EQ(kp.pt.x, features.undistorted[i].x);
    ASSERT_EQ(kp.pt.y, features.undistorted[i].y);
    ASSERT_EQ(kp.octave, features.undistorted[i].octave);
    ASSERT_EQ(pKF->mvInvLevelSigma2[static_cast<std::size_t>(kp.octave)],
              record.pyramid.inverse_sigma2[static_cast<std::size_t>(kp.octave)]);
    ASSERT_EQ(pKF->mvuRight[i], features.right_x[i]);
    ASSERT_EQ(pKF->mvDepth[i], features.depth[i]);
  }
  const std::vector<cv::KeyPoint> keys = pKF->mvKeys;
  EXPECT_EQ(FromOpenCv(keys), features.keypoints) << "and back, nothing lost";
  std::size_t count = 0;
  for (const cv::KeyPoint& kp : pKF->mvKeys) count += kp.pt.x == keys[count].pt.x ? 1 : 0;
  EXPECT_EQ(count, keys.size());
  EXPECT_EQ(pKF->mvKeys.begin()->angle, features.keypoints[0].angle);
  EXPECT_EQ((pKF->mvKeys.end() - 1)->angle, features.keypoints.back().angle);
  EXPECT_EQ(pKF->mvKeysRight.size(), features.right_keypoints.size());
}

TEST(DropIn, DescriptorsAreAMatrixOverTheColumn) {
  const slamdb::Atlas model = Model();
  const LiveAtlas live = FromModel(model);
  KeyFrame* pKF = live.atlas->GetAllMaps().front()->GetAllKeyFrames()[2];
  const Column<Descriptor>& column = model.maps[0].keyframes[2].features.descriptors;
  ASSERT_EQ(pKF->mDescriptors.rows, static_cast<int>(column.size()));
  EXPECT_EQ(pKF->mDescriptors.cols, 32);
  EXPECT_EQ(pKF->mDescriptors.type(), CV_8U);
  EXPECT_EQ(pKF->mDescriptors.row(5).at<std::uint8_t>(0, 31), column[5][31]);
  EXPECT_EQ(pKF->mDescriptors.data, static_cast<const void*>(pKF->features().descriptors.data())) << "no copy";
  EXPECT_EQ(DescriptorRows(pKF->mDescriptors), column);
  EXPECT_EQ(pKF->mDistCoef.total(), static_cast<std::size_t>(model.maps[0].keyframes[2].distortion.rows *
                                                             model.maps[0].keyframes[2].distortion.columns));
}

TEST(DropIn, BagsOfWordsLookLikeDbow2s) {
  const slamdb::Atlas model = Model();
  const LiveAtlas live = FromModel(model);
  KeyFrame* pKF = live.atlas->GetAllMaps().front()->GetAllKeyFrames()[2];
  const Features& features = model.maps[0].keyframes[2].features;
  const BagOfWords& bag = features.bag_of_words;
  ASSERT_FALSE(pKF->mBowVec.empty());
  ASSERT_FALSE(pKF->mFeatVec.empty());
  EXPECT_NEAR(SumOf(pKF->mBowVec), 1, 1e-9) << "converts to what DBoW2 takes";
  EXPECT_EQ(pKF->mBowVec.begin()->first, bag.words[0]);
  EXPECT_EQ(pKF->mBowVec.lower_bound(bag.words[1])->second, bag.weights[1]);
  EXPECT_EQ(pKF->mBowVec.lower_bound(bag.words.back() + 1), pKF->mBowVec.end());

  const FeatureMap map = pKF->mFeatVec;
  ASSERT_EQ(map.size(), pKF->mFeatVec.size());
  auto expected = map.begin();
  for (auto it = pKF->mFeatVec.begin(); it != pKF->mFeatVec.end(); ++it, ++expected) {
    EXPECT_EQ(it->first, expected->first);
    const std::vector<unsigned int> rows = it->second;
    EXPECT_EQ(rows, expected->second);
    EXPECT_EQ(pKF->mFeatVec.lower_bound(it->first)->second.size(), rows.size());
  }
  EXPECT_EQ(map.begin()->second.front(), features.feature_vector.features.front());
  EXPECT_EQ(pKF->mFeatVec.lower_bound(~0U), pKF->mFeatVec.end());
}

TEST(DropIn, CalibrationAndBoundsAreThoseOfTheRecord) {
  World world;
  slamdb::KeyFrame image = world.Image();
  image.imu_calibration.is_set = true;
  Frame frame(world.atlas, image, world.left);
  KeyFrame keyframe(frame, world.map());
  EXPECT_EQ(keyframe.fx, 100);
  EXPECT_EQ(keyframe.invfy, 0.01F);
  EXPECT_EQ(keyframe.cx, 320);
  EXPECT_EQ(keyframe.mbf, 10);
  EXPECT_EQ(keyframe.mThDepth, 3);
  EXPECT_EQ(keyframe.mnMaxX, 640);
  EXPECT_EQ(keyframe.mnGridCols, 64);
  EXPECT_EQ(keyframe.mnScaleLevels, 8);
  EXPECT_EQ(keyframe.mvScaleFactors[3], 8);
  EXPECT_TRUE(keyframe.mImuCalib.is_set);
  EXPECT_EQ(keyframe.mpImuPreintegrated->duration, 0);
}

TEST(DropIn, PreintegrationIsWrittenInPlace) {
  World world;
  KeyFrame* keyframe = world.AddKeyFrame();
  {
    const Change change(world.atlas.gate());
    keyframe->mpImuPreintegrated->duration = 0.5F;
    keyframe->MarkChanged();
  }
  EXPECT_EQ(keyframe->GetImuPreintegrated().duration, 0.5F);
  EXPECT_EQ(ToModel(world.atlas).maps[0].keyframes[0].preintegration.duration, 0.5F);
}

TEST(DropIn, RightCameraAndRelativePoses) {
  World world(Eyes::kFisheyePair);
  KeyFrame* keyframe = world.AddKeyFrame({1, 0, 0});
  EXPECT_EQ(keyframe->GetRelativePoseTlr().translation, Eigen::Vector3f(0.5F, 0, 0));
  EXPECT_EQ(keyframe->GetRelativePoseTrl().translation, Eigen::Vector3f(-0.5F, 0, 0));
  EXPECT_EQ(keyframe->GetRightPoseInverse().translation, keyframe->GetRightCameraCenter());
  EXPECT_EQ(keyframe->GetRightTranslation(), Eigen::Vector3f(-1.5F, 0, 0));
  EXPECT_EQ(keyframe->GetRightRotation(), Eigen::Matrix3f::Identity());
  EXPECT_EQ(keyframe->GetImuRotation(), Eigen::Matrix3f::Identity());
  EXPECT_EQ(keyframe->mvKeysRight.size(), 20U);
  EXPECT_EQ(keyframe->mvKeysRight[1].pt.x, 210);
}

TEST(DropIn, ProjectsWithAndWithoutTheLens) {
  World world;
  slamdb::KeyFrame image = world.Image();
  image.distortion = CopyMatrix((cv::Mat_<float>(5, 1) << 0.1F, 0.02F, 0.003F, 0.004F, 0.5F));
  Frame frame(world.atlas, image, world.left);
  auto* keyframe = new KeyFrame(frame, world.map());
  world.map()->AddKeyFrame(keyframe);
  MapPoint* point = world.AddPoint(keyframe, {2, 1, 4});  // x = 0.5, y = 0.25, r^2 = 0.3125
  cv::Point2f place;
  float u = 0, v = 0;
  ASSERT_TRUE(keyframe->ProjectPointUnDistort(point, place, u, v));
  EXPECT_FLOAT_EQ(place.x, 370);
  EXPECT_FLOAT_EQ(v, 265);
  ASSERT_TRUE(keyframe->ProjectPointDistort(point, place, u, v));
  // radial 1 + 0.03125 + 0.001953125 + 0.0152587890625; tangential x 0.00075 + 0.0032500, y 0.0013125 + 0.001
  EXPECT_NEAR(u, 320 + 100 * (0.5 * 1.0484619140625 + 0.00075 + 0.00325), 1e-3);
  EXPECT_NEAR(place.y, 240 + 100 * (0.25 * 1.0484619140625 + 0.0013125 + 0.001), 1e-3);
  EXPECT_FALSE(keyframe->ProjectPointDistort(world.AddPoint(keyframe, {0, 0, -1}), place, u, v)) << "behind";
  EXPECT_FALSE(keyframe->ProjectPointUnDistort(world.AddPoint(keyframe, {100, 0, 1}), place, u, v)) << "outside";
}

TEST(DropIn, OrdersAsOrbSlam3Does) {
  World world;
  KeyFrame *a = world.AddKeyFrame(), *b = world.AddKeyFrame();
  EXPECT_TRUE(KeyFrame::lId(a, b));
  EXPECT_FALSE(KeyFrame::lId(b, a));
  EXPECT_TRUE(KeyFrame::weightComp(3, 2));
  EXPECT_THAT(world.atlas.GetAtlasKeyframes(), ElementsAre(Pair(a->mnId, a), Pair(b->mnId, b)));
  world.AddPoint(a);
  world.atlas.CreateNewMap();
  world.AddKeyFrame();
  EXPECT_EQ(world.atlas.GetNumLivedKF(), 3U);
  EXPECT_EQ(world.atlas.GetNumLivedMP(), 1U);
}

TEST(DropIn, AKeyFrameUsesTheVocabularyOfItsAtlas) {
  World world;
  EXPECT_THROW(world.AddKeyFrame()->ComputeBoW(), Error);
  // The root and two words: zeros, and ones.
  VocabularyTree tree{.branching = 2, .depth = 1, .word_count = 2};
  tree.descriptors = {Descriptor{}, Descriptor{}, {0xFF}};
  tree.weights = {0, 1, 1};
  tree.words = {VocabularyTree::kNoWord, 0, 1};
  tree.first_child = {0, 2, 2, 2};
  tree.children = {1, 2};
  world.atlas.SetORBVocabulary(&tree);
  Frame frame = world.MakeFrame({0, 0, 0});
  KeyFrame keyframe(frame, world.map());
  EXPECT_TRUE(keyframe.mBowVec.empty());
  keyframe.ComputeBoW();
  EXPECT_EQ(keyframe.mBowVec.size(), 2U) << "the view sees what was computed";
}

TEST(DropIn, ADatabaseLearnsWhatGoes) {
  struct Database : KeyFrameDatabase {
    void add(KeyFrame* pKF) override { known.insert(pKF); }
    void erase(KeyFrame* pKF) override { known.erase(pKF); }
    std::set<KeyFrame*> known;
  } database;
  World world;
  world.AddKeyFrame();
  Frame frame = world.MakeFrame({0, 0, 0});
  auto* keyframe = new KeyFrame(frame, world.map(), &database);
  world.atlas.AddKeyFrame(keyframe);
  database.add(keyframe);
  keyframe->SetNotErase();
  keyframe->SetBadFlag();
  EXPECT_EQ(database.known.size(), 1U) << "it stays for now";
  keyframe->SetErase();
  EXPECT_TRUE(database.known.empty());
}

TEST(FeaturesOf, TakesWhatExtractionGives) {
  const std::vector<cv::KeyPoint> keys = {{1, 2, 31, 90, 50, 3, -1}, {4, 5, 31, 10, 40, 2, -1}};
  cv::Mat descriptors(2, 32, CV_8U);
  descriptors.setTo(7);
  const Features image = FeaturesOfImage({.mvKeys = keys, .mDescriptors = descriptors, .mvDepth = {2, -1}});
  EXPECT_EQ(image.count, 2);
  EXPECT_EQ(image.keypoints[0].angle, 90);
  EXPECT_EQ(image.keypoints[1].octave, 2);
  EXPECT_EQ(image.undistorted, image.keypoints);
  EXPECT_THAT(image.depth, ElementsAre(2, -1));
  EXPECT_THAT(image.right_x, ElementsAre(-1, -1));
  EXPECT_EQ(image.descriptors[1][31], 7);
  EXPECT_FALSE(image.is_fisheye_stereo());

  const Features pair = FeaturesOfFisheyePair(
      {.mvKeys = {keys[0]}, .mDescriptors = descriptors, .mvKeysRight = {keys[1]}, .mvLeftToRightMatch = {0}});
  EXPECT_EQ(pair.count, 2);
  EXPECT_EQ(pair.left_count, 1);
  EXPECT_EQ(pair.right_keypoints[0].x, 4);
  EXPECT_THAT(pair.right_of_left, ElementsAre(0));
  EXPECT_THAT(pair.left_of_right, ElementsAre(-1));
}

TEST(FeaturesOf, RefusesWhatDoesNotFit) {
  const std::vector<cv::KeyPoint> keys(2);
  const cv::Mat two(2, 32, CV_8U), three(3, 32, CV_8U), floats(2, 32, CV_32F), narrow(2, 16, CV_8U);
  EXPECT_EQ(KindOf([&] { (void)FeaturesOfImage({.mvKeys = keys, .mDescriptors = three}); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { (void)FeaturesOfImage({.mvKeys = keys, .mDescriptors = floats}); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { (void)FeaturesOfImage({.mvKeys = keys, .mDescriptors = narrow}); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { (void)FeaturesOfImage({.mvKeys = keys, .mDescriptors = two, .mvDepth = {1}}); }),
            ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { (void)FeaturesOfFisheyePair({.mvKeys = keys, .mDescriptors = three}); }), ErrorKind::kUsage);
}

TEST(OpenCv, MatricesGoBothWays) {
  const cv::Mat original = (cv::Mat_<float>(1, 5) << 1, 2, 3, 4, 5);
  const Matrix copy = CopyMatrix(original);
  EXPECT_EQ(copy.type, CV_32F);
  const cv::Mat view = ViewMatrix(copy);
  EXPECT_EQ(view.at<float>(4), 5);
  EXPECT_EQ(view.data, static_cast<const void*>(copy.data.data()));
  Matrix damaged = copy;
  damaged.columns = 6;  // more than it has bytes
  EXPECT_TRUE(ViewMatrix(damaged).empty());
  damaged.columns = 5;
  damaged.type = -77;
  EXPECT_TRUE(ViewMatrix(damaged).empty());
  EXPECT_EQ(CopyMatrix(original.colRange(1, 3)).data.size(), 8U) << "of a part, row by row";
}

}  // namespace
}  // namespace slamdb::live
