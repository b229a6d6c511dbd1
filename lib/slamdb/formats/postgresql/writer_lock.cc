// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/writer_lock.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/hash.h"

namespace slamdb::postgresql {
namespace {

constexpr std::chrono::milliseconds kFirstPause{1}, kLongestPause{100};

std::int64_t KeyOf(const std::string& name) {
  return static_cast<std::int64_t>(detail::HashBytes(std::as_bytes(std::span(name))));
}

// Who has the lock, as far as the server tells us.
std::string HolderOf(Connection& connection, std::int64_t key) {
  const Result found = connection.Query(
      "SELECT coalesce(nullif(application_name, ''), 'another program'), coalesce(usename, ''), activity.pid FROM "
      "pg_locks JOIN pg_stat_activity AS activity USING (pid) WHERE locktype = 'advisory' AND granted AND objsubid = 1 "
      "AND database = (SELECT oid FROM pg_database WHERE datname = current_database()) AND (classid::bigint << 32 | "
      "objid::bigint) = $1",
      {key});
  if (found.rows() == 0) return "another program";
  const Row row = found[0];
  return detail::Concat(row.Text(0), row.Text(1).empty() ? "" : ", as ", row.Text(1), ", server process ",
                        row.Integer(2));
}

}  // namespace

void WaitForLock(const std::function<bool()>& take, const LockOptions& options, const std::function<Error()>& failure) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  for (std::chrono::milliseconds pause = kFirstPause;; pause = std::min(2 * pause, kLongestPause)) {
    if (take()) return;
    if (std::chrono::duration<double>(Clock::now() - start).count() >= options.timeout) throw failure();
    if (options.progress) options.progress("waiting for the lock", 0);
    std::this_thread::sleep_for(pause);
  }
}

void LockAtlas(Connection& connection, const std::string& name, const LockOptions& options) {
  const std::int64_t key = KeyOf(name);
  WaitForLock([&] { return connection.Integer("SELECT pg_try_advisory_xact_lock($1)", {key}) != 0; }, options,
              [&] {
                return Error(ErrorKind::kLocked, connection.path(), "",
                             detail::Concat("'", name, "' is locked by ", HolderOf(connection, key)));
              });
}

std::string TextOfTime(std::string_view column) {
  return detail::Concat("to_char(", column, " AT TIME ZONE 'UTC', 'YYYY-MM-DD\"T\"HH24:MI:SS\"Z\"')");
}

}  // namespace slamdb::postgresql
