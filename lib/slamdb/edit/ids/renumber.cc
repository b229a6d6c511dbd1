// SPDX-License-Identifier: BSD-3-Clause
// 1. What is there of each kind, in the order in which ids are handed out.
// 2. What is only named: entities long gone, and uninitialised memory.
// 3. New ids: what is there first, then what was handed out once, then what never was; the counter stands between the
//    last two, as before.
#include "slamdb/edit/ids/renumber.h"

#include <algorithm>
#include <limits>

#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/ids/detail/references.h"
#include "slamdb/model/index.h"

namespace slamdb {
namespace {

// An entity that is there: its id, and when it was made.
struct Present {
  std::uint64_t id = 0;
  double time = std::numeric_limits<double>::infinity();
};

using PresentByKind = std::array<std::vector<Present>, kIdKinds>;

std::vector<Present>& Of(PresentByKind& present, IdKind kind) { return present[static_cast<std::size_t>(kind)]; }

// The earliest time at which a keyframe of the map sees a point.
double FirstSeen(const Map& map, const IdTable& rows, const MapPoint& point) {
  double time = std::numeric_limits<double>::infinity();
  for (const Observation& observation : point.observations)
    if (const std::uint32_t row = rows.Find(observation.keyframe.value()); row != kNoRow)
      time = std::min(time, map.keyframes[row].timestamp);
  return time;
}

PresentByKind FindPresent(const Atlas& atlas, bool with_times) {
  PresentByKind present;
  for (const Camera& camera : atlas.cameras) Of(present, IdKind::kCamera).push_back({camera.id.value()});
  for (const Map& map : atlas.maps) {
    Present as_map{map.id.value()};
    for (const KeyFrame& keyframe : map.keyframes) {
      Of(present, IdKind::kKeyFrame).push_back({keyframe.id.value(), keyframe.timestamp});
      Of(present, IdKind::kFrame).push_back({keyframe.frame_id, keyframe.timestamp});
      as_map.time = std::min(as_map.time, keyframe.timestamp);
    }
    Of(present, IdKind::kMap).push_back(as_map);
    const IdTable rows = with_times ? KeyFrameTable(map) : IdTable();
    for (const MapPoint& point : map.points)
      Of(present, IdKind::kPoint).push_back({point.id.value(), with_times ? FirstSeen(map, rows, point) : 0});
  }
  for (std::vector<Present>& list : present) std::erase_if(list, [](const Present& each) { return each.id == kNoId; });
  return present;
}

// Look-up of the ids that are there. Several keyframes may be of one frame; any other id may be there once.
IdTable MakeTable(std::vector<Present>& present, IdKind kind) {
  std::uint64_t lowest = kNoId, highest = 0;
  for (const Present& each : present) {
    lowest = std::min(lowest, each.id);
    highest = std::max(highest, each.id);
  }
  IdTable table = present.empty() ? IdTable() : IdTable(lowest, highest, present.size());
  std::vector<Present> once;
  once.reserve(present.size());
  for (const Present& each : present) {
    if (table.Insert(each.id, static_cast<std::uint32_t>(once.size())) == kNoRow)
      once.push_back(each);
    else if (kind != IdKind::kFrame)
      throw Error(
          ErrorKind::kNotPossible,
          std::string(NameOf(kind)) + " id " + std::to_string(each.id) +
              " is there more than once, so a table of ids cannot say which one is meant; `CheckAtlas` lists all");
  }
  present = std::move(once);
  return table;
}

void Sort(std::vector<Present>& present, IdOrder order) {
  if (order == IdOrder::kAsIs) return;
  const auto by_time = order == IdOrder::kTime;
  std::ranges::stable_sort(present, [by_time](const Present& a, const Present& b) {
    if (by_time && a.time != b.time) return a.time < b.time;
    return a.id < b.id;
  });
}

// Hands out new ids of one kind.
class Numbering {
 public:
  Numbering(IdKind kind, const RenumberOptions& options, std::uint64_t limit)
      : kind_(kind), options_(options), limit_(limit) {}

  // `gone` ascends. Returns the pairs by old id, and sets the counter above what was handed out.
  std::vector<IdPair> Run(const std::vector<Present>& present, const std::vector<std::uint64_t>& gone,
                          std::uint64_t& counter) {
    pairs_.reserve(present.size() + gone.size());
    next_ = options_.offset ? 0 : options_.start;
    for (const Present& each : present) HandOut(each.id);
    std::vector<std::uint64_t> late;
    for (const std::uint64_t id : gone) {
      if (id < limit_ && CanMove(id))
        HandOut(id);
      else
        late.push_back(id);
    }
    counter = options_.offset ? std::max(next_, Moved(limit_)) : next_;
    next_ = counter;
    for (const std::uint64_t id : late) Add(id, next_++);
    std::ranges::sort(pairs_, {}, &IdPair::before);
    return std::move(pairs_);
  }

 private:
  bool CanMove(std::uint64_t id) const {
    return !options_.offset || *options_.offset >= 0 || id >= static_cast<std::uint64_t>(-*options_.offset);
  }

  std::uint64_t Moved(std::uint64_t id) const {
    return CanMove(id) ? id + static_cast<std::uint64_t>(*options_.offset) : 0;
  }

  void HandOut(std::uint64_t id) {
    if (!options_.offset) {
      Add(id, next_++);
    } else if (CanMove(id)) {
      Add(id, Moved(id));
      next_ = std::max(next_, Moved(id) + 1);
    } else {
      throw Error(ErrorKind::kNotPossible, "an offset of " + std::to_string(*options_.offset) + " makes the id of " +
                                               std::string(NameOf(kind_)) + " " + std::to_string(id) + " negative");
    }
    if (pairs_.back().after > LargestId(kind_))
      throw Error(ErrorKind::kNotPossible, std::string(NameOf(kind_)) + " " + std::to_string(id) + " would get id " +
                                               std::to_string(pairs_.back().after) + ", expected at most " +
                                               std::to_string(LargestId(kind_)));
  }

  void Add(std::uint64_t before, std::uint64_t after) { pairs_.push_back({before, after}); }

  const IdKind kind_;
  const RenumberOptions& options_;
  const std::uint64_t limit_;  // ids from here on were never handed out
  std::uint64_t next_ = 0;
  std::vector<IdPair> pairs_;
};

}  // namespace

IdMap PlanRenumbering(const Atlas& atlas, const RenumberOptions& options) {
  PresentByKind present = FindPresent(atlas, options.order == IdOrder::kTime);
  std::array<IdTable, kIdKinds> tables;
  std::array<bool, kIdKinds> wanted{};
  for (const IdKind kind : options.kinds) {
    const auto which = static_cast<std::size_t>(kind);
    wanted[which] = true;
    tables[which] = MakeTable(present[which], kind);
  }
  std::array<std::vector<std::uint64_t>, kIdKinds> gone;
  detail::VisitIds(atlas, [&](auto kind, const auto& field) {
    constexpr auto kWhich = static_cast<std::size_t>(decltype(kind)::value);
    const std::uint64_t id = detail::IdValue(field);
    if (wanted[kWhich] && id != kNoId && tables[kWhich].Find(id) == kNoRow) gone[kWhich].push_back(id);
  });

  IdMap ids;
  ids.counters_before = ids.counters_after = atlas.next_ids;
  for (std::size_t which = 0; which < kIdKinds; ++which) {
    if (!wanted[which]) continue;
    const auto kind = static_cast<IdKind>(which);
    std::ranges::sort(gone[which]);
    gone[which].erase(std::unique(gone[which].begin(), gone[which].end()), gone[which].end());
    std::uint64_t limit = NextId(atlas.next_ids, kind);
    for (const Present& each : present[which]) limit = std::max(limit, each.id + 1);
    Sort(present[which], options.order);
    std::uint64_t& counter = NextId(*ids.counters_after, kind);
    ids.kinds[which] = Numbering(kind, options, limit).Run(present[which], gone[which], counter);
  }
  if (wanted[static_cast<std::size_t>(IdKind::kKeyFrame)]) {
    const IdPair* initial = FindPair(ids[IdKind::kKeyFrame], atlas.next_ids.initial_keyframe);
    ids.counters_after->initial_keyframe = initial != nullptr ? initial->after : ids.counters_after->keyframe;
  }
  return ids;
}

IdMap Renumber(Atlas& atlas, const RenumberOptions& options) {
  detail::Steps steps(options.progress, "renumbering", 2);
  IdMap ids = PlanRenumbering(atlas, options);
  steps.Next();
  ApplyIdMap(atlas, ids, options.threads);
  steps.Next();
  return ids;
}

std::vector<IdKind> IdKindsByName(const std::vector<std::string>& names) {
  std::vector<IdKind> kinds;
  for (const std::string& name : names) {
    const auto kind = IdKindByName(name);
    if (!kind && name != "all") throw Error(ErrorKind::kUsage, "no kind of id is called '" + name + "'");
    for (std::size_t each = 0; each < kIdKinds; ++each)
      if (!kind || kind == static_cast<IdKind>(each)) kinds.push_back(static_cast<IdKind>(each));
  }
  return kinds;
}

}  // namespace slamdb
