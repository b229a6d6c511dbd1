// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <type_traits>
#include <vector>

#include "slamdb/model/detail/packing.h"
#include "slamdb/model/detail/record.h"
#include "slamdb/model/fields.h"

// How a field of any type stands in a record: numbers, ids, flags and enumerators as they are, matrices column by
// column, a quaternion x y z w, a list as its length and its elements.
namespace slamdb::detail {

class RecordWriter {
 public:
  explicit RecordWriter(ByteWriter& out) : out_(out) {}

  template <class T>
  void Field(const T& value) {
    out_.Put(value);
  }
  template <class Scalar, int kRows, int kColumns>
  void Field(const Eigen::Matrix<Scalar, kRows, kColumns>& matrix) {
    out_.PutBytes(std::as_bytes(std::span(matrix.data(), static_cast<std::size_t>(kRows * kColumns))));
  }
  void Field(const Quaternionf& rotation) { Field(Eigen::Vector4f(rotation.coeffs())); }
  void Field(const Rigid3f& pose) {
    Field(pose.rotation);
    Field(pose.translation);
  }
  template <class T, class Allocator>
  void Field(const std::vector<T, Allocator>& values) {
    out_.PutVector(values);
  }
  void Field(const std::vector<FeatureDescriptor>& descriptors) {
    Field(static_cast<std::uint8_t>(descriptors.size()));
    for (const FeatureDescriptor& descriptor : descriptors) {
      Field(descriptor.kind);
      Field(descriptor.bytes);
    }
  }
  void Field(const std::vector<LandmarkFeature>& features) { EncodeLandmarkFeatures(features, out_); }
  // Nothing for null, so that hashes of what has none are what they were.
  void Field(const Boxed<Carried>& carried) { EncodeCarried(carried, out_); }
  void Field(const std::vector<RepeatedEntry>& entries) {
    Field(static_cast<std::uint64_t>(entries.size()));
    for (const RepeatedEntry& entry : entries) {
      Field(entry.position);
      Field(entry.owner_map);
      Field(entry.row);
    }
  }
  void Field(const std::string& text) {
    Field(static_cast<std::uint64_t>(text.size()));
    out_.PutBytes(std::as_bytes(std::span(text)));
  }

 private:
  ByteWriter& out_;
};

// Reads what RecordWriter wrote, as far as anything is read back.
class RecordReader {
 public:
  explicit RecordReader(ByteReader& in) : in_(in) {}

  template <class T>
  void Field(T& value) {
    value = in_.Get<T>();
  }
  void Field(bool& value) { value = in_.Get<std::uint8_t>() != 0; }
  template <class Scalar, int kRows, int kColumns>
  void Field(Eigen::Matrix<Scalar, kRows, kColumns>& matrix) {
    std::memcpy(matrix.data(), in_.TakeArray(kRows * kColumns, sizeof(Scalar)), kRows * kColumns * sizeof(Scalar));
  }
  void Field(Quaternionf& rotation) {
    Eigen::Vector4f coefficients;
    Field(coefficients);
    rotation.coeffs() = coefficients;
  }
  void Field(Rigid3f& pose) {
    Field(pose.rotation);
    Field(pose.translation);
  }
  template <class T, class Allocator>
  void Field(std::vector<T, Allocator>& values) {
    in_.GetVector(values);
  }
  void Field(std::vector<FeatureDescriptor>& descriptors) {
    descriptors.resize(in_.Get<std::uint8_t>());
    for (FeatureDescriptor& descriptor : descriptors) {
      descriptor.kind = static_cast<DescriptorKind>(in_.Get<std::uint8_t>() & 7);
      Field(descriptor.bytes);
    }
  }

 private:
  ByteReader& in_;
};

// A visitor for the walks of fields.h that gives every field of `entity` to `codec`.
template <class Codec, class Entity>
auto EachTo(Codec& codec, Entity& entity) {
  return [&codec, &entity](std::string_view, auto... members) { codec.Field(Member(entity, members...)); };
}

}  // namespace slamdb::detail
