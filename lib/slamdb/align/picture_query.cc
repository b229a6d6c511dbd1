// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/picture_query.h"

#include <algorithm>
#include <unordered_set>

#include "slamdb/align/detail/distance_table.h"
#include "slamdb/align/detail/visibility.h"
#include "slamdb/model/derive.h"

namespace slamdb::detail {
namespace {

constexpr int kMostAlikeBits = 75;      // of a match that nothing else tells: geometry sorts out afterwards
constexpr int kMostNearBits = 75;       // of one that lies where it should
constexpr int kSameBits = 20;           // descriptors that near look the same
constexpr int kRivalPercent = 88;       // a second one is a rival if the best is not below so much of its distance
constexpr double kSamePlace = 0.02;     // of the median depth: nearer points are one thing
constexpr double kSameCorner = 4;       // pixels at the octave: nearer keypoints are one thing
constexpr double kLeastCosine = 0.5;    // of the angle to where a point was seen from: 60 degrees
constexpr std::uint16_t kFar = 0x7FFF;  // more bits than there are

// What views saw of points: a look for each that looks different, those of one point side by side.
struct Appearances {
  std::vector<Bits> looks;
  std::vector<std::uint32_t> rows;    // of `points`, by look; ascending
  std::vector<std::size_t> begins;    // of the looks of a point: [begins[row], begins[row + 1])
  std::vector<std::uint32_t> points;  // each once
};

Appearances AppearancesOf(const KnownMap& known, std::span<const std::uint32_t> views) {
  Appearances all;
  std::unordered_map<std::uint32_t, std::uint32_t> row_of;
  std::vector<std::vector<const Descriptor*>> kept;  // by row
  const auto add = [&](std::uint32_t row, const Descriptor& descriptor) {
    for (const Descriptor* other : kept[row])
      if (HammingDistance(*other, descriptor) <= kSameBits) return;
    kept[row].push_back(&descriptor);
  };
  const MapViews& map = known.views();
  for (const std::uint32_t left : views)
    for (std::uint32_t view = left; view <= map.LastViewOf(left) && !known.LeavesOut(left); ++view)
      for (const Seen& seen : map.SeenBy(view)) {
        const Descriptor* descriptor = known.DescriptorOf(seen.point);
        if (descriptor == nullptr) continue;
        const auto [row, is_new] = row_of.try_emplace(seen.point, static_cast<std::uint32_t>(all.points.size()));
        if (is_new) {
          all.points.push_back(seen.point);
          kept.emplace_back();
          add(row->second, *descriptor);
        }
        add(row->second, map.views()[view].descriptors[seen.keypoint]);
      }
  for (std::uint32_t row = 0; row < kept.size(); ++row) {
    all.begins.push_back(all.looks.size());
    for (const Descriptor* descriptor : kept[row]) all.looks.push_back(BitsOf(*descriptor));
    all.rows.resize(all.looks.size(), row);
  }
  all.begins.push_back(all.looks.size());
  return all;
}

bool IsRival(int best, int other) { return 100 * best >= kRivalPercent * other; }
int FarthestRival(int best) { return 100 * best / kRivalPercent; }

// Calls visit(place) for each distance of at most `most`: few of many.
template <class Visit>
void ForEachWithin(std::span<const std::uint16_t> distances, int most, const Visit& visit) {
  constexpr std::size_t kBlock = 64;  // of which most have none
  for (std::size_t begin = 0; begin < distances.size(); begin += kBlock) {
    const std::span<const std::uint16_t> block = distances.subspan(begin, std::min(kBlock, distances.size() - begin));
    int within = 0;
    for (const std::uint16_t distance : block) within |= static_cast<int>(distance <= most);
    for (std::size_t i = 0; within != 0 && i < block.size(); ++i)
      if (block[i] <= most) visit(begin + i);
  }
}

std::size_t LeastOf(std::span<const std::uint16_t> distances) {
  std::uint16_t least = kFar;
  for (const std::uint16_t distance : distances) least = std::min(least, distance);
  return static_cast<std::size_t>(std::ranges::find(distances, least) - distances.begin());
}

// Matches keypoints with points that were seen, one by one.
class Matcher {
 public:
  Matcher(const PictureQuery& query, const KnownMap& known, std::span<const std::uint32_t> views)
      : picture_(query.view), known_(known), all_(AppearancesOf(known, views)), looks_(all_.looks) {
    std::vector<Bits> bits;
    for (const Descriptor& descriptor : picture_.descriptors) bits.push_back(BitsOf(descriptor));
    keypoints_ = BitColumns(bits);
    bits_ = std::move(bits);
    to_looks_.resize(looks_.size());
    to_keypoints_.resize(keypoints_.size());
    of_look_.resize(keypoints_.size());
  }

  bool empty() const { return looks_.size() == 0 || keypoints_.size() == 0; }

  // How near the best rival of a keypoint's match comes, and the match; nullopt when there is none.
  std::optional<std::pair<double, PictureMatch>> Match(std::uint32_t keypoint) {
    looks_.DistancesTo(bits_[keypoint], to_looks_.data());
    const std::size_t look = LeastOf(to_looks_);
    const int best = to_looks_[look];
    if (best > kMostAlikeBits) return std::nullopt;
    const std::uint32_t row = all_.rows[look];
    if (NearestRival(row, FarthestRival(best)) != kFar) return std::nullopt;
    FindLikeness(row);
    if (LeastOf(to_keypoints_) != keypoint) return std::nullopt;
    const int second = std::min(NearestRivalKeypoint(keypoint, kFar), NearestRival(row, kFar));
    if (IsRival(best, second)) return std::nullopt;
    return std::pair(static_cast<double>(best) / second, PictureMatch{keypoint, all_.points[row], best});
  }

 private:
  const Eigen::Vector3d& PositionOf(std::uint32_t row) const {
    return known_.views().points()[all_.points[row]].position;
  }

  // The least distance of the keypoint at hand, of at most `most`, to a look at another point elsewhere; else kFar.
  int NearestRival(std::uint32_t row, int most) const {
    const double same_place = kSamePlace * known_.views().median_depth();
    int nearest = kFar;
    ForEachWithin(to_looks_, most, [&](std::size_t look) {
      const std::uint32_t other = all_.rows[look];
      if (to_looks_[look] < nearest && other != row && (PositionOf(other) - PositionOf(row)).norm() > same_place)
        nearest = to_looks_[look];
    });
    return nearest;
  }

  // For each keypoint the least distance over what was seen of a point.
  void FindLikeness(std::uint32_t row) {
    std::ranges::fill(to_keypoints_, kFar);
    for (std::size_t look = all_.begins[row]; look < all_.begins[row + 1]; ++look) {
      keypoints_.DistancesTo(all_.looks[look], of_look_.data());
      for (std::size_t i = 0; i < to_keypoints_.size(); ++i) to_keypoints_[i] = std::min(to_keypoints_[i], of_look_[i]);
    }
  }

  int NearestRivalKeypoint(std::uint32_t keypoint, int nearest) const {
    const Keypoint& own = picture_.keypoints[keypoint];
    const double same_corner = kSameCorner * picture_.ScaleOf(own.octave);
    for (std::uint32_t i = 0; i < to_keypoints_.size(); ++i)
      if (i != keypoint && to_keypoints_[i] < nearest &&
          (PixelOf(picture_.keypoints[i]) - PixelOf(own)).norm() > same_corner)
        nearest = to_keypoints_[i];
    return nearest;
  }

  const View& picture_;
  const KnownMap& known_;
  const Appearances all_;
  const BitColumns looks_;
  std::vector<Bits> bits_;  // of the keypoints
  BitColumns keypoints_{{}};
  std::vector<std::uint16_t> to_looks_;                // from the keypoint at hand
  std::vector<std::uint16_t> to_keypoints_, of_look_;  // from the point at hand
};

// The best match for each keypoint and point: the one with the fewest different bits.
std::vector<PictureMatch> OneEach(std::vector<PictureMatch> offered) {
  std::ranges::stable_sort(offered, {}, &PictureMatch::bits);
  std::unordered_set<std::uint32_t> keypoints, points;
  std::vector<PictureMatch> matches;
  for (const PictureMatch& match : offered) {
    if (keypoints.contains(match.keypoint) || points.contains(match.point)) continue;
    keypoints.insert(match.keypoint);
    points.insert(match.point);
    matches.push_back(match);
  }
  return matches;
}

}  // namespace

std::optional<PictureQuery> MakeQuery(const PictureFeatures& features) {
  const std::optional<Lens> lens = Lens::Of(features.camera);
  if (!lens) return std::nullopt;
  PictureQuery query;
  View& view = query.view;
  view.lens = *lens;
  SetPose(view, {});
  const std::size_t count = std::min(features.keypoints.size(), features.descriptors.size());
  SetFeatures(view, features.keypoints, std::span(features.descriptors).first(count));
  SetPicture(view, features.bounds, features.pyramid);
  for (const Keypoint& keypoint : view.keypoints) {
    const Eigen::Vector3d ray = Unproject(features.camera, {keypoint.x, keypoint.y}).cast<double>();
    query.rays.push_back(ray.allFinite() ? ray.normalized() : Eigen::Vector3d(Eigen::Vector3d::UnitZ()));
  }
  return query;
}

std::vector<std::uint32_t> PointsSeenBy(const KnownMap& known, std::span<const std::uint32_t> views) {
  const MapViews& map = known.views();
  std::vector<std::uint32_t> points;
  std::vector<bool> taken(map.points().size(), false);
  for (const std::uint32_t left : views)
    for (std::uint32_t view = left; view <= map.LastViewOf(left) && !known.LeavesOut(left); ++view)
      for (const Seen& seen : map.SeenBy(view)) {
        if (taken[seen.point] || known.DescriptorOf(seen.point) == nullptr) continue;
        taken[seen.point] = true;
        points.push_back(seen.point);
      }
  return points;
}

std::vector<PictureMatch> MatchPicture(const PictureQuery& query, const KnownMap& known,
                                       std::span<const std::uint32_t> views) {
  Matcher matcher(query, known, views);
  if (matcher.empty()) return {};
  std::vector<std::pair<double, PictureMatch>> rated;  // by how near the best rival comes
  for (std::uint32_t keypoint = 0; keypoint < query.view.keypoints.size(); ++keypoint)
    if (const auto match = matcher.Match(keypoint)) rated.push_back(*match);
  std::ranges::stable_sort(rated, {}, &std::pair<double, PictureMatch>::first);
  std::vector<PictureMatch> matches;
  for (const auto& [rating, match] : rated) matches.push_back(match);
  return matches;
}

std::vector<PictureMatch> SearchPicture(const PictureQuery& query, const KnownMap& known,
                                        std::span<const std::uint32_t> points, double radius) {
  std::vector<PictureMatch> offered;
  for (const std::uint32_t point : points) {
    const Descriptor* descriptor = known.DescriptorOf(point);
    if (descriptor == nullptr) continue;
    const auto expected = Expect(query.view, known.views().points()[point], {}, kLeastCosine);
    if (!expected) continue;
    const auto found = FindNear(query.view, *expected, *descriptor, radius, kMostNearBits);
    if (found) offered.push_back({found->keypoint, point, found->bits});
  }
  return OneEach(std::move(offered));
}

}  // namespace slamdb::detail
