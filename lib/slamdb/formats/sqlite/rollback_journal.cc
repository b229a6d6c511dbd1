// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/rollback_journal.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "slamdb/formats/sqlite/detail/big_endian.h"

namespace slamdb::sqlite {
namespace {

constexpr std::array<unsigned char, 8> kMagic = {0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7};
constexpr std::uint32_t kUntilTheEnd = 0xffffffff;  // as a number of records
constexpr std::size_t kBetweenSummedBytes = 200;

bool IsPowerOfTwo(std::uint32_t number, std::uint32_t least, std::uint32_t most) {
  return number >= least && number <= most && std::has_single_bit(number);
}

// Each part of a journal begins with one, at a multiple of the size of a sector.
struct Header {
  std::uint32_t records = 0, nonce = 0, pages = 0, sector_bytes = 0, page_bytes = 0;

  static std::optional<Header> At(int descriptor, std::uint64_t place) {
    std::array<unsigned char, 28> bytes{};
    if (!ReadAt(descriptor, place, bytes) || !std::equal(kMagic.begin(), kMagic.end(), bytes.begin())) return {};
    return Header{BigEndian32(&bytes[8]), BigEndian32(&bytes[12]), BigEndian32(&bytes[16]), BigEndian32(&bytes[20]),
                  BigEndian32(&bytes[24])};
  }
};

std::uint32_t SumOf(std::span<const unsigned char> page, std::uint32_t nonce) {
  std::uint32_t sum = nonce;
  for (std::size_t at = page.size() - kBetweenSummedBytes; at > 0 && at < page.size(); at -= kBetweenSummedBytes)
    sum += page[at];
  return sum;
}

// The name of the journal that binds several together ends with the magic number.
bool IsOfSeveralDatabases(int descriptor, std::uint64_t bytes) {
  std::array<unsigned char, 8> end{};
  return bytes > 28 + end.size() && ReadAt(descriptor, bytes - end.size(), end) && end == kMagic;
}

// Returns whether the journal is whole.
bool ReadRecords(int descriptor, PagesBeside& before) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return false;
  const auto bytes = static_cast<std::uint64_t>(status.st_size);
  if (IsOfSeveralDatabases(descriptor, bytes)) return false;

  std::vector<unsigned char> record(4 + before.page_bytes + 4);
  std::uint64_t sector_bytes = 0;
  for (std::uint64_t place = 0; const auto header = Header::At(descriptor, place);) {
    if (place == 0) sector_bytes = header->sector_bytes;
    if (!IsPowerOfTwo(static_cast<std::uint32_t>(sector_bytes), 32, 65536)) return false;
    place += sector_bytes;
    const bool until_the_end = header->records == kUntilTheEnd;
    for (std::uint32_t i = 0; i < header->records; ++i, place += record.size()) {
      // The last record may have been in the writing: its page was not changed yet.
      if (until_the_end && place + record.size() > bytes) return true;
      if (!ReadAt(descriptor, place, record)) return false;
      const std::uint32_t page = BigEndian32(record.data());
      const auto content = std::span(record).subspan(4, before.page_bytes);
      if (page == 0 || BigEndian32(&record[4 + before.page_bytes]) != SumOf(content, header->nonce)) return false;
      before.places.emplace(page, place + 4);
    }
    place = (place + sector_bytes - 1) / sector_bytes * sector_bytes;
  }
  return true;
}

}  // namespace

RollbackJournal ReadRollbackJournal(int descriptor) {
  const std::optional<Header> first = Header::At(descriptor, 0);
  if (!first || !IsPowerOfTwo(first->page_bytes, 512, 65536)) return {};
  PagesBeside before{.page_bytes = first->page_bytes, .pages = first->pages, .places = {}};
  if (!ReadRecords(descriptor, before)) return {.before = {}, .whole = false};
  return {.before = std::move(before), .whole = true};
}

}  // namespace slamdb::sqlite
