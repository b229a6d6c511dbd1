// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/base/file.h"

// Little-endian bytes of records, and reading them without trust.
namespace slamdb::detail {

static_assert(std::endian::native == std::endian::little, "hashes and the store's blobs are of little-endian bytes");

// Bytes that grow. Kept and cleared between uses, so that its memory is allocated once.
class ByteWriter {
 public:
  ByteWriter() = default;
  explicit ByteWriter(std::string bytes) : bytes_(std::move(bytes)) {}  // goes on behind them

  std::string Take() { return std::move(bytes_); }
  Bytes bytes() const { return std::as_bytes(std::span(bytes_)); }
  void Clear() { bytes_.clear(); }

  template <class T>
  void Put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T> && std::has_unique_object_representations_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  void Put(float value) { Put(std::bit_cast<std::uint32_t>(value)); }
  void Put(double value) { Put(std::bit_cast<std::uint64_t>(value)); }
  void PutBytes(Bytes bytes) { bytes_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size()); }

  // Room for `size` more bytes, which the caller fills before the next call.
  char* Extend(std::size_t size) {
    const std::size_t old = bytes_.size();
    bytes_.resize(old + size);
    return bytes_.data() + old;
  }

  // The number of elements, then the elements.
  template <class Vector>
  void PutVector(const Vector& values) {
    Put(static_cast<std::uint32_t>(values.size()));
    PutBytes(std::as_bytes(std::span(values.data(), values.size())));
  }

 private:
  std::string bytes_;
};

// Reads a blob from front to back. Throws Error when it is too short; sizes are compared before anything is allocated.
class ByteReader {
 public:
  explicit ByteReader(Bytes bytes) : rest_(bytes) {}

  const std::byte* Take(std::size_t size) {
    if (size > rest_.size()) {
      throw Error(ErrorKind::kDamaged, Concat("blob too short: ", size, " more bytes expected, found ", rest_.size()));
    }
    const std::byte* begin = rest_.data();
    rest_ = rest_.subspan(size);
    return begin;
  }
  // The bytes of `count` elements of `size` bytes.
  const std::byte* TakeArray(std::size_t count, std::size_t size) {
    if (size != 0 && count > rest_.size() / size) {
      throw Error(ErrorKind::kDamaged, Concat("blob too short: ", count, " elements of ", size,
                                              " bytes expected, found ", rest_.size(), " bytes"));
    }
    return Take(count * size);
  }
  template <class T>
  T Get() {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    std::memcpy(&value, Take(sizeof(T)), sizeof(T));
    return value;
  }
  template <class Vector>
  void GetVector(Vector& values) {
    const auto count = Get<std::uint32_t>();
    const std::byte* begin = TakeArray(count, sizeof(typename Vector::value_type));
    values.resize(count);
    if (count > 0) std::memcpy(static_cast<void*>(values.data()), begin, count * sizeof(typename Vector::value_type));
  }
  std::size_t left() const { return rest_.size(); }
  Bytes rest() const { return rest_; }
  void ExpectEnd() const {
    if (!rest_.empty()) throw Error(ErrorKind::kDamaged, Concat("blob too long: ", rest_.size(), " bytes left over"));
  }

 private:
  Bytes rest_;
};

}  // namespace slamdb::detail
