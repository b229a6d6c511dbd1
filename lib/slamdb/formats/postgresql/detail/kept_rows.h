// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "slamdb/formats/postgresql/detail/connection.h"

namespace slamdb::postgresql {

// Rows of one copy that stay when the reader goes on, to be looked at by another thread than the one that reads.
class KeptRows {
 public:
  // The reader's row. Its bytes are not copied.
  void Keep(const CopyReader& reader);

  std::size_t size() const { return messages_.size(); }
  std::size_t bytes() const { return bytes_; }  // of all columns
  Row operator[](std::size_t i) const;          // valid as long as this is

 private:
  RowOrigin origin_;
  std::vector<std::shared_ptr<const char>> messages_;  // of each row the one that it is in
  std::vector<Field> fields_;                          // of all rows
  std::size_t columns_ = 0, bytes_ = 0;
};

}  // namespace slamdb::postgresql
