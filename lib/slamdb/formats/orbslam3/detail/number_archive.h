// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "slamdb/formats/orbslam3/detail/layout.h"

namespace slamdb::orbslam3 {

using Number = long double;
static_assert(std::numeric_limits<Number>::digits >= 64);  // every integer of 64 bits and every double

// The archive (see layout.h) whose values are plain numbers, for members of a fork that are of another type; of lists
// the count stands in front. What does not consist of numbers is passed over.
template <bool reads>
class NumberArchive {
 public:
  explicit NumberArchive(std::vector<Number>& numbers) : numbers_(numbers) {}

  template <class T>
  void Identity(const char*, T& id) {
    MoveId(id);
  }
  template <class T>
  void UnsignedLong(const char*, T& value) {
    if constexpr (std::is_integral_v<std::remove_const_t<T>>)
      Move(value);
    else
      MoveId(value);
  }
  template <class T>
  void LongLong(const char*, T& id) {
    MoveId(id);
  }
  template <class T>
  void CameraReference(const char*, T& id) {
    MoveId(id);
  }
  template <class T>
  void Long(const char*, T& value) {
    Move(value);
  }
  template <class T>
  void Int(const char*, T& value) {
    Move(value);
  }
  template <class T>
  void Unsigned(const char*, T& value) {
    Move(value);
  }
  template <class T>
  void Float(const char*, T& value) {
    Move(value);
  }
  template <class T>
  void Double(const char*, T& value) {
    Move(value);
  }
  template <class T>
  void Bool(const char*, T& value) {
    Move(value.recorded);
  }
  template <class T>
  void Floats(const char*, T& values) {
    for (Eigen::Index i = 0; i < values.size(); ++i) Move(values.data()[i]);
  }
  template <class T>
  void Pose(const char*, T& pose) {
    auto& q = pose.rotation.coeffs();
    for (const int i : {3, 0, 1, 2}) Move(q[i]);  // w x y z
    for (int i = 0; i < 3; ++i) Move(pose.translation[i]);
  }
  void ClassInfo(WireClass) {}
  void Begin(Part) {}
  template <class... T>
  void MatrixValue(T&&...) {}
  template <class... T>
  void Keypoints(T&&...) {}
  template <class T>
  void FloatVector(const char*, T& values) {
    MoveList(values, [this](auto& value) { this->Move(value); });
  }
  template <class T>
  void IntVector(const char*, T& values) {
    MoveList(values, [this](auto& value) { this->Move(value); });
  }
  template <class T>
  void LongLongVector(const char*, T& ids) {
    MoveList(ids, [this](auto& id) { this->MoveId(id); });
  }
  template <class T>
  void UnsignedLongVector(const char*, T& ids) {
    MoveList(ids, [this](auto& id) { this->MoveId(id); });
  }
  template <class... T>
  void Descriptors(T&&...) {}
  template <class... T>
  void PointDescriptor(T&&...) {}
  template <class... T>
  void Bow(T&&...) {}
  template <class... T>
  void FeatureMap(T&&...) {}
  template <class T>
  void Grid(const char*, T& grid) {
    std::size_t cell = 0, keypoint = 0;
    MoveList(grid.column_sizes, [&](auto& cells) {
      MoveCount(cells);
      MovePart(grid.cell_sizes, cell, cells, [&](auto& keypoints) {
        MoveCount(keypoints);
        MovePart(grid.keypoints, keypoint, keypoints, [this](auto& row) { this->Move(row); });
      });
    });
  }
  template <class T>
  void Connections(const char*, T& connections) {
    MoveList(connections, [this](auto& connection) {
      this->MoveId(connection.keyframe);
      this->Move(connection.weight);
    });
  }
  template <class... T>
  void Observations(T&&...) {}
  template <class... T>
  void Measurements(T&&...) {}

 private:
  // Negative numbers wrap, so that -1 stays `none`; what does not fit is 0.
  template <class T>
  static T Cast(Number number) {
    if constexpr (std::is_floating_point_v<T>) {
      return static_cast<T>(number);
    } else {
      if (!(number >= static_cast<Number>(std::numeric_limits<std::int64_t>::min()) &&
            number <= static_cast<Number>(std::numeric_limits<std::uint64_t>::max())))
        return 0;
      return number < 0 ? static_cast<T>(static_cast<std::int64_t>(number))
                        : static_cast<T>(static_cast<std::uint64_t>(number));
    }
  }
  template <class T>
  void Move(T& value) {
    if constexpr (!reads)
      numbers_.push_back(static_cast<Number>(value));
    else if (next_ < numbers_.size())
      value = Cast<T>(numbers_[next_++]);
  }
  // A count that the numbers behind it can hold.
  template <class T>
  void MoveCount(T& count) {
    Move(count);
    if constexpr (reads) count = static_cast<T>(std::min<std::size_t>(count, numbers_.size() - next_));
  }
  template <class T, class MoveOne>
  void MoveList(T& values, const MoveOne& move_one) {
    std::size_t count = values.size();
    MoveCount(count);
    if constexpr (reads) values.resize(count);
    for (auto& value : values) move_one(value);
  }
  // `count` values of a list that belongs to several, from `next` on.
  template <class T, class MoveOne>
  void MovePart(T& values, std::size_t& next, std::size_t count, const MoveOne& move_one) {
    if constexpr (reads) values.resize(next + count);
    for (std::size_t i = 0; i < count && next < values.size(); ++i) move_one(values[next++]);
  }
  template <class Entity>
  void MoveId(const Id<Entity>& id) {
    numbers_.push_back(id ? static_cast<Number>(id.value()) : Number{-1});
  }
  template <class Entity>
  void MoveId(Id<Entity>& id) {
    if constexpr (reads) {
      if (next_ < numbers_.size()) id = Id<Entity>(Cast<std::uint64_t>(numbers_[next_++]));
    } else {
      MoveId(std::as_const(id));
    }
  }

  std::vector<Number>& numbers_;
  std::size_t next_ = 0;
};

}  // namespace slamdb::orbslam3
