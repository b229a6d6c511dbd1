// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/formats/postgresql/detail/row.h"

namespace slamdb::postgresql {

// The rows of a binary COPY, out of the messages that it comes in. A message holds whole rows; the first begins with
// the signature, and the last row is followed by a trailer. Throws Error (kDamaged) where that is not so.
class CopyRows {
 public:
  explicit CopyRows(RowOrigin origin) : origin_(std::move(origin)) {}

  // The next message, which must live as long as rows of it are looked at.
  void Take(Bytes message);
  // The next row of the message; false: it has no more.
  bool Next();
  Row row() const { return {fields_, origin_}; }
  // After the last message: throws when the trailer is missing.
  void CheckEnd() const;

 private:
  void TakeHeader();
  Bytes TakeBytes(std::size_t size);
  [[noreturn]] void ThrowDamaged(const char* problem) const;

  RowOrigin origin_;
  Bytes rest_;
  std::vector<Field> fields_;
  bool has_header_ = false, has_trailer_ = false;
};

}  // namespace slamdb::postgresql
