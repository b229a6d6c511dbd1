// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/row.h"

#include <algorithm>
#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"

namespace slamdb::postgresql {
namespace {

// In front of the elements: dimensions, whether there are NULLs, the type, and of the one dimension length and first
// index.
constexpr std::size_t kEmptyArray = 12, kArrayHeader = 20;

Bytes BytesOf(const Field& field) { return {field.data, static_cast<std::size_t>(std::max(field.size, 0))}; }

}  // namespace

void Row::ThrowLacks(std::size_t column) const {
  throw Error(ErrorKind::kInternal, origin_->path, origin_->place,
              detail::Concat("column ", column, " was asked for of ", fields_.size()));
}

void Row::ThrowDamaged(std::size_t column, const std::string& problem) const {
  throw Error(ErrorKind::kDamaged, origin_->path,
              detail::Concat(origin_->place, origin_->place.empty() ? "column " : ", column ", column), problem);
}

std::int64_t Row::Integer(std::size_t column) const {
  const Field& field = At(column);
  switch (field.size) {
    case Field::kNull:
      return 0;
    case 1:
      return BigEndian<std::uint8_t>(field.data);
    case 2:
      return BigEndian<std::int16_t>(field.data);
    case 4:
      return BigEndian<std::int32_t>(field.data);
    case 8:
      return BigEndian<std::int64_t>(field.data);
    default:
      ThrowDamaged(column, detail::Concat("expected an integer, found ", field.size, " bytes"));
  }
}

double Row::Real(std::size_t column) const {
  const Field& field = At(column);
  if (field.size == 8) return std::bit_cast<double>(BigEndian<std::uint64_t>(field.data));
  return static_cast<double>(Real32(column));
}

float Row::Real32(std::size_t column) const {
  const Field& field = At(column);
  if (field.size == Field::kNull) return std::numeric_limits<float>::quiet_NaN();
  if (field.size != 4) ThrowDamaged(column, detail::Concat("expected a real number, found ", field.size, " bytes"));
  return std::bit_cast<float>(BigEndian<std::uint32_t>(field.data));
}

std::string_view Row::Text(std::size_t column) const {
  const Bytes bytes = BytesOf(At(column));
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Bytes Row::Blob(std::size_t column) const { return BytesOf(At(column)); }

Bytes Row::Bits(std::size_t column) const {
  const Bytes bytes = BytesOf(At(column));
  constexpr std::size_t kCount = sizeof(std::uint32_t);
  if (bytes.size() < kCount || BigEndian<std::uint32_t>(bytes.data()) != 8 * (bytes.size() - kCount))
    ThrowDamaged(column, detail::Concat("expected bits, found ", bytes.size(), " bytes"));
  return bytes.subspan(kCount);
}

Bytes Row::Elements(std::size_t column, std::uint32_t element, std::size_t element_size) const {
  const Field& field = At(column);
  if (field.size == Field::kNull) return {};
  const Bytes bytes = BytesOf(field);
  if (bytes.size() < kEmptyArray) ThrowDamaged(column, "an array that ends in its header");
  const auto dimensions = BigEndian<std::uint32_t>(&bytes[0]);
  if (BigEndian<std::uint32_t>(&bytes[8]) != element) ThrowDamaged(column, "an array of another type");
  if (dimensions == 0 && bytes.size() == kEmptyArray) return {};
  if (dimensions != 1 || bytes.size() < kArrayHeader) ThrowDamaged(column, "an array that has not one dimension");
  const Bytes elements = bytes.subspan(kArrayHeader);
  const std::size_t step = sizeof(std::int32_t) + element_size;
  if (elements.size() % step != 0 || elements.size() / step != BigEndian<std::uint32_t>(&bytes[12]))
    ThrowDamaged(column, "an array with NULLs, or whose length is not that of its elements");
  for (std::size_t at = 0; at < elements.size(); at += step) {
    if (BigEndian<std::uint32_t>(&elements[at]) != element_size)
      ThrowDamaged(column, "an array with an element that has not the length of its type");
  }
  return elements;
}

}  // namespace slamdb::postgresql
