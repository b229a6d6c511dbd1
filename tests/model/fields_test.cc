// SPDX-License-Identifier: BSD-3-Clause
// Every component that keeps, compares or prints atlases knows every field of fields.h: a change of any scalar of any
// field, and of the length of any list, does not get past one of them unnoticed.
#include "slamdb/model/fields.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <optional>

#include "slamdb/edit/diff/diff.h"
#include "slamdb/edit/repair/detail/field_bits.h"
#include "slamdb/edit/repair/journal.h"
#include "slamdb/formats/ndjson/detail/ndjson.h"
#include "slamdb/formats/ndjson/json.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/model/digest.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/store/atlases.h"

namespace slamdb {
namespace {

using field_bits::kIsMatrix;
using field_bits::kIsSequence;

// ---- The entities whose fields are changed

constexpr std::size_t kKeyframe = 1, kPoint = 2, kLandmark = 1;

template <class Entity>
Entity& The(Atlas& atlas);
template <>
Atlas& The<Atlas>(Atlas& atlas) {
  return atlas;
}
template <>
Camera& The<Camera>(Atlas& atlas) {
  return atlas.cameras[0];
}
template <>
Map& The<Map>(Atlas& atlas) {
  return atlas.maps[0];
}
template <>
KeyFrame& The<KeyFrame>(Atlas& atlas) {
  return atlas.maps[0].keyframes[kKeyframe];
}
template <>
MapPoint& The<MapPoint>(Atlas& atlas) {
  return atlas.maps[0].points[kPoint];
}
template <>
Landmark& The<Landmark>(Atlas& atlas) {
  return atlas.maps[0].landmarks[kLandmark];
}
template <>
LandmarkFeature& The<LandmarkFeature>(Atlas& atlas) {
  return The<Landmark>(atlas).features[0];
}
template <>
FeatureDescriptor& The<FeatureDescriptor>(Atlas& atlas) {
  return The<LandmarkFeature>(atlas).descriptors[0];
}

template <class Entity>
void FillEmptyLists(Entity& entity) {
  ForEachField(&entity, [&](std::string_view, auto... members) {
    auto& field = Member(entity, members...);
    using Field = std::remove_cvref_t<decltype(field)>;
    if constexpr (kIsSequence<Field> && !std::is_same_v<Field, Column<ImuMeasurement>>)  // of which there are some
      if (field.empty()) field.push_back({});
    if constexpr (std::is_same_v<Field, Boxed<Carried>>) {
      field.Make().members.resize(3, std::byte{7});
      field.Make().descriptors = {.rows = 1, .columns = 2, .type = 5};
      field.Make().descriptors.data.resize(8, std::byte{9});
    }
  });
}

// A sound atlas with fisheye cameras and an IMU, and something in every list of the entities above.
const Atlas& Base() {
  static const Atlas base = [] {
    Atlas atlas = SynthesizeAtlas({.sensor = Sensor::kFisheyeStereo,
                                   .inertial = true,
                                   .keyframes = 4,
                                   .points = 10,
                                   .features = 60,
                                   .threads = 1});
    atlas.maps[0].landmarks.resize(3);
    Landmark& landmark = The<Landmark>(atlas);
    landmark.id = LandmarkId(7);
    LandmarkFeature& feature = landmark.CreateOneFeature();
    feature.has_patch = true;
    feature.patch = {1, 2, 3};
    feature.descriptors = {{DescriptorKind::kOrb, {4, 5}}};
    MapPoint& point = The<MapPoint>(atlas);
    point.origin_map = 0;
    point.visible_count = 9;
    point.found_count = 5;
    FillEmptyLists(The<KeyFrame>(atlas));
    FillEmptyLists(point);
    FillEmptyLists(The<Map>(atlas));
    FillEmptyLists(The<Camera>(atlas));
    atlas.layout = "a fork's";
    FillEmptyLists(atlas);
    for (auto* entries : {&atlas.repeated_maps, &atlas.repeated_cameras, &atlas.maps[0].repeated_keyframes,
                          &atlas.maps[0].repeated_points})
      *entries = {{.position = 1, .owner_map = 0, .row = 0}, {.position = 3, .owner_map = 0, .row = 0}};
    return atlas;
  }();
  return base;
}

// ---- What is done to a field

struct Change {
  std::string what;
  std::function<void(Atlas&)> make;
};

struct FieldCase {
  std::string name;  // `MapPoint.max_distance`
  std::vector<Change> changes;
  std::function<bool(Atlas&, Atlas&)> same;       // whether two atlases hold the same bits in the field
  std::function<std::string(const Atlas&)> json;  // of the entity

  friend void PrintTo(const FieldCase& field, std::ostream* out) { *out << field.name; }
};

// Changes a scalar a little, or much: another sign.
template <class Scalar>
void Touch(Scalar& scalar, bool much = false) {
  if constexpr (std::is_floating_point_v<Scalar>) {
    const Scalar size = std::isfinite(scalar) ? std::abs(scalar) : 0;
    scalar = much ? -3 - 2 * size : std::isfinite(scalar) ? scalar + 1 + size : 0;
  } else if constexpr (std::is_integral_v<Scalar> && std::is_signed_v<Scalar>) {
    scalar = static_cast<Scalar>(much ? ~scalar : scalar ^ 1);
  } else {
    field_bits::FromBits(field_bits::ToBits(scalar) ^ 1, scalar);
  }
}

template <class Element>
std::size_t ScalarsOf(const Element& element) {
  std::size_t count = 0;
  field_bits::ForEachScalar(element, [&](const auto&) { ++count; });
  return count;
}

template <class Element>
void TouchScalar(Element& element, std::size_t which, bool much) {
  field_bits::ForEachScalar(element, [&](auto& scalar) {
    if (which-- == 0) Touch(scalar, much);
  });
}

// Every scalar of the first and the last element of a list, and of every element of anything else.
template <class Field, class Access>
void AddTouches(const Access& field, std::vector<Change>& changes) {
  Atlas base = Base();
  const std::size_t size = field_bits::SizeOf(field(base));
  for (std::size_t i = 0; i < size; ++i) {
    if (kIsSequence<Field> && i != 0 && i + 1 != size) continue;
    const std::size_t scalars = ScalarsOf(field_bits::ElementAt(field(base), i));
    for (std::size_t k = 0; k < scalars; ++k)
      for (const bool much : {false, true})
        changes.push_back({"scalar " + std::to_string(k) + " of element " + std::to_string(i),
                           [=](Atlas& atlas) { TouchScalar(field_bits::ElementAt(field(atlas), i), k, much); }});
  }
}

template <class Field, class Access>
std::vector<Change> ChangesTo(const Access& field) {
  std::vector<Change> changes;
  if constexpr (kIsSequence<Field>) {
    changes.push_back({"one more", [=](Atlas& atlas) { field(atlas).push_back(field(atlas).back()); }});
    changes.push_back({"one less", [=](Atlas& atlas) { field(atlas).pop_back(); }});
  }
  if constexpr (std::is_same_v<Field, Boxed<Carried>>) {
    changes.push_back({"none", [=](Atlas& atlas) { field(atlas).Reset(); }});
    changes.push_back({"a byte", [=](Atlas& atlas) { Touch(field(atlas).Make().members.front()); }});
    changes.push_back({"one less", [=](Atlas& atlas) { field(atlas).Make().members.pop_back(); }});
    changes.push_back({"descriptors", [=](Atlas& atlas) { Touch(field(atlas).Make().descriptors.data.front()); }});
    changes.push_back({"their type", [=](Atlas& atlas) { Touch(field(atlas).Make().descriptors.type); }});
  }
  constexpr bool kHasLists = std::is_same_v<Field, std::vector<LandmarkFeature>> ||
                             std::is_same_v<Field, std::vector<FeatureDescriptor>> ||
                             std::is_same_v<Field, Boxed<Carried>>;
  if constexpr (!kHasLists) AddTouches<Field>(field, changes);  // those have cases of their own
  return changes;
}

template <class Field>
bool SameBits(const Field& a, const Field& b) {
  if constexpr (std::is_same_v<Field, std::vector<FeatureDescriptor>>)
    return a == b;
  else
    return field_bits::SameField(a, b);
}

// A case for each field of an Entity; its JSON is that of The<Printed>.
template <class Entity, class Printed = Entity>
void AddCases(const std::string& entity, std::vector<FieldCase>& cases) {
  ForEachField(static_cast<const Entity*>(nullptr), [&](std::string_view name, auto... members) {
    using Field = std::remove_cvref_t<decltype(Member(std::declval<Entity&>(), members...))>;
    const auto field = [members...](Atlas& atlas) -> Field& { return Member(The<Entity>(atlas), members...); };
    cases.push_back({.name = entity + "." + std::string(name),
                     .changes = ChangesTo<Field>(field),
                     .same = [field](Atlas& a, Atlas& b) { return SameBits(field(a), field(b)); },
                     .json = [](const Atlas& atlas) { return ToJson(The<Printed>(const_cast<Atlas&>(atlas)), -1); }});
  });
}

std::vector<FieldCase> AllCases() {
  std::vector<FieldCase> cases;
  AddCases<Atlas>("Atlas", cases);
  AddCases<Camera>("Camera", cases);
  AddCases<Map>("Map", cases);
  AddCases<KeyFrame>("KeyFrame", cases);
  AddCases<MapPoint>("MapPoint", cases);
  AddCases<Landmark>("Landmark", cases);
  AddCases<LandmarkFeature, Landmark>("LandmarkFeature", cases);
  AddCases<FeatureDescriptor, Landmark>("FeatureDescriptor", cases);
  return cases;
}

// ---- Who must notice

// Fields, or all of an entity's, of which a component misses changes, and why that is right.
struct Exception {
  std::string_view component, field, reason;
};
constexpr Exception kExceptions[] = {
    {"osa", "MapPoint.origin_map", "no .osa file holds it; a loss"},
    {"osa", "MapPoint.visible_count", "no .osa file holds it; a loss"},
    {"osa", "MapPoint.found_count", "no .osa file holds it; a loss"},
    {"osa", "Atlas.repeated_maps", "the owner is not used; an entry behind the end is at the end"},
    {"osa", "Atlas.repeated_cameras", "the owner is not used; an entry behind the end is at the end"},
    {"osa", "KeyFrame.features.grid.cell_sizes", "its length follows from column_sizes"},
    {"osa", "KeyFrame.features.grid.keypoints", "its length follows from cell_sizes"},
    {"osa", "KeyFrame.features.right_grid.cell_sizes", "its length follows from column_sizes"},
    {"osa", "KeyFrame.features.right_grid.keypoints", "its length follows from cell_sizes"},
    {"osa", "KeyFrame.features.bag_of_words.weights", "its length is that of words"},
    {"osa", "KeyFrame.features.feature_vector.sizes", "its length is that of nodes"},
    {"osa", "KeyFrame.features.feature_vector.features", "its length follows from sizes"},
    {"osa", "Atlas.layout", "written as of v1.0 here; tests of forks have the rest"},
    {"osa", "Atlas.carried", "a member of a fork"},
    {"osa", "Camera.carried", "a member of a fork"},
    {"osa", "Map.carried", "a member of a fork"},
    {"osa", "KeyFrame.carried", "a member of a fork"},
    {"osa", "MapPoint.carried", "a member of a fork"},
    {"osa", "Landmark.*", "no .osa file holds them; a loss"},
    {"osa", "LandmarkFeature.*", "no .osa file holds them; a loss"},
    {"osa", "FeatureDescriptor.*", "no .osa file holds them; a loss"},
    {"ndjson reader", "Atlas.layout", "a name that is no UTF-8"},
    {"ndjson reader", "Atlas.repeated_maps", "there is nothing at that place or row"},
    {"ndjson reader", "Atlas.repeated_cameras", "there is nothing at that place or row"},
    {"ndjson reader", "Map.repeated_keyframes", "there is nothing at that place or row"},
    {"ndjson reader", "Map.repeated_points", "there is nothing at that place or row"},
    {"ndjson reader", "KeyFrame.distortion.*", "rows, columns and type tell how much data there is"},
    {"ndjson reader", "KeyFrame.features.grid.*", "column_sizes count cell_sizes, and those keypoints"},
    {"ndjson reader", "KeyFrame.features.right_grid.*", "column_sizes count cell_sizes, and those keypoints"},
    {"ndjson reader", "KeyFrame.features.bag_of_words.*", "each word has a weight"},
    {"ndjson reader", "KeyFrame.features.feature_vector.*", "sizes count features"},
    {"ndjson reader", "Atlas.vocabulary.name", "bytes that are no UTF-8 are written as Latin-1"},
    {"ndjson reader", "Atlas.vocabulary.checksum", "bytes that are no UTF-8 are written as Latin-1"},
    {"ndjson reader", "LandmarkFeature.has_patch", "a patch that is not there has no bytes"},
    {"ndjson reader", "LandmarkFeature.descriptors", "there is one of each kind"},
    {"diff", "Atlas.repeated_maps", "irregular entries count by their number (diff.h)"},
    {"diff", "Atlas.repeated_cameras", "irregular entries count by their number (diff.h)"},
    {"diff", "Map.repeated_keyframes", "irregular entries count by their number (diff.h)"},
    {"diff", "Map.repeated_points", "irregular entries count by their number (diff.h)"},
    {"diff", "KeyFrame.features.map_points", "slots that hold no point do not count (diff.h)"},
    {"diff", "KeyFrame.distortion.continuous", "how a matrix stands in its file (diff.h)"},
    {"diff", "KeyFrame.features.descriptors_form", "how a matrix stands in its file (diff.h)"},
    {"diff", "MapPoint.descriptor_form", "how a matrix stands in its file (diff.h)"},
};

bool IsException(std::string_view component, std::string_view field) {
  for (const Exception& exception : kExceptions) {
    const bool whole = exception.field.ends_with('*');
    const std::string_view name = exception.field.substr(0, exception.field.size() - (whole ? 1 : 0));
    if (exception.component == component && (whole ? field.starts_with(name) : field == name)) return true;
  }
  return false;
}

// As ORB-SLAM3 v1.0 has it: what forks add is tested with them.
std::string OsaOf(Atlas atlas) {
  atlas.layout.clear();
  for (Map& map : atlas.maps) {
    for (KeyFrame& keyframe : map.keyframes) keyframe.carried.Reset();
    for (MapPoint& point : map.points) point.carried.Reset();
  }
  try {
    return EncodeOrbslam3(atlas);
  } catch (const Error& error) {
    return error.what();  // it noticed
  }
}

// What the components have of the base, once.
struct BaseRecords {
  std::uint64_t hash = HashOf(Base());
  std::string osa = OsaOf(Base());
};

// The journal takes it back to the base, bit by bit.
bool JournalNotices(const Atlas& changed) {
  Journal journal;
  AppendChanges(Base(), changed, "test", journal);
  if (journal.edits.empty()) return false;
  Atlas back = changed;
  TakeBack(journal, back);
  return FirstDifference(back, Base()).empty() && HashOf(back) == HashOf(Base());
}

class Fields : public ::testing::TestWithParam<FieldCase> {
 protected:
  // Notes that a component missed a change, unless it may.
  void Expect(bool notices, std::string_view component, const std::string& what) {
    if (IsException(component, GetParam().name))
      missed_[std::string(component)] += notices ? 0 : 1;
    else
      EXPECT_TRUE(notices) << component << " does not notice a change of " << GetParam().name << ": " << what;
  }
  // A component that notices all the same is to be taken off the list of exceptions.
  void ExpectExceptionsAreSome() const {
    for (const auto& [component, missed] : missed_)
      EXPECT_GT(missed, 0) << component << " notices every change of " << GetParam().name;
  }

  const store_test::TemporaryFolder folder_;
  Store store_ = Store::OpenForWriting(folder_ / "s.db", {.sync = false});
  std::map<std::string, int> missed_;
};

// Saved over the base, the change is in the store.
TEST_P(Fields, AnIncrementalSaveWritesEveryChange) {
  const FieldCase& field = GetParam();
  for (const Change& change : field.changes) {
    Atlas changed = Base();
    change.make(changed);
    Atlas base = Base();
    ASSERT_FALSE(field.same(changed, base)) << change.what << " changes nothing";
    store_.Save("a", base, {.threads = 1});
    store_.Save("a", changed, {.threads = 1});
    Atlas loaded = store_.Load("a", {.threads = 1});
    EXPECT_TRUE(field.same(loaded, changed)) << "the store does not keep " << field.name << ": " << change.what;
    EXPECT_EQ(FirstDifference(loaded, changed), "") << change.what;
  }
}

// What the reader of ndjson makes of what its writer wrote: the same, or an error where lists do not fit each other.
bool IsReadBack(const Atlas& changed) {
  try {
    const Atlas read = Decoded(detail::kNdjsonFormat, Encoded(detail::kNdjsonFormat, changed, {.threads = 1}));
    return FirstDifference(read, changed).empty() && HashOf(read) == HashOf(changed);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kDamaged) << error.what();
    EXPECT_THAT(error.place(), ::testing::Not("")) << error.what();
    return false;
  }
}

TEST_P(Fields, NdjsonReadsEveryChangeBack) {
  ASSERT_TRUE(IsReadBack(Base()));
  for (const Change& change : GetParam().changes) {
    Atlas changed = Base();
    change.make(changed);
    Expect(IsReadBack(changed), "ndjson reader", change.what);
  }
}

TEST_P(Fields, EveryComponentNoticesEveryChange) {
  static const BaseRecords base;
  const FieldCase& field = GetParam();
  const std::string base_json = field.json(Base());
  for (const Change& change : field.changes) {
    Atlas changed = Base();
    change.make(changed);
    Expect(HashOf(changed) != base.hash, "hash", change.what);
    Expect(!FirstDifference(changed, Base()).empty(), "EqualsAtlas", change.what);
    Expect(OsaOf(changed) != base.osa, "osa", change.what);
    Expect(field.json(changed) != base_json, "ndjson", change.what);
    Expect(JournalNotices(changed), "journal", change.what);
    Expect(DiffAtlases(Base(), changed, {.threads = 1}).verdict() != AtlasDiff::Verdict::kSame, "diff", change.what);
  }
  ExpectExceptionsAreSome();
}

std::string TestName(const ::testing::TestParamInfo<FieldCase>& info) {
  std::string name = info.param.name;
  for (char& letter : name)
    if (std::isalnum(static_cast<unsigned char>(letter)) == 0) letter = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, Fields, ::testing::ValuesIn(AllCases()), TestName);

// ---- fields.h knows every member

struct Extent {
  std::size_t begin = 0, end = 0;
};

template <class Entity, class Field>
Extent ExtentOf(const Entity& entity, const Field& field) {
  const auto begin =
      static_cast<std::size_t>(reinterpret_cast<const char*>(&field) - reinterpret_cast<const char*>(&entity));
  return {begin, begin + sizeof(Field)};
}

// Between the fields, and the lists that are not among them, there is nothing but padding.
template <class Entity, class... List>
void ExpectCovered(List Entity::*... lists) {
  const Entity entity{};
  std::vector<Extent> covered{ExtentOf(entity, entity.*lists)...};
  ForEachField(&entity, [&](std::string_view, auto... members) {
    covered.push_back(ExtentOf(entity, Member(entity, members...)));
  });
  if constexpr (std::is_same_v<Entity, Atlas>)
    fields::ForEachEncodingField(
        [&](std::string_view, auto... members) { covered.push_back(ExtentOf(entity, Member(entity, members...))); });
  covered.push_back({sizeof(Entity), sizeof(Entity)});
  std::ranges::sort(covered, {}, &Extent::begin);
  std::size_t position = 0;
  for (const Extent& field : covered) {
    const auto is_padding = [&](std::size_t alignment) {
      return field.begin == (position + alignment - 1) / alignment * alignment;
    };
    EXPECT_TRUE(is_padding(1) || is_padding(2) || is_padding(4) || is_padding(8))
        << "bytes " << position << " to " << field.begin << " are of no field of fields.h";
    position = field.end;
  }
}

TEST(FieldsOfTheModel, AreAllInFieldsH) {
  ExpectCovered<Atlas>(&Atlas::maps, &Atlas::cameras);
  ExpectCovered<Camera>();
  ExpectCovered<Map>(&Map::keyframes, &Map::points, &Map::landmarks);
  ExpectCovered<KeyFrame>();
  ExpectCovered<MapPoint>();
  ExpectCovered<Landmark>();
  ExpectCovered<LandmarkFeature>();
  ExpectCovered<FeatureDescriptor>();
}

// ---- Landmarks come and go

class JournalOfLandmarks : public ::testing::Test {
 protected:
  JournalOfLandmarks() {
    for (std::uint64_t id : {4, 5, 6, 7}) Add(before_, id);
    after_ = before_;
  }
  static void Add(Atlas& atlas, std::uint64_t id) {
    Landmark& landmark = atlas.maps[0].landmarks.emplace_back();
    landmark.id = LandmarkId(id);
    landmark.mean.x() = static_cast<double>(id);
    landmark.CreateOneFeature().descriptors = {{DescriptorKind::kOrb, {static_cast<std::uint8_t>(id)}}};
  }
  std::vector<Landmark>& landmarks() { return after_.maps[0].landmarks; }

  // Writes down what was done, takes it back, and returns how many edits it took.
  std::size_t ThereAndBack() {
    Journal journal;
    AppendChanges(before_, after_, "test", journal);
    Atlas back = after_;
    TakeBack(journal, back);
    EXPECT_EQ(FirstDifference(back, before_), "");
    return journal.edits.size();
  }

  Atlas before_ = Base(), after_;
};

TEST_F(JournalOfLandmarks, Added) {
  Add(after_, 8);
  landmarks().insert(landmarks().begin() + 1, Landmark());
  EXPECT_EQ(ThereAndBack(), 2U);
}

TEST_F(JournalOfLandmarks, Removed) {
  landmarks().erase(landmarks().begin() + 4);
  landmarks().pop_back();
  EXPECT_EQ(ThereAndBack(), 2U);
}

TEST_F(JournalOfLandmarks, AddedRemovedAndChanged) {
  landmarks().erase(landmarks().begin() + 3, landmarks().begin() + 5);
  landmarks()[1].seen_count = 77;
  Add(after_, 30);
  EXPECT_EQ(ThereAndBack(), 4U);
}

TEST_F(JournalOfLandmarks, TurnedRound) {
  std::reverse(landmarks().begin(), landmarks().end());
  Add(after_, 9);
  EXPECT_GT(ThereAndBack(), 0U);
}

TEST_F(JournalOfLandmarks, GoWithTheirMap) {
  after_.maps.clear();
  EXPECT_GT(ThereAndBack(), 0U);
}

TEST_F(JournalOfLandmarks, AnotherAtlasIsRefused) {
  Add(after_, 8);
  Journal journal;
  AppendChanges(before_, after_, "test", journal);
  landmarks().back().mean.y() = 1;
  EXPECT_THROW(TakeBack(journal, after_), Error);
}

// How an atlas is written down is hashed and stored, and is no change of what it says.
TEST(EncodingFields, CountInTheHashOnly) {
  fields::ForEachEncodingField([](std::string_view name, auto... members) {
    Atlas changed = Base();
    Touch(Member(changed, members...));
    EXPECT_NE(HashOf(changed), HashOf(Base())) << name;
    EXPECT_EQ(HashWithoutEncoding(changed), HashWithoutEncoding(Base())) << name;
    EXPECT_NE(FirstDifference(changed, Base()), "") << name;
    EXPECT_NE(ToJson(changed, -1), ToJson(Base(), -1)) << name;
    Journal journal;
    AppendChanges(Base(), changed, "test", journal);
    EXPECT_TRUE(journal.edits.empty()) << name;
  });
}

TEST(HashOf, DoesNotDependOnThreads) { EXPECT_EQ(HashOf(Base(), 1), HashOf(Base(), 5)); }

TEST(HashWithoutEncoding, IsTheHashOfTheDefaultEncoding) {
  Atlas atlas = Base();
  atlas.encoding = ArchiveEncoding();
  EXPECT_EQ(HashWithoutEncoding(Base()), HashOf(atlas));
}

// Counters and origins that are not recorded leave the hash as it was before there were any.
TEST(HashOf, KnowsNothingOfWhatIsNotRecorded) {
  Atlas atlas = Base();
  MapPoint& point = The<MapPoint>(atlas);
  EXPECT_TRUE(point.has_tracking());
  const std::uint64_t recorded = HashOf(atlas);
  point.origin_map = MapPoint::kNoOrigin;
  point.visible_count = point.found_count = MapPoint::kNoCount;
  EXPECT_FALSE(point.has_tracking());
  EXPECT_NE(HashOf(atlas), recorded);
}

}  // namespace
}  // namespace slamdb
