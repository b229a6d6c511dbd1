// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace slamdb::live {

struct Runtime;

// Stands for the atlas of points that are of none yet (MapPoint()).
Runtime& NoAtlas();

// Throws Error that `what` (`the keyframe`) is null, or belongs to another atlas.
[[noreturn]] void RefuseNull(std::string_view what);
[[noreturn]] void RefuseForeign(std::string_view what);

// Throws Error unless the object is there and of that atlas.
template <class Object>
void RequireOwn(const Object* object, const Runtime& runtime, std::string_view what) {
  if (object == nullptr) RefuseNull(what);
  if (!object->IsOf(runtime)) RefuseForeign(what);
}

}  // namespace slamdb::live
