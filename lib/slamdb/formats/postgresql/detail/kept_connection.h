// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "slamdb/formats/postgresql/detail/connection.h"

namespace slamdb::postgresql {

// A connection that goes on when this does: each thread keeps the last one, so that verbs that open a store for each of
// ten thousand atlases connect once. One that was lost meanwhile is made anew. A process that forks leaves it to its
// parent.
class KeptConnection {
 public:
  explicit KeptConnection(const std::string& uri, const ConnectionOptions& options = {});
  ~KeptConnection();
  KeptConnection(const KeptConnection&) = delete;
  KeptConnection& operator=(const KeptConnection&) = delete;

  Connection& operator*() const { return *connection_; }
  Connection* operator->() const { return connection_.get(); }
  // Whether it is one that was there.
  bool is_kept() const { return is_kept_; }

 private:
  std::string uri_;
  std::unique_ptr<Connection> connection_;
  bool is_kept_ = false;
};

}  // namespace slamdb::postgresql
