// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/log_index.h"

#include <algorithm>
#include <bit>
#include <span>
#include <utility>
#include <vector>

#include "slamdb/formats/sqlite/detail/big_endian.h"

namespace slamdb::sqlite {
namespace {

constexpr std::size_t kHeaderBytes = 32, kFrameHeaderBytes = 24;
constexpr std::uint32_t kMagic = 0x377f0682;  // with the lowest bit set, checksums are of big-endian words
constexpr std::uint32_t kVersion = 3007000;

// Goes on from frame to frame.
class Checksum {
 public:
  explicit Checksum(bool big_endian) : big_endian_(big_endian) {}
  void Add(std::span<const unsigned char> bytes) {
    for (std::size_t i = 0; i + 8 <= bytes.size(); i += 8) {
      first_ += Word(&bytes[i]) + second_;
      second_ += Word(&bytes[i + 4]) + first_;
    }
  }
  bool Is(const unsigned char* recorded) const {
    return BigEndian32(recorded) == first_ && BigEndian32(recorded + 4) == second_;
  }

 private:
  std::uint32_t Word(const unsigned char* bytes) const {
    const std::uint32_t word = BigEndian32(bytes);
    return big_endian_ ? word : __builtin_bswap32(word);
  }
  bool big_endian_;
  std::uint32_t first_ = 0, second_ = 0;
};

}  // namespace

PagesBeside IndexLog(int descriptor) {
  PagesBeside index;
  std::vector<unsigned char> header(kHeaderBytes);
  if (!ReadAt(descriptor, 0, header)) return index;
  const std::uint32_t page_bytes = BigEndian32(&header[8]);
  Checksum checksum((BigEndian32(&header[0]) & 1) != 0);
  checksum.Add(std::span(header).first(kFrameHeaderBytes));
  if ((BigEndian32(&header[0]) & ~1U) != kMagic || BigEndian32(&header[4]) != kVersion || page_bytes < 512 ||
      page_bytes > 65536 || !std::has_single_bit(page_bytes) || !checksum.Is(&header[24]))
    return index;

  const std::span salts = std::span(header).subspan(16, 8);
  std::vector<unsigned char> frame(kFrameHeaderBytes + page_bytes);
  std::vector<std::pair<std::uint32_t, std::uint64_t>> pending;  // since the last commit
  for (std::uint64_t place = kHeaderBytes; ReadAt(descriptor, place, frame); place += frame.size()) {
    const std::uint32_t page = BigEndian32(&frame[0]), pages_after_commit = BigEndian32(&frame[4]);
    checksum.Add(std::span(frame).first(8));
    checksum.Add(std::span(frame).subspan(kFrameHeaderBytes));
    if (page == 0 || !std::equal(salts.begin(), salts.end(), &frame[8]) || !checksum.Is(&frame[16])) return index;
    pending.emplace_back(page, place + kFrameHeaderBytes);
    if (pages_after_commit == 0) continue;
    for (const auto& [written, at] : pending) index.places[written] = at;
    pending.clear();
    index.page_bytes = page_bytes;
    index.pages = pages_after_commit;
  }
  return index;
}

}  // namespace slamdb::sqlite
