// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/row_pack.h"

#include <zlib.h>

#include <algorithm>
#include <limits>

#include "slamdb/base/detail/concat.h"

namespace slamdb::sqlite {
namespace {

using detail::ByteReader;
using detail::ByteWriter;

constexpr std::uint8_t kLayout = 1;
constexpr std::size_t kLeastDeflated = 256;                   // shorter blobs gain nothing
constexpr std::size_t kMostDeflated = std::size_t{16} << 20;  // larger ones would cost memory before they prove damaged

enum class Tag : std::uint8_t {
  kNull,
  kInteger8,
  kInteger16,
  kInteger32,
  kInteger64,
  kFloat,
  kDouble,
  kText,
  kBlob,
  kDeflated
};

template <class Narrow>
bool Fits(std::int64_t value) {
  return value >= std::numeric_limits<Narrow>::min() && value <= std::numeric_limits<Narrow>::max();
}

template <class Number>
void PutTagged(ByteWriter& out, Tag tag, Number value) {
  out.Put(tag);
  out.Put(value);
}

void PutInteger(ByteWriter& out, std::int64_t value) {
  if (Fits<std::int8_t>(value)) return PutTagged(out, Tag::kInteger8, static_cast<std::int8_t>(value));
  if (Fits<std::int16_t>(value)) return PutTagged(out, Tag::kInteger16, static_cast<std::int16_t>(value));
  if (Fits<std::int32_t>(value)) return PutTagged(out, Tag::kInteger32, static_cast<std::int32_t>(value));
  PutTagged(out, Tag::kInteger64, value);
}

void PutReal(ByteWriter& out, double value) {
  const auto narrow = static_cast<float>(value);
  if (static_cast<double>(narrow) == value) return PutTagged(out, Tag::kFloat, narrow);
  PutTagged(out, Tag::kDouble, value);
}

void PutSized(ByteWriter& out, Tag tag, Bytes bytes) {
  out.Put(tag);
  out.Put(static_cast<std::uint32_t>(bytes.size()));
  out.PutBytes(bytes);
}

// Deflated where that makes it shorter: what a keyframe records of its camera and grid is mostly zeros and repetition.
void PutBlob(ByteWriter& out, Bytes bytes) {
  if (bytes.size() < kLeastDeflated || bytes.size() > kMostDeflated) return PutSized(out, Tag::kBlob, bytes);
  std::string packed(compressBound(bytes.size()), '\0');
  uLongf size = packed.size();
  const int code = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                             reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), Z_BEST_SPEED);
  if (code != Z_OK || size >= bytes.size()) return PutSized(out, Tag::kBlob, bytes);
  out.Put(Tag::kDeflated);
  out.Put(static_cast<std::uint32_t>(bytes.size()));
  out.Put(static_cast<std::uint32_t>(size));
  out.PutBytes(std::as_bytes(std::span(packed).first(size)));
}

void PutValue(ByteWriter& out, const Statement& row, int column) {
  switch (row.Type(column)) {
    case SQLITE_INTEGER:
      return PutInteger(out, row.Integer(column));
    case SQLITE_FLOAT:
      return PutReal(out, row.Real(column));
    case SQLITE_TEXT: {
      const std::string text = row.Text(column);
      return PutSized(out, Tag::kText, std::as_bytes(std::span(text)));
    }
    case SQLITE_BLOB:
      return PutBlob(out, row.Blob(column));
    default:
      out.Put(Tag::kNull);
  }
}

std::string Inflate(ByteReader& in) {
  const auto size = in.Get<std::uint32_t>();
  const auto packed_size = in.Get<std::uint32_t>();
  const std::byte* packed = in.Take(packed_size);
  constexpr std::size_t kMostInflation = 1032;  // what deflate can do
  if (size / kMostInflation > packed_size || size > kMostDeflated)
    throw Error(ErrorKind::kDamaged, detail::Concat(packed_size, " bytes do not hold ", size));
  std::string bytes(size, '\0');
  uLongf written = size;
  const int code =
      uncompress(reinterpret_cast<Bytef*>(bytes.data()), &written, reinterpret_cast<const Bytef*>(packed), packed_size);
  if (code != Z_OK || written != size) throw Error(ErrorKind::kDamaged, "deflated bytes do not inflate");
  return bytes;
}

Bytes TakeSized(ByteReader& in) {
  const auto size = in.Get<std::uint32_t>();
  return {in.Take(size), size};
}

// Binds the next value to a column. What it inflates lives in `inflated`.
void BindValue(ByteReader& in, Statement& insert, int column, std::string& inflated) {
  switch (const auto tag = in.Get<Tag>()) {
    case Tag::kNull:
      insert.BindNull(column);
      return;
    case Tag::kInteger8:
      insert.Bind(column, std::int64_t{in.Get<std::int8_t>()});
      return;
    case Tag::kInteger16:
      insert.Bind(column, std::int64_t{in.Get<std::int16_t>()});
      return;
    case Tag::kInteger32:
      insert.Bind(column, std::int64_t{in.Get<std::int32_t>()});
      return;
    case Tag::kInteger64:
      insert.Bind(column, in.Get<std::int64_t>());
      return;
    case Tag::kFloat:
      insert.BindReal(column, in.Get<float>());
      return;
    case Tag::kDouble:
      insert.BindReal(column, in.Get<double>());
      return;
    case Tag::kText: {
      const Bytes text = TakeSized(in);
      insert.BindText(column, {reinterpret_cast<const char*>(text.data()), text.size()});
      return;
    }
    case Tag::kBlob:
      insert.BindBlob(column, TakeSized(in));
      return;
    case Tag::kDeflated:
      inflated = Inflate(in);
      insert.BindBlob(column, std::as_bytes(std::span(inflated)));
      return;
    default:
      throw Error(ErrorKind::kDamaged, detail::Concat("a value of kind ", static_cast<int>(tag)));
  }
}

int ColumnsOf(Database& database, std::string_view table) {
  Statement statement(database, "SELECT count(*) FROM pragma_table_info(?1)");
  return statement.BindText(1, table).Step() ? static_cast<int>(statement.Integer(0)) : 0;
}

Statement MakeInsert(Database& database, std::string_view table, int columns) {
  std::string sql = detail::Concat("INSERT INTO ", table, " VALUES (?1");
  for (int i = 2; i <= columns; ++i) sql += detail::Concat(", ?", i);
  return {database, sql + ")", detail::Concat("table ", table)};
}

}  // namespace

void PackRows(Statement& select, ByteWriter& out) {
  for (bool first = true; select.Step(); first = false) {
    const int columns = select.Columns();
    if (first) {
      out.Put(kLayout);
      out.Put(static_cast<std::uint8_t>(columns));
    }
    for (int i = 0; i < columns; ++i) PutValue(out, select, i);
  }
  select.Reset();
}

PackedRows::PackedRows(Database& database, std::string_view table)
    : columns_(ColumnsOf(database, table)),
      insert_(MakeInsert(database, table, columns_)),
      inflated_(static_cast<std::size_t>(columns_)) {}

void PackedRows::Insert(Bytes rows) {
  if (rows.empty()) return;
  ByteReader in(rows);
  if (const int layout = in.Get<std::uint8_t>(); layout != kLayout)
    throw Error(ErrorKind::kDamaged, detail::Concat("rows of layout ", layout, ", expected ", int{kLayout}));
  const int columns = in.Get<std::uint8_t>();
  if (columns == 0 || columns > columns_)
    throw Error(ErrorKind::kDamaged, detail::Concat("rows of ", columns, " columns, the table has ", columns_));
  while (in.left() > 0) {
    for (int i = 1; i <= columns; ++i) BindValue(in, insert_, i, inflated_[static_cast<std::size_t>(i - 1)]);
    for (int i = columns + 1; i <= columns_; ++i) insert_.BindNull(i);
    insert_.Run();
  }
}

}  // namespace slamdb::sqlite
