// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "slamdb/base/error.h"
#include "slamdb/formats/orbslam3/detail/input.h"

// Tokens with room behind them are read by short ways, the last ones of a stretch by the way that knows every token:
// both must find the same values and the same errors.
namespace slamdb::orbslam3 {
namespace {

const ArchiveEncoding kText{.text = true};

// What became of reading: the bytes of the values and where the cursor stands, or the error.
struct Outcome {
  std::string values, error;
  std::size_t offset = 0;
  friend bool operator==(const Outcome&, const Outcome&) = default;
};
std::ostream& operator<<(std::ostream& out, const Outcome& outcome) {
  for (const char byte : outcome.values) out << static_cast<int>(byte) << ' ';
  return out << "up to " << outcome.offset << ' ' << outcome.error;
}

// take(input) returns a vector of numbers. The cursor sees `text` up to `end`.
template <class Take>
Outcome Read(const std::string& text, std::size_t end, const Take& take) {
  detail::FileStream stream({std::as_bytes(std::span(text)), "text"});
  TextInput input(&stream, kText);
  input.Confine(1, end);  // behind a character, as behind a header
  Outcome outcome;
  try {
    const auto values = take(input);
    outcome.values.assign(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
    outcome.offset = input.offset();
  } catch (const Error& error) {
    outcome.error = error.what();
  }
  return outcome;
}

class Random {
 public:
  std::size_t Below(std::size_t bound) { return static_cast<std::size_t>(engine_() % bound); }
  char OneOf(std::string_view characters) { return characters[Below(characters.size())]; }
  std::string Digits(std::size_t count) {
    std::string digits;
    while (digits.size() < count) digits += OneOf("0123456789");
    return digits;
  }
  std::string Integer() { return (Below(4) == 0 ? "-" : "") + Digits(1 + Below(Below(3) == 0 ? 21 : 4)); }
  std::string Float() {
    const std::size_t digits = Below(5) == 0 ? Below(20) : Below(2) == 0 ? 9 : 17;
    const std::string exponent = Digits(Below(10) == 0 ? 1 + Below(4) : 2);
    return (Below(4) == 0 ? "-" : "") + Digits(1) + "." + Digits(digits) + "e" + OneOf("+-") +
           (Below(2) == 0 ? "0" + exponent.substr(1) : exponent);
  }
  // Sometimes with a character that is changed, put in or left out.
  std::string Damaged(std::string token) {
    const std::size_t at = Below(token.size()), kind = Below(6);
    const char other = OneOf("0123456789-+.eEx/: \n\r\t,\x7f\x80\xff");
    if (kind == 0) token[at] = other;
    if (kind == 1) token.insert(at, 1, other);
    if (kind == 2) token.erase(at, 1);
    return token;
  }

 private:
  std::mt19937_64 engine_{16};
};

template <class T>
void ExpectSameNearTheEnd(Random& random, const std::string& token) {
  const auto take = [](TextInput& input) { return std::array<T, 1>{input.Take<T>()}; };
  const char* const separators[] = {" ", " ", " ", "\n", "\r\n", "  ", ""};
  const std::string text = "#" + std::string(separators[random.Below(7)]) + token + separators[random.Below(7)];
  const std::string further = text + std::string(100, '7');
  // What the token is cut off from is seen by the one that ends behind it, where no token may end.
  if (token.empty() || text.back() == token.back()) return;
  EXPECT_EQ(Read(further, further.size(), take), Read(further, text.size(), take)) << '"' << text << '"';
}

TEST(TextTokens, AreTheSameNearTheEndAndFarFromIt) {
  Random random;
  for (int i = 0; i < 50'000; ++i) {
    const std::string integer = random.Damaged(random.Integer()), number = random.Damaged(random.Float());
    ExpectSameNearTheEnd<std::uint8_t>(random, integer);
    ExpectSameNearTheEnd<std::int16_t>(random, integer);
    ExpectSameNearTheEnd<std::int32_t>(random, integer);
    ExpectSameNearTheEnd<std::uint32_t>(random, integer);
    ExpectSameNearTheEnd<std::int64_t>(random, integer);
    ExpectSameNearTheEnd<std::uint64_t>(random, integer);
    ExpectSameNearTheEnd<float>(random, number);
    ExpectSameNearTheEnd<double>(random, number);
    if (HasFailure()) return;
  }
}

TEST(TextTokens, BytesAreTheSameOneByOneAndAllAtOnce) {
  Random random;
  for (int i = 0; i < 20'000; ++i) {
    const std::size_t count = random.Below(200), damaged = random.Below(count + 1);
    std::string text = "#";
    for (std::size_t k = 0; k < count; ++k) {
      const std::string token = std::to_string(random.Below(256));
      text += " " + (k == damaged ? random.Damaged(token) : token);
    }
    text += random.OneOf(" \n") + random.Digits(random.Below(200));
    std::vector<std::uint8_t> values(count);
    const auto at_once = [&](TextInput& input) {
      input.TakeArray(values.data(), count);
      return values;
    };
    const auto one_by_one = [&](TextInput& input) {
      for (std::uint8_t& value : values) value = input.Take<std::uint8_t>();
      return values;
    };
    ASSERT_EQ(Read(text, text.size(), at_once), Read(text, text.size(), one_by_one)) << text;
  }
}

TEST(TextTokens, OfBytesEndAtSpacesAlone) {
  for (std::size_t count = 1; count < 100; ++count) {
    for (std::size_t damaged = 0; damaged < count; ++damaged) {
      std::string text = "#";
      for (std::size_t k = 0; k < count; ++k) text += k == damaged ? " 12\t" : " 123";
      text += std::string(200, ' ');
      std::vector<std::uint8_t> values(count);
      const auto take = [&](TextInput& input) {
        input.TakeArray(values.data(), count);
        return values;
      };
      ASSERT_NE(Read(text, text.size(), take).error.find("found '12\t'"), std::string::npos) << text;
    }
  }
}

TEST(TextTokens, OfManyCharactersIsNoByte) {
  for (std::size_t length = 4; length < 600; ++length) {
    const std::string text = "# 1 " + std::string(length - 4, '0') + "/999 " + std::string(700, '7');
    const auto take = [](TextInput& input) {
      std::array<std::uint8_t, 2> values{};
      input.TakeArray(values.data(), values.size());
      return values;
    };
    ASSERT_FALSE(Read(text, text.size(), take).error.empty()) << length;
  }
}

TEST(TextTokens, AreSkippedToTheEndOfTheLastOne) {
  Random random;
  const char* const separators[] = {" ", " ", " ", "\n", "\r\n"};
  for (int i = 0; i < 20'000; ++i) {
    const std::size_t count = 1 + random.Below(random.Below(2) == 0 ? 3 : 200), skipped = 1 + random.Below(count);
    std::string text = "#";
    std::size_t end = 0;
    for (std::size_t k = 0; k < count; ++k) {
      text += separators[random.Below(5)] + (random.Below(3) == 0 ? random.Float() : random.Integer());
      if (k + 1 == skipped) end = text.size();
    }
    const auto skip = [&](TextInput& input) {
      input.SkipArray<int>(skipped);
      return std::vector<int>();
    };
    const std::string whole = text + " ";
    ASSERT_EQ(Read(whole, whole.size(), skip), (Outcome{"", "", end})) << skipped << " of " << text;
    const bool cut = Read(text, text.size(), skip).error.find("truncated") != std::string::npos;
    ASSERT_EQ(cut, skipped == count) << text;
  }
}

}  // namespace
}  // namespace slamdb::orbslam3
