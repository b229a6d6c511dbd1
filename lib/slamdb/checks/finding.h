// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/ids.h"

namespace slamdb {

// By what the owner of the file suffers.
enum class Severity {
  kNote,     // worth knowing; normal in healthy files
  kWarning,  // unusual, usable
  kError,    // a SLAM system crashes or misbehaves on load or later
};
SLAMDB_EXPORT std::string_view ToString(Severity severity);  // "note", "warning", "error"

// Where in an atlas: what does not apply is none. ToString: `map 0, kf 77, feature 12`, or `atlas` when all is none.
struct Place {
  MapId map = {};
  KeyFrameId keyframe = {};
  MapPointId point = {};
  CameraId camera = {};
  LandmarkId landmark = {};
  std::int64_t feature = -1;  // row of the keyframe's features; -1: none
  friend bool operator==(const Place&, const Place&) = default;
};
SLAMDB_EXPORT std::string ToString(const Place& place);

// One breach of one rule.
struct Finding {
  Place place;
  std::string message;  // the breach, behind the place: "observed by kf 77, which does not exist"
  friend bool operator==(const Finding&, const Finding&) = default;
};

// Collects what one rule finds: counts everything, keeps the first `limit`, and makes text only of those it keeps.
// For one thread; rules that run at the same time have one each.
class SLAMDB_EXPORT Findings {
 public:
  explicit Findings(std::size_t limit) : limit_(limit) {}

  // The message is the parts one behind the other: text, numbers, ids, and functions that return text (called only when
  // the finding is kept).
  template <class... Parts>
  void Add(const Place& place, const Parts&... parts) {
    if (count_++ >= limit_) return;
    std::string message;
    (Append(message, parts), ...);
    items_.push_back({place, std::move(message)});
  }

  std::uint64_t count() const { return count_; }
  std::vector<Finding>& items() { return items_; }

 private:
  static void Append(std::string& message, std::string_view text) { message += text; }
  static void Append(std::string& message, double value);
  template <std::integral Integer>
  static void Append(std::string& message, Integer value) {
    message += std::to_string(value);
  }
  template <class Entity>
  static void Append(std::string& message, Id<Entity> id) {
    message += ToString(id);
  }
  template <std::invocable MakeText>
  static void Append(std::string& message, const MakeText& make_text) {
    message += make_text();
  }

  std::size_t limit_;
  std::uint64_t count_ = 0;
  std::vector<Finding> items_;
};

}  // namespace slamdb
