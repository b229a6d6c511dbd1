// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/notices.h"

#include "slamdb/base/detail/server.h"

namespace slamdb {

void Notices::Add(Notice::Kind kind, std::string text) {
  items_.push_back({kind, detail::WithoutPasswords(std::move(text))});
}

}  // namespace slamdb
