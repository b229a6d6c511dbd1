// SPDX-License-Identifier: BSD-3-Clause
// 1. Keyframes are recognised by their images; cameras by what they are.
// 2. Base and theirs get the ids of ours for these, and free ones for what is new.
// 3. Points are recognised by keypoints that see both, which now have equal names, and renumbered in the same way.
#include "slamdb/edit/merge/detail/branch_ids.h"

#include <algorithm>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/hash.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/ids/detail/references.h"
#include "slamdb/edit/merge/detail/branch_points.h"
#include "slamdb/edit/merge/detail/same_camera.h"
#include "slamdb/edit/merge/three_way.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t Row(IdKind kind) { return static_cast<std::size_t>(kind); }

// ---- images

struct Image {
  std::uint64_t hash = 0, id = kNoId;
  bool blank = false;  // without keypoints, so that only its time tells what it is
};

template <class Values>
std::uint64_t HashOfColumn(const Values& values, std::uint64_t seed) {
  return HashBytes(std::as_bytes(std::span(values.data(), values.size())), seed * 31 + values.size());
}

// What a keyframe shows, and how its keypoints are laid out: not what was made of it.
Image ImageOf(const KeyFrame& keyframe) {
  const Features& features = keyframe.features;
  std::uint64_t hash = HashBytes(std::as_bytes(std::span(&keyframe.timestamp, 1)));
  hash = HashOfColumn(features.keypoints, hash);
  hash = HashOfColumn(features.right_keypoints, hash);
  hash = HashOfColumn(features.descriptors, hash);
  if (keyframe.carried && !keyframe.carried->descriptors.data.empty())
    hash = HashOfColumn(keyframe.carried->descriptors.data, hash);
  const std::int64_t shape[] = {static_cast<std::int64_t>(features.map_points.size()), features.left_count};
  hash = HashOfColumn(std::span(shape), hash);
  return {hash, keyframe.id.value(), features.keypoints.empty() && features.descriptors.empty()};
}

std::vector<Image> ImagesOf(const Atlas& atlas, int threads) {
  std::vector<const KeyFrame*> keyframes;
  for (const Map& map : atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes) keyframes.push_back(&keyframe);
  std::vector<Image> images(keyframes.size());
  ParallelFor(keyframes.size(), 16, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) images[row] = ImageOf(*keyframes[row]);
  });
  std::ranges::sort(images, {}, [](const Image& image) { return std::pair(image.hash, image.id); });
  return images;
}

// Which image is which: those of equal id first, then, of images that show something, the others in the order of their
// ids. Ascending by the id before.
std::vector<IdPair> MatchImages(const std::vector<Image>& from, const std::vector<Image>& to) {
  std::vector<IdPair> pairs;
  std::vector<std::uint64_t> left, right;  // of one hash
  for (auto a = from.begin(), b = to.begin(); a != from.end() && b != to.end();) {
    if (a->hash != b->hash) {
      ++(a->hash < b->hash ? a : b);
      continue;
    }
    const std::uint64_t hash = a->hash;
    const bool blank = a->blank;
    left.clear();
    right.clear();
    for (; a != from.end() && a->hash == hash; ++a) left.push_back(a->id);
    for (; b != to.end() && b->hash == hash; ++b) right.push_back(b->id);
    const auto take = [&](std::uint64_t id) { return std::ranges::binary_search(right, id); };
    const std::vector<std::uint64_t> own = left;
    for (const std::uint64_t id : own)
      if (take(id)) {
        pairs.push_back({id, id});
        std::erase(left, id);
        std::erase(right, id);
      }
    for (std::size_t i = 0; !blank && i < std::min(left.size(), right.size()); ++i)
      pairs.push_back({left[i], right[i]});
  }
  std::ranges::sort(pairs, {}, &IdPair::before);
  return pairs;
}

// ---- new ids

using Table = std::unordered_map<std::uint64_t, std::uint64_t>;

Table TableOf(const std::vector<IdPair>& pairs) {
  Table table;
  table.reserve(pairs.size());
  for (const IdPair& pair : pairs) table.emplace(pair.before, pair.after);
  return table;
}

// What one atlas translates one kind of id by: a table, and for what is not in it a shift of what was made since.
struct Renumbering {
  Table known;
  std::uint64_t since = kNoId, limit = kNoId, shift = 0;

  std::uint64_t operator()(std::uint64_t id) const {
    if (const auto found = known.find(id); found != known.end()) return found->second;
    return id >= since && id < limit ? id + shift : id;
  }
};
using Renumberings = std::array<Renumbering, kIdKinds>;

void Translate(Atlas& atlas, const Renumberings& kinds, std::initializer_list<IdKind> which, int threads) {
  std::array<bool, kIdKinds> wanted{};
  for (const IdKind kind : which) wanted[Row(kind)] = true;
  TranslateAtlas(
      atlas, [&](auto kind, std::uint64_t id) { return wanted[Row(kind)] ? kinds[Row(kind)](id) : id; }, threads);
}

std::vector<std::uint64_t> IdsOf(const Atlas& atlas, IdKind kind) {
  std::vector<std::uint64_t> ids;
  if (kind == IdKind::kCamera)
    for (const Camera& camera : atlas.cameras) ids.push_back(camera.id.value());
  for (const Map& map : atlas.maps) {
    if (kind == IdKind::kMap) ids.push_back(map.id.value());
    for (const KeyFrame& keyframe : map.keyframes)
      if (kind == IdKind::kKeyFrame || kind == IdKind::kFrame)
        ids.push_back(kind == IdKind::kFrame ? keyframe.frame_id : keyframe.id.value());
    if (kind != IdKind::kPoint) continue;
    for (const MapPoint& point : map.points) ids.push_back(point.id.value());
    for (const Landmark& landmark : map.landmarks) ids.push_back(landmark.id.value());
  }
  return ids;
}

using KeyFrames = std::unordered_map<std::uint64_t, const KeyFrame*>;  // by id

KeyFrames KeyFramesOf(const Atlas& atlas) {
  KeyFrames keyframes;
  for (const Map& map : atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes) keyframes.emplace(keyframe.id.value(), &keyframe);
  return keyframes;
}

class Unifier {
 public:
  Unifier(Branches& branches, const std::array<std::string, 3>& names, int threads)
      : base_(branches.base), ours_(branches.ours), theirs_(branches.theirs), names_(names), threads_(threads) {}

  UnifiedIds Run() {
    for (std::size_t kind = 0; kind < kIdKinds; ++kind) before_[kind] = IdsOf(theirs_, static_cast<IdKind>(kind));
    PlanLimits();
    MatchCameras();
    MatchKeyFrames();
    const auto first = {IdKind::kMap, IdKind::kFrame, IdKind::kCamera, IdKind::kKeyFrame};
    Translate(base_, of_base_, first, threads_);
    Translate(theirs_, of_theirs_, first, threads_);
    MatchPoints();
    Translate(base_, of_base_, {IdKind::kPoint}, threads_);
    Translate(theirs_, of_theirs_, {IdKind::kPoint}, threads_);
    RecordPairs();
    return std::move(unified_);
  }

 private:
  void PlanLimits() {
    for (std::size_t kind = 0; kind < kIdKinds; ++kind) {
      const auto as_kind = static_cast<IdKind>(kind);
      of_theirs_[kind].since = NextId(base_.next_ids, as_kind);
      of_theirs_[kind].limit = NextId(theirs_.next_ids, as_kind);
      free_[kind] = std::max(NextId(ours_.next_ids, as_kind), of_theirs_[kind].limit);
    }
    of_theirs_[Row(IdKind::kCamera)].since = kNoId;  // they have their table
  }

  // The range of the ids that were made since the base.
  struct Range {
    std::uint64_t lowest = kNoId, highest = 0;
    void Add(std::uint64_t id, std::uint64_t since) {
      if (id == kNoId || id < since) return;
      lowest = std::min(lowest, id);
      highest = std::max(highest, id);
    }
    bool Meets(const Range& other) const { return lowest <= other.highest && other.lowest <= highest; }
  };

  // What both sides made since the base and would meet: theirs goes behind ours.
  void Shift(IdKind kind, const Range& ours, const Range& theirs) {
    if (!ours.Meets(theirs)) return;
    const std::size_t row = Row(kind);
    Renumbering& renumbering = of_theirs_[row];
    renumbering.shift = NextId(ours_.next_ids, kind) - renumbering.since;
    if (renumbering.shift > LargestId(kind) || renumbering.limit > LargestId(kind) - renumbering.shift)
      throw Error(ErrorKind::kNotPossible,
                  Concat(names_[2], ": its ", NameOf(kind), " ids would end beyond ", LargestId(kind),
                         "; make the ids of all three dense first, in the same way: `Renumber`"));
    free_[row] = std::max(free_[row], renumbering.limit + renumbering.shift);
    unified_.shift[row] = renumbering.shift;
  }

  // Of keyframes, their frames and the maps that they were made in. `matched`: those of theirs that base or ours has.
  void PlanShifts(const std::unordered_set<std::uint64_t>& matched) {
    const auto since = [&](IdKind kind) { return of_theirs_[Row(kind)].since; };
    std::array<Range, kIdKinds> ours, theirs;
    const auto add = [&](std::array<Range, kIdKinds>& ranges, IdKind kind, std::uint64_t id) {
      ranges[Row(kind)].Add(id, since(kind));
    };
    const auto add_keyframe = [&](std::array<Range, kIdKinds>& ranges, const KeyFrame& keyframe) {
      add(ranges, IdKind::kKeyFrame, keyframe.id.value());
      add(ranges, IdKind::kFrame, keyframe.frame_id);
      add(ranges, IdKind::kMap, keyframe.origin_map);
    };
    for (const Map& map : ours_.maps) {
      add(ours, IdKind::kMap, map.id.value());
      for (const KeyFrame& keyframe : map.keyframes) add_keyframe(ours, keyframe);
    }
    for (const Map& map : theirs_.maps) {
      bool is_new = true;
      for (const KeyFrame& keyframe : map.keyframes)
        if (matched.contains(keyframe.id.value()))
          is_new = false;
        else
          add_keyframe(theirs, keyframe);
      if (is_new) add(theirs, IdKind::kMap, map.id.value());
    }
    for (const IdKind kind : {IdKind::kMap, IdKind::kFrame, IdKind::kKeyFrame})
      Shift(kind, ours[Row(kind)], theirs[Row(kind)]);
  }

  std::uint64_t Free(IdKind kind) { return free_[Row(kind)]++; }

  // A camera that ours has goes by its id; base and theirs alike when they share one that ours has not.
  void MatchCameras() {
    constexpr std::size_t kKind = Row(IdKind::kCamera);
    std::vector<const Camera*> known;
    std::unordered_set<std::uint64_t> taken;
    for (const Camera& camera : ours_.cameras) {
      known.push_back(&camera);
      taken.insert(camera.id.value());
    }
    std::vector<std::uint64_t> ids(taken.size());
    std::ranges::transform(known, ids.begin(), [](const Camera* camera) { return camera->id.value(); });
    for (Atlas* atlas : {&base_, &theirs_})
      for (const Camera& camera : atlas->cameras) {
        const auto same = std::ranges::find_if(known, [&](const Camera* each) { return IsSameCamera(*each, camera); });
        Table& table = (atlas == &base_ ? of_base_ : of_theirs_)[kKind].known;
        std::uint64_t id = camera.id.value();
        if (same != known.end()) {
          id = ids[static_cast<std::size_t>(same - known.begin())];
        } else {
          if (!taken.insert(id).second) taken.insert(id = Free(IdKind::kCamera));
          known.push_back(&camera);
          ids.push_back(id);
        }
        table[camera.id.value()] = id;
      }
  }

  void MatchKeyFrames() {
    const std::vector<Image> base = ImagesOf(base_, threads_), ours = ImagesOf(ours_, threads_),
                             theirs = ImagesOf(theirs_, threads_);
    const std::vector<IdPair> base_in_ours = MatchImages(base, ours), base_in_theirs = MatchImages(base, theirs);
    RefuseStranger(base_in_ours, ours.size(), 1);
    RefuseStranger(base_in_theirs, theirs.size(), 2);
    const std::vector<IdPair> theirs_in_ours = MatchImages(theirs, ours);
    std::unordered_set<std::uint64_t> matched;
    for (const IdPair& pair : base_in_theirs) matched.insert(pair.after);
    for (const IdPair& pair : theirs_in_ours) matched.insert(pair.before);
    MatchMaps(base_in_ours, base_in_theirs);
    PlanShifts(matched);
    NameAll(IdKind::kKeyFrame, base_in_ours, base_in_theirs, theirs_in_ours);
    CountOtherImages(base, base_in_ours, ours);
    CountOtherImages(base, base_in_theirs, theirs);
  }

  // Maps that a side gave other ids: keyframes of the base tell it, as they keep the map that they were made in.
  void MatchMaps(const std::vector<IdPair>& base_in_ours, const std::vector<IdPair>& base_in_theirs) {
    Table &base = of_base_[Row(IdKind::kMap)].known, &theirs = of_theirs_[Row(IdKind::kMap)].known;
    const KeyFrames of_base = KeyFramesOf(base_);
    base = OriginsOf(of_base, KeyFramesOf(ours_), base_in_ours);
    for (const auto& [before, after] : OriginsOf(of_base, KeyFramesOf(theirs_), base_in_theirs)) {
      const auto in_ours = base.find(before);
      theirs.emplace(after, in_ours == base.end() ? before : in_ours->second);
    }
  }

  // Which origin map of the base is which of a side, where all keyframes agree on it; else none is another one.
  static Table OriginsOf(const KeyFrames& before, const KeyFrames& after, const std::vector<IdPair>& common) {
    Table origins, back;
    for (const IdPair& pair : common) {
      const std::uint64_t was = before.at(pair.before)->origin_map, is = after.at(pair.after)->origin_map;
      if (origins.emplace(was, is).first->second != is || back.emplace(is, was).first->second != was) return {};
    }
    return origins;
  }

  void RefuseStranger(const std::vector<IdPair>& common, std::size_t keyframes, std::size_t side) const {
    if (!common.empty()) return;
    throw Error(ErrorKind::kNotPossible,
                keyframes == 0
                    ? Concat(names_[side], ": has no keyframes, so nothing tells what became of those of ", names_[0])
                    : Concat(names_[side], ": none of its ", Counted(keyframes, "keyframe"), " is one of ", names_[0],
                             ", so it was not made of that: name the atlas that both sides were made of as their base; "
                             "maps of which no base is left are aligned: `MergeAligned`"));
  }

  void CountOtherImages(const std::vector<Image>& base, const std::vector<IdPair>& matched,
                        const std::vector<Image>& side) {
    std::unordered_set<std::uint64_t> lost;
    for (const Image& image : base)
      if (FindPair(matched, image.id) == nullptr) lost.insert(image.id);
    std::unordered_set<std::uint64_t> known;
    for (const IdPair& pair : matched) known.insert(pair.after);
    for (const Image& image : side) unified_.other_images += lost.contains(image.id) && !known.contains(image.id);
  }

  // Ids of one kind for base and theirs, where it is known which is which.
  void NameAll(IdKind kind, const std::vector<IdPair>& base_in_ours, const std::vector<IdPair>& base_in_theirs,
               const std::vector<IdPair>& theirs_in_ours) {
    Table &base = of_base_[Row(kind)].known, &theirs = of_theirs_[Row(kind)].known;
    std::unordered_set<std::uint64_t> used;  // ids of ours that are given to something of theirs
    for (const std::uint64_t id : IdsOf(ours_, kind)) taken_.insert(id);
    base = TableOf(base_in_ours);
    for (const std::uint64_t id : IdsOf(base_, kind))
      if (id != kNoId && !base.contains(id)) base.emplace(id, Keep(kind, id));
    for (const IdPair& pair : base_in_theirs) used.insert(theirs[pair.after] = base.at(pair.before));
    for (const IdPair& pair : theirs_in_ours)
      if (!theirs.contains(pair.before) && used.insert(pair.after).second) theirs.emplace(pair.before, pair.after);
    const Renumbering& shifted = of_theirs_[Row(kind)];
    for (const std::uint64_t id : IdsOf(theirs_, kind))
      if (id != kNoId && !theirs.contains(id)) theirs.emplace(id, Keep(kind, shifted(id)));
    taken_.clear();
  }

  // An id itself where nothing else has it, else a free one.
  std::uint64_t Keep(IdKind kind, std::uint64_t id) {
    if (taken_.insert(id).second) return id;
    const std::uint64_t free = Free(kind);
    taken_.insert(free);
    return free;
  }

  void MatchPoints() {
    const AtlasIndex base(base_), ours(ours_), theirs(theirs_);
    const std::vector<IdPair> in_ours = MatchPointsOfBase(base, ours), in_theirs = MatchPointsOfBase(base, theirs);
    const std::vector<IdPair> new_ones = MatchNewPoints(theirs, ours, in_theirs, in_ours);
    std::unordered_set<std::uint64_t> matched;
    for (const IdPair& pair : in_theirs) matched.insert(pair.after);
    for (const IdPair& pair : new_ones) matched.insert(pair.before);
    Range of_ours, of_theirs;
    const std::uint64_t since = of_theirs_[Row(IdKind::kPoint)].since;
    for (const std::uint64_t id : IdsOf(ours_, IdKind::kPoint)) of_ours.Add(id, since);
    for (const std::uint64_t id : IdsOf(theirs_, IdKind::kPoint))
      if (!matched.contains(id)) of_theirs.Add(id, since);
    Shift(IdKind::kPoint, of_ours, of_theirs);
    NameAll(IdKind::kPoint, in_ours, in_theirs, new_ones);
  }

  void RecordPairs() {
    for (std::size_t kind = 0; kind < kIdKinds; ++kind) {
      const std::vector<std::uint64_t> after = IdsOf(theirs_, static_cast<IdKind>(kind));
      std::vector<IdPair>& pairs = unified_.pairs[kind];
      for (std::size_t i = 0; i < after.size(); ++i)
        if (after[i] != kNoId) pairs.push_back({before_[kind][i], after[i]});
      std::ranges::sort(pairs, {}, [](const IdPair& pair) { return std::pair(pair.before, pair.after); });
      pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    }
  }

  Atlas &base_, &ours_, &theirs_;
  const std::array<std::string, 3>& names_;
  const int threads_;
  UnifiedIds unified_;
  Renumberings of_base_, of_theirs_;
  std::array<std::uint64_t, kIdKinds> free_{};
  std::array<std::vector<std::uint64_t>, kIdKinds> before_;
  std::unordered_set<std::uint64_t> taken_;  // while one kind is named
};

// Whether `part` has deleted a keyframe of the base that `all` has as the base had it: seeing the same points, and with
// the same neighbours. Where `all` went on with it, it stays in any merge.
bool DeletesUntouched(const std::vector<Image>& base, const std::vector<Image>& part, const std::vector<Image>& all,
                      const Atlas& base_atlas, const Atlas& all_atlas) {
  const std::vector<IdPair> in_part = MatchImages(base, part), in_all = MatchImages(base, all);
  const auto before = KeyFramesOf(base_atlas), after = KeyFramesOf(all_atlas);
  return std::ranges::any_of(base, [&](const Image& image) {
    const auto* pair = FindPair(in_all, image.id);
    if (pair == nullptr || FindPair(in_part, image.id) != nullptr) return false;
    const auto was = before.find(pair->before), is = after.find(pair->after);
    return was != before.end() && is != after.end() &&
           was->second->features.map_points == is->second->features.map_points &&
           was->second->connections == is->second->connections && was->second->children == is->second->children;
  });
}

// Of keypoints that see a point in `part`, how many do in `all`, as a share: an atlas that was made of another has its
// points, though some are fused.
struct SeenInBoth {
  std::size_t of_part = 0, of_both = 0;

  void Add(const KeyFrame& part, const KeyFrame& all) {
    const auto &one = part.features.map_points, &other = all.features.map_points;
    for (std::size_t i = 0; i < one.size(); ++i) {
      if (!one[i].has_value()) continue;
      ++of_part;
      of_both += i < other.size() && other[i].has_value();
    }
  }
  bool are_most() const { return 10 * of_both >= 9 * of_part; }
};

}  // namespace

std::optional<BranchSide> FindContaining(const Branches& branches, int threads) {
  const std::vector<Image> base = ImagesOf(branches.base, threads), ours = ImagesOf(branches.ours, threads),
                           theirs = ImagesOf(branches.theirs, threads);
  const auto our_keyframes = KeyFramesOf(branches.ours), their_keyframes = KeyFramesOf(branches.theirs);
  const auto contains = [&](const std::vector<Image>& part, const auto& in_part, const std::vector<Image>& all,
                            const auto& in_all) {
    const std::vector<IdPair> old = MatchImages(part, base), common = MatchImages(part, all);
    std::size_t any_new = 0;
    SeenInBoth seen;
    for (const Image& image : part) {
      if (FindPair(old, image.id) != nullptr) continue;
      const auto* pair = FindPair(common, image.id);
      if (pair == nullptr) return false;
      ++any_new;
      const auto one = in_part.find(pair->before), other = in_all.find(pair->after);
      if (one != in_part.end() && other != in_all.end()) seen.Add(*one->second, *other->second);
    }
    return !old.empty() && any_new > 0 && seen.are_most();
  };
  if (contains(theirs, their_keyframes, ours, our_keyframes) &&
      !DeletesUntouched(base, theirs, ours, branches.base, branches.ours))
    return BranchSide::kOurs;
  if (contains(ours, our_keyframes, theirs, their_keyframes) &&
      !DeletesUntouched(base, ours, theirs, branches.base, branches.theirs))
    return BranchSide::kTheirs;
  return std::nullopt;
}

UnifiedIds UnifyIds(Branches& branches, const std::array<std::string, 3>& names, int threads) {
  return Unifier(branches, names, threads).Run();
}

}  // namespace slamdb::detail

namespace slamdb {

std::size_t CountMissingKeyframes(const Atlas& base, const Atlas& side, int threads) {
  const auto images = detail::ImagesOf(base, threads);
  return images.size() - detail::MatchImages(images, detail::ImagesOf(side, threads)).size();
}

}  // namespace slamdb
