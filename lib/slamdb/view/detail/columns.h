// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

// The columns of a page's data, see schema/view.md.
namespace slamdb::view {

static_assert(std::endian::native == std::endian::little, "columns are little endian");

struct NamedColumn {
  std::string name, bytes;
};
using Columns = std::vector<NamedColumn>;

// A column of numbers that small ones dominate.
class VarintColumn {
 public:
  void Reserve(std::size_t bytes) { bytes_.reserve(bytes); }

  void Add(std::uint64_t value) {
    while (value >= 0x80) {
      bytes_.push_back(static_cast<char>(value | 0x80));
      value >>= 7;
    }
    bytes_.push_back(static_cast<char>(value));
  }
  void AddSigned(std::int64_t value) {
    const auto bits = static_cast<std::uint64_t>(value);
    Add(bits << 1 ^ (value < 0 ? ~std::uint64_t{0} : 0));
  }
  // The difference to the value before, of which the first is 0. Ids of 64 bits wrap round.
  void AddDifference(std::uint64_t value) {
    AddSigned(static_cast<std::int64_t>(value - last_));
    last_ = value;
  }

  std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  std::uint64_t last_ = 0;
};

// Appends the bytes of numbers.
template <class... Numbers>
void AppendBytes(std::string& bytes, const Numbers&... numbers) {
  static_assert((std::is_trivially_copyable_v<Numbers> && ...));
  (bytes.append(reinterpret_cast<const char*>(&numbers), sizeof(numbers)), ...);
}

}  // namespace slamdb::view
