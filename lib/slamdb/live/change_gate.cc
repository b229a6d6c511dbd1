// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/change_gate.h"

#include <algorithm>
#include <vector>

#include "slamdb/base/error.h"

namespace slamdb::live {
namespace {

// The gates that this thread is inside of, and how deep: hardly ever more than one.
struct Held {
  const ChangeGate* gate;
  int depth;
};

std::vector<Held>& HeldHere() {
  thread_local std::vector<Held> held;
  return held;
}

Held* FindHeld(const ChangeGate* gate) {
  for (Held& held : HeldHere())
    if (held.gate == gate) return &held;
  return nullptr;
}

}  // namespace

void ChangeGate::Enter() {
  std::uint32_t state = state_.load(std::memory_order_relaxed);
  for (;;) {
    if ((state & kClosed) != 0) {
      state_.wait(state, std::memory_order_relaxed);
      state = state_.load(std::memory_order_relaxed);
    } else if (state_.compare_exchange_weak(state, state + 1, std::memory_order_acquire, std::memory_order_relaxed)) {
      return;
    }
  }
}

void ChangeGate::Leave() {
  if (state_.fetch_sub(1, std::memory_order_acq_rel) == (kClosed | 1U)) state_.notify_all();
}

void ChangeGate::Close() {
  std::uint32_t state = state_.fetch_or(kClosed, std::memory_order_acq_rel) | kClosed;
  while (state != kClosed) {
    state_.wait(state, std::memory_order_relaxed);
    state = state_.load(std::memory_order_acquire);
  }
}

void ChangeGate::Open() {
  state_.fetch_and(~kClosed, std::memory_order_release);
  state_.notify_all();
}

Change::Change(ChangeGate& gate) : gate_(gate) {
  if (Held* held = FindHeld(&gate); held != nullptr) {
    ++held->depth;
    return;
  }
  HeldHere().push_back({&gate, 1});
  gate.Enter();
}

Change::~Change() {
  Held* held = FindHeld(&gate_);
  if (--held->depth > 0) return;
  *held = HeldHere().back();
  HeldHere().pop_back();
  gate_.Leave();
}

ClosedGate::ClosedGate(ChangeGate& gate) : gate_(gate), alone_(gate.closer_, std::defer_lock) {
  if (FindHeld(&gate) != nullptr)
    throw Error(
        ErrorKind::kUsage,
        "a snapshot of the atlas was asked for inside a Change of it, for whose end it would wait: end it first");
  alone_.lock();
  gate_.Close();
}

ClosedGate::~ClosedGate() { gate_.Open(); }

}  // namespace slamdb::live
