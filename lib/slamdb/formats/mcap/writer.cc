// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/mcap/detail/writer.h"

#include <zlib.h>

#include <limits>

#include "slamdb/base/error.h"
#include "slamdb/formats/export/detail/raw.h"
#include "slamdb/formats/mcap/detail/schemas.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kChunkSize = 1 << 20;
constexpr std::string_view kMagic = "\x89MCAP0\r\n";

enum class Op : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0b,
  kSummaryOffset = 0x0e,
  kDataEnd = 0x0f,
};

void AppendText(std::string& out, std::string_view text) {
  AppendRaw(out, static_cast<std::uint32_t>(text.size()));
  out += text;
}

void AppendRecordHead(std::string& out, Op op, std::uint64_t size) {
  out += static_cast<char>(op);
  AppendRaw(out, size);
}

std::string Record(Op op, std::string_view body) {
  std::string record;
  AppendRecordHead(record, op, body.size());
  return record.append(body);
}

std::uint32_t Checksum(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

// The checksum of `head` and what `write` writes behind it.
std::uint32_t ChecksumOf(std::string_view head, const std::function<void(AtomicFile&)>& write) {
  std::uint32_t checksum = Checksum(head);
  const auto add = [&checksum](Bytes bytes) {
    checksum = Checksum({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, checksum);
  };
  AtomicFile counted(Target(add, "checksum"));
  write(counted);
  counted.Commit();
  return checksum;
}

}  // namespace

McapWriter::McapWriter(AtomicFile& file) : file_(file) {
  std::string header;
  AppendText(header, "");        // profile
  AppendText(header, "slamdb");  // library
  file_.Write(kMagic);
  file_.Write(Record(Op::kHeader, header));
}

std::uint16_t McapWriter::AddSchema(std::string_view name) {
  std::string body;
  AppendRaw(body, ++schema_count_);
  AppendText(body, name);
  AppendText(body, "protobuf");
  AppendText(body, FileDescriptorSetOf(name));
  const std::string record = Record(Op::kSchema, body);
  file_.Write(record);
  schemas_ += record;
  return schema_count_;
}

std::uint16_t McapWriter::AddChannel(std::string_view topic, std::uint16_t schema) {
  if (channel_count_ == std::numeric_limits<std::uint16_t>::max())
    throw Error(
        ErrorKind::kNotPossible,
        "an MCAP file has at most 65,535 channels, and there are more topics of maps; ExportOptions::map writes "
        "one map alone");
  std::string body;
  AppendRaw(body, channel_count_);
  AppendRaw(body, schema);
  AppendText(body, topic);
  AppendText(body, "protobuf");
  AppendRaw(body, std::uint32_t{0});  // metadata
  const std::string record = Record(Op::kChannel, body);
  file_.Write(record);
  channels_ += record;
  return channel_count_++;
}

void McapWriter::AppendMessageHead(std::string& out, std::uint16_t channel, std::uint64_t time, std::uint64_t size) {
  AppendRecordHead(out, Op::kMessage, 2 + 4 + 8 + 8 + size);
  AppendRaw(out, channel);
  AppendRaw(out, static_cast<std::uint32_t>(messages_[channel]++));
  AppendRaw(out, time);  // logged
  AppendRaw(out, time);  // published
  if (message_count_++ == 0) times_.begin = time;
  times_.end = time;
}

void McapWriter::Write(std::uint16_t channel, std::uint64_t time, std::string_view message) {
  if (chunk_.empty()) chunk_times_.begin = time;
  chunk_times_.end = time;
  chunk_index_[channel].emplace_back(time, chunk_.size());
  AppendMessageHead(chunk_, channel, time, message.size());
  chunk_ += message;
  if (chunk_.size() >= kChunkSize) CloseChunk();
}

void McapWriter::WriteLong(std::uint16_t channel, std::uint64_t time, std::uint64_t size,
                           const std::function<void(AtomicFile& to)>& write) {
  CloseChunk();
  std::string head;
  AppendMessageHead(head, channel, time, size);
  const std::uint64_t begin = file_.size();
  WriteChunkHead({time, time}, head.size() + size, ChecksumOf(head, write));
  file_.Write(head);
  write(file_);
  WriteIndices({time, time}, begin, head.size() + size, {{channel, {{time, 0}}}});
}

void McapWriter::CloseChunk() {
  if (chunk_.empty()) return;
  const std::uint64_t begin = file_.size();
  WriteChunkHead(chunk_times_, chunk_.size(), Checksum(chunk_));
  file_.Write(chunk_);
  WriteIndices(chunk_times_, begin, chunk_.size(), chunk_index_);
  chunk_.clear();
  chunk_index_.clear();
}

// Everything of a chunk but its records.
void McapWriter::WriteChunkHead(Span times, std::uint64_t size, std::uint32_t checksum) {
  std::string body;
  AppendRaw(body, times.begin);
  AppendRaw(body, times.end);
  AppendRaw(body, size);
  AppendRaw(body, checksum);
  AppendText(body, "");  // compression: none
  AppendRaw(body, size);
  std::string head;
  AppendRecordHead(head, Op::kChunk, body.size() + size);
  file_.Write(head + body);
}

// The message indices behind a chunk that was just written, and its chunk index for the summary.
void McapWriter::WriteIndices(Span times, std::uint64_t chunk_begin, std::uint64_t size, const MessageIndex& index) {
  const std::uint64_t chunk_end = file_.size();
  std::string records, offsets;
  for (const auto& [channel, messages] : index) {
    AppendRaw(offsets, channel);
    AppendRaw(offsets, chunk_end + records.size());
    std::string body;
    AppendRaw(body, channel);
    AppendRaw(body, static_cast<std::uint32_t>(16 * messages.size()));
    for (const auto& [time, offset] : messages) AppendRaw(body, time), AppendRaw(body, offset);
    records += Record(Op::kMessageIndex, body);
  }
  file_.Write(records);
  std::string body;
  AppendRaw(body, times.begin);
  AppendRaw(body, times.end);
  AppendRaw(body, chunk_begin);
  AppendRaw(body, chunk_end - chunk_begin);
  AppendText(body, offsets);
  AppendRaw(body, static_cast<std::uint64_t>(records.size()));
  AppendText(body, "");
  AppendRaw(body, size);
  AppendRaw(body, size);
  chunk_indices_ += Record(Op::kChunkIndex, body);
  ++chunk_count_;
}

std::string McapWriter::Statistics() const {
  std::string body, counts;
  AppendRaw(body, message_count_);
  AppendRaw(body, schema_count_);
  AppendRaw(body, std::uint32_t{channel_count_});
  AppendRaw(body, std::uint32_t{0});  // attachments
  AppendRaw(body, std::uint32_t{0});  // metadata
  AppendRaw(body, chunk_count_);
  AppendRaw(body, times_.begin);
  AppendRaw(body, times_.end);
  for (const auto& [channel, count] : messages_) AppendRaw(counts, channel), AppendRaw(counts, count);
  AppendText(body, counts);
  return Record(Op::kStatistics, body);
}

void McapWriter::Finish() {
  CloseChunk();
  file_.Write(Record(Op::kDataEnd, std::string(4, '\0')));  // without a checksum of its own: the chunks have theirs
  const std::uint64_t begin = file_.size();
  std::string summary, offsets;
  const auto add = [&](Op op, const std::string& records) {
    if (records.empty()) return;
    std::string body(1, static_cast<char>(op));
    AppendRaw(body, begin + summary.size());
    AppendRaw(body, static_cast<std::uint64_t>(records.size()));
    offsets += Record(Op::kSummaryOffset, body);
    summary += records;
  };
  add(Op::kSchema, schemas_);
  add(Op::kChannel, channels_);
  add(Op::kStatistics, Statistics());
  add(Op::kChunkIndex, chunk_indices_);
  const std::uint64_t offsets_begin = begin + summary.size();
  summary += offsets;
  AppendRecordHead(summary, Op::kFooter, 8 + 8 + 4);
  AppendRaw(summary, begin);
  AppendRaw(summary, offsets_begin);
  AppendRaw(summary, Checksum(summary));
  file_.Write(summary);
  file_.Write(kMagic);
}

}  // namespace slamdb::detail
