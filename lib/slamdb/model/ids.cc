// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/ids.h"

#include "slamdb/export.h"

namespace slamdb {
namespace {

template <class Entity>
std::string Named(const char* kind, Id<Entity> id) {
  return std::string(kind) + (id.has_value() ? std::to_string(id.value()) : "none");
}

}  // namespace

template <>
SLAMDB_EXPORT std::string ToString(MapId id) {
  return Named("map ", id);
}
template <>
SLAMDB_EXPORT std::string ToString(KeyFrameId id) {
  return Named("kf ", id);
}
template <>
SLAMDB_EXPORT std::string ToString(MapPointId id) {
  return Named("mp ", id);
}
template <>
SLAMDB_EXPORT std::string ToString(CameraId id) {
  return Named("camera ", id);
}
template <>
SLAMDB_EXPORT std::string ToString(LandmarkId id) {
  return Named("landmark ", id);
}

}  // namespace slamdb
