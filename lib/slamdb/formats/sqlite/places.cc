// SPDX-License-Identifier: BSD-3-Clause
// 1. All rows of keyframe_words are read, by map and id of the keyframe, which is their order in time.
// 2. A picture is held against each: the words that both have, weighed by how rare they are in real maps, beside what
//    chance gives for so many words of so rare ones.
// 3. Neighbours in time vote together; the best of them stands for the place.
#include "slamdb/formats/sqlite/detail/places.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <numeric>
#include <set>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/formats/sqlite/detail/place_words.h"

namespace slamdb::sqlite {
namespace {

constexpr std::size_t kNeighbours = 3;  // on each side, that vote with one
constexpr double kChance = 11;          // that pictures of other places come to: see likeness
constexpr double kFaint = 0.6;          // of the best likeness, under which such a place is passed over

struct StoredMap {
  std::string atlas;
  MapId id;
};

struct StoredKeyframe {
  std::int64_t map = 0, row = 0;  // rows of the tables
  std::uint64_t id = 0;
};

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

// What all keyframes of a store look like.
class PlaceTable {
 public:
  PlaceTable(Database& database, const std::vector<std::string>& without) : without_(without.begin(), without.end()) {
    ReadMaps(database);
    ReadKeyframes(database);
    Weigh();
  }

  std::vector<std::string> Unknown() const {
    std::vector<std::string> names;
    for (const auto& [name, missing] : missing_)
      if (missing > 0 && !without_.contains(name)) names.push_back(name);
    return names;
  }

  std::vector<StoredPlace> PlacesLike(const PlaceWords& picture, const PlaceOptions& options) const {
    std::vector<StoredPlace> places;
    for (const Vote& vote : BestOf(VotesOf(ScoresOf(picture)), options)) {
      const StoredKeyframe& keyframe = keyframes_[vote.keyframe];
      const StoredMap& map = maps_.at(keyframe.map);
      places.push_back({map.atlas, map.id, KeyFrameId(keyframe.id), vote.likeness});
    }
    return places;
  }

 private:
  void ReadMaps(Database& database) {
    Statement statement(database, "SELECT map.row, name, id FROM map JOIN atlas ON atlas.row = map.atlas", "table map");
    while (statement.Step())
      maps_[statement.Integer(0)] = {statement.Text(1), MapId(static_cast<std::uint64_t>(statement.Integer(2)))};
  }

  void ReadKeyframes(Database& database) {
    Statement ids(database, "SELECT map, row, id FROM keyframe", "table keyframe");  // from keyframe_by_id alone
    while (ids.Step())
      if (maps_.contains(ids.Integer(0)))
        keyframes_.push_back({ids.Integer(0), ids.Integer(1), static_cast<std::uint64_t>(ids.Integer(2))});
    std::ranges::stable_sort(keyframes_, [](const StoredKeyframe& a, const StoredKeyframe& b) {
      return a.map != b.map ? a.map < b.map : a.id < b.id;
    });
    std::vector<std::size_t> by_row(keyframes_.size());
    std::iota(by_row.begin(), by_row.end(), std::size_t{0});
    const auto row_of = [&](std::size_t i) { return keyframes_[i].row; };
    std::ranges::sort(by_row, {}, row_of);
    words_.resize(keyframes_.size());
    Statement words(database, "SELECT keyframe, words FROM keyframe_words ORDER BY keyframe", "table keyframe_words");
    auto at = by_row.begin();
    const auto pass_over = [&] { ++missing_[maps_.at(keyframes_[*at++].map).atlas]; };
    while (words.Step()) {
      while (at != by_row.end() && row_of(*at) < words.Integer(0)) pass_over();
      const Bytes bytes = words.Blob(1);
      if (at == by_row.end() || row_of(*at) != words.Integer(0) || bytes.size() != sizeof(PlaceWords)) continue;
      if (!without_.contains(maps_.at(keyframes_[*at].map).atlas))
        std::memcpy(words_[*at].data(), bytes.data(), bytes.size());
      ++at;
    }
    while (at != by_row.end()) pass_over();
  }

  // How often words are, as a share of all, and how much they tell: in real maps at large. What is frequent in the
  // store may be so because it holds one room, or maps that somebody made up.
  void Weigh() {
    const std::vector<double> frequencies = PlaceWordFrequencies();
    const double sum = std::reduce(frequencies.begin(), frequencies.end());
    for (const double frequency : frequencies) {
      rarity_.push_back(static_cast<float>(-std::log(frequency)));
      share_.push_back(frequency / sum);
    }
    for (const PlaceWords& words : words_) {
      counts_.push_back(0);
      for (const std::uint64_t part : words) counts_.back() += static_cast<std::uint32_t>(std::popcount(part));
    }
  }

  // Pictures unlike those of real maps, as made ones are, have more in common with all of their kind: that tells
  // nothing.
  void ForgetWhatAllHave(std::vector<float>& scores) const {
    std::vector<float> sorted;
    for (std::size_t i = 0; i < scores.size(); ++i)
      if (counts_[i] > 0) sorted.push_back(scores[i]);
    if (sorted.empty()) return;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    for (float& score : scores) score = std::max(0.0F, score - std::max(0.0F, *middle));
  }

  // By keyframe, by how many standard deviations it has more in common with the picture than one with as many words
  // that has nothing to do with it.
  std::vector<float> ScoresOf(const PlaceWords& picture) const {
    double mean = 0, variance = 0;  // of a keyframe with one word
    ForEachWord(picture, [&](std::size_t word) {
      const auto rarity = static_cast<double>(rarity_[word]);
      mean += rarity * share_[word];
      variance += rarity * rarity * share_[word];
    });
    std::vector<float> scores(words_.size(), 0);
    if (!(variance > 0)) return scores;
    for (std::size_t i = 0; i < words_.size(); ++i) {
      const double count = counts_[i];
      if (count == 0) continue;
      PlaceWords both = picture;
      for (std::size_t part = 0; part < both.size(); ++part) both[part] &= words_[i][part];
      float common = 0;
      ForEachWord(both, [&](std::size_t word) { common += rarity_[word]; });
      const double score = (static_cast<double>(common) - count * mean) / std::sqrt(count * variance);
      scores[i] = static_cast<float>(score);
    }
    ForgetWhatAllHave(scores);
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

  std::vector<Vote> BestOf(const std::vector<float>& votes, const PlaceOptions& options) const {
    std::vector<Vote> order, best;
    for (std::size_t i = 0; i < votes.size(); ++i)
      if (votes[i] > 0) order.push_back({i, static_cast<double>(votes[i])});
    std::ranges::stable_sort(order, std::greater(), &Vote::likeness);
    std::map<std::int64_t, std::size_t> of_map;
    for (const Vote& vote : order) {
      if (!options.faint && vote.likeness < kChance && vote.likeness < kFaint * order.front().likeness) break;
      const std::int64_t map = keyframes_[vote.keyframe].map;
      const auto known = of_map.find(map);
      if (known == of_map.end() ? best.size() >= options.places : known->second >= options.of_map) continue;
      if (std::ranges::any_of(best, [&](const Vote& other) { return IsNear(vote.keyframe, other.keyframe); })) continue;
      ++of_map[map];
      best.push_back(vote);
    }
    return best;
  }

  std::set<std::string> without_;                 // atlases
  std::map<std::int64_t, StoredMap> maps_;        // by row of the table
  std::map<std::string, std::uint64_t> missing_;  // keyframes without words, by atlas
  std::vector<StoredKeyframe> keyframes_;         // by map and id
  std::vector<PlaceWords> words_;                 // of each; of those that are not asked, none
  std::vector<std::uint32_t> counts_;             // of these
  std::vector<float> rarity_;                     // by word
  std::vector<double> share_;
};

}  // namespace

StoredPlaces FindPlaces(Database& database, std::span<const std::span<const Descriptor>> pictures,
                        const PlaceOptions& options) {
  const PlaceTable table(database, options.without);
  StoredPlaces places{.by_picture = std::vector<std::vector<StoredPlace>>(pictures.size()), .unknown = table.Unknown()};
  detail::ParallelFor(pictures.size(), 1, options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      places.by_picture[i] = table.PlacesLike(PlaceWordsOf(pictures[i]), options);
  });
  return places;
}

}  // namespace slamdb::sqlite
