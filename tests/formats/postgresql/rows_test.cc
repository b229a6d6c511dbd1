// SPDX-License-Identifier: BSD-3-Clause
// Bytes of rows, without a server: what is encoded is read again, and what is damaged is refused.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "slamdb/formats/postgresql/detail/copy_rows.h"
#include "slamdb/formats/postgresql/detail/encode.h"
#include "tests/support/error_of.h"
#include "tests/support/kind_of.h"

namespace slamdb::postgresql {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::vector<Type> kTypes = {Type::kInt8,   Type::kInt4,      Type::kInt2,     Type::kBool,
                                  Type::kFloat8, Type::kFloat4,    Type::kText,     Type::kBytea,
                                  Type::kUuid,   Type::kInt8Array, Type::kInt4Array};

Bytes BytesOf(std::string_view text) { return std::as_bytes(std::span(text)); }

// A row of each type, and one of NULLs.
std::string Encoded() {
  constexpr std::string_view kUuid = "0123456789abcdef";
  RowEncoder encoder({"server", "table all"}, kTypes);
  encoder.Begin();
  for (const Value& value :
       {Value(std::int64_t{-1} << 40), Value(std::int64_t{-7}), Value(std::int64_t{-2}), Value(std::int64_t{1}),
        Value(-0.0), Value(0.25), Value(std::string_view("text")), Value(BytesOf("blob")), Value(BytesOf(kUuid))})
    encoder.Put(value);
  encoder.Put(std::vector<std::int64_t>{1, -2, std::int64_t{3} << 40});
  encoder.Put(std::vector<std::int32_t>{});
  encoder.End();
  encoder.Begin();
  for (std::size_t i = 0; i < kTypes.size(); ++i) encoder.PutNull();
  encoder.End();
  encoder.AppendTrailer();
  EXPECT_EQ(encoder.rows(), 2);
  return encoder.bytes();
}

// Reads all of a copy that comes in one message, and everything in it; gives how many rows.
int ReadAll(std::string_view copy) {
  CopyRows rows({"server", "table all"});
  rows.Take(BytesOf(copy));
  int count = 0;
  for (; rows.Next(); ++count) {
    const Row row = rows.row();
    std::vector<std::int64_t> longs;
    std::vector<std::int32_t> ints;
    for (std::size_t column : {0, 1, 2, 3}) row.Integer(column);
    for (std::size_t column : {4, 5}) row.Real(column);
    row.Real32(5);
    row.Text(6);
    for (std::size_t column : {7, 8}) row.Blob(column);
    row.Integers64(9, longs);
    row.Integers32(10, ints);
  }
  rows.CheckEnd();
  return count;
}

TEST(Rows, WhatIsEncodedIsRead) {
  const std::string copy = Encoded();
  CopyRows rows({"server", ""});
  rows.Take(BytesOf(copy));
  ASSERT_TRUE(rows.Next());
  const Row row = rows.row();
  EXPECT_EQ(row.Integer(0), std::int64_t{-1} << 40);
  EXPECT_EQ(row.Integer(1), -7);
  EXPECT_EQ(row.Integer(2), -2);
  EXPECT_EQ(row.Integer(3), 1);
  EXPECT_TRUE(row.Real(4) == 0 && std::signbit(row.Real(4)));
  EXPECT_EQ(row.Real(5), 0.25);
  EXPECT_EQ(row.Text(6), "text");
  EXPECT_EQ(row.Blob(7).size(), 4U);
  EXPECT_EQ(row.Blob(8).size(), 16U);
  std::vector<std::int64_t> longs = {9};
  row.Integers64(9, longs);
  EXPECT_THAT(longs, ElementsAre(9, 1, -2, std::int64_t{3} << 40));
  std::vector<std::int32_t> ints;
  row.Integers32(10, ints);
  EXPECT_THAT(ints, ElementsAre());
}

TEST(Rows, NullIsNothing) {
  const std::string copy = Encoded();
  CopyRows rows({"server", ""});
  rows.Take(BytesOf(copy));
  ASSERT_TRUE(rows.Next() && rows.Next());
  const Row row = rows.row();
  std::vector<std::int64_t> longs = {9};
  for (std::size_t column = 0; column < kTypes.size(); ++column) EXPECT_TRUE(row.IsNull(column));
  EXPECT_EQ(row.Integer(0), 0);
  EXPECT_TRUE(std::isnan(row.Real(4)) && std::isnan(row.Real(5)));
  EXPECT_TRUE(row.Text(6).empty() && row.Blob(7).empty());
  row.Integers64(9, longs);
  EXPECT_THAT(longs, ElementsAre(9));
  EXPECT_FALSE(rows.Next());
  rows.CheckEnd();
}

TEST(Rows, BitsOfNansStay) {
  for (const std::uint32_t bits : {0x7fc00000U, 0xffc12345U, 0x7f800001U, 0x80000000U, 0x00000001U}) {
    RowEncoder encoder({"server", ""}, {Type::kFloat4, Type::kFloat8});
    encoder.Begin();
    encoder.PutReal32(std::bit_cast<float>(bits));
    const std::uint64_t wide = std::uint64_t{bits} << 32U | 1U;
    encoder.Put(std::bit_cast<double>(wide));
    encoder.End();
    CopyRows rows({"server", ""});
    rows.Take(BytesOf(encoder.bytes()));
    ASSERT_TRUE(rows.Next());
    EXPECT_EQ(std::bit_cast<std::uint32_t>(rows.row().Real32(0)), bits);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(rows.row().Real(1)), wide);
  }
}

TEST(Rows, EveryCutIsSeen) {
  const std::string copy = Encoded();
  ASSERT_EQ(ReadAll(copy), 2);
  for (std::size_t size = 0; size < copy.size(); ++size)
    EXPECT_EQ(KindOf([&] { ReadAll(std::string_view(copy).substr(0, size)); }), ErrorKind::kDamaged) << size;
  EXPECT_EQ(KindOf([&] { ReadAll(copy + '\0'); }), ErrorKind::kDamaged);
}

// A row that lacks columns is a fault of the statement, and so may be kInternal; nothing else but kDamaged.
TEST(Rows, NoByteMakesItReadBeyond) {
  const std::string copy = Encoded();
  for (std::size_t at = 0; at < copy.size(); ++at) {
    for (const int bits : {0x01, 0x80, 0xff, 0x04}) {
      std::string garbled = copy;
      garbled[at] = static_cast<char>(garbled[at] ^ bits);
      try {
        ReadAll(std::string(garbled));  // of exactly its size, for sanitizers
      } catch (const Error& error) {
        EXPECT_THAT(error.kind(), ::testing::AnyOf(ErrorKind::kDamaged, ErrorKind::kInternal)) << at;
      }
    }
  }
}

// An array column alone, as its bytes are.
Error ReadingArray(const std::string& bytes) {
  const RowOrigin origin{"server", "table link"};
  const Field field{reinterpret_cast<const std::byte*>(bytes.data()), static_cast<std::int32_t>(bytes.size())};
  return ErrorOf([&] {
    std::vector<std::int64_t> values;
    Row({&field, 1}, origin).Integers64(0, values);
  });
}

std::string Array(std::initializer_list<std::uint32_t> numbers) {
  std::string bytes;
  for (const std::uint32_t number : numbers) AppendBigEndian(bytes, number);
  return bytes;
}

TEST(Rows, ArraysThatAreNoneAreDamage) {
  EXPECT_EQ(ReadingArray(Array({1, 0, 20, 1, 1, 8, 0, 5})).problem(), "no error");
  EXPECT_EQ(ReadingArray(Array({0, 0, 20})).problem(), "no error");
  struct Case {
    std::string bytes;
    const char* says;
  };
  for (const Case& one :
       {Case{"", "ends in its header"}, Case{Array({1, 0}), "ends in its header"},
        Case{Array({1, 0, 23, 1, 1, 8, 0, 5}), "another type"},
        Case{Array({2, 0, 20, 1, 1, 1, 1, 8, 0, 5}), "one dimension"}, Case{Array({0, 0, 20, 1}), "one dimension"},
        Case{Array({1, 0, 20, 1}), "one dimension"}, Case{Array({1, 1, 20, 1, 1, 0xffffffff}), "NULLs"},
        Case{Array({1, 0, 20, 2, 1, 8, 0, 5}), "length"}, Case{Array({1, 0, 20, 0xffffffff, 1, 8, 0, 5}), "length"},
        Case{Array({1, 0, 20, 1, 1, 4, 0, 5}), "length of its type"}}) {
    const Error error = ReadingArray(one.bytes);
    EXPECT_EQ(error.kind(), ErrorKind::kDamaged);
    EXPECT_THAT(error.problem(), HasSubstr(one.says));
    EXPECT_EQ(error.place(), "table link, column 0");
  }
}

TEST(Rows, ValuesThatAreOfAnotherLengthAreDamage) {
  const std::string bytes = "abc";
  const RowOrigin origin{"server", ""};
  const Field field{reinterpret_cast<const std::byte*>(bytes.data()), 3};
  const Row row({&field, 1}, origin);
  EXPECT_EQ(KindOf([&] { row.Integer(0); }), ErrorKind::kDamaged);
  EXPECT_EQ(KindOf([&] { row.Real(0); }), ErrorKind::kDamaged);
  EXPECT_EQ(KindOf([&] { row.Real32(0); }), ErrorKind::kDamaged);
  EXPECT_EQ(KindOf([&] { row.Integer(1); }), ErrorKind::kInternal);
}

TEST(Rows, ValuesThatDoNotGoWithTheirColumnAreRefused) {
  const auto put = [](Type type, const Value& value) {
    return KindOf([&] {
      RowEncoder encoder({"server", "table t"}, {type});
      encoder.Add(std::array{value});
    });
  };
  EXPECT_EQ(put(Type::kInt4, Value(std::int64_t{1} << 31)), ErrorKind::kNotPossible);
  EXPECT_EQ(put(Type::kInt2, Value(std::int64_t{-32769})), ErrorKind::kNotPossible);
  EXPECT_EQ(put(Type::kInt2, Value(std::int64_t{-32768})), std::nullopt);
  EXPECT_EQ(put(Type::kFloat4, Value(0.1)), ErrorKind::kInternal);
  EXPECT_EQ(put(Type::kFloat4, Value(static_cast<double>(0.1F))), std::nullopt);
  EXPECT_EQ(put(Type::kFloat4, Value(std::numeric_limits<double>::quiet_NaN())), std::nullopt);
  EXPECT_EQ(put(Type::kFloat4, Value(-std::numeric_limits<double>::infinity())), std::nullopt);
  EXPECT_EQ(put(Type::kInt8, Value(1.0)), ErrorKind::kInternal);
  EXPECT_EQ(put(Type::kText, Value(BytesOf("blob"))), ErrorKind::kInternal);
  EXPECT_EQ(put(Type::kBytea, Value(std::string_view("text"))), ErrorKind::kInternal);
  EXPECT_EQ(put(Type::kUuid, Value(BytesOf("short"))), ErrorKind::kInternal);
  RowEncoder encoder({"server", "table t"}, {Type::kInt8});
  encoder.Begin();
  EXPECT_EQ(KindOf([&] { encoder.End(); }), ErrorKind::kInternal);
  encoder.Put(std::int64_t{1});
  EXPECT_EQ(KindOf([&] { encoder.Put(std::int64_t{2}); }), ErrorKind::kInternal);
}

}  // namespace
}  // namespace slamdb::postgresql
