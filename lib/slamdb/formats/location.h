// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "slamdb/export.h"

namespace slamdb {

// Where an atlas is: a file, or one atlas of several in a store: a file (`store.db#name`) or a database of a PostgreSQL
// server (`postgresql://user@host/database#name`, also `postgres://`, as libpq has it).
// `-` is standard input or output.
// A text converts by Parse().
struct SLAMDB_EXPORT Location {
  std::string path;  // of a server the URI, with the password if it has one
  std::string name;  // in a store; empty: the only one

  Location() = default;
  Location(std::string file, std::string atlas) : path(std::move(file)), name(std::move(atlas)) {}
  Location(std::string_view text) : Location(Parse(text)) {}               // NOLINT(google-explicit-constructor)
  Location(const char* text) : Location(std::string_view(text)) {}         // NOLINT(google-explicit-constructor)
  Location(const std::string& text) : Location(std::string_view(text)) {}  // NOLINT(google-explicit-constructor)

  // Splits at the last `#` of the last component, unless the whole is a file, or named as one (`a#1.osa`). Of a server
  // at the last `#`: one in a user or password is percent-encoded (%23).
  static Location Parse(std::string_view text);
  bool is_server() const;
  // For people: without the password of a server.
  std::string ToString() const;
  friend bool operator==(const Location&, const Location&) = default;
};

}  // namespace slamdb
