// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "slamdb/base/error.h"

namespace slamdb::postgresql {

// What a server says, or the connection to it. Kinds as everywhere; that the connection was lost, or that the server
// is about to stop or to be there, is kLocked, as trying again later may help.
class ServerError : public Error {
 public:
  ServerError(const Error& error, std::string state) : Error(error), state_(std::move(state)) {}

  // The SQLSTATE: five letters (PostgreSQL's documentation, appendix A). Empty: the server said nothing.
  const std::string& state() const { return state_; }
  // No server answered at all.
  bool is_unreachable() const { return kind() == ErrorKind::kNotFound && state_.empty(); }

 private:
  std::string state_;
};

// The error that a state and its message are. `message` is made visible; it must not hold a password.
ServerError ErrorOfState(const std::string& path, const std::string& place, std::string_view state,
                         std::string_view message);

// That nothing more can be heard of the server.
ServerError ConnectionLost(const std::string& path, const std::string& place, std::string_view message);

// That no server answers where it should be.
ServerError NoServer(const std::string& path, std::string_view message);

// True when all that was done in the transaction was for nothing, and doing it again may succeed: others were at work
// on the same rows, the server stops or starts, the connection was lost, or none could be made.
bool IsWorthRetrying(const Error& error);

}  // namespace slamdb::postgresql
