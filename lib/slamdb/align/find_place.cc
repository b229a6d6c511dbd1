// SPDX-License-Identifier: BSD-3-Clause
// 1. Keypoints are matched with the points about the keyframe, and a pose sought on which many agree (RANSAC).
// 2. It is refined, and more points are sought where it says that they are, of all keyframes that see what was found; a
// few
//    times, with a smaller radius.
// 3. What is left must be enough.
#include "slamdb/align/detail/find_place.h"

#include <algorithm>
#include <array>
#include <unordered_map>

namespace slamdb::detail {
namespace {

constexpr std::size_t kFewestToSolve = 8, kFewestToKeep = 12;
constexpr std::array kRadii = {12.0, 6.0, 4.0};  // pixels at octave 0
constexpr std::size_t kMatched = 6;              // keyframes whose points are matched
constexpr std::size_t kNeighbours = 25;          // keyframes whose points are sought

// The left views that see most of what was matched, the most first, then by row.
std::vector<std::uint32_t> ViewsOf(const KnownMap& known, const std::vector<PictureMatch>& matches) {
  std::unordered_map<std::uint32_t, std::uint32_t> counts;
  const MapViews& map = known.views();
  for (const PictureMatch& match : matches)
    for (const Sighting& sighting : map.SightingsOf(match.point))
      if (!map.views()[sighting.view].right && !known.LeavesOut(sighting.view)) ++counts[sighting.view];
  std::vector<std::pair<std::uint32_t, std::uint32_t>> sorted(counts.begin(), counts.end());
  std::ranges::sort(sorted, [](const auto& a, const auto& b) {
    return a.second != b.second ? a.second > b.second : a.first < b.first;
  });
  std::vector<std::uint32_t> views;
  for (const auto& [view, count] : sorted)
    if (views.size() < kNeighbours) views.push_back(view);
  return views;
}

}  // namespace

std::optional<Place> TryPlace(PictureQuery& query, const KnownMap& known, const PreparedMap& map, std::uint32_t view) {
  std::vector<std::uint32_t> about = {view};
  for (const std::uint32_t neighbour : map.groups[view])
    if (about.size() < kMatched) about.push_back(neighbour);
  const PoseFinder finder(known.views(), query.view, query.rays);
  const std::vector<PictureMatch> matches = MatchPicture(query, known, about);
  const std::optional<CameraPose> found = finder.Find(matches, kFewestToSolve, view);
  if (!found) return std::nullopt;
  Place place{.fit = {.pose = *found}, .inliers = finder.InliersOf(matches, *found), .views = {}};
  const auto refine = [&] {
    place.fit = finder.Refine(place.inliers, place.fit.pose);
    SetPose(query.view, place.fit.pose);
    place.views = ViewsOf(known, place.inliers);
  };
  for (const double radius : kRadii) {
    refine();
    const std::vector<PictureMatch> more = SearchPicture(query, known, PointsSeenBy(known, place.views), radius);
    place.inliers = finder.InliersOf(more, place.fit.pose);
    if (place.inliers.size() < kFewestToKeep) return std::nullopt;
  }
  refine();
  return place;
}

SeenShare LookFrom(PictureQuery& query, const KnownMap& known, const Place& place) {
  SetPose(query.view, place.fit.pose);
  std::vector<double> depths(query.view.keypoints.size(), 0);
  for (const PictureMatch& match : place.inliers)
    depths[match.keypoint] = query.view.CameraFromWorld(known.views().points()[match.point].position).z();
  return LookFrom(query.view, depths, known, {}, kPictureCells);
}

}  // namespace slamdb::detail
