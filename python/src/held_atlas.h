// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "python/src/unlocked.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/repair/journal.h"
#include "slamdb/model/atlas.h"

namespace slamdb::python {

// The value of a Python Atlas.
// Arrays, rows and running calls share the value that they began with: what changes the atlas works on a copy and puts
// it in place when it is done. So arrays never dangle, readers on other threads are not disturbed, and a call that
// fails or is interrupted changes nothing.
//
// All but the work in Apply and TakeOver is done with the GIL held.
class HeldAtlas {
 public:
  explicit HeldAtlas(Atlas atlas) : value_(std::make_shared<Atlas>(std::move(atlas))) {}

  const std::shared_ptr<Atlas>& value() const { return value_; }

  // For as long as it lives nothing else changes the atlas.
  // Throws Error: kNotPossible where another thread changes it, kUsage where it is of an edit that is over.
  class Changing {
   public:
    explicit Changing(HeldAtlas& held) : held_(held) {
      held_.RequireOpen();
      if (std::exchange(held_.changing_, true))
        throw Error(ErrorKind::kNotPossible, "another thread is changing this atlas; work on a copy()");
    }
    ~Changing() { held_.changing_ = false; }
    Changing(const Changing&) = delete;
    Changing& operator=(const Changing&) = delete;

   private:
    HeldAtlas& held_;
  };

  // `change(atlas)` runs without the GIL. Throws what it throws, and what Ctrl-C does until it is done.
  template <class Change>
  auto Apply(const Change& change) {
    const Changing guard(*this);
    std::shared_ptr<Atlas> changed;
    auto report = WithoutGil([&] {
      changed = std::make_shared<Atlas>(*value_);
      return change(*changed);
    });
    ThrowIfInterrupted();
    Settle(std::move(changed));
    return report;
  }

  // The same where `change` leaves an atlas as it was when it throws: in place and with the GIL, unless arrays, rows or
  // running calls share the value, so that many small changes do not copy the atlas as often.
  template <class Change>
  auto ApplyWhole(const Change& change) {
    ThrowIfInterrupted();
    if (value_.use_count() > 1) return Apply(change);
    const Changing guard(*this);
    return change(*value_);
  }

  // Puts what `edit` made of `before` in its place, and closes it; `make_journal(made)`, which runs without the GIL,
  // gives what takes it back; null: nothing does.
  // Throws Error (kNotPossible) where another value is in place, and as Apply does, for both.
  template <class MakeJournal>
  std::shared_ptr<const Journal> TakeOver(const std::shared_ptr<Atlas>& before, HeldAtlas& edit,
                                          const MakeJournal& make_journal) {
    const Changing guard(*this), guard_of_edit(edit);
    if (value_ != before) FailChanged();
    const std::shared_ptr<Atlas> made = edit.value_;
    std::shared_ptr<const Journal> journal = WithoutGil([&] { return make_journal(*made); });
    ThrowIfInterrupted();
    edit.RequireOpen();
    Settle(made);
    edit.Close();
    if (journal) history_.push_back(journal);
    return journal;
  }
  [[noreturn]] static void FailChanged() {
    throw Error(ErrorKind::kNotPossible, "the atlas was changed while the edit was open: change what edit.maps has");
  }

  // Of an edit: from now on nothing changes it, and what is changing it fails.
  void Close() { is_over_ = true; }
  void RequireOpen() const {
    if (is_over_)
      throw Error(ErrorKind::kUsage, "the edit is over: change the atlas itself, or begin another edit of it");
  }

  // It was read in part, and nothing has been made of the part since: references lead out of it.
  void MarkAsPart() { part_ = value_.get(); }
  bool is_part() const { return part_ == value_.get(); }

  // Of the edits that were put in place and not taken back, the last one last.
  const std::vector<std::shared_ptr<const Journal>>& history() const { return history_; }
  void ForgetLast() { history_.pop_back(); }

 private:
  // Of what took its time: the edit may be over meanwhile. Signal handlers, which may do anything, come before.
  void Settle(std::shared_ptr<Atlas> changed) {
    RequireOpen();
    value_ = std::move(changed);
  }

  std::vector<std::shared_ptr<const Journal>> history_;
  std::shared_ptr<Atlas> value_;
  const void* part_ = nullptr;
  bool changing_ = false;
  bool is_over_ = false;
};

}  // namespace slamdb::python
