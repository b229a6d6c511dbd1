// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/equals_atlas.h"

#include <cstring>
#include <initializer_list>
#include <sstream>
#include <type_traits>

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

// Declared ahead, so that the templates below find them.
std::string Difference(const Keypoint& a, const Keypoint& b);
std::string Difference(const Connection& a, const Connection& b);
std::string Difference(const Observation& a, const Observation& b);
std::string Difference(const RepeatedEntry& a, const RepeatedEntry& b);
std::string Difference(const ImuMeasurement& a, const ImuMeasurement& b);
std::string Difference(const Quaternionf& a, const Quaternionf& b);
std::string Difference(const Rigid3f& a, const Rigid3f& b);
std::string Difference(const Matrix& a, const Matrix& b);
std::string Difference(const FeatureGrid& a, const FeatureGrid& b);
std::string Difference(const BagOfWords& a, const BagOfWords& b);
std::string Difference(const FeatureVector& a, const FeatureVector& b);
std::string Difference(const FeatureDescriptor& a, const FeatureDescriptor& b);
std::string Difference(const LandmarkFeature& a, const LandmarkFeature& b);
std::string Difference(const Landmark& a, const Landmark& b);
std::string Difference(const Intrinsics& a, const Intrinsics& b);
std::string Difference(const ScalePyramid& a, const ScalePyramid& b);
std::string Difference(const ImageBounds& a, const ImageBounds& b);
std::string Difference(const ImuBias& a, const ImuBias& b);
std::string Difference(const ImuCalibration& a, const ImuCalibration& b);
std::string Difference(const ImuPreintegration& a, const ImuPreintegration& b);
std::string Difference(const KeyFrame& a, const KeyFrame& b);
std::string Difference(const MapPoint& a, const MapPoint& b);
std::string Difference(const Camera& a, const Camera& b);
std::string Difference(const Map& a, const Map& b);
std::string Difference(const Counters& a, const Counters& b);
std::string Difference(const Vocabulary& a, const Vocabulary& b);
std::string Difference(const ArchiveEncoding& a, const ArchiveEncoding& b);
template <class T, class Allocator>
std::string Difference(const std::vector<T, Allocator>& actual, const std::vector<T, Allocator>& expected);

template <class T>
std::string Field(std::string_view name, const T& actual, const T& expected) {
  const std::string difference = Difference(actual, expected);
  return difference.empty() ? difference : std::string(name) + difference;
}

template <class T>
constexpr bool kIsEntity = std::is_same_v<T, KeyFrame> || std::is_same_v<T, MapPoint> || std::is_same_v<T, Map> ||
                           std::is_same_v<T, Camera> || std::is_same_v<T, Landmark>;

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

std::string Difference(const Rigid3f& a, const Rigid3f& b) {
  return Part({SLAMDB_FIELD(rotation), SLAMDB_FIELD(translation)});
}

std::string Difference(const Matrix& a, const Matrix& b) {
  return Part(
      {SLAMDB_FIELD(columns), SLAMDB_FIELD(rows), SLAMDB_FIELD(type), SLAMDB_FIELD(continuous), SLAMDB_FIELD(data)});
}

std::string Difference(const FeatureGrid& a, const FeatureGrid& b) {
  return Part({SLAMDB_FIELD(column_sizes), SLAMDB_FIELD(cell_sizes), SLAMDB_FIELD(keypoints)});
}

std::string Difference(const BagOfWords& a, const BagOfWords& b) {
  return Part({SLAMDB_FIELD(words), SLAMDB_FIELD(weights)});
}

std::string Difference(const FeatureVector& a, const FeatureVector& b) {
  return Part({SLAMDB_FIELD(nodes), SLAMDB_FIELD(sizes), SLAMDB_FIELD(features)});
}

std::string Difference(const Intrinsics& a, const Intrinsics& b) {
  return Part({SLAMDB_FIELD(fx), SLAMDB_FIELD(fy), SLAMDB_FIELD(inverse_fx), SLAMDB_FIELD(inverse_fy), SLAMDB_FIELD(cx),
               SLAMDB_FIELD(cy), SLAMDB_FIELD(baseline_fx), SLAMDB_FIELD(baseline), SLAMDB_FIELD(depth_threshold)});
}

std::string Difference(const ScalePyramid& a, const ScalePyramid& b) {
  return Part({SLAMDB_FIELD(levels), SLAMDB_FIELD(factor), SLAMDB_FIELD(log_factor), SLAMDB_FIELD(factors),
               SLAMDB_FIELD(sigma2), SLAMDB_FIELD(inverse_sigma2)});
}

std::string Difference(const ImageBounds& a, const ImageBounds& b) {
  return Part({SLAMDB_FIELD(grid_columns), SLAMDB_FIELD(grid_rows), SLAMDB_FIELD(inverse_cell_width),
               SLAMDB_FIELD(inverse_cell_height), SLAMDB_FIELD(min_x), SLAMDB_FIELD(min_y), SLAMDB_FIELD(max_x),
               SLAMDB_FIELD(max_y)});
}

std::string Difference(const ImuBias& a, const ImuBias& b) {
  return Part({SLAMDB_FIELD(accelerometer), SLAMDB_FIELD(gyroscope)});
}

std::string Difference(const ImuCalibration& a, const ImuCalibration& b) {
  return Part({SLAMDB_FIELD(camera_from_body), SLAMDB_FIELD(body_from_camera), SLAMDB_FIELD(noise),
               SLAMDB_FIELD(walk_noise), SLAMDB_FIELD(is_set)});
}

std::string Difference(const ImuPreintegration& a, const ImuPreintegration& b) {
  return Part({SLAMDB_FIELD(duration), SLAMDB_FIELD(covariance), SLAMDB_FIELD(information), SLAMDB_FIELD(noise),
               SLAMDB_FIELD(walk_noise), SLAMDB_FIELD(bias), SLAMDB_FIELD(rotation), SLAMDB_FIELD(velocity),
               SLAMDB_FIELD(position), SLAMDB_FIELD(rotation_by_gyro), SLAMDB_FIELD(velocity_by_gyro),
               SLAMDB_FIELD(velocity_by_acc), SLAMDB_FIELD(position_by_gyro), SLAMDB_FIELD(position_by_acc),
               SLAMDB_FIELD(mean_acceleration), SLAMDB_FIELD(mean_angular_velocity), SLAMDB_FIELD(updated_bias),
               SLAMDB_FIELD(bias_change), SLAMDB_FIELD(measurements)});
}

std::string FeaturesDifference(const Features& a, const Features& b) {
  return FirstOf({SLAMDB_FIELD(count), SLAMDB_FIELD(left_count), SLAMDB_FIELD(right_count), SLAMDB_FIELD(keypoints),
                  SLAMDB_FIELD(undistorted), SLAMDB_FIELD(right_x), SLAMDB_FIELD(depth), SLAMDB_FIELD(descriptors),
                  SLAMDB_FIELD(descriptors_form), SLAMDB_FIELD(map_points), SLAMDB_FIELD(right_keypoints),
                  SLAMDB_FIELD(right_of_left), SLAMDB_FIELD(left_of_right), SLAMDB_FIELD(grid),
                  SLAMDB_FIELD(right_grid), SLAMDB_FIELD(bag_of_words), SLAMDB_FIELD(feature_vector)});
}

// Entities are named by id, `kf 77, depth[3]: ...`, where both have the same.
std::string Difference(const KeyFrame& a, const KeyFrame& b) {
  if (a.id != b.id) return Part({SLAMDB_FIELD(id)});
  return FirstOf({SLAMDB_FIELD(frame_id),
                  SLAMDB_FIELD(timestamp),
                  SLAMDB_FIELD(camera_from_world),
                  SLAMDB_FIELD(camera_from_parent),
                  SLAMDB_FIELD(merge_scale),
                  SLAMDB_FIELD(camera),
                  SLAMDB_FIELD(right_camera),
                  SLAMDB_FIELD(intrinsics),
                  SLAMDB_FIELD(calibration_matrix),
                  SLAMDB_FIELD(distortion),
                  SLAMDB_FIELD(half_baseline),
                  SLAMDB_FIELD(left_from_right),
                  SLAMDB_FIELD(bounds),
                  SLAMDB_FIELD(pyramid),
                  FeaturesDifference(a.features, b.features),
                  SLAMDB_FIELD(connections),
                  SLAMDB_FIELD(first_connection),
                  SLAMDB_FIELD(parent),
                  SLAMDB_FIELD(children),
                  SLAMDB_FIELD(loop_edges),
                  SLAMDB_FIELD(merge_edges),
                  SLAMDB_FIELD(not_erase),
                  SLAMDB_FIELD(to_be_erased),
                  SLAMDB_FIELD(bad),
                  SLAMDB_FIELD(origin_map),
                  SLAMDB_FIELD(imu_bias),
                  SLAMDB_FIELD(preintegration),
                  SLAMDB_FIELD(imu_calibration),
                  SLAMDB_FIELD(previous),
                  SLAMDB_FIELD(next),
                  SLAMDB_FIELD(imu_initialized),
                  SLAMDB_FIELD(velocity),
                  SLAMDB_FIELD(body_position),
                  SLAMDB_FIELD(has_velocity)});
}

std::string Difference(const MapPoint& a, const MapPoint& b) {
  if (a.id != b.id) return Part({SLAMDB_FIELD(id)});
  return FirstOf({SLAMDB_FIELD(first_keyframe), SLAMDB_FIELD(first_frame), SLAMDB_FIELD(observation_count),
                  SLAMDB_FIELD(position), SLAMDB_FIELD(normal), SLAMDB_FIELD(observations), SLAMDB_FIELD(descriptor),
                  SLAMDB_FIELD(descriptor_form), SLAMDB_FIELD(bad), SLAMDB_FIELD(reference), SLAMDB_FIELD(replaced_by),
                  SLAMDB_FIELD(min_distance), SLAMDB_FIELD(max_distance)});
}

std::string Difference(const FeatureDescriptor& a, const FeatureDescriptor& b) {
  return Part({SLAMDB_FIELD(kind), SLAMDB_FIELD(bytes)});
}

std::string Difference(const LandmarkFeature& a, const LandmarkFeature& b) {
  return Part({SLAMDB_FIELD(x), SLAMDB_FIELD(y), SLAMDB_FIELD(keypoint_id), SLAMDB_FIELD(type),
               SLAMDB_FIELD(track_status), SLAMDB_FIELD(response), SLAMDB_FIELD(orientation), SLAMDB_FIELD(octave),
               SLAMDB_FIELD(user_flags), SLAMDB_FIELD(depth), SLAMDB_FIELD(initial_depth),
               SLAMDB_FIELD(position_in_camera), SLAMDB_FIELD(patch_size), SLAMDB_FIELD(has_patch), SLAMDB_FIELD(patch),
               SLAMDB_FIELD(spin_image_rows), SLAMDB_FIELD(polar_images_without_rotation), SLAMDB_FIELD(descriptors)});
}

std::string Difference(const Landmark& a, const Landmark& b) {
  if (a.id != b.id) return Part({SLAMDB_FIELD(id)});
  return FirstOf({SLAMDB_FIELD(mean), SLAMDB_FIELD(normal), SLAMDB_FIELD(cov_11), SLAMDB_FIELD(cov_22),
                  SLAMDB_FIELD(cov_33), SLAMDB_FIELD(cov_12), SLAMDB_FIELD(cov_13), SLAMDB_FIELD(cov_23),
                  SLAMDB_FIELD(last_seen), SLAMDB_FIELD(seen_count), SLAMDB_FIELD(features)});
}

std::string Difference(const Camera& a, const Camera& b) {
  if (a.id != b.id) return Part({SLAMDB_FIELD(id)});
  return FirstOf({SLAMDB_FIELD(model), SLAMDB_FIELD(recorded_type), SLAMDB_FIELD(parameters), SLAMDB_FIELD(precision)});
}

std::string Difference(const Map& a, const Map& b) {
  if (a.id != b.id) return Part({SLAMDB_FIELD(id)});
  return FirstOf({SLAMDB_FIELD(initial_keyframe), SLAMDB_FIELD(max_keyframe_id), SLAMDB_FIELD(big_change_index),
                  SLAMDB_FIELD(keyframes), SLAMDB_FIELD(repeated_keyframes), SLAMDB_FIELD(points),
                  SLAMDB_FIELD(repeated_points), SLAMDB_FIELD(landmarks), SLAMDB_FIELD(origins),
                  SLAMDB_FIELD(first_keyframe), SLAMDB_FIELD(lowest_keyframe), SLAMDB_FIELD(imu_initialized),
                  SLAMDB_FIELD(inertial), SLAMDB_FIELD(imu_ba1), SLAMDB_FIELD(imu_ba2)});
}

std::string Difference(const Counters& a, const Counters& b) {
  return Part({SLAMDB_FIELD(map), SLAMDB_FIELD(frame), SLAMDB_FIELD(keyframe), SLAMDB_FIELD(map_point),
               SLAMDB_FIELD(camera), SLAMDB_FIELD(initial_keyframe)});
}

std::string Difference(const Vocabulary& a, const Vocabulary& b) {
  return Part({SLAMDB_FIELD(name), SLAMDB_FIELD(checksum)});
}

std::string Difference(const ArchiveEncoding& a, const ArchiveEncoding& b) {
  return Part({SLAMDB_FIELD(text), SLAMDB_FIELD(boost_version), SLAMDB_FIELD(long_bytes), SLAMDB_FIELD(size_bytes)});
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
  return FirstOf({SLAMDB_FIELD(encoding), SLAMDB_FIELD(vocabulary), SLAMDB_FIELD(maps), SLAMDB_FIELD(repeated_maps),
                  SLAMDB_FIELD(cameras), SLAMDB_FIELD(repeated_cameras), SLAMDB_FIELD(next_ids)});
}

::testing::Matcher<const Atlas&> EqualsAtlas(const Atlas& expected) {
  return ::testing::MakeMatcher(new EqualsAtlasMatcher(expected));
}

}  // namespace slamdb
