// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <boost/serialization/base_object.hpp>
#include <deque>
#include <new>
#include <tuple>
#include <vector>

#include "slamdb/boost/members.h"

// ORB-SLAM3's atlas is a graph of pointers, and Boost numbers the objects that pointers lead to. The model holds
// values. So each value has an entry here, a small object whose address Boost tracks in its place: Boost archives lists
// of pointers to entries as the lists of pointers that ORB-SLAM3 has, with the repeated and the null ones.
namespace slamdb::boost_archive {

// Stands for a Record.
template <class Record>
struct Entry {
  Record* record = nullptr;

  static void operator delete(void*) {}  // Objects frees what Boost makes
};

// GeometricCamera. Abstract as there: a concrete base would be archived differently.
struct CameraEntry {
  Camera* record = nullptr;

  CameraEntry() = default;
  CameraEntry(const CameraEntry&) = delete;
  CameraEntry& operator=(const CameraEntry&) = delete;
  virtual ~CameraEntry() = default;
  virtual CameraModel model() const = 0;

  static void operator delete(void*) {}
};

// Pinhole and KannalaBrandt8.
template <CameraModel kModel>
struct CameraEntryOf final : CameraEntry {
  CameraModel model() const override { return kModel; }
};
using PinholeEntry = CameraEntryOf<CameraModel::kPinhole>;
using KannalaBrandt8Entry = CameraEntryOf<CameraModel::kKannalaBrandt8>;

// The entries of a map by row.
struct MapEntries {
  std::vector<Entry<KeyFrame>*> keyframes;
  std::vector<Entry<MapPoint>*> points;
};

// The entries of an atlas by row. A map that is archived alone is map 0 of one.
struct AtlasEntries {
  Atlas* target = nullptr;        // loading: where the atlas goes
  Entry<Atlas>* atlas = nullptr;  // loading: its entry, once it begins
  Map* map = nullptr;             // whose lists are being archived
  std::vector<MapEntries> lists;  // of the maps so far
  std::vector<Entry<Map>*> maps;
  std::vector<CameraEntry*> cameras;
};

// The entries of one archive. Lives as long as the archive, which compares the addresses of objects long done.
class Objects {
 public:
  Objects() = default;
  Objects(const Objects&) = delete;
  Objects& operator=(const Objects&) = delete;
  ~Objects() {
    for (void* block : loaded_) ::operator delete(block);
  }

  // Of the atlas, or map alone, that is being archived.
  AtlasEntries& Begin() { return atlases_.emplace_back(); }
  AtlasEntries& current() {
    if (atlases_.empty()) FailLoading("an object outside of an atlas");
    return atlases_.back();
  }

  // Saving: makes the entry of a record.
  template <class Record>
  Entry<Record>* Add(Record& record) {
    return &std::get<std::deque<Entry<Record>>>(saved_).emplace_back(Entry<Record>{&record});
  }
  CameraEntry* Add(Camera& camera) {
    CameraEntry* entry = nullptr;
    if (camera.model == CameraModel::kPinhole)
      entry = &std::get<std::deque<PinholeEntry>>(saved_).emplace_back();
    else
      entry = &std::get<std::deque<KannalaBrandt8Entry>>(saved_).emplace_back();
    entry->record = &camera;
    return entry;
  }

  // Loading: takes over an entry that Boost has made.
  template <class Record>
  void Own(Entry<Record>* entry) {
    loaded_.push_back(entry);
  }
  template <CameraModel kModel>
  void Own(CameraEntryOf<kModel>* entry) {
    loaded_.push_back(entry);
    loaded_cameras_.push_back(entry);
    entry->record = &cameras_.emplace_back();
    entry->record->model = kModel;
  }
  // What Boost gives for a pointer can be an object of another class, when the archive is damaged.
  const Camera& Loaded(const CameraEntry* entry) const {
    const auto newest_first = std::find(loaded_cameras_.rbegin(), loaded_cameras_.rend(), entry);
    if (newest_first == loaded_cameras_.rend()) FailLoading("a pointer to no camera");
    return *entry->record;
  }

 private:
  std::deque<AtlasEntries> atlases_;
  std::tuple<std::deque<Entry<Atlas>>, std::deque<Entry<Map>>, std::deque<Entry<KeyFrame>>, std::deque<Entry<MapPoint>>,
             std::deque<PinholeEntry>, std::deque<KannalaBrandt8Entry>>
      saved_;
  std::vector<void*> loaded_;
  std::vector<const CameraEntry*> loaded_cameras_;
  std::deque<Camera> cameras_;  // of the loaded entries
};

template <class Archive>
Objects& ObjectsOf(Archive& archive) {
  static char id;
  return archive.template get_helper<Objects>(&id);
}

// ---- lists of pointers

// The rows that a list may point at: those of the lists of its kind up to it, which is the last.
template <class EntryType>
using Owners = std::vector<const std::vector<EntryType*>*>;

// Saving: the list of pointers that the rows and the irregular entries make.
template <class EntryType>
std::vector<EntryType*> Listed(const Owners<EntryType>& owners, const std::vector<RepeatedEntry>& repeated) {
  const std::vector<EntryType*>& rows = *owners.back();
  std::vector<EntryType*> list;
  list.reserve(rows.size() + repeated.size());
  std::size_t next = 0;
  for (const RepeatedEntry& entry : repeated) {
    while (next < rows.size() && list.size() < entry.position) list.push_back(rows[next++]);
    if (entry.owner_map == RepeatedEntry::kNull) {
      list.push_back(nullptr);
      continue;
    }
    const std::size_t owner = entry.owner_map;
    if (owner >= owners.size() || entry.row >= (owner + 1 == owners.size() ? next : owners[owner]->size()))
      throw Error(ErrorKind::kUsage, "a repeated list entry refers to nothing that stands before it");
    list.push_back((*owners[owner])[entry.row]);
  }
  list.insert(list.end(), rows.begin() + static_cast<std::ptrdiff_t>(next), rows.end());
  return list;
}

// Loading: the irregular entries of a list of pointers.
template <class EntryType>
std::vector<RepeatedEntry> Irregular(const Owners<EntryType>& owners, const std::vector<EntryType*>& list) {
  std::vector<RepeatedEntry> repeated;
  std::size_t next = 0;
  for (std::size_t position = 0; position < list.size(); ++position) {
    if (next < owners.back()->size() && list[position] == (*owners.back())[next]) {
      ++next;
      continue;
    }
    RepeatedEntry& entry = repeated.emplace_back(RepeatedEntry{.position = position});
    if (list[position] == nullptr) continue;
    for (std::size_t owner = 0; owner < owners.size(); ++owner) {
      const auto row = std::ranges::find(*owners[owner], list[position]);
      if (row == owners[owner]->end()) continue;
      entry.owner_map = static_cast<std::uint32_t>(owner);
      entry.row = static_cast<std::uint64_t>(row - owners[owner]->begin());
    }
    if (entry.owner_map == RepeatedEntry::kNull) FailLoading("a pointer to an object of another class");
  }
  return repeated;
}

template <class Archive, class EntryType>
void List(Archive& archive, const Owners<EntryType>& owners, std::vector<RepeatedEntry>& repeated) {
  std::vector<EntryType*> list;
  if constexpr (Archive::is_saving::value) list = Listed(owners, repeated);
  archive& list;
  if constexpr (Archive::is_loading::value) repeated = Irregular(owners, list);
}

// The list of one kind of a map, behind those of the maps before it.
template <class Archive, class Record>
void MapList(Archive& archive, AtlasEntries& entries, std::vector<Entry<Record>*> MapEntries::*kind,
             Column<Record>& records, std::vector<RepeatedEntry>& repeated) {
  if constexpr (Archive::is_saving::value) {
    Objects& objects = ObjectsOf(archive);
    for (Record& record : records) (entries.lists.back().*kind).push_back(objects.Add(record));
  }
  Owners<Entry<Record>> owners;
  for (const MapEntries& lists : entries.lists) owners.push_back(&(lists.*kind));
  List<Archive, Entry<Record>>(archive, owners, repeated);
}

// ---- classes

template <class Archive>
void MapMembers(Archive& archive, Map& map, AtlasEntries& entries) {
  if (entries.map != nullptr) FailLoading("a map in a list of another kind");
  entries.map = &map;
  entries.lists.emplace_back();
  MembersInFront(archive, map);
  MapList(archive, entries, &MapEntries::keyframes, map.keyframes, map.repeated_keyframes);
  MapList(archive, entries, &MapEntries::points, map.points, map.repeated_points);
  MembersBehind(archive, map);
  entries.map = nullptr;
}

// Loading: the row that a new entry of a list begins. It may not move until the entry is read.
inline Map& NewRow(Entry<Map>& entry, AtlasEntries& entries) {
  if (entries.target == nullptr || entries.map != nullptr) FailLoading("a map in a list of another kind");
  entries.maps.push_back(&entry);
  return entries.target->maps.emplace_back();
}
inline KeyFrame& NewRow(Entry<KeyFrame>& entry, AtlasEntries& entries) {
  if (entries.map == nullptr) FailLoading("a keyframe in a list of another kind");
  entries.lists.back().keyframes.push_back(&entry);
  return entries.map->keyframes.emplace_back();
}
inline MapPoint& NewRow(Entry<MapPoint>& entry, AtlasEntries& entries) {
  if (entries.map == nullptr) FailLoading("a map point in a list of another kind");
  entries.lists.back().points.push_back(&entry);
  return entries.map->points.emplace_back();
}

template <class Archive, class Record>
void serialize(Archive& archive, Entry<Record>& entry, const unsigned int version) {
  RequireVersion(version);
  AtlasEntries* entries = nullptr;
  if constexpr (Archive::is_loading::value || std::is_same_v<Record, Map>) entries = &ObjectsOf(archive).current();
  if constexpr (Archive::is_loading::value) entry.record = &NewRow(entry, *entries);
  if constexpr (std::is_same_v<Record, Map>)
    MapMembers(archive, *entry.record, *entries);
  else
    Members(archive, *entry.record);
}

template <class Archive>
void serialize(Archive& archive, CameraEntry& entry, const unsigned int /*version*/) {
  Camera& camera = *entry.record;
  AsNumber<unsigned int>(archive, camera.id);
  archive& camera.recorded_type;
  AsVector<float>(archive, camera.parameters);
}

template <class Archive, CameraModel kModel>
void serialize(Archive& archive, CameraEntryOf<kModel>& entry, const unsigned int version) {
  RequireVersion(version);
  archive& boost::serialization::base_object<CameraEntry>(entry);
  if constexpr (kModel == CameraModel::kKannalaBrandt8) archive& entry.record->precision;
}

// The classes that a pointer to a camera may lead to, in ORB-SLAM3's order.
template <class Archive>
void RegisterCameras(Archive& archive) {
  archive.template register_type<PinholeEntry>();
  archive.template register_type<KannalaBrandt8Entry>();
}

template <class Archive>
void CameraList(Archive& archive, Atlas& atlas, AtlasEntries& entries) {
  std::vector<CameraEntry*> list;
  if constexpr (Archive::is_saving::value) {
    for (Camera& camera : atlas.cameras) entries.cameras.push_back(ObjectsOf(archive).Add(camera));
    list = Listed<CameraEntry>({&entries.cameras}, atlas.repeated_cameras);
  }
  archive& list;
  if constexpr (Archive::is_loading::value) {
    for (CameraEntry* entry : list) {
      if (entry == nullptr || std::ranges::find(entries.cameras, entry) != entries.cameras.end()) continue;
      atlas.cameras.push_back(ObjectsOf(archive).Loaded(entry));
      entries.cameras.push_back(entry);
    }
    atlas.repeated_cameras = Irregular<CameraEntry>({&entries.cameras}, list);
  }
}

template <class Archive>
void serialize(Archive& archive, Entry<Atlas>& entry, const unsigned int version) {
  RequireVersion(version);
  Objects& objects = ObjectsOf(archive);
  AtlasEntries& entries = objects.current();
  if constexpr (Archive::is_loading::value) {
    if (entries.target == nullptr || entries.atlas != nullptr) FailLoading("an atlas in a list of another kind");
    entries.atlas = &entry;
    entry.record = entries.target;
  }
  Atlas& atlas = *entry.record;
  RegisterCameras(archive);
  if constexpr (Archive::is_saving::value)
    for (Map& map : atlas.maps) entries.maps.push_back(objects.Add(map));
  List<Archive, Entry<Map>>(archive, {&entries.maps}, atlas.repeated_maps);
  CameraList(archive, atlas, entries);
  Members(archive, atlas.next_ids);
}

// Boost lets a class say how it makes the objects that pointers lead to.
template <class Archive, class Record>
void load_construct_data(Archive& archive, Entry<Record>* place, const unsigned int /*version*/) {
  ObjectsOf(archive).Own(::new (place) Entry<Record>());
}
template <class Archive, CameraModel kModel>
void load_construct_data(Archive& archive, CameraEntryOf<kModel>* place, const unsigned int /*version*/) {
  ObjectsOf(archive).Own(::new (place) CameraEntryOf<kModel>());
}

}  // namespace slamdb::boost_archive
