// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstring>
#include <string>
#include <type_traits>

#include "slamdb/model/detail/record.h"
#include "slamdb/model/fields.h"

// A field of the model as bits: elements of so many scalars, each as the bits that it has, so that NaNs and what is
// uninitialised survive. Private to the journal.
// The features of a landmark, which hold lists themselves, are the bytes of EncodeLandmarkFeatures; what is carried for
// a fork, those of EncodeCarried.
namespace slamdb::field_bits {

template <class T>
struct IsSequence : std::false_type {};
template <class T, class Allocator>
struct IsSequence<std::vector<T, Allocator>> : std::true_type {};
template <>
struct IsSequence<std::string> : std::true_type {};

template <class T>
inline constexpr bool kIsSequence = IsSequence<std::remove_const_t<T>>::value;
template <class T>
inline constexpr bool kIsMatrix = std::is_base_of_v<Eigen::MatrixBase<std::remove_const_t<T>>, std::remove_const_t<T>>;
template <class T>
struct IsReference : std::false_type {};
template <class Entity>
struct IsReference<Id<Entity>> : std::true_type {};

using LandmarkFeatures = std::vector<LandmarkFeature>;
inline std::vector<std::uint8_t> BytesOf(const LandmarkFeatures& features) {
  detail::ByteWriter writer;
  if (!features.empty()) detail::EncodeLandmarkFeatures(features, writer);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(writer.bytes().data());
  return {bytes, bytes + writer.bytes().size()};
}
// Throws Error when the bytes are not those of features.
inline LandmarkFeatures FeaturesOf(const std::vector<std::uint8_t>& bytes) {
  return bytes.empty() ? LandmarkFeatures() : detail::DecodeLandmarkFeatures(std::as_bytes(std::span(bytes)));
}

using CarriedField = Boxed<Carried>;
inline std::vector<std::uint8_t> BytesOf(const CarriedField& carried) {
  detail::ByteWriter writer;
  detail::EncodeCarried(carried, writer);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(writer.bytes().data());
  return {bytes, bytes + writer.bytes().size()};
}
// Throws Error when the bytes are not those of BytesOf.
inline void FromBytes(const std::vector<std::uint8_t>& bytes, LandmarkFeatures& features) {
  features = FeaturesOf(bytes);
}
inline void FromBytes(const std::vector<std::uint8_t>& bytes, CarriedField& carried) {
  carried = detail::DecodeCarried(std::as_bytes(std::span(bytes)));
}
// What is edited as bytes.
template <class T>
inline constexpr bool kIsRecord = std::is_same_v<T, LandmarkFeatures> || std::is_same_v<T, CarriedField>;

// visit(scalar) for each scalar of an element.
template <class Element, class Visit>
void ForEachScalar(Element& element, const Visit& visit) {
  using T = std::remove_const_t<Element>;
  if constexpr (std::is_same_v<T, Connection>) {
    visit(element.keyframe), visit(element.weight);
  } else if constexpr (std::is_same_v<T, Observation>) {
    visit(element.keyframe), visit(element.left), visit(element.right);
  } else if constexpr (std::is_same_v<T, RepeatedEntry>) {
    visit(element.position), visit(element.owner_map), visit(element.row);
  } else if constexpr (std::is_same_v<T, Keypoint>) {
    for (auto* value : {&element.angle, &element.response, &element.size, &element.x, &element.y}) visit(*value);
    visit(element.class_id), visit(element.octave);
  } else if constexpr (std::is_same_v<T, ImuMeasurement>) {
    for (auto* vector : {&element.acceleration, &element.angular_velocity})
      for (int i = 0; i < 3; ++i) visit((*vector)[i]);
    visit(element.duration);
  } else if constexpr (std::is_same_v<T, Rigid3f>) {
    for (int i = 0; i < 4; ++i) visit(element.rotation.coeffs()[i]);  // x y z w
    for (int i = 0; i < 3; ++i) visit(element.translation[i]);
  } else if constexpr (std::is_same_v<T, Descriptor>) {
    for (auto& byte : element) visit(byte);
  } else if constexpr (std::is_same_v<T, Flag>) {
    visit(element.recorded);
  } else {
    visit(element);
  }
}

// How a scalar is to be read: as Python's struct module names it, and r for a reference, an id.
template <class Scalar>
constexpr char KindOf() {
  if constexpr (IsReference<Scalar>::value) {
    return 'r';
  } else if constexpr (std::is_floating_point_v<Scalar>) {
    return sizeof(Scalar) == 4 ? 'f' : 'd';
  } else {
    if (sizeof(Scalar) == 1) return 'B';
    const bool is_signed = std::is_integral_v<Scalar> && std::is_signed_v<Scalar>;
    return sizeof(Scalar) == 4 ? (is_signed ? 'i' : 'I') : (is_signed ? 'q' : 'Q');
  }
}

template <class Scalar>
std::uint64_t ToBits(const Scalar& scalar) {
  std::uint64_t bits = 0;
  static_assert(sizeof(Scalar) <= sizeof(bits) && std::endian::native == std::endian::little);
  std::memcpy(&bits, &scalar, sizeof(Scalar));
  return bits;
}
template <class Scalar>
void FromBits(std::uint64_t bits, Scalar& scalar) {
  std::memcpy(static_cast<void*>(&scalar), &bits, sizeof(Scalar));
}

// A field as a sequence: a list has its elements, a matrix its coefficients column by column, everything else is one.
template <class Field>
std::size_t SizeOf(const Field& field) {
  if constexpr (kIsSequence<Field> || kIsMatrix<Field>)
    return static_cast<std::size_t>(field.size());
  else
    return 1;
}
template <class Field>
auto& ElementAt(Field& field, std::size_t i) {
  if constexpr (kIsSequence<Field>)
    return field[i];
  else if constexpr (kIsMatrix<Field>)
    return field.data()[i];
  else
    return field;
}

// The kinds of the scalars of one element: "rii" for an observation.
template <class Field>
std::string KindsOf() {
  std::string kinds;
  const auto add = [&](const auto& scalar) { kinds += KindOf<std::remove_cvref_t<decltype(scalar)>>(); };
  if constexpr (kIsSequence<Field>) {
    const typename Field::value_type element{};
    ForEachScalar(element, add);
  } else if constexpr (kIsMatrix<Field>) {
    kinds = KindOf<typename Field::Scalar>();
  } else {
    const Field field{};
    ForEachScalar(field, add);
  }
  return kinds;
}

template <class Element>
void AppendBits(const Element& element, std::vector<std::uint64_t>& bits) {
  ForEachScalar(element, [&](const auto& scalar) { bits.push_back(ToBits(scalar)); });
}

template <class Element>
bool SameElement(const Element& a, const Element& b) {
  if constexpr (std::has_unique_object_representations_v<Element> || !std::is_class_v<Element> ||
                std::is_same_v<Element, Keypoint> || std::is_same_v<Element, ImuMeasurement> ||
                std::is_same_v<Element, Rigid3f>)
    return std::memcmp(&a, &b, sizeof(Element)) == 0;
  else
    return a == b;  // has padding
}

// Whether two fields hold the same bits.
template <class Field>
requires kIsRecord<Field>
bool SameField(const Field& a, const Field& b) { return BytesOf(a) == BytesOf(b); }
template <class Field>
bool SameField(const Field& a, const Field& b) {
  const std::size_t size = SizeOf(a);
  if (size != SizeOf(b)) return false;
  for (std::size_t i = 0; i < size; ++i)
    if (!SameElement(ElementAt(a, i), ElementAt(b, i))) return false;
  return true;
}

}  // namespace slamdb::field_bits
