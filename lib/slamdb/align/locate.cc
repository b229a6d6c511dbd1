// SPDX-License-Identifier: BSD-3-Clause
// 1. The places that look most like the picture, of every map.
// 2. Each is tried, but for those that a found place already covers.
// 3. The one with most inliers is held against the map, and then the next ones where it is refused.
#include "slamdb/align/locate.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "slamdb/align/detail/candidates.h"
#include "slamdb/align/detail/decide.h"
#include "slamdb/align/detail/find_place.h"
#include "slamdb/align/detail/prepared_map.h"
#include "slamdb/align/detail/second_axis.h"
#include "slamdb/base/error.h"

namespace slamdb {
namespace {

using detail::Candidate;
using detail::KnownMap;
using detail::PictureQuery;
using detail::Place;

constexpr std::size_t kPlaces = 6;      // that are compared
constexpr std::size_t kMostJudged = 3;  // that are held against the map
constexpr double kSameDegrees = 3;      // poses that near are one
constexpr double kSameDistance = 0.05;  // of the median depth

constexpr const char* kNothingAlike = "no place of the map looks like it";

struct LikelyPlace {
  std::size_t map;
  Candidate candidate;
};

// What of a map a search may not know.
struct LeftOut {
  std::size_t map = 0;
  std::uint32_t view = kNoRow;
};

// Of places of one map. Another map may well be of the same room.
bool IsSame(const detail::MapViews& map, const Place& one, const Place& other) {
  const Eigen::AngleAxisd turn(one.fit.pose.rotation * other.fit.pose.rotation.transpose());
  return std::abs(turn.angle()) < kSameDegrees * std::numbers::pi / 180 &&
         (one.fit.pose.center() - other.fit.pose.center()).norm() < kSameDistance * map.median_depth();
}

// The standard deviation along the second axis of what was found, in depths of the picture.
double ExtentOf(const detail::MapViews& map, const Place& place) {
  std::vector<Eigen::Vector3d> positions;
  double depth = 0;
  for (const auto& match : place.inliers) {
    positions.push_back(map.points()[match.point].position);
    depth += (place.fit.pose * positions.back()).z();
  }
  depth /= static_cast<double>(positions.size());
  return depth > 0 ? detail::SecondAxis<3>(positions) / depth : 0;
}

// The same of the inliers in the picture, in its smaller sides.
double SpreadOf(const detail::View& view, const Place& place) {
  std::vector<Eigen::Vector2d> places;
  for (const auto& match : place.inliers) places.push_back(detail::PixelOf(view.keypoints[match.keypoint]));
  const double side = view.frame.sizes().minCoeff();
  return side > 0 ? detail::SecondAxis<2>(places) / side : 0;
}

}  // namespace

struct Locator::State {
  State(const Atlas& of, const LocatorOptions& options)
      : atlas(of),
        maps(Maps(of)),
        prepared(options.places_are_known
                     ? detail::PreparedMaps::WithoutWords(maps, options.threads)
                     : detail::PreparedMaps(maps, AlignOptions{.own_vocabulary = options.vocabulary == nullptr,
                                                               .threads = options.threads,
                                                               .progress = options.progress})),
        vocabulary(prepared.trained_words() ? &prepared.trained_tree() : options.vocabulary) {}

  static std::vector<MapRef> Maps(const Atlas& atlas) {
    std::vector<MapRef> maps;
    for (std::size_t map = 0; map < atlas.maps.size(); ++map)
      if (!atlas.maps[map].keyframes.empty()) maps.push_back({&atlas, map});
    if (maps.empty()) throw Error(ErrorKind::kNotPossible, "has no map with keyframes");
    return maps;
  }

  Localization Locate(const PictureFeatures& picture, const LeftOut& left_out) const;
  Localization LocateAt(const PictureFeatures& picture, std::span<const KeyFrameRef> places) const;
  Localization TryAll(PictureQuery& query, const std::vector<LikelyPlace>& like, const LeftOut& left_out) const;
  std::optional<LikelyPlace> PlaceOf(const KeyFrameRef& keyframe) const;
  std::vector<LikelyPlace> PlacesLike(const PictureQuery& query, const LeftOut& left_out) const;
  std::vector<Place> TryPlaces(PictureQuery& query, const std::vector<LikelyPlace>& like,
                               const LeftOut& left_out) const;
  Localization Judge(PictureQuery& query, const std::vector<Place>& places, std::size_t chosen,
                     const LeftOut& left_out) const;
  KnownMap Known(std::size_t map, const LeftOut& left_out) const {
    return {prepared[map].views, map == left_out.map ? left_out.view : kNoRow};
  }

  const Atlas& atlas;
  const std::vector<MapRef> maps;
  const detail::PreparedMaps prepared;
  const VocabularyTree* vocabulary;
};

std::vector<LikelyPlace> Locator::State::PlacesLike(const PictureQuery& query, const LeftOut& left_out) const {
  const Words words = ComputeWords(*vocabulary, {query.view.descriptors.begin(), query.view.descriptors.end()});
  std::vector<LikelyPlace> like;
  for (std::size_t map = 0; map < prepared.size(); ++map) {
    std::vector<float> scores = prepared[map].index.Query(words.bag_of_words);
    if (map == left_out.map && left_out.view != kNoRow) scores[left_out.view] = 0;
    for (const Candidate& candidate : detail::BestPlaces(scores, prepared[map].groups, 0, kPlaces))
      like.push_back({map, candidate});
  }
  std::ranges::stable_sort(
      like, [](const LikelyPlace& a, const LikelyPlace& b) { return a.candidate.score > b.candidate.score; });
  if (like.size() > kPlaces) like.resize(kPlaces);
  return like;
}

std::vector<Place> Locator::State::TryPlaces(PictureQuery& query, const std::vector<LikelyPlace>& like,
                                             const LeftOut& left_out) const {
  std::vector<Place> places;
  for (const auto& [map, candidate] : like) {
    const bool known = std::ranges::any_of(places, [&, map = map, view = candidate.first](const Place& place) {
      return place.map == map && std::ranges::find(place.views, view) != place.views.end();
    });
    if (known) continue;
    std::optional<Place> place = TryPlace(query, Known(map, left_out), prepared[map], candidate.first);
    if (!place) continue;
    place->map = map;
    places.push_back(*std::move(place));
  }
  std::ranges::stable_sort(places, [](const Place& a, const Place& b) { return a.inliers.size() > b.inliers.size(); });
  return places;
}

Localization Locator::State::Judge(PictureQuery& query, const std::vector<Place>& places, std::size_t chosen,
                                   const LeftOut& left_out) const {
  const Place& place = places[chosen];
  const detail::MapViews& map = prepared[place.map].views;
  const detail::SeenShare share = LookFrom(query, Known(place.map, left_out), place);
  Localization found{.has_pose = true,
                     .map = map.map().id,
                     .position = place.fit.pose.center(),
                     .rotation = Eigen::Quaterniond(place.fit.pose.rotation.transpose()),
                     .covariance = place.fit.covariance,
                     .resembles = map.KeyFrameOf(map.views()[place.views.front()]).id};
  LocateEvidence& evidence = found.evidence;
  evidence.features = query.view.keypoints.size();
  evidence.inliers = place.inliers.size();
  evidence.visible = share.visible;
  evidence.found_share = share.found_share();
  evidence.cell_share = share.cell_share();
  evidence.front_share = share.front_share();
  evidence.checked_share = static_cast<double>(share.cells) / static_cast<double>(detail::kPictureCells.count());
  evidence.extent = ExtentOf(map, place);
  evidence.spread = SpreadOf(query.view, place);
  evidence.rms = std::sqrt(2 * place.fit.cost / static_cast<double>(place.fit.residuals));
  const detail::FocalFit focal =
      detail::PoseFinder(map, query.view, query.rays).FitFocalLength(place.inliers, place.fit.pose);
  evidence.focal_factor = focal.factor;
  evidence.focal_deviation = focal.deviation;
  for (const Place& other : places)
    if (other.map == place.map && !IsSame(map, place, other))
      evidence.contradicting = std::max<std::uint64_t>(evidence.contradicting, other.inliers.size());
  detail::GiveVerdict(found);
  return found;
}

Localization Locator::State::TryAll(PictureQuery& query, const std::vector<LikelyPlace>& like,
                                    const LeftOut& left_out) const {
  Localization best{.reason = kNothingAlike};
  const std::vector<Place> places = TryPlaces(query, like, left_out);
  for (std::size_t i = 0; i < std::min(places.size(), kMostJudged); ++i) {
    Localization found = Judge(query, places, i, left_out);
    if (i == 0 || found.verdict < best.verdict) best = std::move(found);
    if (best.verdict == LocateVerdict::kFound) break;
  }
  best.evidence.features = query.view.keypoints.size();
  best.evidence.candidates = like.size();
  return best;
}

Localization Locator::State::Locate(const PictureFeatures& picture, const LeftOut& left_out) const {
  std::optional<PictureQuery> query = detail::MakeQuery(picture);
  if (!query || query->view.keypoints.empty() || vocabulary == nullptr) return {.reason = kNothingAlike};
  return TryAll(*query, PlacesLike(*query, left_out), left_out);
}

// nullopt: the keyframe has no left view.
std::optional<LikelyPlace> Locator::State::PlaceOf(const KeyFrameRef& keyframe) const {
  const auto map = std::ranges::find(maps, keyframe.map, &MapRef::map);
  if (map == maps.end() || keyframe.keyframe >= atlas.maps[keyframe.map].keyframes.size()) return std::nullopt;
  const auto row = static_cast<std::size_t>(map - maps.begin());
  const std::uint32_t view = prepared[row].views.LeftView(static_cast<std::uint32_t>(keyframe.keyframe));
  if (view == kNoRow) return std::nullopt;
  return LikelyPlace{row, {view, 0, 0}};
}

Localization Locator::State::LocateAt(const PictureFeatures& picture, std::span<const KeyFrameRef> places) const {
  std::optional<PictureQuery> query = detail::MakeQuery(picture);
  if (!query || query->view.keypoints.empty()) return {.reason = kNothingAlike};
  std::vector<LikelyPlace> like;
  for (const KeyFrameRef& keyframe : places)
    if (const std::optional<LikelyPlace> place = PlaceOf(keyframe)) like.push_back(*place);
  return TryAll(*query, like, {});
}

Locator::Locator(const Atlas& atlas, const LocatorOptions& options) : state_(std::make_unique<State>(atlas, options)) {}
Locator::Locator(Locator&&) noexcept = default;
Locator::~Locator() = default;

Localization Locator::Locate(const PictureFeatures& picture) const { return state_->Locate(picture, {}); }

Localization Locator::LocateAt(const PictureFeatures& picture, std::span<const KeyFrameRef> places) const {
  return state_->LocateAt(picture, places);
}

Localization Locator::LocateLeftOut(const KeyFrameRef& keyframe) const {
  const std::optional<LikelyPlace> place = state_->PlaceOf(keyframe);
  if (!place) return {.reason = "the keyframe is flagged bad, or has no camera or no pose"};
  return state_->Locate(FeaturesOf(state_->atlas, state_->atlas.maps[keyframe.map].keyframes[keyframe.keyframe]),
                        {place->map, place->candidate.first});
}

}  // namespace slamdb
