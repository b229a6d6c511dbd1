// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/detail/finding.h"

#include <algorithm>
#include <numeric>
#include <utility>

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

// Which keyframes of one map have a word. Words go by numbers in the order in which they come.
class WordLists {
 public:
  // Of the keyframes [first, end) that remain.
  WordLists(const Remains& remains, std::uint32_t first, std::uint32_t end) : first_(first) {
    NumberWords(remains, end);
    std::partial_sum(lists_.begin(), lists_.end(), lists_.begin());
    keyframes_.resize(numbers_.size());
    std::vector<std::size_t> next(lists_.begin(), lists_.end());
    for (std::uint32_t keyframe = first; keyframe < end; ++keyframe)
      for (const std::uint32_t number : WordsOf(keyframe)) keyframes_[next[number]++] = keyframe;
  }

  std::span<const std::uint32_t> WordsOf(std::uint32_t keyframe) const {
    return {numbers_.data() + begins_[keyframe - first_], numbers_.data() + begins_[keyframe - first_ + 1]};
  }
  // Ascending.
  std::span<const std::uint32_t> KeyFramesWith(std::uint32_t number) const {
    return {keyframes_.data() + lists_[number], keyframes_.data() + lists_[number + 1]};
  }

 private:
  void NumberWords(const Remains& remains, std::uint32_t end) {
    std::uint32_t lowest = ~std::uint32_t{0}, highest = 0;
    std::size_t count = 0;
    for (std::uint32_t keyframe = first_; keyframe < end; ++keyframe)
      for (const std::uint32_t word : WordsIn(remains, keyframe)) {
        lowest = std::min(lowest, word);
        highest = std::max(highest, word);
        ++count;
      }
    IdTable number_of = count == 0 ? IdTable() : IdTable(lowest, highest, count);
    numbers_.reserve(count);
    begins_.assign(1, 0);
    lists_.assign(1, 0);
    for (std::uint32_t keyframe = first_; keyframe < end; ++keyframe) {
      for (const std::uint32_t word : WordsIn(remains, keyframe)) {
        const auto next = static_cast<std::uint32_t>(lists_.size() - 1);
        const std::uint32_t before = number_of.Insert(word, next);
        if (before == kNoRow) lists_.push_back(0);
        numbers_.push_back(before == kNoRow ? next : before);
        ++lists_[numbers_.back() + 1];
      }
      begins_.push_back(numbers_.size());
    }
  }

  static std::span<const std::uint32_t> WordsIn(const Remains& remains, std::uint32_t keyframe) {
    if (!remains.Keeps(keyframe)) return {};
    return remains.sights().KeyFrameOf(keyframe).features.bag_of_words.words;
  }

  const std::uint32_t first_;
  std::vector<std::uint32_t> numbers_, keyframes_;
  std::vector<std::size_t> begins_, lists_;  // of each keyframe's numbers, and of each number's keyframes
};

std::vector<WordLists> ListWords(const Remains& remains) {
  std::vector<WordLists> lists;
  std::uint32_t first = 0;
  for (const Map& map : remains.sights().atlas().maps) {
    const auto end = first + static_cast<std::uint32_t>(map.keyframes.size());
    lists.emplace_back(remains, first, end);
    first = end;
  }
  return lists;
}

}  // namespace

Finding::Finding(const Remains& remains, std::span<const std::vector<std::uint32_t>> shown, std::size_t min_points,
                 int threads)
    : remains_(remains),
      sure_(kSure * static_cast<double>(std::max<std::size_t>(min_points, 1))),
      places_(remains.sights().keyframes()),
      places_of_(remains.sights().keyframes()) {
  CountPoints(shown);
  CountWords(threads);
  for (std::uint32_t number = 0; number < places_.size(); ++number) {
    Place& place = places_[number];
    for (const Seer& seer : place.seers) places_of_[seer.keyframe].push_back(number);
    ListRows(place);
    place.value = ValueOf(place, kNoRow);
  }
}

void Finding::CountPoints(std::span<const std::vector<std::uint32_t>> shown) {
  const Sights& sights = remains_.sights();
  std::vector<std::vector<std::uint32_t>> shows(places_.size());  // by place: points, ascending
  std::vector<std::uint32_t> counts(places_.size(), 0);           // by keyframe
  shown_begins_.assign(sights.points() + 1, 0);
  for (std::uint32_t place = 0; place < places_.size(); ++place) {
    if (!remains_.Keeps(place)) continue;
    shows[place] = ShownFrom(place, place < shown.size() ? shown[place] : std::vector<std::uint32_t>());
    std::vector<Seer>& seers = places_[place].seers;
    for (const std::uint32_t point : shows[place]) {
      ++shown_begins_[point + 1];
      for (const Sights::Sight& observer : sights.ObserversOf(point))
        if (counts[observer.number]++ == 0) seers.push_back({observer.number});
    }
    for (Seer& seer : seers) seer.points = std::exchange(counts[seer.keyframe], 0);
    std::ranges::sort(seers, {}, &Seer::keyframe);
  }
  std::partial_sum(shown_begins_.begin(), shown_begins_.end(), shown_begins_.begin());
  shown_at_.resize(shown_begins_.back());
  std::vector<std::size_t> next(shown_begins_.begin(), shown_begins_.end());
  for (std::uint32_t place = 0; place < places_.size(); ++place)
    for (const std::uint32_t point : shows[place]) shown_at_[next[point]++] = place;
}

std::vector<std::uint32_t> Finding::ShownFrom(std::uint32_t place, std::span<const std::uint32_t> beside) const {
  std::vector<std::uint32_t> points;
  for (const Sights::Sight& sight : remains_.sights().PointsOf(place)) points.push_back(sight.number);
  const auto seen = static_cast<std::ptrdiff_t>(points.size());  // ascending
  points.insert(points.end(), beside.begin(), beside.end());
  std::sort(points.begin() + seen, points.end());
  std::inplace_merge(points.begin(), points.begin() + seen, points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  std::erase_if(points, [&](std::uint32_t point) { return !remains_.Stays(point); });
  return points;
}

void Finding::CountWords(int threads) {
  const std::vector<WordLists> lists = ListWords(remains_);
  ParallelFor(places_.size(), kGrain, threads, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> common(places_.size(), 0);  // by keyframe
    for (std::size_t number = begin; number < end; ++number) {
      const auto place = static_cast<std::uint32_t>(number);
      if (!remains_.Keeps(place)) continue;
      std::vector<std::uint32_t> sharing;
      const WordLists& words = lists[remains_.sights().RowOf(place).map];
      for (const std::uint32_t word : words.WordsOf(place))
        for (const std::uint32_t keyframe : words.KeyFramesWith(word))
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
  if (rivals.size() > kMostRivals) {
    std::ranges::nth_element(rivals, rivals.begin() + kMostRivals, more_words);
    rivals.resize(kMostRivals);
  }
  seers.insert(seers.end(), rivals.begin(), rivals.end());
  std::ranges::sort(seers, more_words);
}

double Finding::ValueOf(const Place& place, std::uint32_t without) const {
  const auto is_there = [&](const Seer& seer) { return seer.keyframe != without && remains_.Keeps(seer.keyframe); };
  double best = 0, most = 1;          // what those behind can be at most
  std::size_t ahead = 0, rivals = 0;  // seers with so many words that others are not tried, and who of them is there
  for (const Seer& seer : place.seers) {
    for (; !IsTried(seer.words, place.seers[ahead].words); ++ahead)
      if (is_there(place.seers[ahead])) most = 1 / static_cast<double>(1 + ++rivals);
    if (best >= most) break;
    if (seer.points == 0 || !is_there(seer)) continue;
    const double points = seer.points, share = points * points / (points * points + sure_ * sure_);
    best = std::max(best, share / static_cast<double>(1 + rivals));
  }
  return best;
}

void Finding::ListRows(Place& place) {
  place.rows.clear();
  for (std::uint32_t row = 0; row < place.seers.size(); ++row) place.rows.emplace_back(place.seers[row].keyframe, row);
  std::ranges::sort(place.rows);
  place.gone = 0;
}

void Finding::Change(std::span<const std::uint32_t> points, std::uint32_t by) {
  for (const std::uint32_t point : points)
    for (const std::uint32_t number : PlacesThatShow(point)) {
      Place& place = places_[number];
      for (const Sights::Sight& observer : remains_.sights().ObserversOf(point)) {
        if (!remains_.Keeps(observer.number)) continue;
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
  for (const std::uint32_t number : places_of_[keyframe]) {
    Place& place = places_[number];
    place.value = ValueOf(place, keyframe);
    if (2 * ++place.gone < place.seers.size()) continue;
    std::erase_if(place.seers, [&](const Seer& seer) { return !remains_.Keeps(seer.keyframe); });
    ListRows(place);
  }
}

std::vector<std::uint32_t> Finding::ShownOnce() const {
  std::vector<std::uint32_t> once;
  for (std::uint32_t keyframe = 0; keyframe < places_.size(); ++keyframe) {
    if (!remains_.Keeps(keyframe)) continue;
    std::vector<std::uint32_t> alone;
    std::size_t others = 0;
    for (const Sights::Sight& sight : remains_.sights().PointsOf(keyframe)) {
      if (!remains_.Stays(sight.number)) continue;
      if (PlacesThatShow(sight.number).size() < 2)
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
