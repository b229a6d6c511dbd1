// SPDX-License-Identifier: BSD-3-Clause
// 1. Keyframes by what does not change while a map is edited: descriptors and time; the id decides between equal ones.
//    Those that lost features are known by the rest of them, under the same time.
// 2. Maps by the keyframes that they share.
// 3. Points by descriptor and observers, then by any keypoint that sees both; those of point clouds by position, then
// id.
#include "slamdb/edit/diff/detail/diff_match.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <tuple>

#include "slamdb/base/detail/hash.h"
#include "slamdb/base/detail/parallel.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kPerBlock = 64;

template <class Values>
std::uint64_t HashOf(const Values& values, std::uint64_t seed = 0) {
  return HashBytes(std::as_bytes(std::span(values.data(), values.size())), seed);
}

// Never kNoKey.
std::uint64_t Mixed(std::uint64_t a, std::uint64_t b) {
  const std::array<std::uint64_t, 2> both{a, b};
  return HashOf(both) & ~std::uint64_t{1};
}

std::uint64_t TimeKey(const KeyFrame& keyframe) { return std::bit_cast<std::uint64_t>(keyframe.timestamp); }

// What keyframes are told by; kNoKey where there is nothing.
struct KeyFrameKeys {
  std::vector<std::uint64_t> descriptors;
  bool any_descriptors = false;
};

std::uint64_t KeypointsKey(const KeyFrame& keyframe) {
  const Column<Keypoint>& keypoints = keyframe.features.keypoints;
  return keypoints.empty() ? Pairing::kNoKey : Mixed(HashOf(keypoints), TimeKey(keyframe));
}

KeyFrameKeys KeysOf(const NumberedAtlas& atlas, int threads) {
  const std::size_t count = atlas.keyframes.size();
  KeyFrameKeys keys{.descriptors = std::vector<std::uint64_t>(count, Pairing::kNoKey)};
  ParallelFor(count, kPerBlock, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const Features& features = atlas.keyframes[n]->features;
      if (!features.descriptors.empty()) keys.descriptors[n] = Mixed(HashOf(features.descriptors), 0);
    }
  });
  keys.any_descriptors =
      std::ranges::any_of(keys.descriptors, [](std::uint64_t key) { return key != Pairing::kNoKey; });
  return keys;
}

// A key of each descriptor with its row, ascending.
std::vector<std::pair<std::uint64_t, std::int32_t>> SortedDescriptors(const Features& features) {
  std::vector<std::pair<std::uint64_t, std::int32_t>> rows;
  for (const Descriptor& descriptor : features.descriptors)
    rows.emplace_back(HashOf(descriptor), static_cast<std::int32_t>(rows.size()));
  std::ranges::sort(rows);
  return rows;
}

// visit(row before, row after) for descriptors that both have, equal ones in their order.
template <class Visit>
void ForEachSharedDescriptor(const Features& before, const Features& after, const Visit& visit) {
  const auto first = SortedDescriptors(before), second = SortedDescriptors(after);
  for (auto a = first.begin(), b = second.begin(); a != first.end() && b != second.end();) {
    if (a->first < b->first)
      ++a;
    else if (b->first < a->first)
      ++b;
    else
      visit((a++)->second, (b++)->second);
  }
}

// Whether two keyframes of one time are one of which features were lost: most of the fewer are among the more. With the
// same id and pose any are enough, and none where one lost all. Sessions that began at the same second share none.
bool LostFeaturesOnly(const KeyFrame& before, const KeyFrame& after) {
  const bool stands = before.id == after.id &&
                      before.camera_from_world.translation == after.camera_from_world.translation &&
                      before.camera_from_world.rotation.coeffs() == after.camera_from_world.rotation.coeffs();
  const std::size_t fewer = std::min(before.features.descriptors.size(), after.features.descriptors.size());
  if (fewer == 0) return stands;
  std::size_t shared = 0;
  ForEachSharedDescriptor(before.features, after.features, [&](std::int32_t, std::int32_t) { ++shared; });
  return stands ? shared > 0 : 2 * shared > fewer;
}

Pairing PairKeyFrames(const NumberedAtlas& before, const NumberedAtlas& after, int threads) {
  const KeyFrameKeys before_keys = KeysOf(before, threads), after_keys = KeysOf(after, threads);
  Pairing pairing(before.keyframes.size(), after.keyframes.size());
  const auto join = [&](const auto& key, const Pairing::Accept& accept = {}) {
    pairing.Join([&](std::uint32_t n) { return key(*before.keyframes[n], before_keys, n); },
                 [&](std::uint32_t n) { return key(*after.keyframes[n], after_keys, n); }, accept);
  };
  const auto time = [](const KeyFrame& keyframe, const KeyFrameKeys&, std::uint32_t) {
    return Mixed(TimeKey(keyframe), 0);
  };
  const auto time_and_id = [](const KeyFrame& keyframe, const KeyFrameKeys&, std::uint32_t) {
    return Mixed(Mixed(TimeKey(keyframe), 0), keyframe.id.value());
  };
  const auto lost_features = [&](std::uint32_t a, std::uint32_t b) {
    return LostFeaturesOnly(*before.keyframes[a], *after.keyframes[b]);
  };
  const auto look = [](const KeyFrame& keyframe, const KeyFrameKeys& keys, std::uint32_t n) {
    return keys.descriptors[n] == Pairing::kNoKey ? Pairing::kNoKey : Mixed(keys.descriptors[n], TimeKey(keyframe));
  };
  const auto with_id = [](std::uint64_t key, const KeyFrame& keyframe) {
    return key == Pairing::kNoKey ? key : Mixed(key, keyframe.id.value());
  };
  join([&](const KeyFrame& keyframe, const KeyFrameKeys& keys, std::uint32_t n) {
    return with_id(look(keyframe, keys, n), keyframe);
  });
  join(time_and_id, lost_features);
  join(look);
  join([](const KeyFrame&, const KeyFrameKeys& keys, std::uint32_t n) { return keys.descriptors[n]; });
  join([](const KeyFrame& keyframe, const KeyFrameKeys&, std::uint32_t) { return KeypointsKey(keyframe); });
  join(time, lost_features);
  if (before_keys.any_descriptors && after_keys.any_descriptors) return pairing;
  // A format without descriptors: only times are left. Sessions that began at the same second must not mix otherwise.
  join(time_and_id);
  join(time);
  return pairing;
}

// The maps that share most keyframes first; those without keyframes by id.
Pairing PairMaps(const NumberedAtlas& before, const NumberedAtlas& after, const Pairing& keyframes) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> shared;
  for (std::uint32_t n = 0; n < before.keyframes.size(); ++n)
    if (keyframes.AfterOf(n) != kNoRow)
      ++shared[{before.map_of_keyframe[n], after.map_of_keyframe[keyframes.AfterOf(n)]}];
  std::vector<std::tuple<std::size_t, std::uint32_t, std::uint32_t>> order;
  for (const auto& [maps, count] : shared) order.emplace_back(count, maps.first, maps.second);
  std::ranges::stable_sort(order, [](const auto& a, const auto& b) { return std::get<0>(a) > std::get<0>(b); });
  const std::vector<Map>&before_maps = before.atlas().maps, &after_maps = after.atlas().maps;
  Pairing pairing(before_maps.size(), after_maps.size());
  for (const auto& [count, a, b] : order)
    if (pairing.AfterOf(a) == kNoRow && pairing.BeforeOf(b) == kNoRow) pairing.Add(a, b);
  const auto empty_id = [](const std::vector<Map>& maps, std::uint32_t row) {
    return maps[row].keyframes.empty() ? maps[row].id.value() : Pairing::kNoKey;
  };
  pairing.Join([&](std::uint32_t row) { return empty_id(before_maps, row); },
               [&](std::uint32_t row) { return empty_id(after_maps, row); });
  const auto is_empty = [](const std::vector<Map>& maps, std::uint32_t row) {
    return maps[row].keyframes.empty() && maps[row].points.empty() ? 0 : Pairing::kNoKey;
  };
  pairing.Join([&](std::uint32_t row) { return is_empty(before_maps, row); },
               [&](std::uint32_t row) { return is_empty(after_maps, row); });
  return pairing;
}

Pairing PairCameras(const Atlas& before, const Atlas& after) {
  Pairing pairing(before.cameras.size(), after.cameras.size());
  const auto content = [](const Camera& camera) {
    return Mixed(HashOf(camera.parameters), static_cast<std::uint64_t>(camera.model));
  };
  const auto join = [&](const auto& key) {
    pairing.Join([&](std::uint32_t row) { return key(before.cameras[row]); },
                 [&](std::uint32_t row) { return key(after.cameras[row]); });
  };
  join([&](const Camera& camera) { return Mixed(content(camera), camera.id.value()); });
  join(content);
  join([](const Camera& camera) { return camera.id.value(); });
  return pairing;
}

// Points are compared under the numbers that keyframes have in the atlas after.
class PointPairing {
 public:
  PointPairing(const NumberedAtlas& before, const NumberedAtlas& after, const Pairing& keyframes,
               const FeatureRows& rows, int threads)
      : before_(before),
        after_(after),
        keyframes_(keyframes),
        rows_(rows),
        pairing_(before.points.size(), after.points.size()) {
    before_seen_ = SeenKeys(
        before_, threads, [&](std::uint32_t n) { return keyframes_.AfterOf(n); },
        [&](std::uint32_t n, std::int32_t row) { return rows_.AfterOf(n, row); });
    after_seen_ = SeenKeys(
        after_, threads, [&](std::uint32_t n) { return keyframes_.BeforeOf(n) == kNoRow ? kNoRow : n; }, OwnRow);
  }

  Pairing Run() {
    const auto with = [](std::uint64_t key, std::uint64_t other) {
      return key == Pairing::kNoKey ? key : Mixed(key, other);
    };
    const auto look = [](const MapPoint& point) { return HashOf(point.descriptor); };
    Join([&](const MapPoint& point, std::uint64_t seen) { return with(with(seen, look(point)), point.id.value()); });
    Join([&](const MapPoint& point, std::uint64_t seen) { return with(seen, look(point)); });
    Join([](const MapPoint&, std::uint64_t seen) { return seen; });
    PairByVotes();
    Join([&](const MapPoint& point, std::uint64_t) {
      return point.has_descriptor() ? Mixed(look(point), point.id.value()) : Pairing::kNoKey;
    });
    Join([&](const MapPoint& point, std::uint64_t) { return Mixed(look(point), HashOf(point.position)); });
    if (before_.keyframes.empty() && after_.keyframes.empty())  // point clouds
      Join([](const MapPoint& point, std::uint64_t) { return Mixed(point.id.value(), 0); });
    return std::move(pairing_);
  }

 private:
  static std::int32_t OwnRow(std::uint32_t, std::int32_t row) { return row; }

  // A key of the set of observations in keyframes that both atlases have, by numbers and rows of the atlas after.
  template <class Number, class Row>
  static std::vector<std::uint64_t> SeenKeys(const NumberedAtlas& atlas, int threads, const Number& number,
                                             const Row& row_of) {
    std::vector<std::uint64_t> keys(atlas.points.size(), Pairing::kNoKey);
    ParallelFor(keys.size(), 16 * kPerBlock, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        std::uint64_t sum = 0;
        bool any = false;
        for (const Observation& observation : atlas.points[n]->observations) {
          const std::uint32_t own = atlas.FindKeyFrame(atlas.map_of_point[n], observation.keyframe);
          const std::uint32_t observer = own == kNoRow ? kNoRow : number(own);
          if (observer == kNoRow) continue;
          any = true;
          sum += Mixed(observer, std::uint64_t{static_cast<std::uint32_t>(row_of(own, observation.left))} << 32 |
                                     static_cast<std::uint32_t>(row_of(own, observation.right)));
        }
        if (any) keys[n] = Mixed(sum, 0);
      }
    });
    return keys;
  }

  template <class Key>
  void Join(const Key& key) {
    pairing_.Join([&](std::uint32_t n) { return key(*before_.points[n], before_seen_[n]); },
                  [&](std::uint32_t n) { return key(*after_.points[n], after_seen_[n]); });
  }

  // visit(key of a keypoint) for the keypoints that see a point.
  template <class Number, class Row, class Visit>
  static void ForEachKeypoint(const NumberedAtlas& atlas, std::uint32_t n, const Number& number, const Row& row_of,
                              const Visit& visit) {
    for (const Observation& observation : atlas.points[n]->observations) {
      const std::uint32_t own = atlas.FindKeyFrame(atlas.map_of_point[n], observation.keyframe);
      const std::uint32_t observer = own == kNoRow ? kNoRow : number(own);
      if (observer == kNoRow) continue;
      for (const std::int32_t row : {row_of(own, observation.left), row_of(own, observation.right)})
        if (row >= 0 && row != FeatureRows::kGone)
          visit(std::uint64_t{observer} << 32 | static_cast<std::uint32_t>(row));
    }
  }

  // A point that lost or won observers goes by the keypoints it still has; most of them decide.
  void PairByVotes() {
    std::vector<std::uint64_t> keypoints;
    std::vector<std::uint32_t> owners;
    for (std::uint32_t n = 0; n < after_.points.size(); ++n) {
      if (pairing_.BeforeOf(n) != kNoRow) continue;
      ForEachKeypoint(
          after_, n, [](std::uint32_t own) { return own; }, OwnRow,
          [&](std::uint64_t keypoint) {
            keypoints.push_back(keypoint);
            owners.push_back(n);
          });
    }
    if (keypoints.empty()) return;
    const auto [lowest, highest] = std::ranges::minmax(keypoints);
    IdTable table(lowest, highest, keypoints.size());
    for (std::size_t i = 0; i < keypoints.size(); ++i) table.Insert(keypoints[i], owners[i]);
    std::vector<std::uint32_t> votes;
    for (std::uint32_t n = 0; n < before_.points.size(); ++n) {
      if (pairing_.AfterOf(n) != kNoRow) continue;
      votes.clear();
      ForEachKeypoint(
          before_, n, [&](std::uint32_t own) { return keyframes_.AfterOf(own); },
          [&](std::uint32_t own, std::int32_t row) { return rows_.AfterOf(own, row); },
          [&](std::uint64_t keypoint) {
            const std::uint32_t owner = table.Find(keypoint);
            if (owner != kNoRow && pairing_.BeforeOf(owner) == kNoRow) votes.push_back(owner);
          });
      if (!votes.empty()) pairing_.Add(n, MostFrequent(votes));
    }
  }

  static std::uint32_t MostFrequent(std::vector<std::uint32_t>& votes) {
    std::ranges::sort(votes);
    std::uint32_t best = votes[0];
    std::size_t most = 0;
    for (std::size_t begin = 0, end = 0; begin < votes.size(); begin = end) {
      while (end < votes.size() && votes[end] == votes[begin]) ++end;
      if (end - begin > most) most = end - begin, best = votes[begin];
    }
    return best;
  }

  const NumberedAtlas &before_, &after_;
  const Pairing& keyframes_;
  const FeatureRows& rows_;
  Pairing pairing_;
  std::vector<std::uint64_t> before_seen_, after_seen_;
};

}  // namespace

NumberedAtlas::NumberedAtlas(const Atlas& atlas) : index_(atlas) {
  for (std::uint32_t row = 0; row < atlas.maps.size(); ++row) {
    const Map& map = atlas.maps[row];
    first_keyframe_.push_back(static_cast<std::uint32_t>(keyframes.size()));
    first_point_.push_back(static_cast<std::uint32_t>(points.size()));
    for (const KeyFrame& keyframe : map.keyframes) keyframes.push_back(&keyframe);
    for (const MapPoint& point : map.points) points.push_back(&point);
    map_of_keyframe.resize(keyframes.size(), row);
    map_of_point.resize(points.size(), row);
  }
  first_keyframe_.push_back(static_cast<std::uint32_t>(keyframes.size()));
  first_point_.push_back(static_cast<std::uint32_t>(points.size()));
}

void Pairing::Add(std::uint32_t before, std::uint32_t after) {
  after_of_[before] = after;
  before_of_[after] = before;
}

void Pairing::Join(const Key& before_key, const Key& after_key, const Accept& accept) {
  std::vector<std::uint64_t> keys;
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t n = 0; n < before_of_.size(); ++n) {
    if (before_of_[n] != kNoRow) continue;
    const std::uint64_t key = after_key(n);
    if (key == kNoKey) continue;
    keys.push_back(key);
    numbers.push_back(n);
  }
  if (keys.empty()) return;
  // Entries of one key form a chain, whose first the table knows.
  const auto [lowest, highest] = std::ranges::minmax(keys);
  IdTable table(lowest, highest, keys.size());
  std::vector<std::uint32_t> next(keys.size(), kNoRow), head(keys.size()), last(keys.size());
  for (std::uint32_t entry = 0; entry < keys.size(); ++entry) {
    const std::uint32_t first = table.Insert(keys[entry], entry);
    head[entry] = last[entry] = entry;
    if (first == kNoRow) continue;
    next[last[first]] = entry;
    last[first] = entry;
  }
  for (std::uint32_t n = 0; n < after_of_.size(); ++n) {
    if (after_of_[n] != kNoRow) continue;
    const std::uint32_t first = table.Find(before_key(n));
    if (first == kNoRow || head[first] == kNoRow) continue;
    if (accept && !accept(n, numbers[head[first]])) continue;
    Add(n, numbers[head[first]]);
    head[first] = next[head[first]];
  }
}

FeatureRows::FeatureRows(const NumberedAtlas& before, const NumberedAtlas& after, const Pairing& keyframes, int threads)
    : rows_(before.keyframes.size()) {
  ParallelFor(rows_.size(), kPerBlock, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const std::uint32_t partner = keyframes.AfterOf(static_cast<std::uint32_t>(n));
      if (partner == kNoRow) continue;
      const Features &first = before.keyframes[n]->features, &second = after.keyframes[partner]->features;
      if (first.descriptors.size() == second.descriptors.size()) continue;
      rows_[n].assign(std::max(first.descriptors.size(), first.map_points.size()), kGone);
      ForEachSharedDescriptor(first, second, [&](std::int32_t a, std::int32_t b) { rows_[n][a] = b; });
    }
  });
}

AtlasPairing PairEntities(const NumberedAtlas& before, const NumberedAtlas& after, int threads) {
  Pairing keyframes = PairKeyFrames(before, after, threads);
  Pairing maps = PairMaps(before, after, keyframes);
  Pairing cameras = PairCameras(before.atlas(), after.atlas());
  FeatureRows rows(before, after, keyframes, threads);
  Pairing points = PointPairing(before, after, keyframes, rows, threads).Run();
  return {std::move(maps), std::move(cameras), std::move(keyframes), std::move(rows), std::move(points)};
}

}  // namespace slamdb::detail
