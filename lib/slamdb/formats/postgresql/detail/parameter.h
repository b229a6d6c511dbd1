// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "slamdb/base/file.h"

namespace slamdb::postgresql {

using Uuid = std::array<std::byte, 16>;

// What stands for `$1` of a statement: its type, and its bytes, which are copied.
//   connection.Query("SELECT id FROM map WHERE atlas = $1 AND id = ANY($2)", {atlas, ids});
class Parameter {
 public:
  template <std::integral Integer>
  requires(std::is_signed_v<Integer> || sizeof(Integer) < sizeof(std::int64_t)) Parameter(Integer value)
      : Parameter(static_cast<std::int64_t>(value)) {}                       // NOLINT(google-explicit-constructor)
  Parameter(std::int64_t value);                                             // NOLINT(google-explicit-constructor)
  Parameter(bool value);                                                     // NOLINT(google-explicit-constructor)
  Parameter(double value);                                                   // NOLINT(google-explicit-constructor)
  Parameter(std::string_view text);                                          // NOLINT(google-explicit-constructor)
  Parameter(const std::string& text) : Parameter(std::string_view(text)) {}  // NOLINT(google-explicit-constructor)
  Parameter(const char* text) : Parameter(std::string_view(text)) {}         // NOLINT(google-explicit-constructor)
  Parameter(Bytes blob);                                                     // NOLINT(google-explicit-constructor)
  Parameter(const Uuid& uuid);                                               // NOLINT(google-explicit-constructor)
  Parameter(std::span<const std::int64_t> values);                           // NOLINT(google-explicit-constructor)
  Parameter(std::span<const std::int32_t> values);                           // NOLINT(google-explicit-constructor)
  Parameter(std::span<const std::string> texts);                             // NOLINT(google-explicit-constructor)
  Parameter(std::span<const Bytes> blobs);                                   // NOLINT(google-explicit-constructor)
  Parameter(std::span<const Uuid> uuids);                                    // NOLINT(google-explicit-constructor)

  // bit(n), eight of a byte.
  static Parameter Bits(Bytes bits);
  // NULL, of the type that the statement wants.
  static Parameter Null() { return Parameter(0, {}, true); }

  std::uint32_t type() const { return type_; }  // as in types.h; 0: what the statement wants
  bool is_null() const { return is_null_; }
  const std::string& bytes() const { return bytes_; }

 private:
  Parameter(std::uint32_t type, std::string bytes, bool is_null)
      : type_(type), bytes_(std::move(bytes)), is_null_(is_null) {}

  std::uint32_t type_;
  std::string bytes_;
  bool is_null_ = false;
};

}  // namespace slamdb::postgresql
