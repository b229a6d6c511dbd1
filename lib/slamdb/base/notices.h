// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace slamdb {

// What a reader or writer has to say about work that succeeded.
struct Notice {
  enum class Kind {
    kNote,     // worth knowing
    kWarning,  // unusual; the result may not be what the user expects
    kLoss,     // something of the input is not in an output that claims to hold an atlas: the command line exits 3
  };
  Kind kind;
  std::string text;
  friend bool operator==(const Notice&, const Notice&) = default;
};

// How much of an atlas an export holds.
struct WrittenCounts {
  std::uint64_t keyframes = 0, points = 0;  // keyframes: or poses
};

// Collects notices in the order they come.
//
// Not thread-safe.
class Notices {
 public:
  void Note(std::string text) { items_.push_back({Notice::Kind::kNote, std::move(text)}); }
  void Warn(std::string text) { items_.push_back({Notice::Kind::kWarning, std::move(text)}); }
  void Lose(std::string text) { items_.push_back({Notice::Kind::kLoss, std::move(text)}); }

  // All of those, behind the ones that are there.
  void Add(const Notices& others) { items_.insert(items_.end(), others.items_.begin(), others.items_.end()); }

  // What an export holds: `12,345 points, 41 bad ones left out`, and how many that is, where that are keyframes or
  // points.
  void Tell(std::string written, std::optional<WrittenCounts> counts = std::nullopt) {
    written_ = std::move(written);
    counts_ = counts;
  }

  const std::vector<Notice>& items() const { return items_; }
  // Of the last export; empty when there was none.
  const std::string& written() const { return written_; }
  const std::optional<WrittenCounts>& counts() const { return counts_; }
  bool lossy() const {
    for (const Notice& notice : items_)
      if (notice.kind == Notice::Kind::kLoss) return true;
    return false;
  }

 private:
  std::vector<Notice> items_;
  std::string written_;
  std::optional<WrittenCounts> counts_;
};

}  // namespace slamdb
