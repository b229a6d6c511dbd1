// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/serialization/array.hpp>
#include <limits>

#include "slamdb/boost/containers.h"

// What ORB-SLAM3 archives by helper functions instead of as classes: no class information stands in the archive.
namespace slamdb::boost_archive {

// An id as an `unsigned long`, a `long long`, or the `unsigned int` of a camera.
template <class Number, class Archive, class Entity>
void AsNumber(Archive& archive, Id<Entity>& id) {
  static constexpr Number kNone = static_cast<Number>(-1);
  const bool fits = sizeof(Number) == 8 || !id.has_value() || id.value() < std::numeric_limits<Number>::max();
  if (Archive::is_saving::value && !fits)
    throw Error(ErrorKind::kNotPossible,
                "the id " + std::to_string(id.value()) + " cannot be archived: ORB-SLAM3's have 32 bits there");
  auto number = static_cast<Number>(id.value());
  archive& number;
  if constexpr (Archive::is_loading::value)
    id = number == kNone ? Id<Entity>() : Id<Entity>(static_cast<std::uint64_t>(number));
}

template <class Archive, class Derived>
void Floats(Archive& archive, Eigen::PlainObjectBase<Derived>& values) {
  archive& boost::serialization::make_array(values.data(), static_cast<std::size_t>(values.size()));
}

template <class Archive>
void Bytes(Archive& archive, void* bytes, std::size_t count) {
  archive& boost::serialization::make_array(static_cast<unsigned char*>(bytes), count);
}

template <class Archive>
void Keypoints(Archive& archive, Column<Keypoint>& keypoints) {
  int count = static_cast<int>(keypoints.size());
  archive& count;
  if constexpr (Archive::is_loading::value) {
    if (count < 0) FailLoading(std::to_string(count) + " keypoints");
    keypoints.resize(static_cast<std::size_t>(count));
  }
  for (Keypoint& keypoint : keypoints)
    archive& keypoint.angle& keypoint.response& keypoint.size& keypoint.x& keypoint.y& keypoint.class_id& keypoint
        .octave;
}

// ---- cv::Mat

struct MatrixHead {
  int columns = 0, rows = 0, type = 0;
  unsigned char continuous = 0;
};

template <class Archive>
void Head(Archive& archive, MatrixHead& head) {
  archive& head.columns& head.rows& head.type& head.continuous;
}

// How many bytes follow.
inline std::size_t MatrixBytes(const MatrixHead& head) {
  static constexpr std::size_t kDepthBytes[] = {1, 1, 2, 2, 4, 4, 8, 2};  // OpenCV's CV_8U .. CV_16F
  if (head.columns < 0 || head.rows < 0 || head.type < 0 || head.type >= 4096)
    FailLoading("a matrix of " + std::to_string(head.rows) + " x " + std::to_string(head.columns) + ", type " +
                std::to_string(head.type));
  const std::size_t element = kDepthBytes[head.type & 7] * (static_cast<std::size_t>(head.type >> 3) + 1);
  return static_cast<std::size_t>(head.columns) * static_cast<std::size_t>(head.rows) * element;
}

inline bool HasColumns(MatrixForm form) {
  return form == MatrixForm::kUsual || form == MatrixForm::kUsualNotContinuous;
}

inline MatrixHead DescriptorHead(std::size_t rows, MatrixForm form) {
  const bool continuous = form == MatrixForm::kUsual || form == MatrixForm::kEmptyContinuous;
  return {HasColumns(form) ? 32 : 0, static_cast<int>(rows), 0, continuous};
}

// The form of a matrix of ORB descriptors. Throws when it is none.
inline MatrixForm FormOf(const MatrixHead& head) {
  const bool continuous = head.continuous != 0;
  if (head.columns == 0 && head.rows == 0 && head.type == 0)
    return continuous ? MatrixForm::kEmptyContinuous : MatrixForm::kEmpty;
  if (head.columns != 32 || head.rows < 0 || head.type != 0)
    FailLoading("a descriptor matrix of " + std::to_string(head.rows) + " x " + std::to_string(head.columns) +
                ", type " + std::to_string(head.type) + ", expected N x 32, type 0");
  return continuous ? MatrixForm::kUsual : MatrixForm::kUsualNotContinuous;
}

template <class Archive>
void Descriptors(Archive& archive, Column<Descriptor>& descriptors, MatrixForm& form) {
  MatrixHead head = DescriptorHead(descriptors.size(), form);
  Head(archive, head);
  if constexpr (Archive::is_loading::value) {
    form = FormOf(head);
    descriptors.resize(static_cast<std::size_t>(head.rows));
  }
  Bytes(archive, descriptors.data(), descriptors.size() * sizeof(Descriptor));
}

template <class Archive>
void PointDescriptor(Archive& archive, Descriptor& descriptor, MatrixForm& form) {
  MatrixHead head = DescriptorHead(HasColumns(form) ? 1 : 0, form);
  Head(archive, head);
  if constexpr (Archive::is_loading::value) form = FormOf(head);
  if (head.rows != (HasColumns(form) ? 1 : 0))
    FailLoading("a point with " + std::to_string(head.rows) + " descriptors");
  if (HasColumns(form)) Bytes(archive, descriptor.data(), descriptor.size());
}

}  // namespace slamdb::boost_archive
