// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rows/detail/place_table.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <numeric>
#include <set>
#include <tuple>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "slamdb/base/detail/hash.h"
#include "slamdb/base/detail/parallel.h"

namespace slamdb::rows {
namespace {

constexpr std::size_t kNeighbours = 3;  // on each side, that vote with one
constexpr double kChance = 11;          // that pictures of other places come to: see likeness
constexpr double kFaint = 0.6;          // of the best likeness, under which such a place is passed over

// A place, by the row of its keyframe in the table.
struct Vote {
  std::size_t keyframe = 0;
  double likeness = 0;
};

template <class Visit>
void ForEachWord(const PlaceWords& words, const Visit& visit) {
  for (std::size_t part = 0; part < words.size(); ++part)
    for (std::uint64_t bits = words[part]; bits != 0; bits &= bits - 1)
      visit(part * 64 + static_cast<std::size_t>(std::countr_zero(bits)));
}

class PlaceTable {
 public:
  PlaceTable(const std::map<std::int64_t, PlaceMap>& maps, std::vector<PlaceKeyframe> keyframes,
             std::span<const PlaceWords> others)
      : maps_(maps), keyframes_(std::move(keyframes)), others_(others) {
    std::ranges::stable_sort(keyframes_, [](const PlaceKeyframe& a, const PlaceKeyframe& b) {
      return a.map != b.map ? a.map < b.map : a.id < b.id;
    });
    Weigh();
    for (const PlaceKeyframe& keyframe : keyframes_) counts_.push_back(CountOf(keyframe.words));
    for (const PlaceWords& other : others_) counts_of_others_.push_back(CountOf(other));
  }

  std::vector<StoredPlace> PlacesLike(const PlaceWords& picture, const PlaceOptions& options) const {
    std::vector<StoredPlace> places;
    for (const Vote& vote : BestOf(VotesOf(ScoresOf(picture)), options)) {
      const PlaceKeyframe& keyframe = keyframes_[vote.keyframe];
      const PlaceMap& map = maps_.at(keyframe.map);
      places.push_back({map.atlas, map.id, KeyFrameId(keyframe.id), vote.likeness});
    }
    return places;
  }

 private:
  // How often words are, as a share of all, and how much they tell: in real maps at large. What is frequent in the
  // store may be so because it holds one room, or maps that somebody made up.
  void Weigh() {
    const std::vector<double> frequencies = PlaceWordFrequencies();
    const double sum = std::reduce(frequencies.begin(), frequencies.end());
    for (const double frequency : frequencies) {
      rarity_.push_back(static_cast<float>(-std::log(frequency)));
      share_.push_back(frequency / sum);
    }
  }

  // Pictures unlike those of real maps, as made ones are, have more in common with all of their kind: that tells
  // nothing.
  static void ForgetWhatAllHave(std::vector<float>& scores, std::vector<float> of_all) {
    if (of_all.empty()) return;
    const auto middle = of_all.begin() + static_cast<std::ptrdiff_t>(of_all.size() / 2);
    std::nth_element(of_all.begin(), middle, of_all.end());
    const float all_have = std::max(0.0F, *middle);
    for (float& score : scores) score = std::max(0.0F, score - all_have);
  }

  // What a keyframe and a picture have in common: by how many standard deviations it is more than one with as many
  // words has that has nothing to do with it.
  class Picture {
   public:
    Picture(const PlaceTable& table, const PlaceWords& words) : table_(table), words_(words) {
      ForEachWord(words, [&](std::size_t word) {
        const auto rarity = static_cast<double>(table.rarity_[word]);
        mean_ += rarity * table.share_[word];
        variance_ += rarity * rarity * table.share_[word];
      });
    }
    bool has_words() const { return variance_ > 0; }
    // Of a keyframe that has `count` words, some.
    float ScoreOf(const PlaceWords& keyframe, double count) const {
      PlaceWords both = words_;
      for (std::size_t part = 0; part < both.size(); ++part) both[part] &= keyframe[part];
      float common = 0;
      ForEachWord(both, [&](std::size_t word) { common += table_.rarity_[word]; });
      return static_cast<float>((static_cast<double>(common) - count * mean_) / std::sqrt(count * variance_));
    }

   private:
    const PlaceTable& table_;
    PlaceWords words_;
    double mean_ = 0, variance_ = 0;  // of a keyframe with one word
  };

  std::vector<float> ScoresOf(const PlaceWords& words) const {
    const Picture picture(*this, words);
    std::vector<float> scores(keyframes_.size(), 0), of_all;
    if (!picture.has_words()) return scores;
    for (std::size_t i = 0; i < keyframes_.size(); ++i) {
      if (counts_[i] == 0) continue;
      scores[i] = picture.ScoreOf(keyframes_[i].words, counts_[i]);
      if (others_.empty()) of_all.push_back(scores[i]);
    }
    for (std::size_t i = 0; i < others_.size(); ++i)
      if (counts_of_others_[i] > 0) of_all.push_back(picture.ScoreOf(others_[i], counts_of_others_[i]));
    ForgetWhatAllHave(scores, std::move(of_all));
    return scores;
  }

  bool IsNear(std::size_t one, std::size_t other) const {
    return keyframes_[one].map == keyframes_[other].map && std::max(one, other) - std::min(one, other) <= kNeighbours;
  }

  std::vector<float> VotesOf(const std::vector<float>& scores) const {
    std::vector<float> votes(scores.size(), 0);
    for (std::size_t i = 0; i < scores.size(); ++i)
      for (std::size_t j = i - std::min(i, kNeighbours); j < std::min(scores.size(), i + kNeighbours + 1); ++j)
        if (IsNear(i, j)) votes[i] += scores[j];
    return votes;
  }

  // Of branches of one map the same picture is looked at once, as long as there are other places.
  std::vector<Vote> BestOf(const std::vector<float>& votes, const PlaceOptions& options) const {
    std::vector<Vote> order, best;
    for (std::size_t i = 0; i < votes.size(); ++i)
      if (votes[i] > 0) order.push_back({i, static_cast<double>(votes[i])});
    std::ranges::stable_sort(order, std::greater(), &Vote::likeness);
    std::map<std::int64_t, std::size_t> of_map;
    const auto take = [&](const Vote& vote) {
      const auto known = of_map.find(keyframes_[vote.keyframe].map);
      if (known == of_map.end() ? best.size() >= options.places : known->second >= options.of_map) return;
      if (std::ranges::any_of(best, [&](const Vote& other) { return IsNear(vote.keyframe, other.keyframe); })) return;
      ++of_map[keyframes_[vote.keyframe].map];
      best.push_back(vote);
    };
    std::vector<Vote> copies;
    std::unordered_set<std::uint64_t> seen;  // hashes of words
    for (const Vote& vote : order) {
      if (!options.faint && vote.likeness < kChance && vote.likeness < kFaint * order.front().likeness) break;
      const PlaceKeyframe& keyframe = keyframes_[vote.keyframe];
      const bool is_new = seen.insert(detail::HashBytes(std::as_bytes(std::span(keyframe.words)))).second;
      if (is_new || of_map.contains(keyframe.map))
        take(vote);
      else
        copies.push_back(vote);
    }
    std::ranges::for_each(copies, take);
    std::ranges::sort(best, [](const Vote& a, const Vote& b) {
      return a.likeness != b.likeness ? a.likeness > b.likeness : a.keyframe < b.keyframe;
    });
    return best;
  }

  const std::map<std::int64_t, PlaceMap>& maps_;
  std::vector<PlaceKeyframe> keyframes_;  // by map and id
  std::span<const PlaceWords> others_;
  std::vector<int> counts_, counts_of_others_;  // of the words of each
  std::vector<float> rarity_;                   // by word
  std::vector<double> share_;
};

// Atlases with keyframes that the store knows no words of.
std::vector<std::string> UnknownIn(const std::map<std::int64_t, PlaceMap>& maps,
                                   const std::vector<PlaceKeyframe>& keyframes, const std::set<std::string>& without) {
  std::set<std::int64_t> of_maps;
  for (const PlaceKeyframe& keyframe : keyframes)
    if (keyframe.is_unknown) of_maps.insert(keyframe.map);
  std::set<std::string> names;
  for (const std::int64_t map : of_maps)
    if (const std::string& atlas = maps.at(map).atlas; !without.contains(atlas)) names.insert(atlas);
  return {names.begin(), names.end()};
}

// Numbers maps by their names, so that of what is equally like the same comes first in every store.
std::map<std::int64_t, PlaceMap> NumberByName(const std::map<std::int64_t, PlaceMap>& stored,
                                              std::vector<PlaceKeyframe>& keyframes) {
  std::vector<std::int64_t> order;
  for (const auto& [key, map] : stored) order.push_back(key);
  std::ranges::stable_sort(order, [&](std::int64_t a, std::int64_t b) {
    const PlaceMap &one = stored.at(a), &other = stored.at(b);
    return std::tie(one.atlas, one.id) < std::tie(other.atlas, other.id);
  });
  std::map<std::int64_t, PlaceMap> numbered;
  std::unordered_map<std::int64_t, std::int64_t> numbers;
  for (const std::int64_t key : order) {
    numbers[key] = static_cast<std::int64_t>(numbered.size());
    numbered[numbers[key]] = stored.at(key);
  }
  for (PlaceKeyframe& keyframe : keyframes) keyframe.map = numbers.at(keyframe.map);
  return numbered;
}

}  // namespace

StoredPlaces FindPlaces(const std::map<std::int64_t, PlaceMap>& stored, std::vector<PlaceKeyframe> keyframes,
                        std::span<const PlaceWords> others, std::span<const PlaceWords> pictures,
                        const PlaceOptions& options) {
  const std::set<std::string> without(options.without.begin(), options.without.end());
  std::erase_if(keyframes, [&](const PlaceKeyframe& keyframe) { return !stored.contains(keyframe.map); });
  const std::map<std::int64_t, PlaceMap> maps = NumberByName(stored, keyframes);
  StoredPlaces places{.by_picture = std::vector<std::vector<StoredPlace>>(pictures.size()),
                      .unknown = UnknownIn(maps, keyframes, without)};
  for (PlaceKeyframe& keyframe : keyframes)
    if (without.contains(maps.at(keyframe.map).atlas)) keyframe.words = {};
  const PlaceTable table(maps, std::move(keyframes), others);
  detail::ParallelFor(pictures.size(), 1, options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) places.by_picture[i] = table.PlacesLike(pictures[i], options);
  });
  return places;
}

}  // namespace slamdb::rows
