// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "slamdb/formats/layouts/layout.h"

// What the members of ORB-SLAM3's keyframes and map points are like: how well bytes fit the member that they are taken
// for.
namespace slamdb::layouts {

// What a record has told so far, for members that must agree with it. Negative: nothing.
struct RecordFacts {
  enum Fact : std::uint8_t {
    kId,
    kColumns,  // of the grid
    kRows,
    kCellWidth,  // inverted
    kCellHeight,
    kLeft,  // bounds
    kTop,
    kFx,
    kFy,
    kBaseline,
    kFeatures,   // N
    kKeypoints,  // of the left image
    kLevels,
    kFactor,
    kCount,  // nObs
    kObservers,
    kFirstObserver,
    kLastObserver,
    kLeast,  // mfMinDistance
    kFacts
  };
  std::array<double, kFacts> values;

  RecordFacts() { values.fill(-1); }
  double operator[](Fact fact) const { return values[fact]; }
  double& operator[](Fact fact) { return values[fact]; }
  friend bool operator==(const RecordFacts&, const RecordFacts&) = default;
};

// Where a member of a record would stand.
struct MemberPlace {
  std::uint64_t begin = 0, end = 0;
};

inline constexpr int kNoPenalty = 0;
inline constexpr int kBadPenalty = 100;  // it can hardly be the member

// What speaks against the bytes being the member, from 0 to kBadPenalty.
using MemberCheck = int (*)(std::string_view file, MemberPlace place, RecordFacts& facts);

struct MemberTraits {
  bool differs = false;   // from record to record
  bool constant = false;  // in all records of a session
  bool anchor = false;    // a place that cannot be mistaken: when it fits, so does what stands in front
};

struct KnownMember {
  std::string_view of_class, name;
  MemberCheck check = nullptr;
  std::uint64_t bytes = 0;  // of the type that the check knows; 0: of any length
  MemberTraits traits;
  double (*rises)(std::string_view file, std::uint64_t at) = nullptr;  // a number that is larger where the id is
};

// The member of that class and name; null when it is none of ORB-SLAM3's that can be told from others.
const KnownMember* FindKnownMember(std::string_view of_class, std::string_view name);

// The penalty of a member in several records, from 0 to 2 * kBadPenalty; `facts` learn from it.
int PenaltyOf(const KnownMember& member, std::string_view file, std::span<const MemberPlace> places,
              std::span<RecordFacts> facts);

// How a member of a layout is held against what ORB-SLAM3's own member of that name is like, in whichever form it is.
class CheckedMember {
 public:
  CheckedMember() = default;  // of which nothing is known
  CheckedMember(std::string_view of_class, const LayoutMember& member);

  bool known() const { return known_ != nullptr; }
  bool anchor() const { return known() && known_->traits.anchor; }
  // Of several records, from 0 to 2 * kBadPenalty; `facts` learn from it.
  int Penalty(std::string_view file, std::span<const MemberPlace> places, std::span<RecordFacts> facts) const;
  // Of a whole number of 64 bits in ORB-SLAM3.
  std::optional<std::int64_t> Whole(std::string_view file, MemberPlace place) const;

 private:
  const KnownMember* known_ = nullptr;
  const LayoutType* own_ = nullptr;
  bool is_own_ = true;  // the bytes are as in v1.0
  LayoutType type_;
  std::string form_;
};

}  // namespace slamdb::layouts
