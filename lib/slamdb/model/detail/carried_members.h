// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/model/atlas.h"

namespace slamdb::detail {

// Whether an entity has members of a fork that are no part of the model.
inline bool HasMembers(const Boxed<Carried>& carried) { return carried && !carried->members.empty(); }

// Returns whether there were any.
inline bool DropMembers(Boxed<Carried>& carried) {
  if (!HasMembers(carried)) return false;
  carried.Make().members.clear();
  if (carried->empty()) carried.Reset();
  return true;
}

// visit(carried) for what each entity carries, that of the atlas itself first; const when the atlas is.
template <class AnAtlas, class Visit>
void ForEachCarried(AnAtlas& atlas, const Visit& visit) {
  visit(atlas.carried);
  for (auto& camera : atlas.cameras) visit(camera.carried);
  for (auto& map : atlas.maps) {
    visit(map.carried);
    for (auto& keyframe : map.keyframes) visit(keyframe.carried);
    for (auto& point : map.points) visit(point.carried);
  }
}

}  // namespace slamdb::detail
