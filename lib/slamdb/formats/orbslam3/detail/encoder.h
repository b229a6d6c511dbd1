// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <numeric>
#include <span>
#include <utility>

#include "slamdb/formats/orbslam3/detail/layout.h"
#include "slamdb/formats/orbslam3/detail/output.h"

namespace slamdb::orbslam3 {

// The archive (see layout.h) that writes: the mirror of Decoder.
template <class Output>
class Encoder {
 public:
  Encoder(const Output& to, const ClassTable& table) : output(to), classes(table) {}

  Output output;
  ClassTable classes;

  void ClassInfo(WireClass wire_class) { PutClassInfo(wire_class, 0); }
  // Tracked classes are those that are stored through pointers.
  void PutClassInfo(WireClass wire_class, std::uint8_t tracking) {
    if (!classes.FirstUse(wire_class)) return;
    output.Put(tracking);
    output.Put(std::uint32_t{0});
  }
  void ClassCount(WireClass wire_class, std::uint64_t count) {
    ClassInfo(wire_class);
    output.PutSize(count);
    output.Put(std::uint32_t{0});
  }
  void VectorCount(WireClass wire_class, std::uint64_t count) {
    classes.Register(wire_class);
    output.PutSize(count);
    if constexpr (Output::kText) output.Put(std::uint32_t{0});
  }

  void Begin(Part) {}
  template <class Entity>
  void Identity(const char*, const Id<Entity>& id) {
    output.PutUnsignedLong(id.value());
  }
  void UnsignedLong(const char*, std::uint64_t value) { output.PutUnsignedLong(value); }
  template <class Entity>
  void UnsignedLong(const char*, const Id<Entity>& id) {
    output.PutUnsignedLong(id.value());
  }
  void Long(const char*, std::int64_t value) { output.PutLong(value); }
  template <class Entity>
  void LongLong(const char*, const Id<Entity>& id) {
    output.Put(static_cast<std::int64_t>(id.value()));
  }
  void CameraReference(const char*, const CameraId& id) { output.Put(Narrow(id.value())); }
  void Int(const char*, std::int32_t value) { output.Put(value); }
  void Unsigned(const char*, std::uint32_t value) { output.Put(value); }
  void Float(const char*, const float& value) { output.PutArray(&value, 1); }
  void Double(const char*, const double& value) { output.PutArray(&value, 1); }
  void Bool(const char*, const Flag& value) { output.Put(value.recorded); }
  template <class Derived>
  void Floats(const char*, const Eigen::PlainObjectBase<Derived>& values) {
    output.PutArray(values.data(), static_cast<std::size_t>(values.size()));
  }
  void Pose(const char*, const Rigid3f& pose) {
    const auto& q = pose.rotation;
    const auto& t = pose.translation;
    const std::array<float, 7> values{q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()};
    output.PutArray(values.data(), values.size());
  }
  void MatrixValue(const char*, const Matrix& matrix) {
    PutMatrixHeader(matrix.columns, matrix.rows, matrix.type, matrix.continuous.recorded);
    output.PutArray(reinterpret_cast<const std::uint8_t*>(matrix.data.data()), matrix.data.size());
  }
  void Descriptors(const char* name, const Column<Descriptor>& descriptors, MatrixForm form,
                   const Boxed<Carried>& carried) {
    if (carried && carried->descriptors.columns != 0) return MatrixValue(name, carried->descriptors);
    PutDescriptors(descriptors.data(), descriptors.size(), form);
  }
  void PointDescriptor(const char* name, const Descriptor& descriptor, MatrixForm form, const Boxed<Carried>& carried) {
    if (carried && carried->descriptors.columns != 0) return MatrixValue(name, carried->descriptors);
    PutDescriptors(&descriptor, form == MatrixForm::kUsual || form == MatrixForm::kUsualNotContinuous ? 1 : 0, form);
  }
  void Keypoints(const char*, const Column<Keypoint>& keypoints) {
    output.Put(static_cast<std::int32_t>(keypoints.size()));
    if constexpr (!Output::kText) {
      output.PutArray(keypoints.data(), keypoints.size());
    } else {
      for (const Keypoint& keypoint : keypoints) {
        output.PutArray(&keypoint.angle, 5);
        output.PutArray(&keypoint.class_id, 2);
      }
    }
  }
  template <class Vector>
  void FloatVector(const char*, const Vector& values) {
    VectorCount(WireClass::kFloats, values.size());
    output.PutArray(values.data(), values.size());
  }
  void IntVector(const char*, const Column<std::int32_t>& values) {
    VectorCount(WireClass::kInts, values.size());
    output.PutArray(values.data(), values.size());
  }
  template <class Entity>
  void LongLongVector(const char*, const Column<Id<Entity>>& ids) {
    VectorCount(WireClass::kLongLongs, ids.size());
    output.PutArray(reinterpret_cast<const std::int64_t*>(ids.data()), ids.size());
  }
  template <class Vector>
  void UnsignedLongVector(const char*, const Vector& ids) {
    VectorCount(WireClass::kUnsignedLongs, ids.size());
    output.PutUnsignedLongs(reinterpret_cast<const std::uint64_t*>(ids.data()), ids.size());
  }

  void Bow(const char*, const BagOfWords& bow) {
    ClassInfo(WireClass::kBowVector);
    ClassCount(WireClass::kBowMap, bow.words.size());
    if (!bow.words.empty()) ClassInfo(WireClass::kBowPair);
    for (std::size_t i = 0; i < bow.words.size(); ++i) {
      output.Put(bow.words[i]);
      output.PutArray(&bow.weights[i], 1);
    }
  }
  void FeatureMap(const char*, const FeatureVector& vector) {
    ClassInfo(WireClass::kFeatureVector);
    ClassCount(WireClass::kFeatureMap, vector.nodes.size());
    if (!vector.nodes.empty()) ClassInfo(WireClass::kFeaturePair);
    const std::uint32_t* features = vector.features.data();
    for (std::size_t i = 0; i < vector.nodes.size(); ++i) {
      output.Put(vector.nodes[i]);
      VectorCount(WireClass::kUnsigneds, vector.sizes[i]);
      output.PutArray(features, vector.sizes[i]);
      features += vector.sizes[i];
    }
  }
  void Grid(const char*, const FeatureGrid& grid) {
    ClassCount(WireClass::kGrid, grid.column_sizes.size());
    const std::uint32_t* lengths = grid.cell_sizes.data();
    const std::uint64_t* keypoints = grid.keypoints.data();
    const std::uint64_t* const end = keypoints + grid.keypoints.size();
    for (const std::uint32_t cells : grid.column_sizes) {
      ClassCount(WireClass::kGridColumn, cells);
      if (cells > 0) classes.Register(WireClass::kSizes);
      const std::span column(lengths, cells);
      output.PutSizeVectors(column, keypoints, static_cast<std::size_t>(end - keypoints));
      keypoints = std::accumulate(column.begin(), column.end(), keypoints);
      lengths += cells;
    }
  }
  void Connections(const char*, const Column<Connection>& connections) {
    WeightCount(connections.size());
    output.PutWeights(connections.size(), [connection = connections.begin()]() mutable {
      const auto& [keyframe, weight] = *connection++;
      return std::pair(keyframe.value(), weight);
    });
  }
  // Two maps from one column; entries that one side lacks are left out of its map.
  void Observations(const char*, const char*, const Column<Observation>& observations) {
    PutSide(observations, &Observation::left);
    PutSide(observations, &Observation::right);
  }
  void Measurements(const char*, const Column<ImuMeasurement>& measurements) {
    ClassCount(WireClass::kMeasurementList, measurements.size());
    if (measurements.empty()) return;
    ClassInfo(WireClass::kMeasurement);
    output.PutArray(reinterpret_cast<const float*>(measurements.data()), measurements.size() * 7);
  }

 private:
  void PutMatrixHeader(std::int32_t columns, std::int32_t rows, std::int32_t type, std::uint8_t continuous) {
    output.Put(columns);
    output.Put(rows);
    output.Put(type);
    output.Put(continuous);
  }
  void PutDescriptors(const Descriptor* descriptors, std::size_t rows, MatrixForm form) {
    const bool has_columns = form == MatrixForm::kUsual || form == MatrixForm::kUsualNotContinuous;
    const bool continuous = form == MatrixForm::kUsual || form == MatrixForm::kEmptyContinuous;
    PutMatrixHeader(has_columns ? 32 : 0, static_cast<std::int32_t>(rows), 0, continuous ? 1 : 0);
    output.PutArray(reinterpret_cast<const std::uint8_t*>(descriptors), rows * sizeof(Descriptor));
  }
  void WeightCount(std::size_t count) {
    ClassCount(WireClass::kWeightMap, count);
    if (count > 0) ClassInfo(WireClass::kWeightPair);
  }
  void PutSide(const Column<Observation>& observations, std::int32_t Observation::*side) {
    std::size_t count = 0;
    for (const Observation& observation : observations) count += observation.*side != Observation::kAbsent;
    WeightCount(count);
    output.PutWeights(count, [observation = observations.begin(), side]() mutable {
      while ((*observation).*side == Observation::kAbsent) ++observation;
      const std::pair entry(observation->keyframe.value(), (*observation).*side);
      ++observation;
      return entry;
    });
  }
};

}  // namespace slamdb::orbslam3
