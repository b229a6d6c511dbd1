// SPDX-License-Identifier: BSD-3-Clause
// The records byte by byte; tests/formats/viewers reads the same with the official reader.
#include "slamdb/formats/mcap/detail/mcap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <limits>
#include <map>

#include "slamdb/formats/export/detail/protobuf.h"
#include "slamdb/formats/mcap/detail/schemas.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::string_view kMagic = "\x89MCAP0\r\n";

template <class Number>
Number At(std::string_view bytes, std::size_t place) {
  Number number{};
  std::memcpy(&number, bytes.data() + place, sizeof number);
  return number;
}

std::uint32_t Checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

struct Record {
  std::uint8_t op;
  std::uint64_t begin;  // in the file, of the op
  std::string_view body;
};

std::vector<Record> Records(std::string_view bytes, std::uint64_t begin = 0) {
  std::vector<Record> records;
  for (std::size_t at = 0; at < bytes.size();) {
    const auto size = At<std::uint64_t>(bytes, at + 1);
    records.push_back({static_cast<std::uint8_t>(bytes[at]), begin + at, bytes.substr(at + 9, size)});
    at += 9 + size;
  }
  return records;
}

std::vector<Record> RecordsOfFile(std::string_view file) {
  EXPECT_TRUE(file.starts_with(kMagic) && file.ends_with(kMagic));
  return Records(file.substr(8, file.size() - 16), 8);
}

// The records of a chunk, behind its times, sizes, checksum and empty compression.
std::string_view InChunk(const Record& chunk) { return chunk.body.substr(8 + 8 + 8 + 4 + 4 + 8); }

// Topic and time of each message.
std::vector<std::pair<std::string, std::uint64_t>> Messages(std::string_view file) {
  std::map<std::uint16_t, std::string> topics;
  std::vector<std::pair<std::string, std::uint64_t>> messages;
  for (const Record& record : RecordsOfFile(file)) {
    if (record.op == 4)
      topics[At<std::uint16_t>(record.body, 0)] = record.body.substr(8, At<std::uint32_t>(record.body, 4));
    if (record.op == 6)
      for (const Record& message : Records(InChunk(record)))
        messages.emplace_back(topics.at(At<std::uint16_t>(message.body, 0)), At<std::uint64_t>(message.body, 6));
  }
  return messages;
}

std::string Written(const Atlas& atlas, Notices& notices) { return Encoded(detail::kMcapFormat, atlas, {}, notices); }
std::string Written(const Atlas& atlas) {
  Notices ignored;
  return Written(atlas, ignored);
}

TEST(Mcap, MessagesComeInTheOrderOfTime) {
  EXPECT_THAT(Messages(Written(SmallAtlas())),
              ElementsAre(std::pair("/tf", 500'000'000U), std::pair("/map_0/points", 500'000'000U),
                          std::pair("/map_0/poses", 500'000'000U), std::pair("/map_0/graph", 500'000'000U),
                          std::pair("/map_0/camera", 500'000'000U), std::pair("/tf", 500'000'000U),
                          std::pair("/tf", 1'500'000'000U), std::pair("/tf", 2'000'000'000U),
                          std::pair("/map_1/points", 2'000'000'000U), std::pair("/map_1/poses", 2'000'000'000U),
                          std::pair("/map_1/graph", 2'000'000'000U), std::pair("/map_1/camera", 2'000'000'000U),
                          std::pair("/tf", 2'000'000'000U)));
}

// What players seek by: the places of chunks and messages, and the checksums.
TEST(Mcap, IndicesLeadToWhatTheySay) {
  const std::string file = Written(SmallAtlas());
  std::size_t chunks = 0, summary_begin = 0;
  for (const Record& record : RecordsOfFile(file)) {
    if (record.op == 6) {
      ++chunks;
      EXPECT_EQ(At<std::uint32_t>(record.body, 24), Checksum(InChunk(record)));
    }
    if (record.op == 15) summary_begin = record.begin + 9 + record.body.size();
    if (record.op == 8) {
      const auto begin = At<std::uint64_t>(record.body, 16);
      EXPECT_EQ(file[begin], 6);
      EXPECT_EQ(At<std::uint64_t>(record.body, 24), 9 + At<std::uint64_t>(file, begin + 1));
      const std::size_t offsets = At<std::uint32_t>(record.body, 32);
      for (std::size_t i = 0; i < offsets; i += 10) {
        const std::size_t index = At<std::uint64_t>(record.body, 36 + i + 2);
        EXPECT_EQ(file[index], 7);
        EXPECT_EQ(At<std::uint16_t>(file, index + 9), At<std::uint16_t>(record.body, 36 + i));
        const std::size_t message = begin + 9 + 40 + At<std::uint64_t>(file, index + 9 + 2 + 4 + 8);
        EXPECT_EQ(file[message], 5);
        EXPECT_EQ(At<std::uint16_t>(file, message + 9), At<std::uint16_t>(record.body, 36 + i));
      }
    }
  }
  EXPECT_EQ(chunks, 5U) << "each cloud has one of its own";
  const std::size_t footer = file.size() - 8 - 20;
  EXPECT_EQ(At<std::uint64_t>(file, footer), summary_begin);
  EXPECT_EQ(At<std::uint32_t>(file, footer + 16),
            Checksum(std::string_view(file).substr(summary_begin, footer + 16 - summary_begin)));
}

TEST(Mcap, StatisticsCount) {
  const std::string file = Written(SmallAtlas());
  for (const Record& record : RecordsOfFile(file))
    if (record.op == 11) {
      EXPECT_EQ(At<std::uint64_t>(record.body, 0), 13U);              // messages
      EXPECT_EQ(At<std::uint16_t>(record.body, 8), 5U);               // schemas
      EXPECT_EQ(At<std::uint32_t>(record.body, 10), 9U);              // channels
      EXPECT_EQ(At<std::uint32_t>(record.body, 22), 5U);              // chunks
      EXPECT_EQ(At<std::uint64_t>(record.body, 26), 500'000'000U);    // first
      EXPECT_EQ(At<std::uint64_t>(record.body, 34), 2'000'000'000U);  // last
    }
}

// More than a chunk of keyframes.
TEST(Mcap, LongTimelinesAreInChunks) {
  Atlas atlas = OneMapAtlas();
  const KeyFrame keyframe = atlas.maps[0].keyframes[0];
  for (int i = 0; i < 20'000; ++i) {
    atlas.maps[0].keyframes.push_back(keyframe);
    atlas.maps[0].keyframes.back().timestamp = 2 + 0.001 * i;
    atlas.maps[0].keyframes.back().id = KeyFrameId(static_cast<std::uint64_t>(100 + i));
  }
  std::uint64_t last = 0;
  std::size_t chunks = 0;
  const std::string file = Written(atlas);
  for (const Record& record : RecordsOfFile(file))
    if (record.op == 6) {
      EXPECT_GE(At<std::uint64_t>(record.body, 0), last);
      last = At<std::uint64_t>(record.body, 8);
      ++chunks;
    }
  EXPECT_GT(chunks, 4U);
  EXPECT_EQ(last, 21'999'000'000U);
}

TEST(Mcap, TimesThatHaveNoNanosecondsAreTheNearest) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].keyframes[0].timestamp = 1.4e18;
  atlas.maps[0].keyframes[1].timestamp = -5;
  Notices notices;
  const auto messages = Messages(Written(atlas, notices));
  EXPECT_EQ(messages.front().second, 0U);
  EXPECT_EQ(messages.back().second, static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()));
  ASSERT_EQ(notices.items().size(), 1U);
  EXPECT_THAT(notices.items()[0].text, HasSubstr("2 keyframes"));
}

TEST(Mcap, MapsOfOneIdHaveNamesOfTheirOwn) {
  Atlas atlas = SmallAtlas();
  atlas.maps[1].id = atlas.maps[0].id;
  const std::string file = Written(atlas);
  EXPECT_THAT(file, HasSubstr("/map_0/points"));
  EXPECT_THAT(file, HasSubstr("/map_0_1/points"));
  atlas.maps[1].id = MapId();
  EXPECT_THAT(Written(atlas), HasSubstr("/map_none/points"));
}

TEST(Mcap, HoldsNothingOfAnEmptyAtlas) {
  const std::string file = Written({});
  EXPECT_TRUE(Messages(file).empty());
  Atlas atlas;
  atlas.maps.resize(1);
  EXPECT_EQ(Messages(Written(atlas)).size(), 1U) << "which way is up";
}

TEST(Mcap, PointsThatAreNowhereAreLeftOut) {
  Atlas atlas = OneMapAtlas();
  for (MapPoint& point : atlas.maps[0].points) point.position.x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(Written(atlas), Not(HasSubstr("/map_0/points")));
}

TEST(Mcap, NamesEdgesThatLeadOut) {
  Atlas atlas = OneMapAtlas();
  Notices none, some;
  Encoded(detail::kMcapFormat, atlas, {}, none);
  EXPECT_TRUE(none.items().empty());
  atlas.maps[0].keyframes[0].bad = true;  // of 1: its child and its connection
  atlas.maps[0].keyframes[1].merge_edges = {KeyFrameId(7)};
  Encoded(detail::kMcapFormat, atlas, {}, some);
  ASSERT_EQ(some.items().size(), 1U);
  EXPECT_THAT(some.items()[0].text, HasSubstr("to keyframes that are not written with these: 2 edges"));
}

// As protoc encodes them: field 1, varint 300; field 2, text; field 3, a message with field 1, varint 1.
TEST(Protobuf, AppendsFields) {
  std::string bytes;
  detail::ProtoAppender proto(bytes);
  proto.Varint(1, 300);
  proto.Text(2, "testing");
  proto.Message(3, [](detail::ProtoAppender& inner) { inner.Varint(1, 1); });
  proto.Fixed32(4, 1);
  proto.Double(5, 1);
  EXPECT_EQ(bytes,
            std::string("\x08\xac\x02\x12\x07testing\x1a\x02\x08\x01\x25\x01\0\0\0\x29\0\0\0\0\0\0\xf0\x3f", 30));
}

TEST(Protobuf, LongMessagesHaveLongLengths) {
  std::string bytes;
  detail::ProtoAppender(bytes).Message(1, [](detail::ProtoAppender& inner) { inner.Text(1, std::string(200, 'x')); });
  EXPECT_EQ(bytes.substr(0, 6), std::string("\x0a\xcb\x01\x0a\xc8\x01", 6));
}

// What a message needs comes before it.
TEST(Schemas, HoldAllThatTheyNeed) {
  const std::string set = detail::FileDescriptorSetOf("foxglove.FrameTransform");
  const std::size_t time = set.find("google/protobuf/timestamp.proto"), vector = set.find("foxglove/Vector3.proto"),
                    quaternion = set.find("foxglove/Quaternion.proto"), own = set.find("foxglove/FrameTransform.proto");
  EXPECT_LT(time, vector);
  EXPECT_LT(vector, quaternion);
  EXPECT_LT(quaternion, own);
  EXPECT_NE(own, set.npos);
  EXPECT_THAT(set, Not(HasSubstr("SceneEntity")));
}

}  // namespace
}  // namespace slamdb
