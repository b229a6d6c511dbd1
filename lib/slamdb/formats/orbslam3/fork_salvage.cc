// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/fork_salvage.h"

#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/layouts/detail/inference.h"
#include "slamdb/formats/orbslam3/detail/fork.h"
#include "slamdb/formats/orbslam3/detail/fork_files.h"
#include "slamdb/formats/orbslam3/detail/fork_losses.h"
#include "slamdb/formats/orbslam3/detail/meaning.h"
#include "slamdb/formats/orbslam3/infer_layout.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/model/detail/carried_members.h"

namespace slamdb::orbslam3 {
namespace {

using detail::Concat;
using layouts::MapRecords;
using layouts::RecordList;

std::vector<RecordPlace> PlacesOf(const RecordList& list) {
  std::vector<RecordPlace> places;
  for (std::size_t i = 0; i < list.records.size(); ++i) places.push_back({list.records[i].body, EndOf(list, i)});
  return places;
}

// Those that are seen whole.
std::vector<RecordPlace> WholePlaces(std::span<const MapRecords> maps, RecordList MapRecords::*list_of) {
  std::vector<RecordPlace> whole;
  for (const MapRecords& map : maps)
    for (const RecordPlace& place : PlacesOf(map.*list_of))
      if (place.end > 0) whole.push_back(place);
  return whole;
}

// Which layouts read one in eight of the keyframes, and of the points, that are seen whole from end to end: of another
// layout none is, and of a damaged file many may not be.
class FittingLayouts {
 public:
  FittingLayouts(const layouts::ArchiveBytes& archive, std::span<const MapRecords> maps)
      : archive_(archive),
        keyframes_(WholePlaces(maps, &MapRecords::keyframes)),
        points_(WholePlaces(maps, &MapRecords::points)) {}

  // Where every class has been met, which is fast.
  bool FitsWarm(const Layout& layout) const {
    return AreWarm(keyframes_, layout, "KeyFrame") && AreWarm(points_, layout, "MapPoint");
  }
  // Of few records most may bring classes, which only reading them tells.
  bool FitsRead(const Layout& layout) const {
    if (keyframes_.size() > kFew && points_.size() > kFew) return false;
    const Source source(std::as_bytes(std::span(archive_.file)), "");
    detail::FileStream stream(source);
    const MapPlaces few{First(keyframes_), First(points_)};
    const ArchiveHeader header{archive_.encoding, archive_.begin};
    const Map read =
        ReadForkRecords(stream, header, ForkProgram(layout), std::span(&few, 1), RecordUse::kMeaning).atlas.maps[0];
    return IsEnough(read.keyframes.size(), few.keyframes.size()) && IsEnough(read.points.size(), few.points.size());
  }

 private:
  static constexpr std::size_t kFew = 32;

  static bool IsEnough(std::size_t fitting, std::size_t of) { return 8 * fitting >= of; }
  static std::vector<RecordPlace> First(std::vector<RecordPlace> places) {
    places.resize(std::min(places.size(), kFew));
    return places;
  }
  bool AreWarm(const std::vector<RecordPlace>& places, const Layout& layout, const char* name) const {
    const layouts::Wire wire(layout, archive_.encoding);
    const layouts::WarmWalk walk(wire, archive_.file, archive_.encoding);
    const std::int64_t row = wire.RowOf(name);
    if (row < 0) return false;
    const auto fits = [&](const RecordPlace& place) {
      return walk.BehindMembers(wire.classes[static_cast<std::size_t>(row)], place.begin, 0) == place.end;
    };
    return IsEnough(static_cast<std::size_t>(std::ranges::count_if(places, fits)), places.size());
  }

  const layouts::ArchiveBytes& archive_;
  const std::vector<RecordPlace> keyframes_, points_;
};

SalvagedMap Counted(const Map& map) {
  SalvagedMap counted{.id = map.id};
  counted.keyframes = {map.keyframes.size(), map.keyframes.size()};
  counted.points = {map.points.size(), map.points.size()};
  return counted;
}

void DropCarried(Atlas& atlas) {
  detail::ForEachCarried(atlas, [](Boxed<Carried>& carried) {
    if (carried) carried.Make().members.clear();
  });
}

// Flags that may be others must not cost what they stand at.
void DropDoubtfulFlags(Atlas& atlas) {
  for (Map& map : atlas.maps) {
    for (KeyFrame& keyframe : map.keyframes) keyframe.bad = keyframe.to_be_erased = false;
    for (MapPoint& point : map.points) {
      point.bad = false;
      point.replaced_by = MapPointId();
    }
  }
}

// An atlas of a layout that no program knows is one of v1.0, which every program reads.
void UseOwnLayout(const InferredLayout& inferred, Salvage& salvage) {
  const std::string how = inferred.differences.empty() ? "" : Concat(" (", ListedSentences(inferred.differences), ")");
  salvage.losses.push_back(Concat("read in a layout that was inferred", how,
                                  ", and saved as of ORB-SLAM3 v1.0, without what that does not have"));
  constexpr std::string_view kKept = ": flags of what is bad or replaced are not believed, and everything is kept";
  if (const std::size_t others = inferred.alternatives.size(); others > 0)
    salvage.losses.push_back(Concat(detail::Counted(others, "other layout"), others == 1 ? " fits" : " fit",
                                    " as well (`InferLayout` lists them)", kKept));
  if (!inferred.doubts.empty())
    salvage.losses.push_back(Concat("the layout is in doubt: ", ListedSentences(inferred.doubts), kKept));
  if (!inferred.sure()) DropDoubtfulFlags(salvage.atlas);
  DropCarried(salvage.atlas);
  salvage.atlas.layout.clear();
}

// ---- Files that are whole

Salvage AllOf(Atlas atlas) {
  Salvage salvage{.atlas = std::move(atlas)};
  for (const Map& map : salvage.atlas.maps) salvage.maps.push_back(Counted(map));
  salvage.maps_listed = salvage.atlas.maps.size() + salvage.atlas.repeated_maps.size();
  return salvage;
}

template <class Read>
std::optional<Salvage> Whole(const Read& read) {
  try {
    return read();
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::kOutOfResources) throw;
    return std::nullopt;
  }
}

std::optional<Salvage> WholeInferred(const Source& source, layouts::RecordLayouts& records) {
  return Whole([&]() -> std::optional<Salvage> {
    const InferredLayout inferred = InferLayoutOf(source, records, {});
    Notices notices;
    ReadOptions options;
    options.of<Orbslam3ReadOptions>().layout = ToJson(inferred.layout);
    Salvage salvage = AllOf(ReadOrbslam3(source, options, notices));
    if (!inferred.known)
      UseOwnLayout(inferred, salvage);
    else if (!inferred.doubts.empty())
      salvage.losses.push_back(
          Concat("the layout ", inferred.layout.id, " is in doubt: ", ListedSentences(inferred.doubts)));
    return salvage;
  });
}

std::optional<Salvage> WholeIn(const Source& source, const ForkProgram& program) {
  return Whole([&]() -> std::optional<Salvage> {
    Notices notices;
    LayoutReading reading = ReadInLayout(source, program, {}, notices);
    if (!reading.fits) return std::nullopt;
    return AllOf(std::move(reading.atlas));
  });
}

// ---- Records of files that are not

std::string_view TextOf(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

std::vector<MapPlaces> PlacesOf(std::span<const MapRecords> maps) {
  std::vector<MapPlaces> places;
  for (const MapRecords& map : maps) places.push_back({PlacesOf(map.keyframes), PlacesOf(map.points)});
  return places;
}

SalvagedList ListOf(const RecordList& list, std::size_t read) {
  return {std::max<std::uint64_t>(list.announced, list.records.size()), read};
}

void Tell(const SalvagedList& list, std::size_t map, const char* what, std::vector<std::string>& damage) {
  if (list.read < list.listed)
    damage.push_back(
        Concat("map ", map, ": ", list.listed - list.read, " of ", list.listed, " ", what, " are damaged"));
}

// Records of a damaged file, read in the layout that makes most sense of them.
struct RecordReading {
  Atlas atlas;
  std::vector<MapPlaces> readable;
  std::string layout;  // as atlases name it; empty: it was inferred
  layouts::Meaning meaning;
  std::vector<std::string> differences, doubts;
};

RecordReading ReadIn(const Layout& layout, const Source& source, const ArchiveHeader& header,
                     std::span<const MapPlaces> places, RecordUse use = RecordUse::kAtlas) {
  const ForkProgram program(layout);
  detail::FileStream stream(source);
  ForkRecords records = ReadForkRecords(stream, header, program, places, use);
  RecordReading reading{.atlas = std::move(records.atlas), .readable = std::move(records.readable)};
  reading.meaning = MeaningOf(reading.atlas, program);
  return reading;
}

// The first records bring the classes of members, and tell their types.
RecordReading ReadTyped(const Layout& layout, const Source& source, const ArchiveHeader& header,
                        std::span<const MapPlaces> places) {
  constexpr std::size_t kMostTrials = 512;
  MapPlaces first;
  if (!places.front().keyframes.empty()) first.keyframes.push_back(places.front().keyframes.front());
  if (!places.front().points.empty()) first.points.push_back(places.front().points.front());
  const layouts::Typings typings(layout);
  for (std::size_t trial = 0; trial < std::min(kMostTrials, typings.count()); ++trial) {
    const Layout typed = typings.At(trial);
    const Map read = ReadIn(typed, source, header, std::span(&first, 1)).atlas.maps.front();
    if (read.keyframes.size() == first.keyframes.size() && read.points.size() == first.points.size())
      return ReadIn(typed, source, header, places);
  }
  return ReadIn(layout, source, header, places);
}

// What holes leave of a known layout has doubts of its own: another layout is only believed where it has fewer.
bool HasFewerDoubts(const layouts::Meaning& changed, const layouts::Meaning& known) {
  return changed.doubts.size() < known.doubts.size();
}

void TryOptions(const Source& source, const ArchiveHeader& header, std::span<const MapPlaces> places,
                std::span<const layouts::ClassOption> options, std::optional<RecordReading>& best) {
  constexpr double kAlike = 2;
  for (const layouts::ClassOption& option : options) {
    RecordReading reading = ReadTyped(option.layout, source, header, places);
    reading.differences = option.findings.differences;
    reading.doubts = option.findings.doubts;
    reading.doubts.insert(reading.doubts.end(), reading.meaning.doubts.begin(), reading.meaning.doubts.end());
    if (best && !best->layout.empty() && !HasFewerDoubts(reading.meaning, best->meaning)) continue;
    if (!best || reading.meaning.penalty < best->meaning.penalty - kAlike)
      best = std::move(reading);
    else if (reading.meaning.penalty < best->meaning.penalty + kAlike)
      best->doubts.push_back(Concat("it could as well be: ", ListedSentences(reading.differences)));
  }
}

// Members of the known layout in other forms or order, where that makes more sense of the records that are read in it.
void ReformRecords(const Layout& known, const Source& source, const ArchiveHeader& header,
                   std::span<const MapPlaces> places, RecordReading& reading) {
  Layout layout = known;
  layouts::Meaning meaning = reading.meaning;
  std::vector<std::string> differences;
  const auto judge = [&](const Layout& changed) {
    return ReadIn(changed, source, header, reading.readable, RecordUse::kMeaning).meaning;
  };
  layouts::Reform(judge, layout, meaning, differences);
  if (!differences.empty() && HasFewerDoubts(meaning, reading.meaning)) {
    reading = ReadIn(layout, source, header, places);
    reading.differences = std::move(differences);
  }
}

// `best`: in the known layout, if there is one; or else in one with members in other forms, or in another one, where
// that makes no sense.
std::optional<RecordReading> ReadRecords(layouts::RecordLayouts& records, const Source& source,
                                         const ArchiveHeader& header, std::span<const MapPlaces> places,
                                         const Layout* known, std::optional<RecordReading> best) {
  if (best) {
    constexpr std::size_t kMostBytes = std::size_t{24} << 20U;  // which are decoded some hundred times
    if (records.archive().file.size() > kMostBytes) return best;
    ReformRecords(*known, source, header, places, *best);
    best->doubts = best->meaning.doubts;
  }
  if (known == &KnownLayouts().front()) return best;  // all records end where those of v1.0 do
  for (const bool thorough : {false, true})
    if (!best || !best->meaning.doubts.empty())
      TryOptions(source, header, places, records.Find(thorough).options, best);
  return best;
}

// The name and checksum in front of all.
Vocabulary VocabularyOf(std::string_view file, const ArchiveHeader& header) {
  constexpr std::uint64_t kLongest = 4096, kChecksum = 32;
  std::uint64_t at = header.bytes;
  const auto text = [&] {
    const std::uint64_t width = header.encoding.size_bytes;
    const std::uint64_t size = width == 4 ? layouts::NumberAt<std::uint32_t>(file, at).value_or(0)
                                          : layouts::NumberAt<std::uint64_t>(file, at).value_or(0);
    if (size > kLongest || size > file.size() - std::min<std::uint64_t>(file.size(), at + width)) return std::string();
    const std::string taken(file.substr(at + width, size));
    at += width + size;
    return taken;
  };
  Vocabulary vocabulary;
  vocabulary.name = text();
  vocabulary.checksum = text();
  return vocabulary.checksum.size() == kChecksum ? vocabulary : Vocabulary();
}

// What was read, and what is lost with the rest.
Salvage SalvageOf(RecordReading reading, std::span<const MapRecords> maps, std::string_view file,
                  const ArchiveHeader& header) {
  Salvage salvage{.atlas = std::move(reading.atlas)};
  salvage.atlas.encoding = header.encoding;
  salvage.atlas.vocabulary = VocabularyOf(file, header);
  for (std::size_t row = 0; row < maps.size(); ++row) {
    const Map& map = salvage.atlas.maps[row];
    SalvagedMap& read = salvage.maps.emplace_back(Counted(map));
    read.keyframes = ListOf(maps[row].keyframes, map.keyframes.size());
    read.points = ListOf(maps[row].points, map.points.size());
    read.lost_head = true;
    Tell(read.keyframes, row, "keyframes", salvage.damage);
    Tell(read.points, row, "map points", salvage.damage);
  }
  salvage.maps_listed = maps.size();
  salvage.lost_beginning = salvage.atlas.vocabulary.name.empty();
  if (!reading.layout.empty()) {
    salvage.atlas.layout = reading.layout;
  } else {
    DropCarried(salvage.atlas);
    salvage.damage.emplace_back("members that ORB-SLAM3 v1.0 does not have are left out: their layout is not whole");
  }
  if (!reading.doubts.empty()) {
    DropDoubtfulFlags(salvage.atlas);
    salvage.damage.push_back(
        Concat("the layout is in doubt, and with it what was read: ", ListedSentences(reading.doubts)));
  }
  if (salvage.damage.empty()) salvage.damage.emplace_back("what stands around the keyframes and map points is damaged");
  return salvage;
}

}  // namespace

bool HasKeyFrames(const Atlas& atlas) {
  return std::ranges::any_of(atlas.maps, [](const Map& map) { return !map.keyframes.empty(); });
}

const Layout* KnownLayoutOf(const layouts::ArchiveBytes& archive, std::span<const MapRecords> maps) {
  const FittingLayouts fitting(archive, maps);
  for (const auto fits : {&FittingLayouts::FitsWarm, &FittingLayouts::FitsRead}) {
    const Layout* best = nullptr;
    std::uint64_t farthest = 0;
    for (const Layout& layout : KnownLayouts()) {
      if (!(fitting.*fits)(layout)) continue;
      const std::uint64_t reached = layouts::Judge(archive, layout).reached;
      if (best != nullptr && reached <= farthest) continue;
      best = &layout;
      farthest = reached;
    }
    if (best != nullptr) return best;
  }
  return nullptr;
}

std::optional<Salvage> SalvageFork(Bytes bytes, const std::string& path, const ArchiveHeader& header) {
  const Source source(bytes, path);
  layouts::RecordLayouts records({TextOf(bytes), header.encoding, header.bytes});
  const std::span<const MapRecords> maps = records.maps();
  if (maps.empty()) return std::nullopt;
  const Layout* known = KnownLayoutOf(records.archive(), maps);
  const std::vector<MapPlaces> places = PlacesOf(maps);
  std::optional<RecordReading> in_known;
  const auto read_in_known = [&] {
    if (known == nullptr || in_known) return;
    in_known = ReadIn(*known, source, header, places);
    in_known->layout = known->id;
  };
  const bool own = known == &KnownLayouts().front();
  if (own) read_in_known();
  if (own && in_known->meaning.doubts.empty()) return std::nullopt;
  const bool is_cut = own && !layouts::Judge(records.archive(), *known).whole;
  if (!is_cut)
    if (auto whole = WholeInferred(source, records)) return whole;
  read_in_known();
  std::optional<RecordReading> reading = ReadRecords(records, source, header, places, known, std::move(in_known));
  if (!reading || reading->layout == KnownLayouts().front().id) return std::nullopt;
  return SalvageOf(*std::move(reading), maps, TextOf(bytes), header);
}

std::optional<Salvage> SalvageOwnRecords(Bytes bytes, const std::string& path, const ArchiveHeader& header) {
  const std::vector<MapRecords> maps = layouts::FindRecords(TextOf(bytes), header.encoding);
  if (maps.empty()) return std::nullopt;
  RecordReading reading = ReadIn(KnownLayouts().front(), {bytes, path}, header, PlacesOf(maps));
  if (!HasKeyFrames(reading.atlas)) return std::nullopt;
  return SalvageOf(std::move(reading), maps, TextOf(bytes), header);
}

std::optional<Salvage> SalvageInLayout(Bytes bytes, const std::string& path, const ArchiveHeader& header,
                                       const std::string& given) {
  if (IsOwnLayout(given)) return std::nullopt;
  const Layout layout = LayoutOf(given);
  if (NameFor(layout).empty()) return std::nullopt;
  const Source source(bytes, path);
  const ForkProgram program(layout);
  if (auto whole = WholeIn(source, program)) return whole;
  if (header.encoding.text)
    throw Error(
        ErrorKind::kNotPossible, path, "",
        "a text archive that is damaged is recovered as of ORB-SLAM3 v1.0 alone, not in a layout that is given");
  const std::vector<MapRecords> maps = layouts::FindRecords(TextOf(bytes), header.encoding);
  RecordReading reading = ReadIn(layout, source, header, PlacesOf(maps));
  if (!HasKeyFrames(reading.atlas))
    throw Error(ErrorKind::kDamaged, path, "",
                Concat("no keyframe is whole in the layout ", TitleOf(layout), " that is given"));
  reading.layout = NameFor(layout);
  reading.doubts = reading.meaning.doubts;
  return SalvageOf(std::move(reading), maps, TextOf(bytes), header);
}

}  // namespace slamdb::orbslam3
