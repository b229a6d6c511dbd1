// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace slamdb::live {

class KeyFrame;

// A keyframe that sees a point, and its keypoints that do.
struct Observer {
  KeyFrame* keyframe = nullptr;
  std::int32_t left = -1, right = -1;  // -1: not in that image
};

// The observers of a map point. Public because MapPoint and Atlas hold them by value. Lists of a loaded atlas stand
// side by side in few blocks, which the atlas keeps until it goes: a million lists of their own cost more than finding
// what belongs into them. A list that is full gets memory of its own, and leaves its place in the block unused. Not
// thread-safe.
class ObserverList {
 public:
  ObserverList() = default;
  ObserverList(const ObserverList&) = delete;
  ObserverList& operator=(const ObserverList&) = delete;

  // Replaces the list by `observers`, which stay where they are and outlive it.
  void Place(std::span<Observer> observers) {
    own_.reset();
    first_ = observers.data();
    size_ = capacity_ = static_cast<std::uint32_t>(observers.size());
  }

  // Moves it into memory of its own.
  void Own() { MoveTo(size_); }

  Observer* begin() { return first_; }
  Observer* end() { return first_ + size_; }
  const Observer* begin() const { return first_; }
  const Observer* end() const { return first_ + size_; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }

  Observer* Insert(Observer* before, const Observer& observer) {
    const std::ptrdiff_t row = before - first_;
    if (size_ == capacity_) MoveTo(std::max<std::uint32_t>(4, 2 * capacity_));
    std::move_backward(first_ + row, first_ + size_, first_ + size_ + 1);
    ++size_;
    first_[row] = observer;
    return first_ + row;
  }

  void Erase(Observer* observer) {
    std::move(observer + 1, end(), observer);
    --size_;
  }

  // What it holds; it is empty afterwards and has no memory.
  std::vector<Observer> Take() {
    std::vector<Observer> observers(begin(), end());
    Place({});
    return observers;
  }

 private:
  void MoveTo(std::uint32_t capacity) {
    auto moved = std::make_unique<Observer[]>(capacity);
    std::copy(begin(), end(), moved.get());
    own_ = std::move(moved);
    first_ = own_.get();
    capacity_ = capacity;
  }

  Observer* first_ = nullptr;
  std::uint32_t size_ = 0, capacity_ = 0;
  std::unique_ptr<Observer[]> own_;  // null: in a block of the atlas
};

}  // namespace slamdb::live
