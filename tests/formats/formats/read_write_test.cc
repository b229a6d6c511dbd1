// SPDX-License-Identifier: BSD-3-Clause
// The way in and out: files, streams and memory, options of single formats, formats of one's own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <new>
#include <sstream>
#include <utility>

#include "slamdb/base/atomic_file.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/rows/options.h"
#include "slamdb/formats/salvage.h"
#include "tests/formats/formats/small_atlas.h"
#include "tests/support/kind_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;

const std::string kTiny = SLAMDB_FIXTURES "/tiny/tiny.osa";

Error ErrorOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error;
  }
  return {ErrorKind::kInternal, "no error"};
}

std::string Text(const Atlas& atlas) { return EncodeAtlas(atlas, {.format = "ndjson"}); }

// ---- one line each

TEST(ReadAndWrite, OneLineEach) {
  const TemporaryFolder folder;
  const Atlas atlas = ReadAtlas(kTiny);
  WriteAtlas(atlas, folder.Path("copy.osa"));
  EXPECT_EQ(ReadFile(folder.Path("copy.osa")), ReadFile(kTiny));
  WriteAtlas(atlas, folder.Path("maps.db#lab"));
  EXPECT_EQ(Text(ReadAtlas(folder.Path("maps.db#lab"))), Text(atlas));
  EXPECT_EQ(ErrorOf([&] { static_cast<void>(ReadAtlas(folder.Path("maps.db#hall"))); }).path(), folder.Path("maps.db"));
}

TEST(ReadAndWrite, ByTheFormatOfTheOptions) {
  const TemporaryFolder folder;
  WriteAtlas(SmallAtlas(), folder.Path("poses"), {.format = "tum"});
  EXPECT_THAT(ReadFile(folder.Path("poses")), HasSubstr("# timestamp tx ty tz"));
  EXPECT_EQ(ReadAtlas(folder.Path("poses"), {.format = "tum"}).maps.size(), 2U);
  const Error error = ErrorOf([&] { static_cast<void>(ReadAtlas(folder.Path("poses"), {.format = "orbslam3"})); });
  EXPECT_EQ(error.kind(), ErrorKind::kDamaged);
  EXPECT_EQ(ErrorOf([&] { static_cast<void>(ReadAtlas(kTiny, {.format = "xml"})); }).kind(), ErrorKind::kUsage);
}

TEST(ReadAndWrite, TellsWhatItIsGivenToTell) {
  const TemporaryFolder folder;
  Notices notices;
  WriteAtlas(OneMapAtlas(), folder.Path("a.ply"));
  WriteAtlas(OneMapAtlas(), folder.Path("b.ply"), {}, &notices);
  EXPECT_NE(notices.written(), "");
  const std::string longer = ReadFile(kTiny) + "xyz";
  Notices of_reading;
  static_cast<void>(DecodeAtlas(longer, {}, &of_reading));
  ASSERT_EQ(of_reading.items().size(), 1U);
  EXPECT_THAT(of_reading.items()[0].text, HasSubstr("memory: 3 bytes behind the end"));
}

// ---- memory and streams

TEST(ReadAndWrite, Memory) {
  const std::string bytes = ReadFile(kTiny);
  EXPECT_EQ(EncodeAtlas(DecodeAtlas(bytes), {.format = "orbslam3"}), bytes);
  EXPECT_EQ(EncodeAtlas(DecodeAtlas(std::as_bytes(std::span(bytes))), {.format = "orbslam3"}), bytes);
  const Error cut = ErrorOf([&] { static_cast<void>(DecodeAtlas(std::string_view(bytes).substr(0, 1000))); });
  EXPECT_EQ(cut.kind(), ErrorKind::kDamaged);
  EXPECT_EQ(cut.path(), "memory");
  EXPECT_THAT(cut.place(), HasSubstr("byte "));
  EXPECT_EQ(ErrorOf([] { static_cast<void>(DecodeAtlas("")); }).kind(), ErrorKind::kDamaged);
}

TEST(ReadAndWrite, Streams) {
  // Longer than what is read at once.
  std::istringstream in(EncodeAtlas(SmallAtlas(), {.format = "orbslam3"}) + std::string(3'000'000, '\0'));
  Notices notices;
  const Atlas atlas = ReadAtlas(in, {}, &notices);
  ASSERT_EQ(notices.items().size(), 1U);
  EXPECT_THAT(notices.items()[0].text, HasSubstr("stream: 3000000 bytes behind the end"));
  std::ostringstream out;
  WriteAtlas(atlas, out, {.format = "orbslam3"});
  EXPECT_EQ(out.str(), EncodeAtlas(SmallAtlas(), {.format = "orbslam3"}));
}

TEST(ReadAndWrite, StreamsThatFail) {
  std::istringstream in("anything");
  in.setstate(std::ios::badbit);
  const Error reading = ErrorOf([&] { static_cast<void>(ReadAtlas(in)); });
  EXPECT_EQ(std::string(reading.what()), "stream: cannot be read");
  EXPECT_EQ(reading.kind(), ErrorKind::kNotPossible);
  std::ostringstream out;
  out.setstate(std::ios::badbit);
  EXPECT_EQ(std::string(ErrorOf([&] { WriteAtlas(SmallAtlas(), out, {.format = "tum"}); }).what()),
            "stream: cannot be written");
}

// What stays in the buffer of a stream is not written yet.
TEST(ReadAndWrite, AFullDiskBehindAStreamIsNoticed) {
  if (!std::filesystem::is_character_file("/dev/full")) GTEST_SKIP() << "no /dev/full";
  for (const char* format : {"tum", "csv", "ply"}) {
    std::ofstream full("/dev/full");
    EXPECT_EQ(KindOf([&] { WriteAtlas(SmallAtlas(), full, {.format = format}); }), ErrorKind::kNotPossible) << format;
  }
}

TEST(ReadAndWrite, StreamsThatThrowTellByErrors) {
  std::stringstream stream;
  stream.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
  WriteAtlas(SmallAtlas(), stream, {.format = "orbslam3"});
  EXPECT_EQ(ReadAtlas(stream, {.format = "orbslam3"}).maps.size(), SmallAtlas().maps.size());
  EXPECT_EQ(stream.exceptions(), std::ios::failbit | std::ios::badbit | std::ios::eofbit) << "as its owner has it";
  std::ofstream nowhere("/nowhere/at/all");
  try {
    nowhere.exceptions(std::ios::badbit);
  } catch (const std::ios_base::failure&) {
  }
  EXPECT_EQ(KindOf([&] { WriteAtlas(SmallAtlas(), nowhere, {.format = "tum"}); }), ErrorKind::kNotPossible);
}

TEST(ReadAndWrite, WhatHasNoSuffixNeedsAFormat) {
  std::ostringstream out;
  for (const Error& error : {ErrorOf([&] { WriteAtlas(SmallAtlas(), out, {}); }),
                             ErrorOf([] { static_cast<void>(EncodeAtlas(SmallAtlas(), {})); })}) {
    EXPECT_EQ(error.kind(), ErrorKind::kUsage);
    EXPECT_THAT(error.problem(), HasSubstr("has no suffix to tell the format by; WriteOptions::format names it ("));
  }
}

TEST(ReadAndWrite, StoresAreFiles) {
  std::ostringstream out;
  const TemporaryFolder folder;
  WriteAtlas(SmallAtlas(), folder.Path("a.db"));
  const std::string bytes = ReadFile(folder.Path("a.db"));
  for (const Error& error : {ErrorOf([&] { WriteAtlas(SmallAtlas(), out, {.format = "store"}); }),
                             ErrorOf([&] { static_cast<void>(DecodeAtlas(bytes)); }),
                             ErrorOf([&] { static_cast<void>(SalvageBytes(std::as_bytes(std::span(bytes)))); })}) {
    EXPECT_EQ(error.kind(), ErrorKind::kNotPossible);
    EXPECT_THAT(error.problem(), HasSubstr("a store is a file"));
  }
}

TEST(SalvageBytes, GivesWhatIsWhole) {
  const std::string bytes = ReadFile(SLAMDB_FIXTURES "/session_small_a/session_small_a.osa");
  const std::string half = bytes.substr(0, bytes.size() / 2);
  const Salvage salvage = SalvageBytes(std::as_bytes(std::span(half)));
  EXPECT_FALSE(salvage.damage.empty());
  ASSERT_EQ(salvage.maps.size(), 1U);
  EXPECT_GT(salvage.maps[0].keyframes.read, 5U);
  const Error other = ErrorOf(
      [] { static_cast<void>(SalvageBytes(std::as_bytes(std::span("1 0 0 0 0 0 0 1\n")), {.format = "tum"})); });
  EXPECT_EQ(other.kind(), ErrorKind::kUnsupported);
}

// ---- options of single formats

TEST(FormatOptions, HasOneStructOfEachType) {
  FormatOptions options;
  EXPECT_TRUE(std::as_const(options).of<PointCloudOptions>().binary);
  PointCloudOptions& cloud = options.of<PointCloudOptions>();
  cloud.binary = false;
  options.of<ExportOptions>().map = MapId(3);
  options.of<StoreWriteOptions>().provenance = "a test";
  EXPECT_EQ(&options.of<PointCloudOptions>(), &cloud) << "it stays where it is";
  const FormatOptions copy = options;
  EXPECT_FALSE(copy.of<PointCloudOptions>().binary);
  EXPECT_EQ(copy.of<ExportOptions>().map, MapId(3));
  EXPECT_EQ(copy.of<StoreWriteOptions>().provenance, "a test");
  options.of<ExportOptions>() = {};
  EXPECT_EQ(copy.of<ExportOptions>().map, MapId(3)) << "copies are apart";
}

TEST(FormatOptions, ReachTheirFormat) {
  WriteOptions options{.format = "orbslam3"};
  options.of<Orbslam3WriteOptions>().boost_version = 12;
  EXPECT_EQ(EncodeAtlas(ReadAtlas(kTiny), options)[0x1e], 12);
  const WriteOptions ascii = WriteOptions{.format = "ply"}.With(PointCloudOptions{.binary = false});
  EXPECT_THAT(EncodeAtlas(SmallAtlas(), ascii), HasSubstr("format ascii"));
  EXPECT_THAT(EncodeAtlas(SmallAtlas(), {.format = "ply"}), HasSubstr("format binary"));
}

// ---- a format of one's own

constexpr std::string_view kMagic = "timestamps\n";

Atlas ReadTimestamps(const Source& source, const ReadOptions& options, Notices&) {
  const WholeFile file(source);
  if (!file.text().starts_with(kMagic)) throw Error(ErrorKind::kDamaged, source.path, "byte 0", "no timestamps");
  std::istringstream text{std::string(file.text().substr(kMagic.size()))};
  Atlas atlas;
  atlas.maps.resize(1);
  for (double time = 0; text >> time;) atlas.maps[0].keyframes.emplace_back().timestamp = time;
  if (options.threads == 77) throw std::bad_alloc();
  return atlas;
}

void WriteTimestamps(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  AtomicFile file(target, {.overwrite = options.overwrite, .sync = options.sync});
  file.Write(kMagic);
  for (const KeyFrame& keyframe : atlas.maps.at(0).keyframes) file.Write(std::to_string(keyframe.timestamp) + "\n");
  notices.Note("timestamps alone");
  file.Commit();
}

const Format kTimestamps{.id = "timestamps",
                         .title = "timestamps of one map",
                         .reads = Content::kPoses,
                         .writes = Content::kPoses,
                         .read = ReadTimestamps,
                         .write = WriteTimestamps};

TEST(CustomFormat, ReadsAndWritesLikeTheOthers) {
  const TemporaryFolder folder;
  Notices notices;
  WriteAtlas(SmallAtlas(), folder.Path("a"), {.custom_format = &kTimestamps}, &notices);
  EXPECT_EQ(ReadFile(folder.Path("a")), "timestamps\n1.500000\n0.500000\n");
  EXPECT_EQ(notices.items().front().text, "timestamps cannot hold map points (4)");
  EXPECT_EQ(notices.items().back().text, "timestamps alone");
  const Atlas atlas = ReadAtlas(folder.Path("a"), {.custom_format = &kTimestamps});
  EXPECT_EQ(atlas.maps[0].keyframes[1].timestamp, 0.5);
  EXPECT_EQ(EncodeAtlas(atlas, {.custom_format = &kTimestamps}), ReadFile(folder.Path("a")));
  EXPECT_EQ(DecodeAtlas("timestamps\n2\n", {.custom_format = &kTimestamps}).maps[0].keyframes[0].timestamp, 2);
  const WriteOptions strict{.custom_format = &kTimestamps, .strict = true};
  EXPECT_THAT(ErrorOf([&] { static_cast<void>(EncodeAtlas(SmallAtlas(), strict)); }).problem(),
              HasSubstr("timestamps cannot hold"));
}

TEST(CustomFormat, IsRefusedWhereItCannot) {
  Format neither = kTimestamps;
  neither.read = nullptr;
  neither.write = nullptr;
  EXPECT_EQ(ErrorOf([&] { static_cast<void>(DecodeAtlas("x", {.custom_format = &neither})); }).kind(),
            ErrorKind::kUnsupported);
  EXPECT_EQ(ErrorOf([&] { static_cast<void>(EncodeAtlas({}, {.custom_format = &neither})); }).kind(),
            ErrorKind::kUsage);
  EXPECT_EQ(ErrorOf([&] { static_cast<void>(SalvageBytes({}, {.custom_format = &kTimestamps})); }).kind(),
            ErrorKind::kUnsupported);
}

TEST(ReadAndWrite, TooLittleMemoryIsAnError) {
  const ReadOptions hungry{.custom_format = &kTimestamps, .threads = 77};
  const Error error = ErrorOf([&] { static_cast<void>(DecodeAtlas("timestamps\n", hungry)); });
  EXPECT_EQ(error.kind(), ErrorKind::kOutOfResources);
  EXPECT_THAT(error.problem(), HasSubstr("too little memory"));
}

}  // namespace
}  // namespace slamdb
