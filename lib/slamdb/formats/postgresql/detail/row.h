// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "slamdb/base/file.h"
#include "slamdb/formats/postgresql/detail/big_endian.h"
#include "slamdb/formats/postgresql/detail/types.h"

namespace slamdb::postgresql {

// The bytes of one column as the server sent them. Not owned.
struct Field {
  const std::byte* data = nullptr;
  std::int32_t size = kNull;

  static constexpr std::int32_t kNull = -1;
};

// Where a row comes from, for errors.
struct RowOrigin {
  std::string path;   // the server's, without password
  std::string place;  // `table map_point`; may be empty
};

// A row of a result or of a copy, in binary. Valid as long as what it came from.
//
// A server is trusted no more than a file is: what has not the length of its type throws Error (kDamaged). A column
// that the row lacks is a fault of the caller, and throws Error (kInternal).
class Row {
 public:
  Row(std::span<const Field> fields, const RowOrigin& origin) : fields_(fields), origin_(&origin) {}

  std::size_t columns() const { return fields_.size(); }
  std::span<const Field> fields() const { return fields_; }
  const RowOrigin& origin() const { return *origin_; }
  bool IsNull(std::size_t column) const { return At(column).size == Field::kNull; }
  std::int64_t Integer(std::size_t column) const;  // bool, int2, int4, int8; 0 for NULL
  double Real(std::size_t column) const;           // float4, float8; NaN for NULL
  float Real32(std::size_t column) const;          // float4, every bit of NaNs too; NaN for NULL
  std::string_view Text(std::size_t column) const;
  Bytes Blob(std::size_t column) const;  // bytea, uuid
  Bytes Bits(std::size_t column) const;  // bit(n), eight of a byte

  // Appends an array of one dimension without NULLs: int8[], int4[]. NULL appends nothing.
  template <class Vector>
  void Integers64(std::size_t column, Vector& out) const {
    AppendIntegers<std::int64_t>(column, oid::kInt8, out);
  }
  template <class Vector>
  void Integers32(std::size_t column, Vector& out) const {
    AppendIntegers<std::int32_t>(column, oid::kInt4, out);
  }

 private:
  const Field& At(std::size_t column) const {
    if (column >= fields_.size()) ThrowLacks(column);
    return fields_[column];
  }
  // The elements of an array, each with its length in front, which is that of the type: checked. `element` is the type.
  Bytes Elements(std::size_t column, std::uint32_t element, std::size_t element_size) const;
  [[noreturn]] void ThrowLacks(std::size_t column) const;
  [[noreturn]] void ThrowDamaged(std::size_t column, const std::string& problem) const;

  template <class Integer, class Vector>
  void AppendIntegers(std::size_t column, std::uint32_t element, Vector& out) const {
    constexpr std::size_t kStep = sizeof(std::int32_t) + sizeof(Integer);
    const Bytes elements = Elements(column, element, sizeof(Integer));
    const std::size_t before = out.size();
    out.resize(before + elements.size() / kStep);
    for (std::size_t i = before, at = sizeof(std::int32_t); i < out.size(); ++i, at += kStep)
      out[i] = static_cast<typename Vector::value_type>(BigEndian<Integer>(&elements[at]));
  }

  std::span<const Field> fields_;
  const RowOrigin* origin_;
};

}  // namespace slamdb::postgresql
