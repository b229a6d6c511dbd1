// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <array>
#include <exception>
#include <optional>

#include "slamdb/base/detail/sanitizers.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/orbslam3/crafted_atlases.h"
#include "tests/formats/orbslam3/real_atlases.h"

// Damaged archives: every one ends in an atlas or in an Error that says where, never in a crash or in much memory.
namespace slamdb {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Values;
using Field = CraftedArchive::Field;

class Damage : public ::testing::TestWithParam<bool> {
 protected:
  // The error of reading the bytes; none when they decode. Any other exception fails the test.
  std::optional<Error> ErrorOf(const std::string& bytes, int threads = 1) {
    Notices notices;
    ReadOptions options;
    options.of<Orbslam3ReadOptions>().layout = "v1.0";  // forks have tests of their own
    options.threads = threads;
    try {
      static_cast<void>(ReadOrbslam3({std::as_bytes(std::span(bytes)), kName}, options, notices));
    } catch (const Error& error) {
      return error;
    } catch (const std::exception& error) {
      ADD_FAILURE() << "foreign exception: " << error.what();
    }
    return std::nullopt;
  }

  // A file that was cut says so, with its path and the place.
  void ExpectTruncation(const std::string& whole, std::size_t size, int threads = 1) {
    const std::optional<Error> error = ErrorOf(whole.substr(0, size), threads);
    ASSERT_TRUE(error) << "cut at " << size << " of " << whole.size() << " bytes, but read";
    EXPECT_EQ(error->path(), kName);
    if (size <= 64) return;  // within the header
    EXPECT_THAT(error->what(), AllOf(HasSubstr("byte "), HasSubstr("truncated"))) << "cut at " << size;
  }

  static constexpr const char* kName = "damaged.osa";
};

// Kilobytes; grows only.
long PeakMemory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

TEST_P(Damage, CutAnywhere) {
  for (const Crafted& crafted : {CraftTinyAtlas({.text = GetParam()}), CraftOddAtlas({.text = GetParam()})}) {
    // The newline at the end of a text archive is not part of it: without it the last token may have been cut.
    for (std::size_t size = 1; size < crafted.bytes.size(); size += 1 + crafted.bytes.size() / 600)
      ExpectTruncation(crafted.bytes, size);
  }
}

TEST_P(Damage, ByteChangedAnywhere) {
  for (const Crafted& crafted : {CraftTinyAtlas({.text = GetParam()}), CraftOddAtlas({.text = GetParam()})}) {
    std::size_t turn = 0;
    for (std::size_t at = 0; at < crafted.bytes.size(); at += 1 + crafted.bytes.size() / 1000) {
      std::string damaged = crafted.bytes;
      damaged[at] = static_cast<char>(damaged[at] ^ std::array{0x01, 0x80, 0xFF}[turn++ % 3]);
      ErrorOf(damaged);
    }
  }
}

// The value of a field replaced, in the width it has.
std::string Replaced(const Crafted& crafted, const Field& field, std::uint64_t value, bool text) {
  std::string bytes = crafted.bytes;
  std::string replacement = std::to_string(value);
  if (!text) replacement.assign(reinterpret_cast<const char*>(&value), field.length);
  return bytes.replace(field.offset, field.length, replacement);
}

TEST_P(Damage, HugeCountsAreRefusedBeforeTheyAreAllocated) {
  const long before = PeakMemory();
  for (const Crafted& crafted : {CraftTinyAtlas({.text = GetParam()}), CraftOddAtlas({.text = GetParam()})}) {
    for (const Field& field : crafted.fields) {
      if (field.kind != Field::Kind::kCount) continue;
      for (const std::uint64_t count : {std::uint64_t{100'000}, std::uint64_t{0x7FFF'FFFF}, std::uint64_t{1} << 40,
                                        (std::uint64_t{1} << 61) + 1, ~std::uint64_t{0}}) {
        if (GetParam() || field.length == 8 || count >> 32 == 0) {
          const std::optional<Error> error = ErrorOf(Replaced(crafted, field, count, GetParam()));
          ASSERT_TRUE(error) << "count " << count << " at byte " << field.offset << " was believed";
          EXPECT_THAT(error->what(), HasSubstr("byte ")) << "count " << count << " at byte " << field.offset;
        }
      }
    }
  }
  // The sanitizer keeps what was freed for a while.
  constexpr long kMostKilobytes = SLAMDB_ADDRESS_SANITIZER ? 512 * 1024 : 64 * 1024;
  EXPECT_LT(PeakMemory() - before, kMostKilobytes);
}

TEST_P(Damage, UnknownClassesAndObjectsAreRefused) {
  for (const Crafted& crafted : {CraftTinyAtlas({.text = GetParam()}), CraftOddAtlas({.text = GetParam()})}) {
    for (const Field& field : crafted.fields) {
      if (field.kind == Field::Kind::kCount) continue;
      for (const std::uint64_t value : {99U, 5000U, 32767U}) {
        const std::optional<Error> error = ErrorOf(Replaced(crafted, field, value, GetParam()));
        ASSERT_TRUE(error) << "id " << value << " at byte " << field.offset << " was believed";
        EXPECT_THAT(error->what(), HasSubstr("byte "));
      }
    }
  }
}

TEST_P(Damage, SyntheticAtlasCutAtHundredsOfPlaces) {
  SyntheticOptions options;
  options.sensor = Sensor::kFisheyeStereo;
  options.inertial = true;
  options.keyframes = 12;
  options.points = 300;
  Atlas atlas = SynthesizeAtlas(options);
  atlas.encoding.text = GetParam();
  const std::string bytes = EncodeOrbslam3(atlas);
  for (std::size_t i = 1; i < 200; ++i) ExpectTruncation(bytes, bytes.size() / 200 * i, static_cast<int>(1 + i % 2));
}

INSTANTIATE_TEST_SUITE_P(Encodings, Damage, Values(false, true),
                         [](const auto& test) { return test.param ? "text" : "binary"; });

class DamagedRealFile : public Damage {};

TEST_P(DamagedRealFile, CutAtHundredsOfPlaces) {
  const std::string name = GetParam() ? "mono_small_text" : "mono_small";
  SLAMDB_REQUIRE_REAL_ATLAS(path, name);
  const std::string bytes = ReadWhole(path);
  for (std::size_t i = 1; i < 200; ++i) ExpectTruncation(bytes, bytes.size() / 200 * i, static_cast<int>(1 + i % 2));
}

TEST_P(DamagedRealFile, ByteChangedAtHundredsOfPlaces) {
  const std::string name = GetParam() ? "mono_small_text" : "mono_small";
  SLAMDB_REQUIRE_REAL_ATLAS(path, name);
  std::string bytes = ReadWhole(path);
  for (std::size_t i = 0; i < 200; ++i) {
    char& byte = bytes[bytes.size() / 200 * i + 7 * i % 64];
    byte = static_cast<char>(byte ^ 0xFF);
    ErrorOf(bytes, static_cast<int>(1 + i % 2));
    byte = static_cast<char>(byte ^ 0xFF);
  }
}

INSTANTIATE_TEST_SUITE_P(OrbSlam3, DamagedRealFile, Values(false, true),
                         [](const auto& test) { return test.param ? "text" : "binary"; });

// What is no archive at all: each its own sentence.
class NoArchive : public Damage {};

TEST_F(NoArchive, SaysWhatItIs) {
  EXPECT_THAT(ErrorOf("")->what(), HasSubstr("empty"));
  EXPECT_THAT(ErrorOf("hello, world\n")->what(), HasSubstr("not a Boost archive"));
  std::string old = CraftTinyAtlas({.version = 9}).bytes;
  EXPECT_THAT(ErrorOf(old)->what(), HasSubstr("version 9"));
}

}  // namespace
}  // namespace slamdb
