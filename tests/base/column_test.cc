// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/column.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <numeric>
#include <thread>

namespace slamdb {
namespace {

TEST(Column, HoldsWhatIsPutInAtEverySize) {
  for (const std::size_t size : {0U, 1U, 15U, 1000U, 65536U, 131072U, 524288U, 3000000U}) {
    Column<std::uint32_t> column(size);
    std::iota(column.begin(), column.end(), 7U);
    const Column<std::uint32_t> copy = column;
    column.assign(size, 0);
    for (std::size_t i = 0; i < size; ++i) ASSERT_EQ(copy[i], i + 7);
  }
}

TEST(Column, InitialisesWhenAskedTo) {
  Column<std::uint64_t> column;
  column.resize(1000, 5);
  EXPECT_EQ(std::accumulate(column.begin(), column.end(), std::uint64_t{0}), 5000U);
  column.resize(2000, 1);
  EXPECT_EQ(std::accumulate(column.begin(), column.end(), std::uint64_t{0}), 6000U);
}

TEST(Column, IsAlignedFor16Bytes) {
  std::vector<Column<std::uint8_t>> columns;
  for (std::size_t size = 1; size < 200; ++size) {
    columns.emplace_back(size);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(columns.back().data()) % 16, 0U);
  }
}

// Blocks overlap nothing, however they come and go.
TEST(Column, KeepsBlocksApart) {
  std::vector<Column<std::uint8_t>> columns(500);
  for (int round = 0; round < 20; ++round) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if ((i + static_cast<std::size_t>(round)) % 3 == 0) columns[i] = Column<std::uint8_t>();
      if ((i + static_cast<std::size_t>(round)) % 3 == 1)
        columns[i].assign((i * 7919 + static_cast<std::size_t>(round) * 104729) % 40000, static_cast<std::uint8_t>(i));
    }
    for (std::size_t i = 0; i < columns.size(); ++i)
      for (const std::uint8_t byte : columns[i]) ASSERT_EQ(byte, static_cast<std::uint8_t>(i));
  }
}

TEST(Column, MovesBetweenThreadsAndOutlivesTheOneThatMadeIt) {
  std::vector<Column<std::uint64_t>> columns(64);
  std::vector<std::thread> makers;
  for (std::size_t maker = 0; maker < 4; ++maker) {
    makers.emplace_back([&columns, maker] {
      for (std::size_t i = maker; i < columns.size(); i += 4) {
        Column<std::uint64_t> unused(1000, 1);
        columns[i].assign(10000 + i, i);
      }
    });
  }
  for (std::thread& maker : makers) maker.join();
  for (std::size_t i = 0; i < columns.size(); ++i)
    EXPECT_EQ(std::accumulate(columns[i].begin(), columns[i].end(), std::uint64_t{0}), i * (10000 + i));
  std::thread([&columns] { columns.clear(); }).join();
}

TEST(Column, ThrowsForImpossibleSizes) {
  const std::size_t huge = static_cast<std::size_t>(-1) / 4;
  EXPECT_THROW(ColumnAllocator<std::uint64_t>().allocate(huge), std::bad_alloc);
}

}  // namespace
}  // namespace slamdb
