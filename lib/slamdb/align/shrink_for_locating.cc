// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/shrink_for_locating.h"

#include <algorithm>
#include <string_view>

#include "slamdb/align/detail/picture_query.h"
#include "slamdb/align/locate.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/model/index.h"

namespace slamdb {
namespace {

constexpr double kRadius = 4;             // pixels at octave 0, about where the map says that a point is
constexpr std::size_t kMostPlaces = 100;  // that are located
constexpr std::size_t kBatch = 8;         // between two tellings

// What the picture of a keyframe shows of the map without it, from where the map says that it was taken.
std::vector<std::uint32_t> ShownAt(const Atlas& atlas, const detail::MapViews& map, std::uint32_t left) {
  const PictureFeatures picture = FeaturesOf(atlas, map.KeyFrameOf(map.views()[left]));
  std::optional<detail::PictureQuery> query = detail::MakeQuery(picture);
  if (!query) return {};
  const detail::CameraPose pose = detail::PoseOf(map.views()[left]);
  detail::SetPose(query->view, pose);
  const detail::KnownMap known(map, left);
  std::vector<std::uint32_t> views;
  for (const detail::MapViews::Covisible& covisible : map.Covisibles(left)) views.push_back(covisible.view);
  const std::vector<detail::PictureMatch> found =
      detail::SearchPicture(*query, known, detail::PointsSeenBy(known, views), kRadius);
  std::vector<std::uint32_t> rows;
  for (const detail::PictureMatch& match : detail::PoseFinder(map, query->view, query->rays).InliersOf(found, pose))
    rows.push_back(map.points()[match.point].row);
  return rows;
}

std::vector<PointsShown> LookAgain(const Atlas& atlas, int threads) {
  std::vector<PointsShown> shown(atlas.maps.size());
  for (std::size_t row = 0; row < atlas.maps.size(); ++row) {
    const detail::MapViews map(atlas, row, threads);
    shown[row].resize(atlas.maps[row].keyframes.size());
    detail::ParallelFor(shown[row].size(), 1, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t keyframe = begin; keyframe < end; ++keyframe)
        if (const std::uint32_t left = map.LeftView(static_cast<std::uint32_t>(keyframe)); left != kNoRow)
          shown[row][keyframe] = ShownAt(atlas, map, left);
    });
  }
  return shown;
}

// Keyframes of an atlas, with what they see, however the atlas is cut.
class Places {
 public:
  Places(const Atlas& atlas, const ShrinkOptions& options) : threads_(options.threads), progress_(options.progress) {
    std::vector<KeyFrameRef> all;
    for (std::size_t map = 0; map < atlas.maps.size(); ++map)
      for (std::size_t row = 0; row < atlas.maps[map].keyframes.size(); ++row)
        if (!atlas.maps[map].keyframes[row].bad) all.push_back({map, row});
    const std::size_t step = std::max<std::size_t>(1, (all.size() + kMostPlaces - 1) / kMostPlaces);
    for (std::size_t i = 0; i < all.size(); i += step) {
      const Map& map = atlas.maps[all[i].map];
      const KeyFrame& keyframe = map.keyframes[all[i].keyframe];
      places_.push_back({map.id, keyframe.id, FeaturesOf(atlas, keyframe)});
    }
  }

  std::size_t size() const { return places_.size(); }

  // How many are found in what the atlas has become; those that it still has, as if it had never had them.
  std::uint64_t CountFound(const Atlas& atlas, std::string_view stage) const {
    if (progress_) progress_(stage, 0);
    const Locator locator(atlas, {.vocabulary = nullptr, .threads = threads_, .progress = {}});
    const AtlasIndex index(atlas);
    std::vector<std::uint8_t> found(places_.size(), 0);
    for (std::size_t done = 0; done < places_.size(); done += kBatch) {
      if (progress_) progress_(stage, static_cast<double>(done) / static_cast<double>(places_.size()));
      const std::size_t count = std::min(kBatch, places_.size() - done);
      detail::ParallelFor(count, 1, threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = done + begin; i < done + end; ++i)
          found[i] = IsFound(locator, RowIn(atlas, index, places_[i]), places_[i]) ? 1 : 0;
      });
    }
    return static_cast<std::uint64_t>(std::ranges::count(found, 1));
  }

 private:
  struct Place {
    MapId map;
    KeyFrameId keyframe;
    PictureFeatures features;
  };

  static std::optional<KeyFrameRef> RowIn(const Atlas& atlas, const AtlasIndex& index, const Place& place) {
    for (std::size_t map = 0; map < atlas.maps.size(); ++map)
      if (atlas.maps[map].id == place.map)
        if (const std::uint32_t row = index.KeyFrameRow(map, place.keyframe); row != kNoRow)
          return KeyFrameRef{map, row};
    return std::nullopt;
  }

  static bool IsFound(const Locator& locator, const std::optional<KeyFrameRef>& kept, const Place& place) {
    const Localization at = kept ? locator.LocateLeftOut(*kept) : locator.Locate(place.features);
    return at.verdict == LocateVerdict::kFound;
  }

  std::vector<Place> places_;
  const int threads_;
  const Progress& progress_;
};

}  // namespace

ShrinkReport ShrinkForLocating(Atlas& atlas, ShrinkOptions options) {
  std::optional<Places> places;
  PlacesFound found;
  options.looks.before = [&](const Atlas& whole) {
    places.emplace(whole, options);
    found.places = places->size();
    found.before = found.after = places->CountFound(whole, "locating in the whole");
    return LookAgain(whole, options.threads);
  };
  options.looks.after = [&](const Atlas& rest) {
    if (places) found.after = places->CountFound(rest, "locating in what is kept");
  };
  ShrinkReport report = Shrink(atlas, options);
  if (places) report.found = found;
  return report;
}

}  // namespace slamdb
