// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/select.h"

#include <algorithm>
#include <numeric>
#include <set>

#include "slamdb/base/error.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/up.h"

namespace slamdb {
namespace {

std::string ListOf(const std::set<std::uint64_t>& ids) {
  constexpr std::size_t kMost = 12;
  std::string list;
  std::size_t count = 0;
  for (const std::uint64_t id : ids) {
    if (count++ == kMost) return list + " ...";
    list += (list.empty() ? "" : ", ") + std::to_string(id);
  }
  return list;
}

// Inside by the even-odd rule: a ray to the right crosses the outline an odd number of times.
bool IsInside(const std::vector<Eigen::Vector2f>& polygon, const Eigen::Vector2f& place) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2f &a = polygon[i], &b = polygon[j];
    if ((a.y() > place.y()) == (b.y() > place.y())) continue;
    if (place.x() < a.x() + (place.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

bool HasAny(const std::vector<std::uint8_t>& flags) {
  return std::ranges::any_of(flags, [](std::uint8_t flag) { return flag != 0; });
}

class Selector {
 public:
  Selector(const AtlasIndex& index, const SelectOptions& options)
      : index_(index), atlas_(index.atlas()), options_(options), subset_(Subset::Nothing(index.atlas())) {}

  Subset Run() {
    RequireSense();
    PickKeyFrames();
    if (options_.every > 1) ThinOut();
    for (std::size_t row = 0; row < atlas_.maps.size(); ++row) CutByRegion(row);
    if (options_.except) Invert();
    for (std::size_t row = 0; row < atlas_.maps.size(); ++row) MarkLandmarks(row);
    RequireSomething();
    return std::move(subset_);
  }

 private:
  bool HasRegion() const { return options_.box || !options_.polygon.empty(); }
  bool CutsCameras() const { return HasRegion() && options_.region != RegionOf::kPoints; }
  bool CutsPointsAlone() const { return HasRegion() && options_.region == RegionOf::kPoints; }
  bool CutsPoints() const { return HasRegion() && options_.region != RegionOf::kCameras; }

  void RequireSense() const {
    if (options_.map && index_.MapRow(*options_.map) == kNoRow) {
      std::set<std::uint64_t> ids;
      for (const Map& map : atlas_.maps) ids.insert(map.id.value());
      throw Error(ErrorKind::kNotPossible, "there is no " + ToString(*options_.map) + "; there are " + ListOf(ids));
    }
    for (const KeyFrameId id : options_.keyframes)
      if (!index_.LocateKeyFrame(id))
        throw Error(ErrorKind::kNotPossible, "there is no keyframe " + std::to_string(id.value()));
    if (!options_.polygon.empty() && options_.polygon.size() < 3)
      throw Error(ErrorKind::kUsage,
                  "a polygon needs three corners or more, found " + std::to_string(options_.polygon.size()));
    for (const Eigen::Vector2f& corner : options_.polygon)
      if (!corner.allFinite()) throw Error(ErrorKind::kUsage, "the corners of a polygon must be finite");
    if (options_.every == 0) throw Error(ErrorKind::kUsage, "every 0th keyframe is none; give 1 or more");
    if (options_.component && *options_.component == 0)
      throw Error(ErrorKind::kUsage, "component 0 is none; 1 is the largest");
    if (options_.session) RequireSession();
  }

  void RequireSession() const {
    std::set<std::uint64_t> sessions;
    for (const Map& map : atlas_.maps)
      for (const KeyFrame& keyframe : map.keyframes) sessions.insert(keyframe.origin_map);
    if (!sessions.contains(*options_.session))
      throw Error(ErrorKind::kNotPossible, "no keyframe is from session " + std::to_string(*options_.session) +
                                               "; sessions are " + ListOf(sessions));
  }

  bool Picks(const KeyFrame& keyframe) const {
    const std::uint64_t id = keyframe.id.value();
    if (id < options_.first_keyframe || id > options_.last_keyframe) return false;
    if (options_.session && keyframe.origin_map != *options_.session) return false;
    // Written so that a timestamp that is not a number is outside every span, but inside when none is given.
    return !(keyframe.timestamp < options_.begin_time) && !(keyframe.timestamp > options_.end_time) &&
           (keyframe.timestamp == keyframe.timestamp || !HasSpan());
  }
  bool HasSpan() const {
    return options_.begin_time != SelectOptions().begin_time || options_.end_time != SelectOptions().end_time;
  }

  void PickKeyFrames() {
    for (std::size_t row = 0; row < atlas_.maps.size(); ++row) {
      const Map& map = atlas_.maps[row];
      if (options_.map && map.id != *options_.map) continue;
      for (std::size_t i = 0; i < map.keyframes.size(); ++i)
        subset_.maps[row].keyframes[i] = Picks(map.keyframes[i]) ? 1 : 0;
    }
    if (!options_.keyframes.empty())
      IntersectWith([&](Subset& listed) {
        for (std::size_t row = 0; row < atlas_.maps.size(); ++row)
          for (const KeyFrameId id : options_.keyframes)
            if (const std::uint32_t found = index_.KeyFrameRow(row, id); found != kNoRow)
              listed.maps[row].keyframes[found] = 1;
      });
    if (options_.component) IntersectWith([&](Subset& component) { MarkComponent(component); });
  }

  template <class Mark>
  void IntersectWith(const Mark& mark) {
    Subset other = Subset::Nothing(atlas_);
    mark(other);
    for (std::size_t row = 0; row < subset_.maps.size(); ++row)
      for (std::size_t i = 0; i < subset_.maps[row].keyframes.size(); ++i)
        subset_.maps[row].keyframes[i] &= other.maps[row].keyframes[i];
  }

  void MarkComponent(Subset& marked) const {
    const std::vector<Component> components =
        FindComponents(index_, options_.map ? std::optional(index_.MapRow(*options_.map)) : std::nullopt);
    const std::size_t number = *options_.component;
    if (number > components.size())
      throw Error(ErrorKind::kNotPossible, "there is no component " + std::to_string(number) +
                                               "; the covisibility graph has " + std::to_string(components.size()));
    const Component& component = components[number - 1];
    for (const std::uint32_t row : component.keyframes) marked.maps[component.map].keyframes[row] = 1;
  }

  // Keeps the first of each `every` keyframes of a map in order of time.
  void ThinOut() {
    for (std::size_t row = 0; row < atlas_.maps.size(); ++row) {
      std::vector<std::uint8_t>& flags = subset_.maps[row].keyframes;
      std::vector<std::pair<double, std::size_t>> by_time;
      for (std::size_t i = 0; i < flags.size(); ++i)
        if (flags[i]) by_time.emplace_back(atlas_.maps[row].keyframes[i].timestamp, i);
      std::ranges::stable_sort(by_time, [&](const auto& a, const auto& b) {
        if (a.first != b.first) return a.first < b.first;
        return atlas_.maps[row].keyframes[a.second].id < atlas_.maps[row].keyframes[b.second].id;
      });
      for (std::size_t i = 0; i < by_time.size(); ++i)
        if (i % options_.every != 0) flags[by_time[i].second] = 0;
    }
  }

  // Without a polygon there is nothing to look up.
  PlanPlane PlaneOf(const Map& map) const {
    if (options_.plane != PlanPlane::kAuto || options_.polygon.empty()) return options_.plane;
    Eigen::Index vertical = 0;
    UpOf(map).direction.cwiseAbs().maxCoeff(&vertical);
    return vertical == 0 ? PlanPlane::kYz : vertical == 1 ? PlanPlane::kXz : PlanPlane::kXy;
  }

  bool Contains(PlanPlane plane, const Eigen::Vector3f& place) const {
    if (options_.box && !options_.box->contains(place)) return false;
    if (options_.polygon.empty()) return true;
    const bool has_x = plane != PlanPlane::kYz, has_z = plane != PlanPlane::kXy;
    return IsInside(options_.polygon, {has_x ? place.x() : place.y(), has_z ? place.z() : place.y()});
  }

  // Cuts the keyframes that are picked, and marks points.
  void CutByRegion(std::size_t row) {
    const Map& map = atlas_.maps[row];
    const PlanPlane plane = PlaneOf(map);
    std::vector<std::uint8_t>& keyframes = subset_.maps[row].keyframes;
    std::vector<std::uint8_t>& points = subset_.maps[row].points;
    const std::vector<std::uint8_t> picked = keyframes;
    if (CutsCameras())
      for (std::size_t i = 0; i < keyframes.size(); ++i)
        if (keyframes[i] && !Contains(plane, CameraCenter(map.keyframes[i]))) keyframes[i] = 0;
    const std::vector<std::uint8_t>& observers = CutsPoints() ? picked : keyframes;
    std::vector<std::uint8_t> sees_one(keyframes.size(), 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (CutsPoints() && !Contains(plane, map.points[i].position)) continue;
      for (const Observation& observation : map.points[i].observations) {
        const std::uint32_t observer = index_.KeyFrameRow(row, observation.keyframe);
        if (observer == kNoRow || !observers[observer]) continue;
        points[i] = 1;
        sees_one[observer] = 1;
      }
    }
    if (CutsPointsAlone()) keyframes = sees_one;
  }

  void Invert() {
    for (std::size_t row = 0; row < subset_.maps.size(); ++row) {
      auto& [keyframes, points, landmarks] = subset_.maps[row];
      for (std::uint8_t& flag : keyframes) flag = CutsPointsAlone() ? 1 : !flag;
      for (std::uint8_t& flag : points) flag = CutsPoints() ? !flag : 1;
    }
  }

  // Nothing observes landmarks: where no region of points decides, they go with the keyframes of their map.
  void MarkLandmarks(std::size_t row) {
    const Map& map = atlas_.maps[row];
    const PlanPlane plane = PlaneOf(map);
    const bool is_asked_for = !options_.map || map.id == *options_.map;
    const bool stays =
        map.keyframes.empty() ? (options_.map && is_asked_for) != options_.except : HasAny(subset_.maps[row].keyframes);
    std::vector<std::uint8_t>& landmarks = subset_.maps[row].landmarks;
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      const bool inside = is_asked_for && Contains(plane, map.landmarks[i].mean.cast<float>());
      landmarks[i] = CutsPoints() ? inside != options_.except : stays;
    }
  }

  // Points of a region that no camera inside sees are something: the border may bring the keyframes that do.
  void RequireSomething() const {
    for (const Subset::MapRows& rows : subset_.maps) {
      if (HasAny(rows.keyframes) || HasAny(rows.landmarks)) return;
      if (CutsPoints() && !options_.except && HasAny(rows.points)) return;
    }
    throw Error(ErrorKind::kNotPossible, options_.except
                                             ? "nothing is left: the selection holds the whole atlas"
                                             : "nothing is selected: no keyframe meets all that is asked for");
  }

  const AtlasIndex& index_;
  const Atlas& atlas_;
  const SelectOptions& options_;
  Subset subset_;
};

// Union-find with path halving.
std::uint32_t Root(std::vector<std::uint32_t>& root, std::uint32_t row) {
  while (root[row] != row) row = root[row] = root[root[row]];
  return row;
}

void AddComponents(const AtlasIndex& index, std::uint32_t map_row, std::vector<Component>& components) {
  const Map& map = index.atlas().maps[map_row];
  std::vector<std::uint32_t> root(map.keyframes.size());
  std::iota(root.begin(), root.end(), 0U);
  for (std::uint32_t row = 0; row < root.size(); ++row)
    for (const Connection& connection : map.keyframes[row].connections)
      if (const std::uint32_t other = index.KeyFrameRow(map_row, connection.keyframe); other != kNoRow)
        root[Root(root, row)] = Root(root, other);
  std::vector<std::size_t> number(root.size(), components.size() + root.size());
  for (std::uint32_t row = 0; row < root.size(); ++row) {
    std::size_t& place = number[Root(root, row)];
    if (place >= components.size()) {
      place = components.size();
      components.push_back({map_row, {}});
    }
    components[place].keyframes.push_back(row);
  }
}

}  // namespace

Subset Select(const AtlasIndex& index, const SelectOptions& options) { return Selector(index, options).Run(); }

std::vector<Component> FindComponents(const AtlasIndex& index, std::optional<std::uint32_t> map) {
  std::vector<Component> components;
  for (std::uint32_t row = 0; row < index.atlas().maps.size(); ++row)
    if (!map || *map == row) AddComponents(index, row, components);
  std::ranges::stable_sort(components, std::ranges::greater(),
                           [](const Component& component) { return component.keyframes.size(); });
  return components;
}

}  // namespace slamdb
