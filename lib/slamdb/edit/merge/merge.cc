// SPDX-License-Identifier: BSD-3-Clause
// 1. The vocabularies must agree.
// 2. Maps that came before are recognised by their content.
// 3. For each later input: the range of its ids of each kind, the shift that takes it out of the way, its cameras.
// 4. The shift goes over all ids, the maps move into the result.
// 5. Everything is counted again.
// 6. Two maps are joined, if asked.
#include "slamdb/edit/merge/merge.h"

#include <algorithm>
#include <mutex>
#include <set>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/ids/detail/references.h"
#include "slamdb/edit/merge/detail/mixture.h"
#include "slamdb/edit/merge/detail/same_camera.h"
#include "slamdb/model/counters.h"
#include "slamdb/model/detail/carried_members.h"
#include "slamdb/model/detail/irregular_entries.h"

namespace slamdb {
namespace {

template <class Value>
using ByKind = std::array<Value, kIdKinds>;

constexpr std::size_t Row(IdKind kind) { return static_cast<std::size_t>(kind); }

// ---- ids

struct IdRange {
  std::uint64_t lowest = kNoId, highest = 0;  // inclusive; empty when lowest > highest

  void Add(std::uint64_t id) {
    lowest = std::min(lowest, id);
    highest = std::max(highest, id);
  }
  void Add(const IdRange& other) {
    lowest = std::min(lowest, other.lowest);
    highest = std::max(highest, other.highest);
  }
  bool empty() const { return lowest > highest; }
  bool Meets(const IdRange& other) const { return lowest <= other.highest && other.lowest <= highest; }
};

// The ids that an atlas names, of entities that are there or were once: those below its counters. Anything else is
// uninitialised memory.
ByKind<IdRange> FindRanges(const Atlas& atlas, int threads) {
  ByKind<std::uint64_t> limits;
  for (std::size_t kind = 0; kind < kIdKinds; ++kind) limits[kind] = NextId(atlas.next_ids, static_cast<IdKind>(kind));
  ByKind<IdRange> ranges;
  std::mutex mutex;
  const auto scan = [&](const auto& list, std::size_t grain) {
    detail::ParallelFor(list.size(), grain, threads, [&](std::size_t begin, std::size_t end) {
      ByKind<IdRange> found;
      for (std::size_t row = begin; row < end; ++row)
        detail::VisitIds(list[row], [&](auto kind, const auto& field) {
          constexpr std::size_t kKind = Row(decltype(kind)::value);
          const std::uint64_t id = detail::IdValue(field);
          if (id < limits[kKind]) found[kKind].Add(id);
        });
      const std::lock_guard lock(mutex);
      for (std::size_t kind = 0; kind < kIdKinds; ++kind) ranges[kind].Add(found[kind]);
    });
  };
  scan(atlas.cameras, 1024);
  scan(atlas.maps, 1024);
  for (const Map& map : atlas.maps) {
    scan(map.keyframes, 16);
    scan(map.points, 4096);
  }
  return ranges;
}

// translate(kind, id) for TranslateAtlas: ids that were handed out move by the shift of their kind, cameras by a table.
struct Shift {
  ByKind<std::uint64_t> limits{}, offsets{};
  std::vector<IdPair> cameras;

  bool empty() const {
    return std::ranges::all_of(offsets, [](std::uint64_t offset) { return offset == 0; }) &&
           std::ranges::all_of(cameras, [](const IdPair& pair) { return pair.before == pair.after; });
  }

  template <IdKind kind>
  std::uint64_t operator()(detail::IdKindConstant<kind>, std::uint64_t id) const {
    if constexpr (kind == IdKind::kCamera) {
      const auto found = std::ranges::find(cameras, id, &IdPair::before);
      if (found != cameras.end()) return found->after;
    }
    return id < limits[Row(kind)] ? id + offsets[Row(kind)] : id;
  }
};

// ---- the merge

class Merger {
 public:
  explicit Merger(const MergeOptions& options) : options_(options) {}

  MergeResult Run(std::vector<Atlas> inputs) {
    if (inputs.empty()) throw Error(ErrorKind::kUsage, "there is nothing to merge");
    CompareVocabularies(inputs);
    ChooseLayout(inputs);
    for (const Atlas& input : inputs) CountInput(input);
    FindSameMaps(inputs);
    std::optional<JoinOptions> join = options_.join;
    if (join) ChooseMaps(inputs, *join);
    detail::Steps steps(options_.progress, "merging", inputs.size());
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      Append(i, inputs[i]);
      steps.Next();
    }
    Verify();
    if (join)
      Join(*join, inputs.size());
    else
      CompareMaps();
    return std::move(result_);
  }

 private:
  std::string NameOfInput(std::size_t i) const {
    return i < options_.names.size() ? options_.names[i] : "input " + std::to_string(i + 1);
  }

  // Landmarks have no bags of words, so atlases of landmarks alone have no vocabulary.
  static bool HasVocabulary(const Atlas& input) {
    return !input.vocabulary.checksum.empty() ||
           std::ranges::any_of(input.maps, [](const Map& map) { return !map.keyframes.empty(); });
  }

  void CompareVocabularies(const std::vector<Atlas>& inputs) {
    const auto first_with = std::ranges::find_if(inputs, HasVocabulary);
    if (first_with == inputs.end()) return;
    vocabulary_input_ = static_cast<std::size_t>(first_with - inputs.begin());
    const Vocabulary& first = first_with->vocabulary;
    for (std::size_t i = vocabulary_input_ + 1; i < inputs.size(); ++i) {
      const Vocabulary& other = inputs[i].vocabulary;
      if (other.checksum == first.checksum || !HasVocabulary(inputs[i])) continue;
      if (!options_.ignore_vocabulary && !options_.force)
        throw Error(
            ErrorKind::kNotPossible,
            NameOfInput(i) + ": its bags of words are of vocabulary '" + other.name + "' (MD5 " + other.checksum +
                "), those of " + NameOfInput(vocabulary_input_) + " of '" + first.name + "' (" + first.checksum +
                "): place recognition would compare words that mean different things; recompute the bags of words "
                "of one; MergeOptions::force merges all the same");
      report().other_vocabularies.push_back(NameOfInput(i));
    }
  }

  // Members of a fork mean something in their own layout only: of several layouts the first that is needed stays.
  void ChooseLayout(std::vector<Atlas>& inputs) {
    const auto has_members = [](const Atlas& input) {
      bool has = false;
      detail::ForEachCarried(input, [&](const Boxed<Carried>& carried) { has = has || detail::HasMembers(carried); });
      return has;
    };
    const auto first_with = std::ranges::find_if(inputs, has_members);
    Atlas& first = first_with == inputs.end() ? inputs.front() : *first_with;
    result_.atlas.layout = first.layout;
    result_.atlas.carried = std::move(first.carried);
    first.carried.Reset();
    for (Atlas& input : inputs) {
      const bool same = input.layout == result_.atlas.layout;
      const std::uint64_t before = report().dropped_members;
      detail::ForEachCarried(input, [&](Boxed<Carried>& carried) {
        if (!same || &carried == &input.carried) report().dropped_members += detail::DropMembers(carried);
      });
      if (!same && report().dropped_members > before)
        report().other_layouts.push_back(NameOfInput(static_cast<std::size_t>(&input - inputs.data())));
    }
  }

  void CountInput(const Atlas& input) {
    report().inputs.push_back(
        {.name = NameOfInput(report().inputs.size()), .counts = CountContent(input, options_.threads)});
  }

  struct KnownMap {
    std::size_t input, row;
    ContentSignature signature;
    bool left_out = false;
  };

  void FindSameMaps(const std::vector<Atlas>& inputs) {
    for (std::size_t input = 0; input < inputs.size(); ++input)
      for (std::size_t row = 0; row < inputs[input].maps.size(); ++row) {
        const Map& map = inputs[input].maps[row];
        KnownMap known{input, row, SignatureOf(map)};
        if (const KnownMap* first = map.keyframes.empty() && map.landmarks.empty() ? nullptr : FindSame(inputs, known);
            first != nullptr) {
          known.left_out = options_.same_map == SameMap::kKeepFirst;
          const MapId first_id = inputs[first->input].maps[first->row].id;
          if (options_.same_map == SameMap::kError)
            throw Error(ErrorKind::kNotPossible, NameOfInput(input) + ": its " + ToString(map.id) + " is " +
                                                     ToString(first_id) + " of " + NameOfInput(first->input) +
                                                     " again: the same images and points");
          report().same_maps.push_back({input, first->input, map.id, first_id, known.left_out});
        }
        maps_.push_back(known);
      }
  }

  const KnownMap* FindSame(const std::vector<Atlas>& inputs, const KnownMap& sought) const {
    const auto map_of = [&](const KnownMap& known) -> const Map& { return inputs[known.input].maps[known.row]; };
    std::optional<std::uint64_t> hash;
    for (const KnownMap& known : maps_) {
      if (known.input == sought.input || known.left_out || known.signature != sought.signature) continue;
      if (!hash) hash = ContentHash(map_of(sought), options_.threads);
      if (ContentHash(map_of(known), options_.threads) == *hash) return &known;
    }
    return nullptr;
  }

  void Append(std::size_t i, Atlas& input) {
    report().dropped_list_entries += detail::DropIrregularEntries(input);
    RaiseCounters(input);  // an atlas may hold ids above its counters
    const ByKind<IdRange> ranges = FindRanges(input, options_.threads);
    if (i == vocabulary_input_) result_.atlas.vocabulary = std::move(input.vocabulary);
    if (i == 0) result_.atlas.encoding = input.encoding;
    Shift shift = MakeShift(i, ranges, input.next_ids);
    PlaceCameras(i, input, shift);
    RecordIds(i, input, shift);
    if (!shift.empty()) detail::TranslateAtlas(input, shift, options_.threads);
    RaiseTo(input.next_ids, shift);
    report().inputs[i].shift = shift.offsets;
    report().inputs[i].cameras = std::move(shift.cameras);
    MoveMaps(i, input);
  }

  // Kind by kind nothing when the range is free, else what takes it to the first free id.
  Shift MakeShift(std::size_t i, const ByKind<IdRange>& ranges, const Counters& limits) {
    Shift shift;
    for (std::size_t kind = 0; kind < kIdKinds; ++kind) {
      const auto as_kind = static_cast<IdKind>(kind);
      shift.limits[kind] = NextId(limits, as_kind);
      IdRange range = ranges[kind];
      if (range.empty() || as_kind == IdKind::kCamera) continue;
      const auto meets = [&](const IdRange& used) { return used.Meets(range); };
      if (std::ranges::any_of(used_[kind], meets)) {
        const std::uint64_t free = NextId(result_.atlas.next_ids, as_kind), largest = LargestId(as_kind);
        if (free > largest || range.highest - range.lowest > largest - free)
          throw Error(ErrorKind::kNotPossible, detail::Concat(NameOfInput(i), ": its ", NameOf(as_kind),
                                                              " ids would begin at ", free, " and end beyond ", largest,
                                                              "; make the ids of the inputs dense first: `Renumber`"));
        shift.offsets[kind] = free - range.lowest;
        range.lowest += shift.offsets[kind];
        range.highest += shift.offsets[kind];
      }
      used_[kind].push_back(range);
    }
    return shift;
  }

  // Cameras that an earlier input has go by its id; others keep theirs where it is free.
  void PlaceCameras(std::size_t i, Atlas& input, Shift& shift) {
    std::vector<Camera>& cameras = result_.atlas.cameras;
    std::uint64_t& next = result_.atlas.next_ids.camera;
    const std::size_t earlier = cameras.size();
    for (Camera& camera : input.cameras) {
      const auto end = cameras.begin() + static_cast<std::ptrdiff_t>(earlier);
      const auto same =
          std::find_if(cameras.begin(), end, [&](const Camera& other) { return detail::IsSameCamera(other, camera); });
      const std::uint64_t before = camera.id.value();
      if (same != end) {
        ++report().inputs[i].unified_cameras;
        ++report().left_out.cameras;
        shift.cameras.push_back({before, same->id.value()});
        continue;
      }
      const bool taken = std::any_of(cameras.begin(), end, [&](const Camera& other) { return other.id == camera.id; });
      const std::uint64_t after = taken ? std::max(next, shift.limits[Row(IdKind::kCamera)]) : before;
      if (after != kNoId) next = std::max(next, after + 1);
      shift.cameras.push_back({before, after});
      camera.id = CameraId(after);
      cameras.push_back(std::move(camera));
    }
    input.cameras.clear();
  }

  void RaiseTo(const Counters& counters, const Shift& shift) {
    Counters& next = result_.atlas.next_ids;
    const auto raise = [&](std::uint64_t& counter, std::uint64_t other, IdKind kind) {
      counter = std::max(counter, other + shift.offsets[Row(kind)]);
    };
    for (const CounterField& counter : CounterFields())
      raise(next.*counter.field, counters.*counter.field, counter.kind);
  }

  bool IsLeftOut(std::size_t input, std::size_t row) const {
    return std::ranges::any_of(
        maps_, [&](const KnownMap& map) { return map.input == input && map.row == row && map.left_out; });
  }

  void MoveMaps(std::size_t i, Atlas& input) {
    for (std::size_t row = 0; row < input.maps.size(); ++row) {
      if (IsLeftOut(i, row)) {
        report().left_out += CountContent(input.maps[row], options_.threads);
        continue;
      }
      result_.atlas.maps.push_back(std::move(input.maps[row]));
      input_of_map_.push_back(i);
    }
  }

  // Before the ids change.
  void RecordIds(std::size_t i, const Atlas& input, const Shift& shift) {
    if (!options_.id_maps) return;
    IdMap ids{.input = NameOfInput(i)};
    ids[IdKind::kCamera] = shift.cameras;
    const auto add = [&](auto kind, std::uint64_t id, bool left_out) {
      if (id != kNoId) ids[kind].push_back({id, left_out ? kNoId : shift(kind, id)});
    };
    for (std::size_t row = 0; row < input.maps.size(); ++row) {
      const Map& map = input.maps[row];
      const bool left_out = IsLeftOut(i, row);
      add(detail::IdKindConstant<IdKind::kMap>(), map.id.value(), left_out);
      for (const KeyFrame& keyframe : map.keyframes) {
        add(detail::IdKindConstant<IdKind::kKeyFrame>(), keyframe.id.value(), left_out);
        add(detail::IdKindConstant<IdKind::kFrame>(), keyframe.frame_id, left_out);
      }
      for (const MapPoint& point : map.points)
        add(detail::IdKindConstant<IdKind::kPoint>(), point.id.value(), left_out);
      for (const Landmark& landmark : map.landmarks)
        if (landmark.is_numbered()) add(detail::IdKindConstant<IdKind::kPoint>(), landmark.id.value(), left_out);
    }
    for (std::vector<IdPair>& pairs : ids.kinds) {
      std::ranges::sort(pairs, {}, [](const IdPair& pair) { return std::pair(pair.before, pair.after); });
      pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    }
    report().id_maps.push_back(std::move(ids));
  }

  void Verify() {
    ContentCounts expected;
    for (const MergedInput& input : report().inputs) expected += input.counts;
    expected -= report().left_out;
    report().result = CountContent(result_.atlas, options_.threads);
    if (report().result != expected)
      throw Error(ErrorKind::kInternal,
                  "the merged atlas does not hold what its inputs do; this is a fault of slamdb, nothing was written");
  }

  // Maps of other inputs with the first map of the first one; each aspect is told once.
  void CompareMaps() {
    const auto named = [&](std::size_t row) {
      const Map& map = result_.atlas.maps[row];
      return detail::NamedMap{&map, ToString(map.id) + " (" + NameOfInput(input_of_map_[row]) + ")"};
    };
    std::optional<std::size_t> first;
    std::set<std::string_view> told;
    for (std::size_t row = 0; row < input_of_map_.size(); ++row) {
      if (result_.atlas.maps[row].keyframes.empty()) continue;
      if (!first) first = row;
      if (input_of_map_[row] == input_of_map_[*first]) continue;
      for (detail::Mixture& mixture : detail::MixturesOf(named(*first), named(row), detail::Together::kSideBySide))
        if (told.insert(mixture.aspect).second) report().warnings.push_back(std::move(mixture.sentence));
    }
  }

  // Which maps are joined, when that is not said: the only ones that there are.
  void ChooseMaps(const std::vector<Atlas>& inputs, JoinOptions& join) const {
    if (inputs.size() > 2)
      throw Error(ErrorKind::kUsage, "two maps can be joined at a time; merge the first two inputs, then the next");
    std::vector<MapId> first = MapsToJoin(inputs.front()), second = MapsToJoin(inputs.back());
    if (inputs.size() == 1 && first.size() == 2) {
      second = {first.back()};
      first.pop_back();
    }
    if ((!join.first && first.size() != 1) || (!join.second && second.size() != 1))
      throw Error(ErrorKind::kUsage, "there are several maps to choose from, or none: say which two to join");
    if (!join.first) join.first = first.front();
    if (!join.second) join.second = second.front();
    RequireMap(inputs.front(), NameOfInput(0), join.first);
    RequireMap(inputs.back(), NameOfInput(inputs.size() - 1), join.second);
    for (const KeyFramePair& anchor : join.anchors) {
      RequireKeyFrame(inputs.front(), NameOfInput(0), join.first, anchor.first);
      RequireKeyFrame(inputs.back(), NameOfInput(inputs.size() - 1), join.second, anchor.second);
    }
  }

  // Those with keyframes; if there is none, those with landmarks.
  static std::vector<MapId> MapsToJoin(const Atlas& input) {
    std::vector<MapId> with_keyframes, with_landmarks;
    for (const Map& map : input.maps) {
      if (!map.keyframes.empty()) with_keyframes.push_back(map.id);
      if (!map.landmarks.empty()) with_landmarks.push_back(map.id);
    }
    return with_keyframes.empty() ? with_landmarks : with_keyframes;
  }

  // In the ids that the user knows, before they change.
  static void RequireMap(const Atlas& input, const std::string& name, MapId id) {
    if (std::ranges::find(input.maps, id, &Map::id) == input.maps.end())
      throw Error(ErrorKind::kNotPossible, name + ": has no " + ToString(id) + " to join");
  }
  static void RequireKeyFrame(const Atlas& input, const std::string& name, MapId map, KeyFrameId id) {
    const Map& of = *std::ranges::find(input.maps, map, &Map::id);
    if (std::ranges::find(of.keyframes, id, &KeyFrame::id) == of.keyframes.end())
      throw Error(ErrorKind::kNotPossible,
                  name + ": " + ToString(id) + " is not in " + ToString(map) + ", so it cannot be an anchor");
  }

  // In the ids that the second input has now.
  void Join(JoinOptions join, std::size_t inputs) {
    const ByKind<std::uint64_t>& shift = report().inputs.back().shift;
    if (inputs > 1) {
      join.second = MapId(join.second.value() + shift[Row(IdKind::kMap)]);
      for (KeyFramePair& anchor : join.anchors)
        anchor.second = KeyFrameId(anchor.second.value() + shift[Row(IdKind::kKeyFrame)]);
    }
    join.force = join.force || options_.force;
    join.threads = options_.threads;
    join.progress = options_.progress;
    report().join = JoinMaps(result_.atlas, join);
    for (IdMap& ids : report().id_maps) FollowJoin(*report().join, ids);
  }

  MergeReport& report() { return result_.report; }

  const MergeOptions& options_;
  MergeResult result_;
  std::size_t vocabulary_input_ = 0;   // the first input that has a vocabulary
  ByKind<std::vector<IdRange>> used_;  // ids of the inputs so far
  std::vector<KnownMap> maps_;
  std::vector<std::size_t> input_of_map_;  // by row of the result
};

// Landmarks stand among the points.
template <class Id>
void FollowFused(const std::vector<std::pair<Id, Id>>& replaced, IdMap& ids) {
  for (IdPair& pair : ids[IdKind::kPoint]) {
    const auto found = std::ranges::lower_bound(replaced, Id(pair.after), {}, &std::pair<Id, Id>::first);
    if (found != replaced.end() && found->first.value() == pair.after) pair.after = found->second.value();
  }
}

}  // namespace

void FollowJoin(const JoinReport& join, IdMap& ids) {
  for (IdPair& pair : ids[IdKind::kMap])
    if (pair.after == join.second.value()) pair.after = join.first.value();
  if (join.fused) FollowFuse(*join.fused, ids);
  if (join.alike) FollowFused(join.alike->replaced, ids);
}

void FollowFuse(const FuseReport& fused, IdMap& ids) { FollowFused(fused.replaced, ids); }

void FollowRemoval(std::span<const MapPointId> gone, IdMap& ids) {
  for (IdPair& pair : ids[IdKind::kPoint])
    if (std::ranges::binary_search(gone, MapPointId(pair.after))) pair.after = kNoId;
}

MergeResult MergeAtlases(std::vector<Atlas> inputs, const MergeOptions& options) {
  return Merger(options).Run(std::move(inputs));
}

}  // namespace slamdb
