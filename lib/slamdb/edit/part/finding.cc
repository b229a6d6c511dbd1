// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/detail/finding.h"

#include <algorithm>
#include <unordered_map>

#include "slamdb/base/detail/parallel.h"

namespace slamdb::detail {
namespace {

constexpr double kSure = 2;         // times the points with which a camera is found: pictures show less than keyframes
constexpr float kWordShare = 0.8F;  // of the most words in common, above which ORB-SLAM3 tries a keyframe
constexpr double kFreshWords = 0.75;     // of what a keyframe has in common with its neighbours, what a picture has
constexpr std::uint32_t kMatches = 15;   // points in common that make a neighbour: ORB-SLAM3's fewest matches
constexpr std::size_t kMostRivals = 64;  // keyframes that see nothing of a place, but share words
constexpr std::size_t kGrain = 16;

// Whether a keyframe is tried, if another has so many words in common with the picture.
bool IsTried(std::uint32_t words, std::uint32_t most) {
  return most == 0 || words > static_cast<std::uint32_t>(kWordShare * static_cast<float>(most));
}

using Lists = std::unordered_map<std::uint32_t, std::vector<std::uint32_t>>;

// word -> keyframes that have it, map by map.
std::vector<Lists> ListWords(const Remains& remains) {
  const Sights& sights = remains.sights();
  std::vector<Lists> lists(sights.atlas().maps.size());
  for (std::uint32_t keyframe = 0; keyframe < sights.keyframes(); ++keyframe)
    if (remains.Keeps(keyframe))
      for (const std::uint32_t word : sights.KeyFrameOf(keyframe).features.bag_of_words.words)
        lists[sights.RowOf(keyframe).map][word].push_back(keyframe);
  return lists;
}

}  // namespace

Finding::Finding(const Remains& remains, std::span<const std::vector<std::uint32_t>> shown, std::size_t min_points,
                 int threads)
    : remains_(remains),
      sure_(kSure * static_cast<double>(std::max<std::size_t>(min_points, 1))),
      places_(remains.sights().keyframes()),
      shown_at_(remains.sights().points()),
      places_of_(remains.sights().keyframes()) {
  for (std::uint32_t place = 0; place < places_.size(); ++place)
    if (remains.Keeps(place)) CountPoints(place, place < shown.size() ? shown[place] : std::vector<std::uint32_t>());
  CountWords(threads);
  for (std::uint32_t number = 0; number < places_.size(); ++number) {
    Place& place = places_[number];
    for (std::uint32_t row = 0; row < place.seers.size(); ++row) {
      place.rows.emplace_back(place.seers[row].keyframe, row);
      places_of_[place.seers[row].keyframe].push_back(number);
    }
    std::ranges::sort(place.rows);
    place.value = ValueOf(place, kNoRow);
  }
}

void Finding::CountPoints(std::uint32_t place, std::span<const std::uint32_t> shown) {
  std::vector<std::uint32_t> points(shown.begin(), shown.end());
  for (const Sights::Sight& sight : remains_.sights().PointsOf(place)) points.push_back(sight.number);
  std::ranges::sort(points);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  std::unordered_map<std::uint32_t, std::uint32_t> counts;
  for (const std::uint32_t point : points) {
    if (!remains_.Stays(point)) continue;
    shown_at_[point].push_back(place);
    for (const Sights::Sight& observer : remains_.sights().ObserversOf(point)) ++counts[observer.number];
  }
  for (const auto& [keyframe, count] : counts) places_[place].seers.push_back({keyframe, count});
  std::ranges::sort(places_[place].seers, {}, &Seer::keyframe);
}

void Finding::CountWords(int threads) {
  const Sights& sights = remains_.sights();
  const std::vector<Lists> lists = ListWords(remains_);
  ParallelFor(places_.size(), kGrain, threads, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> common(places_.size(), 0);  // by keyframe
    for (std::size_t number = begin; number < end; ++number) {
      const auto place = static_cast<std::uint32_t>(number);
      if (!remains_.Keeps(place)) continue;
      std::vector<std::uint32_t> sharing;
      for (const std::uint32_t word : sights.KeyFrameOf(place).features.bag_of_words.words)
        for (const std::uint32_t keyframe : lists[sights.RowOf(place).map].at(word))
          if (common[keyframe]++ == 0) sharing.push_back(keyframe);
      SetWords(place, sharing, common);
      for (const std::uint32_t keyframe : sharing) common[keyframe] = 0;
    }
  });
}

void Finding::SetWords(std::uint32_t place, std::span<const std::uint32_t> sharing,
                       std::span<const std::uint32_t> common) {
  std::vector<Seer>& seers = places_[place].seers;
  std::uint32_t most = 0;  // of neighbours; a picture from here is to this keyframe as these are
  for (Seer& seer : seers) {
    seer.words = common[seer.keyframe];
    if (seer.keyframe != place) most = std::max(most, seer.words);
  }
  for (Seer& seer : seers) {
    if (seer.keyframe == place) seer.words = most;
    if (seer.points >= kMatches) seer.words = static_cast<std::uint32_t>(kFreshWords * seer.words);
  }
  std::vector<Seer> rivals;
  for (const std::uint32_t keyframe : sharing)
    if (!std::ranges::binary_search(seers, keyframe, {}, &Seer::keyframe))
      rivals.push_back({.keyframe = keyframe, .words = common[keyframe]});
  const auto more_words = [](const Seer& a, const Seer& b) {
    return a.words != b.words ? a.words > b.words : a.keyframe < b.keyframe;
  };
  std::ranges::sort(rivals, more_words);
  if (rivals.size() > kMostRivals) rivals.resize(kMostRivals);
  seers.insert(seers.end(), rivals.begin(), rivals.end());
  std::ranges::sort(seers, more_words);
}

double Finding::ValueOf(const Place& place, std::uint32_t without) const {
  const auto is_there = [&](const Seer& seer) { return seer.keyframe != without && remains_.Keeps(seer.keyframe); };
  double best = 0;
  std::size_t ahead = 0, rivals = 0;  // seers with so many words that others are not tried, and who of them is there
  for (const Seer& seer : place.seers) {
    for (; !IsTried(seer.words, place.seers[ahead].words); ++ahead)
      if (is_there(place.seers[ahead])) ++rivals;
    if (!is_there(seer)) continue;
    const double points = seer.points, share = points * points / (points * points + sure_ * sure_);
    best = std::max(best, share / static_cast<double>(1 + rivals));
  }
  return best;
}

void Finding::Change(std::span<const std::uint32_t> points, std::uint32_t by) {
  for (const std::uint32_t point : points)
    for (const std::uint32_t number : shown_at_[point]) {
      Place& place = places_[number];
      for (const Sights::Sight& observer : remains_.sights().ObserversOf(point)) {
        const auto row =
            std::ranges::lower_bound(place.rows, observer.number, {}, &std::pair<std::uint32_t, std::uint32_t>::first);
        place.seers[row->second].points += by;
      }
    }
}

double Finding::Loss(std::uint32_t keyframe, std::span<const std::uint32_t> going) {
  Change(going, ~std::uint32_t{0});  // one less
  double loss = 0;
  for (const std::uint32_t place : places_of_[keyframe])
    loss += places_[place].value - ValueOf(places_[place], keyframe);
  Change(going, 1);
  return loss;
}

void Finding::Remove(std::uint32_t keyframe, std::span<const std::uint32_t> going) {
  Change(going, ~std::uint32_t{0});
  for (const std::uint32_t place : places_of_[keyframe]) places_[place].value = ValueOf(places_[place], keyframe);
}

std::vector<std::uint32_t> Finding::ShownOnce() const {
  std::vector<std::uint32_t> once;
  for (std::uint32_t keyframe = 0; keyframe < places_.size(); ++keyframe) {
    if (!remains_.Keeps(keyframe)) continue;
    std::vector<std::uint32_t> alone;
    std::size_t others = 0;
    for (const Sights::Sight& sight : remains_.sights().PointsOf(keyframe)) {
      if (!remains_.Stays(sight.number)) continue;
      if (shown_at_[sight.number].size() < 2)
        alone.push_back(sight.number);
      else
        ++others;
    }
    if (static_cast<double>(others) >= sure_) once.insert(once.end(), alone.begin(), alone.end());
  }
  return once;
}

void Finding::Drop(std::span<const std::uint32_t> points) {
  Change(points, ~std::uint32_t{0});
  for (Place& place : places_) place.value = ValueOf(place, kNoRow);
}

}  // namespace slamdb::detail
