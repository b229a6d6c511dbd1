// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/detail/branch_proof.h"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/merge/detail/branch_view.h"

namespace slamdb::detail {
namespace {

[[noreturn]] void Fail(const std::string& what) {
  throw Error(
      ErrorKind::kInternal,
      what + " is neither in the merged atlas nor named as deleted; this is a fault of slamdb, nothing was written");
}

// Which of the inputs, and the result, have a key.
struct Presence {
  bool base = false, ours = false, theirs = false, result = false;
};

// Walks four lists that ascend by their keys at once: visit(presence, elements), null where a list lacks the key.
template <class Element, class Key, class Visit>
void Walk(const std::vector<Element>& base, const std::vector<Element>& ours, const std::vector<Element>& theirs,
          const std::vector<Element>& result, const Key& key, const Visit& visit) {
  const std::vector<Element>* lists[] = {&base, &ours, &theirs, &result};
  std::size_t at[4] = {};
  for (;;) {
    const Element* least = nullptr;
    for (std::size_t i = 0; i < 4; ++i)
      if (at[i] < lists[i]->size() && (least == nullptr || key((*lists[i])[at[i]]) < key(*least)))
        least = &(*lists[i])[at[i]];
    if (least == nullptr) return;
    const Element* found[4] = {};
    for (std::size_t i = 0; i < 4; ++i)
      if (at[i] < lists[i]->size() && key((*lists[i])[at[i]]) == key(*least)) found[i] = &(*lists[i])[at[i]];
    for (std::size_t i = 0; i < 4; ++i) at[i] += found[i] != nullptr;
    visit(Presence{found[0] != nullptr, found[1] != nullptr, found[2] != nullptr, found[3] != nullptr}, found);
  }
}

// Counts a key in the ledger. Returns whether something that nobody deleted is not there.
bool Count(const Presence& in, BranchLedger& ledger) {
  ledger.base += in.base;
  ledger.ours += in.ours;
  ledger.theirs += in.theirs;
  ledger.result += in.result;
  const bool deleted = in.base && !(in.ours && in.theirs);
  if (!in.base && in.ours && in.theirs)
    ++ledger.added_by_both;
  else if (!in.base && in.ours)
    ++ledger.added_by_ours;
  else if (!in.base && in.theirs)
    ++ledger.added_by_theirs;
  if (in.result) {
    ledger.kept += deleted;
    return false;
  }
  if (!deleted) return true;
  ++(in.ours ? ledger.deleted_by_theirs : in.theirs ? ledger.deleted_by_ours : ledger.deleted_by_both);
  return false;
}

std::pair<std::uint64_t, std::uint64_t> PlaceOf(const Inventory::Sighting& each) {
  return {each.keyframe, each.keypoint};
}

class Prover {
 public:
  Prover(const Inventory& base, const Inventory& ours, const Inventory& theirs, const Inventory& result,
         std::uint64_t cleared, ThreeWayReport& report)
      : base_(base), ours_(ours), theirs_(theirs), result_(result), cleared_(cleared), report_(report) {
    for (const auto& [gone, survivor] : report.fused) survivors_.emplace(gone.value(), survivor.value());
    for (const auto& [id, features] : result.keyframes) keyframes_.insert(id);
    points_.insert(result.points.begin(), result.points.end());
  }

  void Run() {
    KeyFrames();
    Points();
    Sightings();
    Edges();
    const std::pair<std::string_view, const BranchLedger*> ledgers[] = {{"a keyframe", &report_.keyframes},
                                                                        {"a point", &report_.points},
                                                                        {"an observation", &report_.observations},
                                                                        {"a loop or merge edge", &report_.edges}};
    for (const auto& [what, ledger] : ledgers)
      if (!ledger->AddsUp()) Fail(std::string(what));
  }

 private:
  std::uint64_t SurvivorOf(std::uint64_t point) const {
    for (std::size_t steps = 0; steps <= survivors_.size(); ++steps) {
      const auto found = survivors_.find(point);
      if (found == survivors_.end() || points_.contains(point)) return point;
      point = found->second;
    }
    return point;
  }

  void KeyFrames() {
    using Element = std::pair<std::uint64_t, std::uint64_t>;
    Walk(
        base_.keyframes, ours_.keyframes, theirs_.keyframes, result_.keyframes,
        [](const Element& each) { return each.first; },
        [&](const Presence& in, const Element* const* found) {
          const Element* of = found[1] ? found[1] : found[2] ? found[2] : found[0];
          if (of == nullptr) of = found[3];
          if (Count(in, report_.keyframes) || (found[3] && of->second != found[3]->second) || of == found[3])
            Fail(ToString(KeyFrameId(of->first)) + " with its features");
        });
  }

  void Points() {
    Walk(
        base_.points, ours_.points, theirs_.points, result_.points, [](std::uint64_t id) { return id; },
        [&](const Presence& in, const std::uint64_t* const* found) {
          if (!in.base && !in.ours && !in.theirs) Fail(ToString(MapPointId(*found[3])) + " of the result");
          if (!Count(in, report_.points)) return;
          const std::uint64_t id = found[1] ? *found[1] : *found[2];
          if (SurvivorOf(id) != id && points_.contains(SurvivorOf(id))) {
            ++report_.points.fused;
          } else {
            ++report_.points.dropped;
            report_.dropped_points.emplace_back(id);
          }
        });
  }

  void Sightings() {
    using Sighting = Inventory::Sighting;
    for (const Sighting& each : result_.sightings) pairs_.insert(KeyOf(each.keyframe, each.point));
    Walk(base_.sightings, ours_.sightings, theirs_.sightings, result_.sightings, PlaceOf,
         [&](const Presence& in, const Sighting* const* found) { Weigh(in, found); });
    if (emptied_ > cleared_) Fail("an observation");
  }

  static std::uint64_t KeyOf(std::uint64_t keyframe, std::uint64_t point) {
    return keyframe * 0x9E3779B97F4A7C15U + point;
  }

  void Weigh(Presence in, const Inventory::Sighting* const* found) {
    if (found[3] != nullptr && !IsKnown(found)) FindClaim(*found[3], in);
    if (!Count(in, report_.observations)) return;
    const Inventory::Sighting& lost = found[1] ? *found[1] : *found[2];
    const std::uint64_t point = SurvivorOf(lost.point);
    if (keyframes_.contains(lost.keyframe) && points_.contains(point)) {
      if (pairs_.contains(KeyOf(lost.keyframe, point))) {
        ++report_.observations.fused;
      } else {
        ++report_.observations.dropped;
        ++emptied_;
      }
    } else {
      ++report_.observations.dropped;  // with the keyframe or the point, which are accounted for
    }
  }

  // A keypoint sees in the result what one of the inputs says that it sees.
  bool IsKnown(const Inventory::Sighting* const* found) const {
    for (int input = 0; input < 3; ++input)
      if (found[input] != nullptr && SurvivorOf(found[input]->point) == found[3]->point) return true;
    return false;
  }

  // Or what a point of an input says that sees it, which fusing makes the keypoint say, too.
  void FindClaim(const Inventory::Sighting& seen, Presence& in) const {
    const std::pair<const Inventory*, bool*> inputs[] = {
        {&base_, &in.base}, {&ours_, &in.ours}, {&theirs_, &in.theirs}};
    bool is_known = false;
    for (const auto& [input, has] : inputs)
      if (Claims(*input, seen)) is_known = *has = true;
    if (!is_known) Fail(Concat("what keypoint ", seen.keypoint, " of ", KeyFrameId(seen.keyframe), " sees"));
  }

  bool Claims(const Inventory& input, const Inventory::Sighting& seen) const {
    auto claim = std::ranges::lower_bound(input.claims, PlaceOf(seen), {}, PlaceOf);
    for (; claim != input.claims.end() && PlaceOf(*claim) == PlaceOf(seen); ++claim)
      if (SurvivorOf(claim->point) == seen.point) return true;
    return false;
  }

  void Edges() {
    using Edge = Inventory::Edge;
    Walk(
        base_.edges, ours_.edges, theirs_.edges, result_.edges, [](const Edge& each) { return each; },
        [&](const Presence& in, const Edge* const* found) {
          if (!Count(in, report_.edges)) return;
          const Edge& edge = found[1] ? *found[1] : *found[2];
          if (keyframes_.contains(edge.first) && keyframes_.contains(edge.second))
            Fail(Concat("the edge of ", KeyFrameId(edge.first), " and ", KeyFrameId(edge.second)));
          ++report_.edges.dropped;
        });
  }

  const Inventory &base_, &ours_, &theirs_, &result_;
  const std::uint64_t cleared_;
  std::uint64_t emptied_ = 0;
  ThreeWayReport& report_;
  std::unordered_map<std::uint64_t, std::uint64_t> survivors_;
  std::unordered_set<std::uint64_t> keyframes_, points_, pairs_;
};

}  // namespace

Inventory::Inventory(const Atlas& atlas) {
  for (const Map& map : atlas.maps) {
    for (const KeyFrame& keyframe : map.keyframes) {
      const std::uint64_t id = keyframe.id.value();
      const Features& features = keyframe.features;
      keyframes.emplace_back(id,
                             features.keypoints.size() + features.right_keypoints.size() + keyframe.descriptor_count());
      for (std::size_t slot = 0; slot < features.map_points.size(); ++slot)
        if (features.map_points[slot]) sightings.push_back({id, slot, features.map_points[slot].value()});
      for (const auto* list : {&keyframe.loop_edges, &keyframe.merge_edges})
        for (const KeyFrameId other : *list) {
          const std::uint64_t to = other.value();
          edges.push_back({std::min(id, to), std::max(id, to), list == &keyframe.merge_edges});
        }
    }
    for (const MapPoint& point : map.points) points.push_back(point.id.value());
    AddClaims(map);
  }
  std::ranges::sort(keyframes);
  std::ranges::sort(points);
  std::ranges::sort(sightings, {}, PlaceOf);
  std::ranges::sort(claims, {}, PlaceOf);
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
}

void Inventory::AddClaims(const Map& map) {
  const IdTable rows = KeyFrameTable(map);
  for (const MapPoint& point : map.points)
    for (const Observation& observation : point.observations) {
      const std::uint32_t row = rows.Find(observation.keyframe.value());
      if (row == kNoRow) continue;
      for (const std::int32_t keypoint : {observation.left, observation.right})
        if (keypoint >= 0 && !Sightings::Sees(map.keyframes[row], keypoint, point.id))
          claims.push_back({observation.keyframe.value(), static_cast<std::uint64_t>(keypoint), point.id.value()});
    }
}

void Prove(const Inventory& base, const Inventory& ours, const Inventory& theirs, const Inventory& result,
           std::uint64_t cleared, ThreeWayReport& report) {
  Prover(base, ours, theirs, result, cleared, report).Run();
}

}  // namespace slamdb::detail
