// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <string>

namespace slamdb {

// A strong id: KeyFrameId converts neither to MapPointId nor from an integer.
// Ids come from the file and may be anything.
// A default-constructed id is `none`, which ORB-SLAM3 writes as -1.
template <class Entity>
class Id {
 public:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};

  constexpr Id() = default;
  constexpr explicit Id(std::uint64_t value) : value_(value) {}

  constexpr std::uint64_t value() const { return value_; }
  constexpr bool has_value() const { return value_ != kNone; }
  constexpr explicit operator bool() const { return has_value(); }

  friend constexpr auto operator<=>(const Id&, const Id&) = default;

 private:
  std::uint64_t value_ = kNone;
};

struct Map;
struct KeyFrame;
struct MapPoint;
struct Camera;
struct Landmark;

using MapId = Id<Map>;            // ORB-SLAM3: Map::mnId
using KeyFrameId = Id<KeyFrame>;  // KeyFrame::mnId
using MapPointId = Id<MapPoint>;  // MapPoint::mnId
using CameraId = Id<Camera>;      // GeometricCamera::mnId (32 bits there; 0xffffffff is none)
using LandmarkId = Id<Landmark>;  // MRPT: CLandmark::ID, an int64_t; none is INVALID_LANDMARK_ID, -1

// How findings, errors and the command line name an entity: `map 0`, `kf 77`, `mp 4312`, `camera 1`,
// `landmark 5`, `kf none`.
template <class Entity>
std::string ToString(Id<Entity> id);
template <>
std::string ToString(MapId id);
template <>
std::string ToString(KeyFrameId id);
template <>
std::string ToString(MapPointId id);
template <>
std::string ToString(CameraId id);
template <>
std::string ToString(LandmarkId id);

}  // namespace slamdb

template <class Entity>
struct std::hash<slamdb::Id<Entity>> {
  std::size_t operator()(slamdb::Id<Entity> id) const noexcept {
    return std::hash<std::uint64_t>()(id.value() * 0x9E3779B97F4A7C15u);
  }
};
