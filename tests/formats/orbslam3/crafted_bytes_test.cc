// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "slamdb/base/error.h"
#include "slamdb/formats/orbslam3/detail/salvage.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "tests/formats/orbslam3/crafted_atlases.h"

// A byte that was changed is either refused, or read into the atlas and written back: none is passed over.
namespace slamdb {
namespace {

// What is written back of the bytes; nothing when reading or writing refuses them, or a notice says that they were not
// all read.
std::optional<std::string> WrittenBack(const std::string& bytes) {
  Notices notices;
  ReadOptions options;
  options.of<Orbslam3ReadOptions>().layout = "v1.0";  // forks have tests of their own
  options.threads = 1;
  try {
    const Atlas atlas = ReadOrbslam3({std::as_bytes(std::span(bytes)), "changed.osa"}, options, notices);
    if (notices.lossy()) return std::nullopt;
    return EncodeOrbslam3(atlas);
  } catch (const Error&) {
    return std::nullopt;
  }
}

// Text has many spellings of one float: digits beyond those that tell floats apart, of which library version 10 writes
// 8. Anything else must be the same.
bool IsSameNumber(const std::string& one, const std::string& other) {
  if (one.back() != other.back() || (one + other).find_first_of(".en") == std::string::npos) return false;
  const auto eight_digits = [](const std::string& token) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.8g", static_cast<double>(std::strtof(token.c_str(), nullptr)));
    return std::string(text.data());
  };
  const double value = std::strtod(one.c_str(), nullptr), same = std::strtod(other.c_str(), nullptr);
  return value == same || eight_digits(one) == eight_digits(other);
}

bool IsSameText(std::string_view left, std::string_view right) {
  const auto next = [](std::string_view& text) {
    const std::size_t end = std::min(text.find_first_of(" \n"), text.size() - 1);
    const std::string token(text.substr(0, end + 1));
    text.remove_prefix(end + 1);
    return token;
  };
  while (!left.empty() && !right.empty()) {
    const std::string one = next(left), other = next(right);
    if (one != other && !IsSameNumber(one, other)) return false;
  }
  return left.empty() && right.empty();
}

void ExpectKeptOrRefused(const Crafted& crafted, bool text, const std::vector<int>& changes) {
  ASSERT_TRUE(WrittenBack(crafted.bytes) == crafted.bytes);
  std::string bytes = crafted.bytes;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const int change : changes) {
      bytes[at] = static_cast<char>(crafted.bytes[at] ^ change);
      const std::optional<std::string> written = WrittenBack(bytes);
      ASSERT_TRUE(!written || *written == bytes || (text && IsSameText(bytes, *written)))
          << "byte " << at << " changed by " << change << " is lost";
    }
    bytes[at] = crafted.bytes[at];
  }
}

struct Writer {
  const char* name;
  Craft craft;
};
void PrintTo(const Writer& writer, std::ostream* stream) { *stream << writer.name; }

const std::vector<int> kEveryBit{1, 2, 4, 8, 16, 32, 64, 128}, kTwoValues{0x01, 0x10};

class EveryWriterKeepsOrRefuses : public ::testing::TestWithParam<Writer> {};

TEST_P(EveryWriterKeepsOrRefuses, OddAtlas) {
  const Craft& craft = GetParam().craft;
  ExpectKeptOrRefused(CraftOddAtlas(craft), craft.text, craft.text ? kTwoValues : kEveryBit);
}

INSTANTIATE_TEST_SUITE_P(Writers, EveryWriterKeepsOrRefuses,
                         ::testing::Values(Writer{"binary_unix64", {}}, Writer{"binary_10", {.version = 10}},
                                           Writer{"binary_20", {.version = 20}},
                                           Writer{"binary_windows64", {.long_bytes = 4}},
                                           Writer{"binary_bits32", {.long_bytes = 4, .size_bytes = 4}},
                                           Writer{"text_unix64", {.text = true}},
                                           Writer{"text_10", {.text = true, .version = 10}},
                                           Writer{"text_windows64", {.text = true, .long_bytes = 4}},
                                           Writer{"text_bits32", {.text = true, .long_bytes = 4, .size_bytes = 4}}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(EveryByteIsKeptOrRefused, OfTheTinyAtlas) { ExpectKeptOrRefused(CraftTinyAtlas({}), false, kEveryBit); }
TEST(EveryByteIsKeptOrRefused, OfTheTinyAtlasInText) {
  ExpectKeptOrRefused(CraftTinyAtlas({.text = true}), true, {0x01});
}

TEST(EveryByteIsKeptOrRefused, SaysPlaceAndValue) {
  std::string bytes = CraftTinyAtlas({}).bytes;
  constexpr std::string_view kOne("\1\0\0\0\0\0\0\0\0\0\0\0", 12);
  const std::size_t list = bytes.find(kOne, bytes.find(kOne) + 1);  // behind the atlas: one map, item version 0
  ASSERT_NE(list, std::string::npos);
  bytes[list + 8] = 5;
  try {
    Notices notices;
    static_cast<void>(ReadOrbslam3({std::as_bytes(std::span(bytes)), "changed.osa"}, {}, notices));
    FAIL() << "read";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kDamaged);
    EXPECT_EQ(error.problem(),
              "an item version of 5, expected 0: the file is damaged, or not written by ORB-SLAM3 v1.0");
    EXPECT_EQ(error.place(), "byte " + std::to_string(list + 12) + ", mvpBackupMaps");
  }
}

// Such a byte costs nothing where what is whole is saved: it is named.
TEST(EveryByteIsKeptOrRefused, SalvagingToleratesWhatIsNotKept) {
  std::size_t tolerated = 0;
  const std::string good = CraftTinyAtlas({}).bytes;
  for (std::size_t at = 0; at < good.size(); ++at) {
    std::string bytes = good;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x40);
    const Source source(std::as_bytes(std::span(bytes)), "changed.osa");
    std::string problem;
    std::size_t behind = 0;  // the value that was refused
    try {
      Notices notices;
      static_cast<void>(ReadOrbslam3(source, {}, notices));
    } catch (const Error& error) {
      problem = error.problem().substr(0, error.problem().find("; `RecoverAtlas`"));
      if (error.place().starts_with("byte ")) behind = std::stoul(error.place().substr(5));
    }
    if (behind <= at || behind - at > sizeof(std::uint32_t)) continue;  // of a count before it
    if (!problem.starts_with("class tracking") && !problem.starts_with("an item version") &&
        !problem.starts_with("a matrix flag"))
      continue;
    ++tolerated;
    const Salvage salvage = detail::SalvageOrbslam3(source, {});
    ASSERT_EQ(salvage.damage.size(), 1U) << at;
    EXPECT_THAT(salvage.damage[0], ::testing::HasSubstr(problem));
    EXPECT_TRUE(EncodeOrbslam3(salvage.atlas) == good) << at;
  }
  EXPECT_GT(tolerated, 100U);
}

}  // namespace
}  // namespace slamdb
