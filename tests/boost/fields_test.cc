// SPDX-License-Identifier: BSD-3-Clause
// Every field of the model, one by one: it is in the archive, where slamdb writes it too, and comes back from there.
#include "slamdb/model/fields.h"

#include "slamdb/boost.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/boost/archives.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

using testing::Loaded;
using testing::Saved;

// ---- another value for anything

template <class Number>
requires std::is_arithmetic_v<Number>
void Touch(Number& number) { number = static_cast<Number>(number == Number{1} ? 2 : 1); }
void Touch(std::byte& byte) { byte ^= std::byte{1}; }
void Touch(Flag& flag) { flag.recorded ^= 3; }
void Touch(CameraModel& model) {
  model = model == CameraModel::kPinhole ? CameraModel::kKannalaBrandt8 : CameraModel::kPinhole;
}
void Touch(MatrixForm& form) { form = MatrixForm::kUsualNotContinuous; }
void Touch(Rigid3f& pose) { pose.rotation.y() += 0.5F; }
void Touch(Keypoint& keypoint) { Touch(keypoint.octave); }
void Touch(Connection& connection) { Touch(connection.weight); }
void Touch(Observation& observation) { Touch(observation.right); }
void Touch(Column<ImuMeasurement>& measurements) { Touch(measurements.at(0).duration); }
void Touch(Descriptor& descriptor) { Touch(descriptor[31]); }
template <class Entity>
void Touch(Id<Entity>& id) {
  id = Id<Entity>(id.value() == 3 ? 4 : 3);
}
template <class Derived>
void Touch(Eigen::PlainObjectBase<Derived>& matrix) {
  Touch(matrix.data()[matrix.size() - 1]);
}
void Touch(std::string& text) { text += '~'; }
void Touch(std::vector<RepeatedEntry>& entries) { entries.push_back({.position = 1}); }
template <class Value, class Allocator>
void Touch(std::vector<Value, Allocator>& values) {
  if (values.empty()) {
    values.push_back(Value{});
  } else {
    Touch(values.back());
  }
}

// Sizes say how another column is cut: one goes up and one goes down.
template <class Field>
void MoveOne(Field& sizes) {
  if constexpr (std::is_same_v<Field, Column<std::uint32_t>>) {
    const auto some = std::ranges::find_if(sizes, [](std::uint32_t size) { return size > 0; });
    ASSERT_NE(some, sizes.end());
    --*some;
    ++(some == sizes.begin() ? *(some + 1) : *(some - 1));
  }
}

// The shape of a matrix belongs to its data; these changes keep the number of bytes.
bool TouchShape(std::string_view name, KeyFrame& keyframe) {
  if (name == "distortion.type") keyframe.distortion.type = 4;  // 32-bit integers
  if (name == "distortion.rows" || name == "distortion.columns")
    std::swap(keyframe.distortion.rows, keyframe.distortion.columns);
  return name == "distortion.type" || name == "distortion.rows" || name == "distortion.columns";
}
template <class Entity>
bool TouchShape(std::string_view, Entity&) {
  return false;
}

template <class Entity, class Field>
void TouchField(std::string_view name, Entity& entity, Field& field) {
  if (TouchShape(name, entity)) return;
  if constexpr (std::is_same_v<Field, Boxed<Carried>>)
    FAIL() << "of a fork";  // the walk leaves it out
  else if (name.ends_with("sizes"))
    MoveOne(field);
  else
    Touch(field);
}

// ---- the walk

// ORB-SLAM3 has these in memory alone, and no archive of it holds them.
bool IsArchived(const MapPoint*, std::string_view name) {
  return name != "origin_map" && name != "visible_count" && name != "found_count";
}
bool IsArchived(const Map*, std::string_view name) { return name != "landmarks"; }
bool IsArchived(const void*, std::string_view) { return true; }
// Of a fork, which stock classes are not.
bool IsOfAFork(std::string_view name) { return name == "carried" || name == "layout"; }

template <class Kind>
class BoostFields : public ::testing::Test {
 protected:
  BoostFields()
      : base_(SynthesizeAtlas({.sensor = Sensor::kFisheyeStereo,
                               .inertial = true,
                               .keyframes = 4,
                               .points = 30,
                               .features = 100,
                               .threads = 1})) {
    base_.encoding = {};
    bytes_ = Saved<Kind>(base_);
  }

  // get(atlas) is the entity.
  template <class Entity, class Get>
  int Walk(const Get& get) {
    int fields = 0;
    ForEachField(static_cast<const Entity*>(nullptr), [&](std::string_view name, auto... members) {
      if (IsOfAFork(name)) return;
      SCOPED_TRACE(name);
      Atlas touched = base_;
      TouchField(name, get(touched), Member(get(touched), members...));
      ASSERT_NE(FirstDifference(touched, base_), "") << "the test changes nothing";
      ++fields;
      const std::string bytes = Saved<Kind>(touched);
      ASSERT_EQ(bytes != bytes_, IsArchived(static_cast<const Entity*>(nullptr), name));
      if (bytes == bytes_) return;
      Atlas encoded = touched;
      encoded.encoding = {.text = Kind::kText, .boost_version = testing::BoostVersion()};
      EXPECT_TRUE(EncodeOrbslam3(encoded) == bytes) << "slamdb writes other bytes";
      EXPECT_EQ(FirstDifference(Loaded<Atlas, Kind>(bytes), touched), "");

      Atlas alone = base_;
      alone.encoding = touched.encoding;
      get(alone) = Loaded<Entity, Kind>(Saved<Kind>(get(touched)));
      EXPECT_EQ(FirstDifference(alone, touched), "") << "of the entity alone";
    });
    return fields;
  }

  Atlas base_;
  std::string bytes_;
};
TYPED_TEST_SUITE(BoostFields, testing::Kinds);

TYPED_TEST(BoostFields, OfAKeyFrame) {
  EXPECT_GE(this->template Walk<KeyFrame>([](Atlas& atlas) -> KeyFrame& { return atlas.maps[0].keyframes[2]; }), 100);
}
TYPED_TEST(BoostFields, OfAPoint) {
  EXPECT_GE(this->template Walk<MapPoint>([](Atlas& atlas) -> MapPoint& { return atlas.maps[0].points[5]; }), 14);
}
TYPED_TEST(BoostFields, OfACamera) {
  EXPECT_GE(this->template Walk<Camera>([](Atlas& atlas) -> Camera& { return atlas.cameras[0]; }), 5);
}
TYPED_TEST(BoostFields, OfAMap) {
  EXPECT_GE(this->template Walk<Map>([](Atlas& atlas) -> Map& { return atlas.maps[0]; }), 13);
}
TYPED_TEST(BoostFields, OfAnAtlas) {
  EXPECT_GE(this->template Walk<Atlas>([](Atlas& atlas) -> Atlas& { return atlas; }), 10);
}

}  // namespace
}  // namespace slamdb
