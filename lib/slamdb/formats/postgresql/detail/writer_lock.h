// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "slamdb/base/progress.h"
#include "slamdb/formats/postgresql/detail/connection.h"

namespace slamdb::postgresql {

struct LockOptions {
  double timeout = 5;  // seconds; infinity: for ever
  Progress progress;   // called while it waits, and ends that by throwing. May be empty.
};

// Calls `take` until it is true, with pauses. Throws what `failure` gives when that takes longer than options.timeout.
void WaitForLock(const std::function<bool()>& take, const LockOptions& options, const std::function<Error()>& failure);

// Takes the lock of an atlas' name until the transaction ends: whoever changes an atlas holds it; readers need none.
// Throws Error (kLocked) that says who has it.
void LockAtlas(Connection& connection, const std::string& name, const LockOptions& options);

// A timestamptz as the store in SQLite has times, as SQL: `2026-01-31T12:00:00Z`.
std::string TextOfTime(std::string_view column);

}  // namespace slamdb::postgresql
