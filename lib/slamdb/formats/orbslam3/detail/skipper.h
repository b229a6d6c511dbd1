// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/orbslam3/detail/reading_archive.h"

namespace slamdb::orbslam3 {

// Passes over records without decoding them; runs ahead of the decoders to find where each record begins.
template <class Input>
class Skipper : public ReadingArchive<Input> {
 public:
  using ReadingArchive<Input>::ReadingArchive;

  void Begin(Part) {}
  template <class Entity>
  void Identity(const char* name, const Id<Entity>&) {
    Field(name);
    this->input.place.id = this->input.TakeUnsignedLong();
  }
  template <class Value>
  void UnsignedLong(const char* name, const Value&) {
    Field(name);
    this->input.SkipUnsignedLongs(1);
  }
  void Long(const char* name, std::int64_t) {
    Field(name);
    this->input.SkipUnsignedLongs(1);
  }
  template <class Value>
  void LongLong(const char* name, const Value&) {
    Skip<std::int64_t>(name, 1);
  }
  void CameraReference(const char* name, const CameraId&) { Skip<std::uint32_t>(name, 1); }
  void Int(const char* name, std::int32_t) { Skip<std::int32_t>(name, 1); }
  void Unsigned(const char* name, std::uint32_t) { Skip<std::uint32_t>(name, 1); }
  void Float(const char* name, float) { Skip<float>(name, 1); }
  void Double(const char* name, double) { Skip<double>(name, 1); }
  void Bool(const char* name, const Flag&) { Skip<std::uint8_t>(name, 1); }
  template <class Derived>
  void Floats(const char* name, const Eigen::PlainObjectBase<Derived>& values) {
    Skip<float>(name, static_cast<std::size_t>(values.size()));
  }
  void Pose(const char* name, const Rigid3f&) { Skip<float>(name, 7); }
  void MatrixValue(const char* name, const Matrix&) {
    Field(name);
    Matrix header;
    this->input.template SkipArray<std::uint8_t>(this->MatrixBytes(header));
  }
  void Descriptors(const char* name, const Column<Descriptor>&, MatrixForm, const Boxed<Carried>&) {
    SkipDescriptors(name);
  }
  void PointDescriptor(const char* name, const Descriptor&, MatrixForm, const Boxed<Carried>&) {
    SkipDescriptors(name);
  }
  void Keypoints(const char* name, const Column<Keypoint>&) {
    Field(name);
    this->input.template SkipArray<float>(this->KeypointCount() * 7);
  }
  template <class Vector>
  void FloatVector(const char* name, const Vector&) {
    SkipVector<float>(name, WireClass::kFloats);
  }
  void IntVector(const char* name, const Column<std::int32_t>&) { SkipVector<std::int32_t>(name, WireClass::kInts); }
  template <class Vector>
  void LongLongVector(const char* name, const Vector&) {
    SkipVector<std::int64_t>(name, WireClass::kLongLongs);
  }
  template <class Vector>
  void UnsignedLongVector(const char* name, const Vector&) {
    Field(name);
    this->input.SkipUnsignedLongs(this->UnsignedLongCount());
  }
  void Bow(const char* name, const BagOfWords&) {
    Field(name);
    this->SkipBowEntries(this->BowCount());
  }
  void FeatureMap(const char* name, const FeatureVector&) {
    Field(name);
    this->ClassInfo(WireClass::kFeatureVector);
    const std::uint64_t count = this->ClassCount(WireClass::kFeatureMap, 8, 2);
    if (count == 0) return;
    this->ClassInfo(WireClass::kFeaturePair);
    for (std::uint64_t i = 0; i < count; ++i) {
      this->input.template SkipArray<std::uint32_t>(1);
      this->input.template SkipArray<std::uint32_t>(this->VectorCount(WireClass::kUnsigneds, sizeof(std::uint32_t)));
    }
  }
  void Grid(const char* name, const FeatureGrid&) {
    Field(name);
    const std::uint64_t columns = this->ClassCount(WireClass::kGrid, 8, 2);
    for (std::uint64_t column = 0; column < columns; ++column) {
      const std::uint64_t cells = this->ClassCount(WireClass::kGridColumn, this->input.encoding().size_bytes, 2);
      if (cells > 0) this->classes.Register(WireClass::kSizes);
      this->SkipGridColumn(cells);
    }
  }
  void Connections(const char* name, const Column<Connection>&) { SkipWeights(name); }
  void Observations(const char* left_name, const char* right_name, const Column<Observation>&) {
    SkipWeights(left_name);
    SkipWeights(right_name);
  }
  void Measurements(const char* name, const Column<ImuMeasurement>&) {
    Field(name);
    const std::uint64_t count = this->ClassCount(WireClass::kMeasurementList, sizeof(ImuMeasurement), 7);
    if (count == 0) return;
    this->ClassInfo(WireClass::kMeasurement);
    this->input.template SkipArray<float>(count * 7);
  }

 private:
  void Field(const char* name) { this->input.place.field = name; }
  template <class T>
  void Skip(const char* name, std::size_t count) {
    Field(name);
    this->input.template SkipArray<T>(count);
  }
  template <class T>
  void SkipVector(const char* name, WireClass wire_class) {
    Field(name);
    this->input.template SkipArray<T>(this->VectorCount(wire_class, sizeof(T)));
  }
  void SkipDescriptors(const char* name) {
    Field(name);
    MatrixForm form;
    Matrix other;
    const std::uint64_t rows = this->DescriptorRows(&form, other);
    this->input.template SkipArray<std::uint8_t>(other.columns != 0 ? this->DataBytes(other)
                                                                    : rows * sizeof(Descriptor));
  }
  void SkipWeights(const char* name) {
    Field(name);
    this->input.SkipWeights(this->WeightCount());
  }
};

}  // namespace slamdb::orbslam3
