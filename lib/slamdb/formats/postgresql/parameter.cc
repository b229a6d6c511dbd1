// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/parameter.h"

#include <bit>

#include "slamdb/formats/postgresql/detail/encode.h"

namespace slamdb::postgresql {
namespace {

template <std::integral Integer>
std::string BigEndianText(Integer value) {
  std::string bytes;
  AppendBigEndian(bytes, value);
  return bytes;
}

std::string TextOf(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

// Of elements that have data() and size().
template <class Element>
std::string ArrayText(std::uint32_t type, std::span<const Element> elements) {
  std::string bytes;
  AppendArray(bytes, type, elements,
              [](std::string& out, const Element& element) { AppendField(out, element.data(), element.size()); });
  return bytes;
}

template <std::integral Integer>
std::string IntegersText(std::span<const Integer> values) {
  std::string bytes;
  AppendIntegers(bytes, values);
  return bytes;
}

}  // namespace

Parameter::Parameter(std::int64_t value) : Parameter(oid::kInt8, BigEndianText(value), false) {}
Parameter::Parameter(bool value) : Parameter(oid::kBool, std::string(1, value ? '\1' : '\0'), false) {}
Parameter::Parameter(double value)
    : Parameter(oid::kFloat8, BigEndianText(std::bit_cast<std::uint64_t>(value)), false) {}
Parameter::Parameter(std::string_view text) : Parameter(oid::kText, std::string(text), false) {}
Parameter::Parameter(Bytes blob) : Parameter(oid::kBytea, TextOf(blob), false) {}
Parameter::Parameter(const Uuid& uuid) : Parameter(oid::kUuid, TextOf(uuid), false) {}
Parameter::Parameter(std::span<const std::int64_t> values) : Parameter(oid::kInt8Array, IntegersText(values), false) {}
Parameter::Parameter(std::span<const std::int32_t> values) : Parameter(oid::kInt4Array, IntegersText(values), false) {}
Parameter::Parameter(std::span<const std::string> texts)
    : Parameter(oid::kTextArray, ArrayText(oid::kText, texts), false) {}
Parameter::Parameter(std::span<const Bytes> blobs)
    : Parameter(oid::kByteaArray, ArrayText(oid::kBytea, blobs), false) {}
Parameter::Parameter(std::span<const Uuid> uuids) : Parameter(oid::kUuidArray, ArrayText(oid::kUuid, uuids), false) {}

Parameter Parameter::Bits(Bytes bits) { return Parameter(oid::kBit, BitsText(bits), false); }

}  // namespace slamdb::postgresql
