// SPDX-License-Identifier: BSD-3-Clause
// 1. Entities of the two atlases are paired by content (diff_match.h).
// 2. Each pair is compared field by field, references by where they lead (diff_pair.h); pairs are independent.
// 3. What was found is added up in the order of the atlas before.
#include "slamdb/edit/diff/diff.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/diff/detail/diff_pair.h"
#include "slamdb/model/content.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/umeyama.h"

namespace slamdb {
namespace {

constexpr std::size_t kKeyFramesPerBlock = 8, kPointsPerBlock = 2048;

template <class Diff, class Compare>
std::vector<Diff> CompareEach(std::size_t count, std::size_t grain, int threads, const Compare& compare) {
  std::vector<Diff> diffs(count);
  detail::ParallelFor(count, grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) diffs[n] = compare(static_cast<std::uint32_t>(n));
  });
  return diffs;
}

template <std::size_t kCount, class Diff>
std::vector<AspectCount> CountAspects(const std::array<std::string_view, kCount>& names,
                                      const std::vector<Diff>& pairs) {
  std::vector<AspectCount> counts;
  for (std::size_t aspect = 0; aspect < kCount; ++aspect) {
    const auto count =
        std::ranges::count_if(pairs, [aspect](const detail::PairDiff& pair) { return pair.Has(aspect); });
    if (count > 0) counts.push_back({names[aspect], static_cast<std::uint64_t>(count)});
  }
  return counts;
}

// What the pairing and the comparison of the pairs say about one kind of entity. `name_before` and `name_after` take a
// number.
template <std::size_t kCount, class Diff, class Name>
EntityDiff Summarize(const detail::Pairing& pairing, const std::vector<Diff>& pairs,
                     const std::array<std::string_view, kCount>& aspects, const Name& name_before,
                     const Name& name_after) {
  EntityDiff diff{.before = pairing.before_size(), .after = pairing.after_size()};
  for (std::uint32_t n = 0; n < diff.before; ++n) {
    if (pairing.AfterOf(n) == kNoRow) diff.removed.push_back(name_before(n));
    if (pairs[n].renumbered) ++diff.renumbered;
    if (pairs[n].aspects != 0) ++diff.changed;
  }
  for (std::uint32_t n = 0; n < diff.after; ++n)
    if (pairing.BeforeOf(n) == kNoRow) diff.added.push_back(name_after(n));
  std::ranges::sort(diff.removed);
  std::ranges::sort(diff.added);
  diff.changes = CountAspects(aspects, pairs);
  return diff;
}

Distribution DistributionOf(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  Distribution distribution{.count = values.size()};
  if (values.empty()) return distribution;
  std::ranges::sort(values);
  distribution.mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  distribution.median = values[values.size() / 2];
  distribution.max = values.back();
  return distribution;
}

void AddField(std::vector<FieldDiff>& fields, std::string name, const std::string& before, const std::string& after) {
  if (before != after) fields.push_back({std::move(name), before, after});
}
void AddField(std::vector<FieldDiff>& fields, std::string name, std::uint64_t before, std::uint64_t after) {
  AddField(fields, std::move(name), std::to_string(before), std::to_string(after));
}

std::uint64_t IrregularEntries(const Atlas& atlas) {
  std::size_t entries = atlas.repeated_maps.size() + atlas.repeated_cameras.size();
  for (const Map& map : atlas.maps) entries += map.repeated_keyframes.size() + map.repeated_points.size();
  return entries;
}

std::vector<std::uint64_t> LandmarkHashes(const Atlas& atlas, bool with_ids) {
  std::vector<std::uint64_t> hashes;
  for (const Map& map : atlas.maps)
    for (const Landmark& landmark : map.landmarks)
      hashes.push_back(ContentHash(landmark) + (with_ids ? landmark.id.value() * 3 : 0));
  std::ranges::sort(hashes);
  return hashes;
}

// How many landmarks each atlas has that the other has not. Returns whether there are any.
bool AddLandmarks(std::vector<FieldDiff>& fields, const char* name, bool with_ids, const Atlas& a, const Atlas& b) {
  const std::vector<std::uint64_t> before = LandmarkHashes(a, with_ids), after = LandmarkHashes(b, with_ids);
  std::vector<std::uint64_t> removed, added;
  std::ranges::set_difference(before, after, std::back_inserter(removed));
  std::ranges::set_difference(after, before, std::back_inserter(added));
  if (removed.empty() && added.empty()) return false;
  fields.push_back({name, std::to_string(removed.size()), std::to_string(added.size())});
  return true;
}

// How many references of each kind an entity has.
using LinkTotals = std::array<std::uint64_t, detail::kLinkKinds>;
LinkTotals TotalsOf(const KeyFrame& keyframe) {
  LinkTotals totals{};
  for (const MapPointId point : keyframe.features.map_points) totals[detail::kSlots] += point.has_value() ? 1 : 0;
  totals[detail::kCovisibility] = keyframe.connections.size();
  totals[detail::kParents] = keyframe.parent ? 1 : 0;
  totals[detail::kChildren] = keyframe.children.size();
  totals[detail::kLoops] = keyframe.loop_edges.size();
  totals[detail::kMerges] = keyframe.merge_edges.size();
  totals[detail::kInTime] = (keyframe.previous ? 1U : 0U) + (keyframe.next ? 1U : 0U);
  return totals;
}
LinkTotals TotalsOf(const MapPoint& point) {
  LinkTotals totals{};
  totals[detail::kObservations] = point.observations.size();
  return totals;
}

class Comparison {
 public:
  Comparison(const Atlas& before, const Atlas& after, const DiffOptions& options)
      : before_(before),
        after_(after),
        pairing_(detail::PairEntities(before_, after_, options.threads)),
        comparison_(before_, after_, pairing_, detail::Sameness(options.tolerance)),
        threads_(options.threads) {}

  AtlasDiff Run() {
    const auto keyframe = [this](std::uint32_t n) { return comparison_.CompareKeyFrame(n); };
    const auto point = [this](std::uint32_t n) { return comparison_.ComparePoint(n); };
    keyframes_ =
        CompareEach<detail::KeyFramePairDiff>(before_.keyframes.size(), kKeyFramesPerBlock, threads_, keyframe);
    points_ = CompareEach<detail::PointPairDiff>(before_.points.size(), kPointsPerBlock, threads_, point);
    SummarizeHeads();
    SummarizeEntities();
    CountLinks();
    for (std::uint32_t map = 0; map < before_.atlas().maps.size(); ++map)
      if (pairing_.maps.AfterOf(map) != kNoRow) diff_.motions.push_back(MotionOf(map));
    CompareFields();
    return std::move(diff_);
  }

 private:
  // Maps and cameras.
  void SummarizeHeads() {
    const auto map = [this](std::uint32_t row) { return comparison_.CompareMap(row); };
    const auto camera = [this](std::uint32_t row) { return comparison_.CompareCamera(row); };
    const auto map_name = [](const detail::NumberedAtlas& atlas) {
      return [&maps = atlas.atlas().maps](std::uint32_t row) {
        return EntityName{maps[row].id.value(), maps[row].id.value()};
      };
    };
    const auto camera_name = [](const detail::NumberedAtlas& atlas) {
      return [&cameras = atlas.atlas().cameras](std::uint32_t row) { return EntityName{0, cameras[row].id.value()}; };
    };
    diff_.maps = Summarize(pairing_.maps, CompareEach<detail::PairDiff>(before_.atlas().maps.size(), 1, 1, map),
                           detail::kMapAspectNames, map_name(before_), map_name(after_));
    diff_.cameras =
        Summarize(pairing_.cameras, CompareEach<detail::PairDiff>(before_.atlas().cameras.size(), 1, 1, camera),
                  detail::kCameraAspectNames, camera_name(before_), camera_name(after_));
  }

  void SummarizeEntities() {
    const auto keyframe_name = [](const detail::NumberedAtlas& atlas) {
      return [&atlas](std::uint32_t n) {
        return EntityName{atlas.atlas().maps[atlas.map_of_keyframe[n]].id.value(), atlas.keyframes[n]->id.value()};
      };
    };
    const auto point_name = [](const detail::NumberedAtlas& atlas) {
      return [&atlas](std::uint32_t n) {
        return EntityName{atlas.atlas().maps[atlas.map_of_point[n]].id.value(), atlas.points[n]->id.value()};
      };
    };
    diff_.keyframes = Summarize(pairing_.keyframes, keyframes_, detail::kKeyFrameAspectNames, keyframe_name(before_),
                                keyframe_name(after_));
    diff_.points =
        Summarize(pairing_.points, points_, detail::kPointAspectNames, point_name(before_), point_name(after_));
    diff_.keyframes.changed_map = ChangedMaps(pairing_.keyframes, before_.map_of_keyframe, after_.map_of_keyframe);
    diff_.points.changed_map = ChangedMaps(pairing_.points, before_.map_of_point, after_.map_of_point);
    for (const detail::PairDiff& pair : keyframes_) diff_.other_ids += pair.other_ids ? 1 : 0;
    for (const detail::PairDiff& pair : points_) diff_.other_ids += pair.other_ids ? 1 : 0;
  }

  std::uint64_t ChangedMaps(const detail::Pairing& pairing, const std::vector<std::uint32_t>& map_before,
                            const std::vector<std::uint32_t>& map_after) const {
    std::uint64_t changed = 0;
    for (std::uint32_t n = 0; n < map_before.size(); ++n) {
      const std::uint32_t partner = pairing.AfterOf(n);
      if (partner != kNoRow && pairing_.maps.AfterOf(map_before[n]) != map_after[partner]) ++changed;
    }
    return changed;
  }

  void CountLinks() {
    for (const std::string_view name : detail::kLinkNames) diff_.links.push_back({.kind = name});
    const auto add = [this](std::size_t kind, const detail::LinkCounts& counts) {
      diff_.links[kind].removed += counts.removed;
      diff_.links[kind].added += counts.added;
      diff_.links[kind].changed += counts.changed;
    };
    for (const detail::KeyFramePairDiff& pair : keyframes_)
      for (std::size_t kind = 0; kind < detail::kLinkKinds; ++kind) add(kind, pair.links[kind]);
    for (const detail::PointPairDiff& pair : points_) add(detail::kObservations, pair.observations);
    CountBefore(before_.keyframes, pairing_.keyframes);
    CountBefore(before_.points, pairing_.points);
    CountAfter(after_.keyframes, pairing_.keyframes);
    CountAfter(after_.points, pairing_.points);
  }

  // What an entity without partner refers to went, or came, with it.
  template <class Entity>
  void CountBefore(const std::vector<const Entity*>& entities, const detail::Pairing& pairing) {
    for (std::uint32_t n = 0; n < entities.size(); ++n) {
      const LinkTotals totals = TotalsOf(*entities[n]);
      for (std::size_t kind = 0; kind < detail::kLinkKinds; ++kind) {
        diff_.links[kind].before += totals[kind];
        if (pairing.AfterOf(n) == kNoRow) diff_.links[kind].removed += totals[kind];
      }
    }
  }
  template <class Entity>
  void CountAfter(const std::vector<const Entity*>& entities, const detail::Pairing& pairing) {
    for (std::uint32_t n = 0; n < entities.size(); ++n) {
      const LinkTotals totals = TotalsOf(*entities[n]);
      for (std::size_t kind = 0; kind < detail::kLinkKinds; ++kind) {
        diff_.links[kind].after += totals[kind];
        if (pairing.BeforeOf(n) == kNoRow) diff_.links[kind].added += totals[kind];
      }
    }
  }

  // Places before and after, of all that is in both and finite.
  struct Places {
    std::vector<Eigen::Vector3d> before, after;
    void Add(const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
      if (!from.allFinite() || !to.allFinite()) return;
      before.push_back(from.cast<double>());
      after.push_back(to.cast<double>());
    }
  };

  MapMotion MotionOf(std::uint32_t map) const {
    MapMotion motion{.before = before_.atlas().maps[map].id,
                     .after = after_.atlas().maps[pairing_.maps.AfterOf(map)].id};
    MoveKeyFrames(map, motion);
    MovePoints(map, motion);
    if (motion.moved()) FitWhole(PlacesOf(map), motion);
    return motion;
  }

  Places PlacesOf(std::uint32_t map) const {
    Places places;
    for (std::uint32_t n = before_.FirstKeyFrame(map); n < before_.FirstKeyFrame(map + 1); ++n)
      if (const std::uint32_t partner = pairing_.keyframes.AfterOf(n); partner != kNoRow)
        places.Add(CameraCenter(*before_.keyframes[n]), CameraCenter(*after_.keyframes[partner]));
    for (std::uint32_t n = before_.FirstPoint(map); n < before_.FirstPoint(map + 1); ++n)
      if (const std::uint32_t partner = pairing_.points.AfterOf(n); partner != kNoRow)
        places.Add(before_.points[n]->position, after_.points[partner]->position);
    return places;
  }

  void MoveKeyFrames(std::uint32_t map, MapMotion& motion) const {
    std::vector<double> distances, degrees;
    for (std::uint32_t n = before_.FirstKeyFrame(map); n < before_.FirstKeyFrame(map + 1); ++n) {
      if (!keyframes_[n].Has(detail::kPose)) continue;  // or it has no partner
      distances.push_back(keyframes_[n].distance);
      degrees.push_back(keyframes_[n].degrees);
    }
    motion.keyframes = distances.size();
    motion.keyframe_distance = DistributionOf(std::move(distances));
    motion.keyframe_degrees = DistributionOf(std::move(degrees));
  }

  void MovePoints(std::uint32_t map, MapMotion& motion) const {
    std::vector<double> distances;
    for (std::uint32_t n = before_.FirstPoint(map); n < before_.FirstPoint(map + 1); ++n)
      if (points_[n].Has(detail::kPosition)) distances.push_back(points_[n].distance);
    motion.points = distances.size();
    motion.point_distance = DistributionOf(std::move(distances));
  }

  static void FitWhole(const Places& places, MapMotion& motion) {
    try {
      UmeyamaResult fit = SolveUmeyama(places.before, places.after, {});
      motion.after_from_before = fit.target_from_source;
      motion.rest = DistributionOf(std::move(fit.residuals));
    } catch (const Error&) {
      // Too little is in both atlases to say how the whole moved; the distances of the parts are told anyway.
    }
  }

  void CompareFields() {
    const Atlas &a = before_.atlas(), &b = after_.atlas();
    AddField(diff_.fields, "vocabulary", a.vocabulary.name, b.vocabulary.name);
    AddField(diff_.fields, "vocabulary checksum", a.vocabulary.checksum, b.vocabulary.checksum);
    AddField(diff_.fields, "layout", a.layout, b.layout);
    if (a.carried != b.carried) AddField(diff_.fields, "members of a fork", "some", "others");
    AddField(diff_.fields, "null or repeated entries", IrregularEntries(a), IrregularEntries(b));
    if (!AddLandmarks(diff_.fields, "landmarks that the other has not", false, a, b))
      AddLandmarks(diff_.numbering, "landmarks of other ids", true, a, b);
    const Counters &before = a.next_ids, &after = b.next_ids;
    AddField(diff_.numbering, "next map id", before.map, after.map);
    AddField(diff_.numbering, "next frame id", before.frame, after.frame);
    AddField(diff_.numbering, "next keyframe id", before.keyframe, after.keyframe);
    AddField(diff_.numbering, "next point id", before.map_point, after.map_point);
    AddField(diff_.numbering, "next camera id", before.camera, after.camera);
    AddField(diff_.numbering, "next initial keyframe id", before.initial_keyframe, after.initial_keyframe);
    for (std::uint32_t map = 0; map < a.maps.size(); ++map)
      if (const std::uint32_t partner = pairing_.maps.AfterOf(map); partner != kNoRow)
        AddField(diff_.numbering, "largest keyframe id of " + ToString(a.maps[map].id), a.maps[map].max_keyframe_id,
                 b.maps[partner].max_keyframe_id);
    const auto archive = [](const Atlas& atlas) { return std::string(atlas.encoding.text ? "text" : "binary"); };
    AddField(diff_.encoding, "archive", archive(a), archive(b));
    AddField(diff_.encoding, "boost version", a.encoding.boost_version, b.encoding.boost_version);
    AddField(diff_.encoding, "bytes of a long", a.encoding.long_bytes, b.encoding.long_bytes);
    AddField(diff_.encoding, "bytes of a size", a.encoding.size_bytes, b.encoding.size_bytes);
  }

  const detail::NumberedAtlas before_, after_;
  const detail::AtlasPairing pairing_;
  const detail::PairComparison comparison_;
  const int threads_;
  std::vector<detail::KeyFramePairDiff> keyframes_;  // by number in the atlas before; empty without partner
  std::vector<detail::PointPairDiff> points_;
  AtlasDiff diff_;
};

}  // namespace

AtlasDiff::Verdict AtlasDiff::verdict() const {
  const std::array<const EntityDiff*, 4> kinds = {&maps, &cameras, &keyframes, &points};
  const bool same_entities = std::ranges::all_of(kinds, [](const EntityDiff* kind) {
    return kind->removed.empty() && kind->added.empty() && kind->changed_map == 0 && kind->changed == 0;
  });
  if (!same_entities || !fields.empty() || !std::ranges::all_of(links, &LinkDiff::same)) return Verdict::kDifferent;
  const bool renumbered = other_ids > 0 || !numbering.empty() ||
                          std::ranges::any_of(kinds, [](const EntityDiff* kind) { return kind->renumbered > 0; });
  return renumbered ? Verdict::kRenumbered : Verdict::kSame;
}

AtlasDiff DiffAtlases(const Atlas& before, const Atlas& after, const DiffOptions& options) {
  AtlasDiff diff = Comparison(before, after, options).Run();
  detail::Steps(options.progress, "comparing", 1).Next();
  return diff;
}

}  // namespace slamdb
