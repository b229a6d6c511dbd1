// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/copy_rows.h"

#include <cstring>

#include "slamdb/base/error.h"
#include "slamdb/formats/postgresql/detail/encode.h"

namespace slamdb::postgresql {

void CopyRows::ThrowDamaged(const char* problem) const {
  throw Error(ErrorKind::kDamaged, origin_.path, origin_.place, problem);
}

Bytes CopyRows::TakeBytes(std::size_t size) {
  if (rest_.size() < size) ThrowDamaged("a row of a binary COPY that is cut");
  const Bytes bytes = rest_.first(size);
  rest_ = rest_.subspan(size);
  return bytes;
}

// The signature, flags, and an extension that may be skipped. Flags of the upper half change the format.
void CopyRows::TakeHeader() {
  const Bytes signature = TakeBytes(kCopySignature.size());
  if (std::memcmp(signature.data(), kCopySignature.data(), signature.size()) != 0)
    ThrowDamaged("expected the signature of a binary COPY");
  const auto flags = BigEndian<std::uint32_t>(TakeBytes(4).data());
  if (flags >> 16U != 0) ThrowDamaged("a binary COPY with flags that this program does not know");
  TakeBytes(BigEndian<std::uint32_t>(TakeBytes(4).data()));
  has_header_ = true;
}

void CopyRows::Take(Bytes message) {
  rest_ = message;
  if (!has_header_) TakeHeader();
}

bool CopyRows::Next() {
  if (rest_.empty()) return false;
  const auto columns = BigEndian<std::int16_t>(TakeBytes(2).data());
  if (has_trailer_) ThrowDamaged("a row behind the end of a binary COPY");
  if (columns == kCopyTrailer) {
    has_trailer_ = true;
    if (!rest_.empty()) ThrowDamaged("bytes behind the end of a binary COPY");
    return false;
  }
  if (columns < 0) ThrowDamaged("a row with less than no columns");
  fields_.resize(static_cast<std::size_t>(columns));
  for (Field& field : fields_) {
    field.size = BigEndian<std::int32_t>(TakeBytes(4).data());
    if (field.size < Field::kNull) ThrowDamaged("a column with less than no bytes");
    field.data = field.size == Field::kNull ? nullptr : TakeBytes(static_cast<std::size_t>(field.size)).data();
  }
  return true;
}

void CopyRows::CheckEnd() const {
  if (!has_trailer_) ThrowDamaged("a binary COPY without its end");
}

}  // namespace slamdb::postgresql
