// SPDX-License-Identifier: BSD-3-Clause
// What stock Boost can notice of damage ends in an exception. Not here: class ids that no class has, and counts beyond
// the file, which Boost follows.
#include <algorithm>

#include "slamdb/boost.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/boost/archives.h"
#include "tests/boost/orb_classes.h"
#include "tests/formats/orbslam3/crafted_atlases.h"

// A class that a later program has changed.
namespace orb {
struct NewerPoint : MapPoint {};
}  // namespace orb
BOOST_CLASS_VERSION(orb::NewerPoint, 1)

namespace slamdb {
namespace {

using testing::Binary;
using testing::Load;
using testing::Saved;

// The kind of the Error that loading throws; nothing when it throws none, which then fails the test.
template <class Value, class Kind>
std::optional<ErrorKind> KindOfError(const std::string& bytes) {
  Value value;
  try {
    Load<Kind>(bytes, value);
    ADD_FAILURE() << "was believed";
  } catch (const Error& error) {
    return error.kind();
  } catch (const std::exception& error) {
    ADD_FAILURE() << error.what();
  }
  return std::nullopt;
}

template <class Kind>
class BoostDamage : public ::testing::Test {};
TYPED_TEST_SUITE(BoostDamage, testing::Kinds);

// Afterwards a program may let the archive delete what it has made, or not.
TYPED_TEST(BoostDamage, CutAnywhere) {
  bool deletes = false;
  for (const Crafted& crafted :
       {CraftTinyAtlas({.text = TypeParam::kText}), CraftOddAtlas({.text = TypeParam::kText})}) {
    for (std::size_t size = 100; size + 1 < crafted.bytes.size(); size += 1 + crafted.bytes.size() / 1500) {
      std::istringstream stream(crafted.bytes.substr(0, size));
      typename TypeParam::Input archive(stream);
      Atlas atlas;
      EXPECT_THROW(archive >> atlas, std::exception) << "cut at " << size;
      EXPECT_TRUE(atlas.maps.empty() && atlas.cameras.empty());
      deletes = !deletes;
      if (deletes) archive.delete_created_pointers();
    }
  }
}

TYPED_TEST(BoostDamage, ALaterClassVersion) {
  const auto error = KindOfError<MapPoint, TypeParam>(Saved<TypeParam>(orb::NewerPoint{}));
  EXPECT_EQ(error, ErrorKind::kUnsupported);
}

TYPED_TEST(BoostDamage, ADescriptorThatIsNone) {
  for (const int damage : {0, 1, 2, 3}) {
    orb::MapPoint point;
    orb::Mat& descriptor = point.mDescriptor;
    if (damage == 0) descriptor.cols = 16;
    if (damage == 1) descriptor.rows = 2;
    if (damage == 2) descriptor.rows = -1;
    if (damage == 3) descriptor.type = 5;
    EXPECT_EQ((KindOfError<MapPoint, TypeParam>(Saved<TypeParam>(point))), ErrorKind::kDamaged) << damage;
  }
}

TYPED_TEST(BoostDamage, AKeypointRowThatTheModelHasForNone) {
  for (const bool right : {false, true}) {
    orb::MapPoint point = orb::MakePoint(1);
    (right ? point.mBackupObservationsId2 : point.mBackupObservationsId1)[4] = Observation::kAbsent;
    EXPECT_EQ((KindOfError<MapPoint, TypeParam>(Saved<TypeParam>(point))), ErrorKind::kDamaged) << right;
  }
}

TYPED_TEST(BoostDamage, ANullCamera) {
  std::ostringstream stream;
  {
    typename TypeParam::Output archive(stream);
    archive.template register_type<orb::Pinhole>();
    archive.template register_type<orb::KannalaBrandt8>();
    const orb::GeometricCamera* camera = nullptr;
    archive << camera;
  }
  EXPECT_EQ((KindOfError<Camera, TypeParam>(stream.str())), ErrorKind::kDamaged);
}

// ---- bytes of a binary archive changed

// Where two archives differ first.
std::size_t Mismatch(const std::string& a, const std::string& b) {
  return static_cast<std::size_t>(std::ranges::mismatch(a, b).in1 - a.begin());
}

template <class Number>
std::string Changed(std::string bytes, std::size_t offset, Number number) {
  std::memcpy(bytes.data() + offset, &number, sizeof(number));
  return bytes;
}

Atlas MakeAtlas() { return SynthesizeAtlas({.keyframes = 3, .points = 20, .features = 30, .threads = 1}); }

TEST(BoostBinaryDamage, ANullAtlas) {
  const std::string bytes = Saved<Binary>(Atlas());
  const std::size_t pointer = 40 + 2 * sizeof(std::uint64_t);  // behind the header and two empty strings
  EXPECT_EQ((KindOfError<Atlas, Binary>(Changed(bytes, pointer, std::int16_t{-1}))), ErrorKind::kDamaged);
}

TEST(BoostBinaryDamage, NegativeSizes) {
  KeyFrame keyframe = MakeAtlas().maps[0].keyframes[0], other = keyframe;
  const std::string bytes = Saved<Binary>(keyframe);
  other.features.keypoints.pop_back();
  EXPECT_EQ((KindOfError<KeyFrame, Binary>(Changed(bytes, Mismatch(bytes, Saved<Binary>(other)), -1))),
            ErrorKind::kDamaged);
  other = keyframe;
  other.distortion.columns += 1;
  EXPECT_EQ((KindOfError<KeyFrame, Binary>(Changed(bytes, Mismatch(bytes, Saved<Binary>(other)), -1))),
            ErrorKind::kDamaged);
  other = keyframe;
  other.distortion.type += 1;
  EXPECT_EQ((KindOfError<KeyFrame, Binary>(Changed(bytes, Mismatch(bytes, Saved<Binary>(other)), 4096))),
            ErrorKind::kDamaged);
}

// A second pointer in each list of an atlas, whose object id is made that of an object of another class: 0 the atlas,
// 1 the map, 2 to 4 its keyframes, from 5 on its points.
TEST(BoostBinaryDamage, PointersToObjectsOfAnotherClass) {
  const auto make = [](int list, std::uint64_t row) {
    Atlas atlas = MakeAtlas();
    atlas.maps.resize(2);
    atlas.cameras.resize(2);
    const RepeatedEntry entry{.position = 2, .owner_map = 0, .row = row};
    if (list == 0) atlas.repeated_maps = {entry};
    if (list == 1) atlas.maps[0].repeated_keyframes = {entry};
    if (list == 2) atlas.maps[0].repeated_points = {entry};
    if (list == 3) atlas.repeated_cameras = {entry};
    return Saved<Binary>(atlas);
  };
  for (const int list : {0, 1, 2, 3}) {
    const std::string bytes = make(list, 0);
    const std::size_t object = Mismatch(bytes, make(list, 1));
    EXPECT_NO_THROW((testing::Loaded<Atlas, Binary>(bytes)));
    for (const std::uint32_t id : {0U, 1U, 3U, 6U}) {
      const bool same_class = (list == 0 && id == 1) || (list == 1 && id == 3) || (list == 2 && id == 6);
      if (same_class) continue;
      EXPECT_EQ((KindOfError<Atlas, Binary>(Changed(bytes, object, id))), ErrorKind::kDamaged)
          << "list " << list << ", object " << id;
    }
  }
}

// An atlas in the list of maps, and a map in the list of keyframes: objects that would never end.
TEST(BoostBinaryDamage, ObjectsInListsOfAnotherKind) {
  const Atlas atlas = MakeAtlas();
  Atlas other = atlas;
  other.maps[0].id = MapId(99);
  const std::string bytes = Saved<Binary>(atlas);
  const std::size_t map_contents = Mismatch(bytes, Saved<Binary>(other));  // class id, info, object id in front
  const std::size_t map_pointer = map_contents - 4 - 5 - 2;
  EXPECT_EQ((KindOfError<Atlas, Binary>(Changed(bytes, map_pointer, std::int16_t{0}))), ErrorKind::kDamaged);

  other = atlas;
  other.maps[0].keyframes[0].id = KeyFrameId(99);
  const std::size_t keyframe_pointer = Mismatch(bytes, Saved<Binary>(other)) - 4 - 5 - 2;
  const std::string nested = Changed(bytes, keyframe_pointer, std::int16_t{4});
  EXPECT_EQ((KindOfError<Atlas, Binary>(Changed(nested, keyframe_pointer + 2, std::uint32_t{2}))), ErrorKind::kDamaged);
}

}  // namespace
}  // namespace slamdb
