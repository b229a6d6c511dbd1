// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/atomic_file.h"

namespace slamdb::detail {

// Writes an MCAP file: chunks with their checksums, an index of each, and the summary by which players seek.
// All schemas, then all channels, then messages in the order of their times.
// Memory is bounded by a chunk of a mebibyte and the indices. schema/mcap.md has the records.
class McapWriter {
 public:
  explicit McapWriter(AtomicFile& file);

  // One of Foxglove's messages: `foxglove.PointCloud`.
  std::uint16_t AddSchema(std::string_view name);
  // Throws Error when there are more than 65,535.
  std::uint16_t AddChannel(std::string_view topic, std::uint16_t schema);

  // Time in nanoseconds since 1970.
  void Write(std::uint16_t channel, std::uint64_t time, std::string_view message);
  // A message of `size` bytes that does not stand in memory, in a chunk of its own. `write` writes it, and is called
  // twice: the checksum stands before it.
  void WriteLong(std::uint16_t channel, std::uint64_t time, std::uint64_t size,
                 const std::function<void(AtomicFile& to)>& write);

  // The summary. The file is whole then.
  void Finish();

 private:
  struct Span {
    std::uint64_t begin = 0, end = 0;  // times
  };
  using MessageIndex = std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>>;

  void AppendMessageHead(std::string& out, std::uint16_t channel, std::uint64_t time, std::uint64_t size);
  void CloseChunk();
  void WriteChunkHead(Span times, std::uint64_t size, std::uint32_t checksum);
  void WriteIndices(Span times, std::uint64_t chunk_begin, std::uint64_t size, const MessageIndex& index);
  std::string Statistics() const;

  AtomicFile& file_;
  std::string schemas_, channels_, chunk_indices_;  // records of the summary
  std::uint16_t schema_count_ = 0, channel_count_ = 0;
  std::uint32_t chunk_count_ = 0;
  std::string chunk_;  // records
  Span chunk_times_;
  MessageIndex chunk_index_;
  std::map<std::uint16_t, std::uint64_t> messages_;  // of each channel
  std::uint64_t message_count_ = 0;
  Span times_;
};

}  // namespace slamdb::detail
