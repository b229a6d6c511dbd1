// SPDX-License-Identifier: BSD-3-Clause
// The chain of keyframes in time: what previous and next keyframes say about each other.
#include <array>

#include "slamdb/checks/detail/catalogue.h"
#include "slamdb/checks/detail/visit.h"

namespace slamdb::detail {
namespace {

// One direction of the chain, and the other.
struct Direction {
  KeyFrameId KeyFrame::*link;
  KeyFrameId KeyFrame::*back;
};
constexpr std::array kDirections = {Direction{&KeyFrame::previous, &KeyFrame::next},
                                    Direction{&KeyFrame::next, &KeyFrame::previous}};

// A map whose chain is looked at.
class Chain {
 public:
  explicit Chain(Map& map) : map_(map), rows_(KeyFrameTable(map)) {}

  // A link is wrong when the keyframe that it leads to has another neighbour on that side.
  std::size_t CutContradictions() {
    std::vector<KeyFrameId*> wrong;
    for (const Direction& direction : kDirections)
      for (KeyFrame& keyframe : map_.keyframes) {
        const KeyFrame* other = Neighbour(keyframe, direction.link);
        if (other == nullptr || other->*direction.back == keyframe.id) continue;
        if (Find(other->*direction.back) != nullptr) wrong.push_back(&(keyframe.*direction.link));
      }
    for (KeyFrameId* link : wrong) *link = KeyFrameId();
    return wrong.size();
  }

  // What one side says alone the other says too; or none does, where the IMU was not integrated across.
  std::size_t CloseLinks() {
    std::size_t changed = 0;
    for (const Direction& direction : kDirections)
      for (KeyFrame& keyframe : map_.keyframes) {
        KeyFrame* other = Neighbour(keyframe, direction.link);
        if (other == nullptr || other->*direction.back == keyframe.id) continue;
        const bool is_taken = Find(other->*direction.back) != nullptr;
        const bool gets_previous = direction.back == &KeyFrame::previous;
        if (is_taken || (gets_previous && map_.imu_initialized && !(other->preintegration.duration > 0)))
          keyframe.*direction.link = KeyFrameId();
        else
          other->*direction.back = keyframe.id;
        ++changed;
      }
    return changed;
  }

 private:
  KeyFrame* Find(KeyFrameId id) {
    const std::uint32_t row = rows_.Find(id.value());
    return row == kNoRow ? nullptr : &map_.keyframes[row];
  }
  KeyFrame* Neighbour(const KeyFrame& keyframe, KeyFrameId KeyFrame::*link) {
    KeyFrame* other = Find(keyframe.*link);
    return other == &keyframe ? nullptr : other;  // the business of self-link
  }

  Map& map_;
  IdTable rows_;
};

}  // namespace

std::size_t MendChains(Atlas& atlas) {
  std::size_t changed = 0;
  for (Map& map : atlas.maps) {
    Chain chain(map);
    changed += chain.CutContradictions();
    changed += chain.CloseLinks();
  }
  return changed;
}

void CheckTemporalMutual(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t row, const Map& map, const KeyFrame& keyframe) {
    if (map.inertial) return;  // the business of imu-chain, where it matters more
    const KeyFrame* previous = subject.index.FindKeyFrame(row, keyframe.previous);
    const KeyFrame* next = subject.index.FindKeyFrame(row, keyframe.next);
    if (previous != nullptr && previous != &keyframe && previous->next != keyframe.id)
      findings.Add(PlaceOf(map, keyframe), "previous ", keyframe.previous, " is followed by ", previous->next,
                   " instead of it");
    if (next != nullptr && next != &keyframe && next->previous != keyframe.id)
      findings.Add(PlaceOf(map, keyframe), "next ", keyframe.next, " comes after ", next->previous, " instead of it");
  });
}

}  // namespace slamdb::detail
