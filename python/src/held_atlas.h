// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <utility>

#include "slamdb/model/atlas.h"

namespace slamdb::python {

// The value of a Python Atlas.
// Arrays, rows and running calls share the value that they began with: what changes the atlas works on a copy and puts
// it in place when it is done. So arrays never dangle, readers on other threads are not disturbed, and a call that
// fails or is interrupted changes nothing.
//
// All but the work in Change is done with the GIL held.
class HeldAtlas {
 public:
  explicit HeldAtlas(Atlas atlas) : value_(std::make_shared<Atlas>(std::move(atlas))) {}

  const std::shared_ptr<Atlas>& value() const { return value_; }

  // `change(atlas)` runs without the GIL. Throws what it throws.
  template <class Change>
  auto Apply(const Change& change) {
    const Changing guard(*this);
    std::shared_ptr<Atlas> changed;
    auto report = [&] {
      const pybind11::gil_scoped_release unlocked;
      changed = std::make_shared<Atlas>(*value_);
      return change(*changed);
    }();
    value_ = std::move(changed);
    return report;
  }

 private:
  class Changing {
   public:
    explicit Changing(HeldAtlas& held) : held_(held) {
      if (std::exchange(held_.changing_, true))
        throw std::runtime_error("another thread is changing this atlas; work on a copy()");
    }
    ~Changing() { held_.changing_ = false; }
    Changing(const Changing&) = delete;
    Changing& operator=(const Changing&) = delete;

   private:
    HeldAtlas& held_;
  };

  std::shared_ptr<Atlas> value_;
  bool changing_ = false;
};

}  // namespace slamdb::python
