// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "tests/support/postgresql_server.h"

namespace slamdb {

// PgBouncer in front of a server, in transaction mode: all clients of a database share `connections` of the server's,
// and each transaction gets another one. It ends with this object.
class PgBouncer {
 public:
  // Tests do without it, by name: if (!PgBouncer::IsInstalled()) GTEST_SKIP() << "pgbouncer is not installed";
  static bool IsInstalled();

  // `settings` go into its file, a line each.
  PgBouncer(const PostgresqlServer& server, int connections, std::string_view settings = {});
  ~PgBouncer();
  PgBouncer(const PgBouncer&) = delete;
  PgBouncer& operator=(const PgBouncer&) = delete;

  // Through its socket, as the server's superuser.
  std::string Uri(std::string_view database) const;

 private:
  bool Answers() const;

  std::filesystem::path folder_;
  int port_ = 0;
  pid_t process_ = 0;
};

}  // namespace slamdb
