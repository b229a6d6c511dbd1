// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <utility>
#include <vector>

#include "slamdb/edit/repair/journal.h"
#include "slamdb/model/atlas.h"

namespace slamdb::python {

// The value of a Python Atlas.
// Arrays, rows and running calls share the value that they began with: what changes the atlas works on a copy and puts
// it in place when it is done. So arrays never dangle, readers on other threads are not disturbed, and a call that
// fails or is interrupted changes nothing.
//
// All but the work in Apply is done with the GIL held.
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

  // The same where `change` leaves an atlas as it was when it throws: in place and with the GIL, unless arrays, rows or
  // running calls share the value, so that many small changes do not copy the atlas as often.
  template <class Change>
  auto ApplyWhole(const Change& change) {
    if (value_.use_count() > 1) return Apply(change);
    const Changing guard(*this);
    return change(*value_);
  }

  // Puts another value in place, which `journal` takes back; null: nothing does.
  void Put(std::shared_ptr<Atlas> value, std::shared_ptr<const Journal> journal) {
    const Changing guard(*this);
    value_ = std::move(value);
    if (journal) history_.push_back(std::move(journal));
  }

  // Of the edits that were put in place and not taken back, the last one last.
  const std::vector<std::shared_ptr<const Journal>>& history() const { return history_; }
  void ForgetLast() { history_.pop_back(); }

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

  std::vector<std::shared_ptr<const Journal>> history_;
  std::shared_ptr<Atlas> value_;
  bool changing_ = false;
};

}  // namespace slamdb::python
