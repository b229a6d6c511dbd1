// SPDX-License-Identifier: BSD-3-Clause
// The form that forks of ORB-SLAM2 convert the text into: a header of six numbers, then a record for each node but the
// root: u32 parent, 32 bytes of descriptor, f32 weight, u8 is-word.
#include <array>
#include <cstring>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/dbow2/detail/encoding.h"

namespace slamdb::dbow2 {
namespace {

constexpr std::size_t kHeader = 24, kRecord = 4 + sizeof(Descriptor) + 4 + 1, kGrain = 16'384;

struct BinaryHeader {
  std::uint32_t nodes, record_bytes;
  std::int32_t branching, depth, scoring, weighting;
};
static_assert(sizeof(BinaryHeader) == kHeader);

BinaryHeader ReadHeader(std::string_view file) {
  BinaryHeader header;
  std::memcpy(&header, file.data(), sizeof header);
  return header;
}

void ReadRecord(const char* at, NodeTable& table, std::size_t node) {
  float weight = 0;
  std::memcpy(&table.parents[node], at, 4);
  std::memcpy(&table.tree.descriptors[node], at + 4, sizeof(Descriptor));
  std::memcpy(&weight, at + 36, sizeof weight);
  table.tree.weights[node] = static_cast<double>(weight);
  table.is_word[node] = static_cast<std::uint8_t>(at[40] != 0);
}

}  // namespace

std::optional<Header> ParseBinaryHeader(std::string_view file) {
  if (file.size() < kHeader) return std::nullopt;
  const BinaryHeader header = ReadHeader(file);
  if (header.record_bytes != kRecord) return std::nullopt;
  return Header{header.branching, header.depth, header.scoring, header.weighting, kHeader};
}

VocabularyTree ParseBinary(const std::string& path, std::string_view file, const Header& header, int threads) {
  const std::uint32_t announced = ReadHeader(file).nodes;  // with the root
  const std::size_t bytes = file.size() - kHeader;
  const std::size_t nodes = bytes / kRecord;
  if (bytes % kRecord != 0 || nodes + 1 != announced)
    throw Error(ErrorKind::kDamaged, path, "byte 0",
                "announces " + std::to_string(announced) + " nodes with the root, but " + std::to_string(bytes) +
                    " bytes follow, which are " + std::to_string(nodes) + " nodes of " + std::to_string(kRecord) +
                    " bytes" + (nodes + 1 < announced ? ": the file is truncated" : ""));
  NodeTable table(header, nodes, path);
  table.place = [](std::uint32_t node) { return "byte " + std::to_string(kHeader + (node - 1) * kRecord); };
  const char* const records = file.data() + kHeader;
  detail::ParallelFor(nodes, kGrain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) ReadRecord(records + i * kRecord, table, i + 1);
  });
  return LinkNodes(std::move(table));
}

}  // namespace slamdb::dbow2
