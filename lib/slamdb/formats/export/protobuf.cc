// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/export/detail/protobuf.h"

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"

namespace slamdb::detail {

void ProtoAppender::AppendVarint(std::string& out, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) out += static_cast<char>(value | 0x80);
  out += static_cast<char>(value);
}

void ProtoFile::Fail(const char* at, const std::string& problem) const {
  throw Error(ErrorKind::kDamaged, path, at == nullptr ? "" : Concat("byte ", at - bytes.data()), problem);
}

void ProtoReader::FailTruncated() const {
  file_->Fail(rest_.data(), "a message of Protocol Buffers ends in a field: the file is truncated or damaged");
}

std::uint64_t ProtoReader::TakeVarint() {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 64; shift += 7) {
    if (rest_.empty()) FailTruncated();
    const auto byte = static_cast<unsigned char>(rest_[0]);
    rest_.remove_prefix(1);
    value |= std::uint64_t{byte & 0x7fU} << shift;
    if (byte < 0x80) return value;
  }
  file_->Fail(rest_.data(), "a number of more than 64 bits: the file is damaged");
}

std::uint64_t ProtoReader::TakeFixed(std::size_t bytes) {
  if (rest_.size() < bytes) FailTruncated();
  std::uint64_t value = 0;
  std::memcpy(&value, rest_.data(), bytes);
  rest_.remove_prefix(bytes);
  return value;
}

std::string_view ProtoReader::TakeDelimited() {
  const std::uint64_t size = TakeVarint();
  if (size > rest_.size())
    file_->Fail(rest_.data(), Concat("a length of ", size, " does not fit into the ", rest_.size(),
                                     " bytes left: the file is truncated or damaged"));
  const std::string_view bytes = rest_.substr(0, static_cast<std::size_t>(size));
  rest_.remove_prefix(bytes.size());
  return bytes;
}

bool ProtoReader::Next(ProtoField& field) {
  if (rest_.empty()) return false;
  const std::uint64_t tag = TakeVarint();
  field = {.number = static_cast<std::uint32_t>(tag >> 3U), .wire = static_cast<ProtoField::Wire>(tag & 7U)};
  if (field.number == 0 || tag >> 32U != 0)
    file_->Fail(rest_.data(), "a field without a number: the file is damaged, or no message of Protocol Buffers");
  switch (field.wire) {
    case ProtoField::Wire::kVarint:
      field.value = TakeVarint();
      return true;
    case ProtoField::Wire::kFixed64:
      field.value = TakeFixed(8);
      return true;
    case ProtoField::Wire::kFixed32:
      field.value = TakeFixed(4);
      return true;
    case ProtoField::Wire::kBytes:
      field.bytes = TakeDelimited();
      return true;
  }
  file_->Fail(rest_.data(), Concat("a field of kind ", tag & 7U, ": the file is damaged"));
}

}  // namespace slamdb::detail
