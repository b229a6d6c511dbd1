// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/kept_connection.h"

#include <unistd.h>

#include <utility>

namespace slamdb::postgresql {
namespace {

struct Kept {
  std::string uri;
  pid_t process = 0;
  std::unique_ptr<Connection> connection;

  ~Kept() { Forget(); }
  // Its parent goes on with a connection that a forked process only inherited: to close it would say goodbye for both.
  void Forget() {
    if (process != ::getpid()) (void)connection.release();
    connection.reset();
  }
};
thread_local Kept kept;

bool Answers(Connection& connection) {
  try {
    connection.Execute("SELECT 1");
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

KeptConnection::KeptConnection(const std::string& uri, const ConnectionOptions& options) : uri_(uri) {
  if (kept.connection != nullptr && kept.uri == uri && kept.process == ::getpid()) {
    connection_ = std::move(kept.connection);
    is_kept_ = Answers(*connection_);
  }
  if (!is_kept_) connection_ = std::make_unique<Connection>(uri, options);
}

KeptConnection::~KeptConnection() {
  if (connection_ == nullptr || connection_->is_lost()) return;
  kept.Forget();
  kept.uri = uri_;
  kept.process = ::getpid();
  kept.connection = std::move(connection_);
}

}  // namespace slamdb::postgresql
