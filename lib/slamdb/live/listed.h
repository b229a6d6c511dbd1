// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

namespace slamdb::live {

class Map;
struct Runtime;

// What maps and the change log keep in each keyframe and map point, so that neither needs a look-up.
//
// Public because KeyFrame and MapPoint are made of it; ObjectList and ChangeLog below, because Map and Runtime are.
class Listed {
 public:
  Listed(const Listed&) = delete;
  Listed& operator=(const Listed&) = delete;

  // Whether it belongs to the live atlas of that runtime, whose objects alone it may be linked to.
  bool IsOf(const Runtime& runtime) const { return runtime_ == &runtime; }

  // Whether the map lists it: it was added there and not erased since.
  // Thread-safe, as is Owner().
  bool IsListedIn(const Map* map) const { return map != nullptr && listed_in_.load(std::memory_order_acquire) == map; }

  // The map that it was added to last, whether it lists it still or not; null: none yet.
  Map* Owner() const { return owner_.load(std::memory_order_acquire); }

 protected:
  explicit Listed(Runtime& runtime) : runtime_(&runtime) {}

  bool is_owned() const { return Owner() != nullptr; }
  Runtime& runtime() const { return *runtime_; }
  void Join(Runtime& runtime) { runtime_ = &runtime; }

 private:
  friend class Map;
  template <class Object>
  friend class ObjectList;
  template <class Object>
  friend class ChangeLog;

  Runtime* runtime_;                       // of its atlas
  std::atomic<Map*> owner_ = nullptr;      // deletes it; null: the client does
  std::atomic<Map*> listed_in_ = nullptr;  // the owner, until it is erased
  std::uint32_t row_ = 0;                  // in the owner's list of live or of erased objects
  std::atomic<bool> changed_ = false;      // is in the change log
  void* next_changed_ = nullptr;
};

// Objects in the order in which they were added. Adding and removing take constant time. Not thread-safe.
template <class Object>
class ObjectList {
 public:
  void Reserve(std::size_t count) { rows_.reserve(count); }

  void Add(Object* object) {
    object->Listed::row_ = static_cast<std::uint32_t>(rows_.size());
    rows_.push_back(object);
    ++count_;
  }

  void Remove(Object* object) {
    rows_[object->Listed::row_] = nullptr;
    --count_;
    if (rows_.size() > 2 * count_ + kHolesAlways) CloseHoles();
  }

  std::size_t size() const { return count_; }

  // Which of two listed objects was added first.
  static bool IsBefore(const Object* a, const Object* b) { return a->Listed::row_ < b->Listed::row_; }

  std::vector<Object*> ToVector() const {
    std::vector<Object*> objects;
    objects.reserve(count_);
    for (Object* object : rows_)
      if (object != nullptr) objects.push_back(object);
    return objects;
  }

 private:
  static constexpr std::size_t kHolesAlways = 64;

  void CloseHoles() {
    std::vector<Object*> kept = ToVector();
    rows_.clear();
    count_ = 0;
    for (Object* object : kept) Add(object);
  }

  std::vector<Object*> rows_;  // null: removed
  std::size_t count_ = 0;
};

// The objects that changed since they were last taken: a stack through the objects themselves, so that marking a change
// allocates nothing and taking costs as much as changed. Both are thread-safe; one thread at a time takes. What is
// written before Add and read after Take is either seen or in the log again.
template <class Object>
class ChangeLog {
 public:
  void Add(Object* object) {
    Listed* listed = object;
    if (listed->changed_.exchange(true, std::memory_order_acq_rel)) return;
    void* head = head_.load(std::memory_order_relaxed);
    do {
      listed->next_changed_ = head;
    } while (!head_.compare_exchange_weak(head, object, std::memory_order_release, std::memory_order_relaxed));
  }

  std::vector<Object*> Take() {
    std::vector<Object*> objects;
    void* next = head_.exchange(nullptr, std::memory_order_acquire);
    while (next != nullptr) {
      auto* object = static_cast<Object*>(next);
      Listed* listed = object;
      next = listed->next_changed_;
      listed->changed_.exchange(false, std::memory_order_acq_rel);  // sees what an Add that came too late had written
      objects.push_back(object);
    }
    return objects;
  }

 private:
  std::atomic<void*> head_ = nullptr;
};

}  // namespace slamdb::live
