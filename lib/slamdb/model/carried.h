// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "slamdb/model/matrix.h"

namespace slamdb {

// What a value has only rarely: a null pointer, or a T of its own.
// Copying copies the T; two are equal when both are null, or what they hold is.
template <class T>
class Boxed {
 public:
  Boxed() = default;
  Boxed(const Boxed& other) : value_(other.value_ ? std::make_unique<T>(*other.value_) : nullptr) {}
  Boxed(Boxed&&) noexcept = default;
  Boxed& operator=(const Boxed& other) {
    if (this != &other) value_ = other.value_ ? std::make_unique<T>(*other.value_) : nullptr;
    return *this;
  }
  Boxed& operator=(Boxed&&) noexcept = default;
  ~Boxed() = default;

  explicit operator bool() const { return value_ != nullptr; }
  const T& operator*() const { return *value_; }
  const T* operator->() const { return value_.get(); }
  // To be changed; made when there is none.
  T& Make() {
    if (!value_) value_ = std::make_unique<T>();
    return *value_;
  }
  void Reset() { value_.reset(); }

  friend bool operator==(const Boxed& a, const Boxed& b) {
    return a.value_ && b.value_ ? *a.value_ == *b.value_ : !a.value_ && !b.value_;
  }

 private:
  std::unique_ptr<T> value_;
};

// What a file has of an entity and the model does not know: members of a fork's classes, and descriptors of another
// kind than ORB's.
struct Carried {
  // The members that are no part of the model, one behind the other in the order of Atlas::layout, packed as
  // schema/layouts.md says. Ids in them are not translated when entities get new ones.
  Column<std::byte> members;
  // Of a keyframe, where they are not 32 bytes each: SIFT, SuperPoint. Row r is keypoint r; Features::descriptors is
  // empty then. Of a point: one row. No columns: none.
  Matrix descriptors;

  bool empty() const { return members.empty() && descriptors == Matrix(); }
  friend bool operator==(const Carried&, const Carried&) = default;
};

}  // namespace slamdb
