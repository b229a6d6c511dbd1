// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/ids/id_map.h"

#include <algorithm>

#include "slamdb/base/error.h"
#include "slamdb/edit/ids/detail/references.h"
#include "slamdb/model/index.h"

namespace slamdb {
namespace {

constexpr std::array<std::string_view, kIdKinds> kNames = {"map", "keyframe", "point", "frame", "camera"};

std::string Named(IdKind kind, std::uint64_t id) { return std::string(NameOf(kind)) + " " + std::to_string(id); }

// Fields of 32 bits.
constexpr std::uint64_t kLargestNarrow = 0xffffffff;
bool IsNarrow(IdKind kind) { return kind == IdKind::kMap || kind == IdKind::kCamera; }

// Look-up of one side of the pairs of a kind.
IdTable TableOf(const std::vector<IdPair>& pairs, std::uint64_t IdPair::*side, IdKind kind, const char* which) {
  std::uint64_t lowest = kNoId, highest = 0;
  for (const IdPair& pair : pairs) {
    if (pair.*side == kNoId)
      throw Error(ErrorKind::kNotPossible, "the id map has no " + std::string(which) + " id for " +
                                               Named(kind, side == &IdPair::after ? pair.before : pair.after) +
                                               ", so it cannot be applied; it is of a merge that left something out");
    lowest = std::min(lowest, pair.*side);
    highest = std::max(highest, pair.*side);
  }
  IdTable table = pairs.empty() ? IdTable() : IdTable(lowest, highest, pairs.size());
  for (std::uint32_t row = 0; row < pairs.size(); ++row)
    if (table.Insert(pairs[row].*side, row) != kNoRow)
      throw Error(ErrorKind::kUsage, "the id map names " + std::string(which) + " " + Named(kind, pairs[row].*side) +
                                         " twice; two entities cannot share an id");
  return table;
}

// An IdMap made ready for look-up, and held against an atlas.
class Translator {
 public:
  explicit Translator(const IdMap& ids) : ids_(ids) {
    for (std::size_t kind = 0; kind < kIdKinds; ++kind) {
      const auto as_kind = static_cast<IdKind>(kind);
      before_[kind] = TableOf(ids.kinds[kind], &IdPair::before, as_kind, "old");
      after_[kind] = TableOf(ids.kinds[kind], &IdPair::after, as_kind, "new");
      for (const IdPair& pair : ids.kinds[kind])
        if (IsNarrow(as_kind) && pair.after != kNoId && pair.after > LargestId(as_kind))
          throw Error(ErrorKind::kUsage, "the id map makes " + Named(as_kind, pair.before) + " " +
                                             std::to_string(pair.after) + ", expected at most " +
                                             std::to_string(LargestId(as_kind)));
    }
  }

  std::uint64_t operator()(IdKind kind, std::uint64_t id) const {
    const auto which = static_cast<std::size_t>(kind);
    const std::uint32_t row = before_[which].Find(id);
    return row == kNoRow ? id : ids_.kinds[which][row].after;
  }

  bool Maps(IdKind kind) const { return !ids_[kind].empty(); }
  bool Knows(IdKind kind, std::uint64_t id) const { return before_[static_cast<std::size_t>(kind)].Find(id) != kNoRow; }
  bool HandsOut(IdKind kind, std::uint64_t id) const {
    return after_[static_cast<std::size_t>(kind)].Find(id) != kNoRow;
  }

 private:
  const IdMap& ids_;
  std::array<IdTable, kIdKinds> before_, after_;
};

void RequireKnown(const Translator& translator, IdKind kind, std::uint64_t id) {
  if (id != kNoId && translator.Maps(kind) && !translator.Knows(kind, id))
    throw Error(ErrorKind::kNotPossible,
                "the id map does not name " + Named(kind, id) + ", which the atlas has; it is of another atlas");
}

// Everything in the atlas has a new id, and nothing that has none is named by one that is taken.
void RequireFits(const Atlas& atlas, const Translator& translator) {
  for (const Camera& camera : atlas.cameras) RequireKnown(translator, IdKind::kCamera, camera.id.value());
  for (const Map& map : atlas.maps) {
    RequireKnown(translator, IdKind::kMap, map.id.value());
    for (const KeyFrame& keyframe : map.keyframes) {
      RequireKnown(translator, IdKind::kKeyFrame, keyframe.id.value());
      RequireKnown(translator, IdKind::kFrame, keyframe.frame_id);
    }
    for (const MapPoint& point : map.points) RequireKnown(translator, IdKind::kPoint, point.id.value());
  }
  detail::VisitIds(atlas, [&](auto kind, const auto& field) {
    const std::uint64_t id = detail::IdValue(field);
    if (id == kNoId || translator.Knows(kind, id) || !translator.HandsOut(kind, id)) return;
    throw Error(ErrorKind::kNotPossible,
                "the atlas names " + Named(kind, id) + ", which it does not have and the id map gives to another");
  });
}

// A counter that is what the map says it was becomes what the map says; any other only rises above what is handed out.
void SetCounters(Atlas& atlas, const IdMap& ids) {
  for (const CounterField& counter : CounterFields()) {
    std::uint64_t& next = atlas.next_ids.*counter.field;
    if (ids.counters_before && ids.counters_after && next == (*ids.counters_before).*counter.field) {
      next = (*ids.counters_after).*counter.field;
    } else if (counter.field != &Counters::initial_keyframe) {
      for (const IdPair& pair : ids[counter.kind]) next = std::max(next, pair.after + 1);
    }
  }
}

}  // namespace

std::string_view NameOf(IdKind kind) { return kNames[static_cast<std::size_t>(kind)]; }

std::span<const CounterField> CounterFields() {
  static constexpr CounterField kFields[] = {
      {IdKind::kMap, "next_map", &Counters::map},
      {IdKind::kKeyFrame, "next_keyframe", &Counters::keyframe},
      {IdKind::kPoint, "next_point", &Counters::map_point},
      {IdKind::kFrame, "next_frame", &Counters::frame},
      {IdKind::kCamera, "next_camera", &Counters::camera},
      {IdKind::kKeyFrame, "next_initial_keyframe", &Counters::initial_keyframe},
  };
  return kFields;
}

std::uint64_t& NextId(Counters& counters, IdKind kind) {
  return counters.*std::ranges::find(CounterFields(), kind, &CounterField::kind)->field;
}

std::uint64_t NextId(const Counters& counters, IdKind kind) {
  return counters.*std::ranges::find(CounterFields(), kind, &CounterField::kind)->field;
}

const IdPair* FindPair(const std::vector<IdPair>& pairs, std::uint64_t before) {
  const auto found = std::ranges::lower_bound(pairs, before, {}, &IdPair::before);
  return found == pairs.end() || found->before != before ? nullptr : &*found;
}

std::optional<IdKind> IdKindByName(std::string_view name) {
  const auto found = std::ranges::find(kNames, name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<IdKind>(found - kNames.begin());
}

std::uint64_t LargestId(IdKind kind) {
  constexpr std::uint64_t kOne = 1;
  switch (kind) {
    case IdKind::kMap:
    case IdKind::kCamera:
      return kLargestNarrow - 1;  // the last is none
    case IdKind::kKeyFrame:
      return (kOne << 31) - 1;  // vertices of ORB-SLAM3's optimisers
    case IdKind::kPoint:
    case IdKind::kFrame:
      break;
  }
  return (kOne << 63) - 1;  // signed in some fields
}

IdMap Inverse(const IdMap& ids) {
  IdMap inverse{ids.input, ids.kinds, ids.counters_after, ids.counters_before};
  for (std::size_t kind = 0; kind < kIdKinds; ++kind) {
    for (IdPair& pair : inverse.kinds[kind]) {
      if (pair.after == kNoId)
        throw Error(
            ErrorKind::kNotPossible,
            "the id map cannot be undone: " + Named(static_cast<IdKind>(kind), pair.before) + " is not in its result");
      std::swap(pair.before, pair.after);
    }
    std::ranges::sort(inverse.kinds[kind], {}, &IdPair::before);
  }
  return inverse;
}

void ApplyIdMap(Atlas& atlas, const IdMap& ids, int threads) {
  const Translator translator(ids);
  RequireFits(atlas, translator);
  detail::TranslateAtlas(atlas, translator, threads);
  SetCounters(atlas, ids);
}

}  // namespace slamdb
