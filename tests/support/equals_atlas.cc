// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/equals_atlas.h"

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <sstream>
#include <type_traits>

#include "slamdb/model/fields.h"

namespace slamdb {
namespace {

// A difference is told as the path below the values that are compared, then what they are; empty when there is none.

template <class T>
std::string Shown(const T& value) {
  std::ostringstream text;
  if constexpr (std::is_enum_v<T> || std::is_same_v<T, std::uint8_t>) {
    text << static_cast<std::int64_t>(value);
  } else if constexpr (std::is_same_v<T, Flag>) {
    text << int{value.recorded};
  } else {
    text.precision(17);
    text << value;
  }
  return text.str();
}

std::string Shown(std::byte value) { return Shown(static_cast<std::uint8_t>(value)); }

std::string Shown(const Descriptor& descriptor) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : descriptor) text += {kDigits[byte >> 4], kDigits[byte & 15]};
  return text;
}

template <class Entity>
std::string Shown(Id<Entity> id) {
  return ToString(id);
}

// Values without parts and without padding.
template <class T>
std::string Difference(const T& actual, const T& expected) {
  static_assert(std::is_trivially_copyable_v<T>);
  if (std::memcmp(&actual, &expected, sizeof(T)) == 0) return {};
  return ": " + Shown(actual) + " instead of " + Shown(expected);
}

std::string Difference(const std::string& actual, const std::string& expected) {
  return actual == expected ? std::string() : ": " + actual + " instead of " + expected;
}

template <class Number, int kRows, int kColumns>
std::string Difference(const Eigen::Matrix<Number, kRows, kColumns>& actual,
                       const Eigen::Matrix<Number, kRows, kColumns>& expected) {
  for (int i = 0; i < kRows * kColumns; ++i) {
    const std::string difference = Difference(actual.data()[i], expected.data()[i]);
    if (!difference.empty()) return "[" + std::to_string(i) + "]" + difference;
  }
  return {};
}

template <class T>
constexpr bool kIsEntity = std::is_same_v<T, KeyFrame> || std::is_same_v<T, MapPoint> || std::is_same_v<T, Map> ||
                           std::is_same_v<T, Camera> || std::is_same_v<T, Landmark>;

// What fields.h lists the fields of, entities and parts of them.
template <class T>
constexpr bool kHasFields = kIsEntity<T> || std::is_same_v<T, LandmarkFeature> || std::is_same_v<T, FeatureDescriptor>;

// Declared ahead, so that the templates below find them.
std::string Difference(const Keypoint& a, const Keypoint& b);
std::string Difference(const Connection& a, const Connection& b);
std::string Difference(const Observation& a, const Observation& b);
std::string Difference(const RepeatedEntry& a, const RepeatedEntry& b);
std::string Difference(const ImuMeasurement& a, const ImuMeasurement& b);
std::string Difference(const Quaternionf& a, const Quaternionf& b);
std::string Difference(const Rigid3f& a, const Rigid3f& b);
std::string Difference(const Boxed<Carried>& a, const Boxed<Carried>& b);
template <class Entity>
requires kHasFields<Entity> std::string Difference(const Entity& a, const Entity& b);
template <class T, class Allocator>
std::string Difference(const std::vector<T, Allocator>& actual, const std::vector<T, Allocator>& expected);

template <class T>
std::string Field(std::string_view name, const T& actual, const T& expected) {
  const std::string difference = Difference(actual, expected);
  return difference.empty() ? difference : std::string(name) + difference;
}

template <class T, class Allocator>
std::string Difference(const std::vector<T, Allocator>& actual, const std::vector<T, Allocator>& expected) {
  if (actual.size() != expected.size())
    return ": " + std::to_string(actual.size()) + " entries instead of " + std::to_string(expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i) {
    const std::string difference = Difference(actual[i], expected[i]);
    if (!difference.empty()) return "[" + std::to_string(i) + "]" + difference;
  }
  return {};
}

template <class T, class Allocator>
requires kIsEntity<T> std::string Field(std::string_view name, const std::vector<T, Allocator>& actual,
                                        const std::vector<T, Allocator>& expected) {
  if (actual.size() != expected.size()) return std::string(name) + Difference(actual, expected);
  for (std::size_t i = 0; i < actual.size(); ++i) {
    const std::string difference = Difference(actual[i], expected[i]);
    if (difference.empty()) continue;
    if (actual[i].id != expected[i].id) return std::string(name) + "[" + std::to_string(i) + "]" + difference;
    return ToString(actual[i].id) + ", " + difference;
  }
  return {};
}

std::string FirstOf(std::initializer_list<std::string> differences) {
  for (const std::string& difference : differences)
    if (!difference.empty()) return difference;
  return {};
}

// The first of the parts of a struct: `.x: 1 instead of 2`.
std::string Part(std::initializer_list<std::string> differences) {
  const std::string difference = FirstOf(differences);
  return difference.empty() ? difference : "." + difference;
}

// Spells a member's name once.
#define SLAMDB_FIELD(member) Field(#member, a.member, b.member)

std::string Difference(const Keypoint& a, const Keypoint& b) {
  if (std::memcmp(&a, &b, sizeof a) == 0) return {};
  return Part({SLAMDB_FIELD(angle), SLAMDB_FIELD(response), SLAMDB_FIELD(size), SLAMDB_FIELD(x), SLAMDB_FIELD(y),
               SLAMDB_FIELD(class_id), SLAMDB_FIELD(octave)});
}

std::string Difference(const Connection& a, const Connection& b) {
  return Part({SLAMDB_FIELD(keyframe), SLAMDB_FIELD(weight)});
}

std::string Difference(const Observation& a, const Observation& b) {
  if (std::memcmp(&a, &b, sizeof a) == 0) return {};
  return Part({SLAMDB_FIELD(keyframe), SLAMDB_FIELD(left), SLAMDB_FIELD(right)});
}

std::string Difference(const RepeatedEntry& a, const RepeatedEntry& b) {
  return Part({SLAMDB_FIELD(position), SLAMDB_FIELD(owner_map), SLAMDB_FIELD(row)});
}

std::string Difference(const ImuMeasurement& a, const ImuMeasurement& b) {
  if (std::memcmp(static_cast<const void*>(&a), static_cast<const void*>(&b), sizeof a) == 0) return {};
  return Part({SLAMDB_FIELD(acceleration), SLAMDB_FIELD(angular_velocity), SLAMDB_FIELD(duration)});
}

std::string Difference(const Quaternionf& a, const Quaternionf& b) {
  const Eigen::Vector4f actual = a.coeffs(), expected = b.coeffs();
  return Difference(actual, expected);
}

std::string Difference(const Boxed<Carried>& a, const Boxed<Carried>& b) {
  if (a == b) return {};
  if (!a || !b) return b ? ": nothing carried" : ": something carried instead of nothing";
  const std::string members = Difference(a->members, b->members);
  return members.empty() ? ".descriptors: others" : ".members" + members;
}

std::string Difference(const Rigid3f& a, const Rigid3f& b) {
  return Part({SLAMDB_FIELD(rotation), SLAMDB_FIELD(translation)});
}

// The first field of an entity that differs, empty when none does. Keyframes name the columns of their features, which
// are most of what they have, without saying `features` each time.
template <class Entity>
std::string FieldsDifference(const Entity& a, const Entity& b) {
  constexpr std::string_view kFeatures = "features.";
  std::string difference;
  ForEachField(&a, [&](std::string_view name, auto... members) {
    if (!difference.empty()) return;
    if (std::is_same_v<Entity, KeyFrame> && name.starts_with(kFeatures))
      name = name.substr(std::min(kFeatures.size(), name.size()));
    difference = Field(name, Member(a, members...), Member(b, members...));
  });
  return difference;
}

// Entities are named by id, `kf 77, depth[3]: ...`, where both have the same.
template <class Entity>
requires kHasFields<Entity> std::string Difference(const Entity& a, const Entity& b) {
  if constexpr (kIsEntity<Entity>) {
    if (a.id != b.id) return Part({SLAMDB_FIELD(id)});
    if constexpr (std::is_same_v<Entity, Map>)
      return FirstOf({FieldsDifference(a, b), SLAMDB_FIELD(keyframes), SLAMDB_FIELD(points), SLAMDB_FIELD(landmarks)});
    else
      return FieldsDifference(a, b);
  } else {
    return Part({FieldsDifference(a, b)});
  }
}

std::string EncodingDifference(const Atlas& a, const Atlas& b) {
  std::string difference;
  fields::ForEachEncodingField([&](std::string_view name, auto... members) {
    if (difference.empty()) difference = Field(name, Member(a, members...), Member(b, members...));
  });
  return difference;
}

class EqualsAtlasMatcher : public ::testing::MatcherInterface<const Atlas&> {
 public:
  explicit EqualsAtlasMatcher(const Atlas& expected) : expected_(expected) {}

  bool MatchAndExplain(const Atlas& actual, ::testing::MatchResultListener* listener) const override {
    const std::string difference = FirstDifference(actual, expected_);
    if (!difference.empty()) *listener << "which differs first at " << difference;
    return difference.empty();
  }
  void DescribeTo(std::ostream* out) const override { *out << "equals the expected atlas bit by bit"; }

 private:
  const Atlas& expected_;
};

}  // namespace

std::string FirstDifference(const Atlas& a, const Atlas& b) {
  return FirstOf({EncodingDifference(a, b), FieldsDifference(a, b), SLAMDB_FIELD(cameras), SLAMDB_FIELD(maps)});
}

::testing::Matcher<const Atlas&> EqualsAtlas(const Atlas& expected) {
  return ::testing::MakeMatcher(new EqualsAtlasMatcher(expected));
}

}  // namespace slamdb
