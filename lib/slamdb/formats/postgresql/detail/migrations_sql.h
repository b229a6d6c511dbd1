// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string_view>

namespace slamdb::postgresql {

// One step of the schema: schema/postgresql/<name>.sql brings a store from version number - 1 to `number`.
struct Migration {
  int number;
  std::string_view name;
  std::string_view sql;
};

// All of them, ascending from 1. Their SQL is compiled into the library.
std::span<const Migration> Migrations();

}  // namespace slamdb::postgresql
