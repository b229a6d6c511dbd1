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

Eigen::Vector2d PlaceOf(const Keypoint& keypoint) {
  return {static_cast<double>(keypoint.x), static_cast<double>(keypoint.y)};
}

// What views saw of points: a column for each that looks different.
struct Appearances {
  std::vector<Bits> bits;
  std::vector<std::uint32_t> rows;    // of `points`, by column
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
    all.bits.push_back(BitsOf(descriptor));
    all.rows.push_back(row);
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
  return all;
}

// For each keypoint and point the least distance over what was seen of it.
class Likeness {
 public:
  Likeness(const View& picture, const Appearances& all) : columns_(all.points.size()) {
    std::vector<Bits> bits;
    for (const Descriptor& descriptor : picture.descriptors) bits.push_back(BitsOf(descriptor));
    least_.assign(bits.size() * columns_, kFar);
    const DistanceTable table(bits, all.bits);
    for (std::size_t row = 0; row < bits.size(); ++row) {
      const std::uint16_t* distances = table.Row(row);
      std::uint16_t* least = &least_[row * columns_];
      for (std::size_t column = 0; column < all.bits.size(); ++column)
        least[all.rows[column]] = std::min(least[all.rows[column]], distances[column]);
    }
  }
  const std::uint16_t* Row(std::size_t row) const { return &least_[row * columns_]; }
  std::uint16_t operator()(std::size_t row, std::size_t column) const { return least_[row * columns_ + column]; }

 private:
  std::size_t columns_;
  std::vector<std::uint16_t> least_;
};

bool IsRival(int best, int other) { return 100 * best >= kRivalPercent * other; }

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
  std::unordered_set<std::uint32_t> taken;
  for (const std::uint32_t left : views)
    for (std::uint32_t view = left; view <= map.LastViewOf(left) && !known.LeavesOut(left); ++view)
      for (const Seen& seen : map.SeenBy(view))
        if (known.DescriptorOf(seen.point) != nullptr && taken.insert(seen.point).second) points.push_back(seen.point);
  return points;
}

std::vector<PictureMatch> MatchPicture(const PictureQuery& query, const KnownMap& known,
                                       std::span<const std::uint32_t> views) {
  const View& picture = query.view;
  const Appearances all = AppearancesOf(known, views);
  const std::size_t rows = picture.keypoints.size(), columns = all.points.size();
  if (rows == 0 || columns == 0) return {};
  const Likeness likeness(picture, all);
  std::vector<std::uint32_t> best_row(columns, 0);
  std::vector<std::uint16_t> least(columns, kFar);
  for (std::uint32_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column) {
      if (likeness(row, column) >= least[column]) continue;
      least[column] = likeness(row, column);
      best_row[column] = row;
    }
  const auto position = [&](std::size_t column) -> const Eigen::Vector3d& {
    return known.views().points()[all.points[column]].position;
  };
  const double same_place = kSamePlace * known.views().median_depth();
  std::vector<std::pair<double, PictureMatch>> rated;  // by how near the best rival comes
  for (std::uint32_t row = 0; row < rows; ++row) {
    const std::uint16_t* distances = likeness.Row(row);
    const auto column = static_cast<std::size_t>(std::min_element(distances, distances + columns) - distances);
    const int best = distances[column];
    if (best > kMostAlikeBits || best_row[column] != row) continue;
    int second = kFar;  // the best rival's distance
    for (std::size_t i = 0; i < columns; ++i)
      if (i != column && distances[i] < second && (position(i) - position(column)).norm() > same_place)
        second = distances[i];
    const Keypoint& own = picture.keypoints[row];
    const double same_corner = kSameCorner * picture.ScaleOf(own.octave);
    for (std::uint32_t i = 0; i < rows; ++i)
      if (i != row && likeness(i, column) < second &&
          (PlaceOf(picture.keypoints[i]) - PlaceOf(own)).norm() > same_corner)
        second = likeness(i, column);
    if (IsRival(best, second)) continue;
    rated.emplace_back(static_cast<double>(best) / second, PictureMatch{row, all.points[column], best});
  }
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
