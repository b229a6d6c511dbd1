// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/kept_rows.h"

#include <algorithm>

namespace slamdb::postgresql {

void KeptRows::Keep(const CopyReader& reader) {
  const Row row = reader.row();
  if (messages_.empty()) origin_ = row.origin();
  messages_.push_back(reader.message());
  fields_.insert(fields_.end(), row.fields().begin(), row.fields().end());
  columns_ = row.columns();
  for (const Field& field : row.fields()) bytes_ += static_cast<std::size_t>(std::max(field.size, 0));
}

Row KeptRows::operator[](std::size_t i) const { return {std::span(fields_).subspan(i * columns_, columns_), origin_}; }

}  // namespace slamdb::postgresql
