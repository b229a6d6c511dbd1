// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>

#include "slamdb/formats/orbslam3/detail/fork.h"
#include "slamdb/formats/orbslam3/detail/fork_steps.h"
#include "slamdb/formats/orbslam3/detail/fork_values.h"
#include "slamdb/formats/orbslam3/detail/looks_whole.h"
#include "slamdb/formats/orbslam3/detail/pointers.h"
#include "slamdb/model/counters.h"

// How an atlas of a fork is read: one pass from front to back. Members that the model knows go through the same steps
// as those of v1.0; the others are packed.
namespace slamdb::orbslam3 {
namespace {

constexpr std::size_t kLeastKeyFrameBytes = 1024, kLeastPointBytes = 60;

template <class Input>
class ForkReader {
 public:
  ForkReader(detail::FileStream& file, const ArchiveHeader& header, const ForkProgram& program,
             const ReadOptions& options)
      : file_(file),
        program_(program),
        options_(options),
        main_(At(file, header), ClassTable(header.encoding), options.features) {
    atlas_.encoding = header.encoding;
  }

  ForkReading Read() {
    Members members(*this);
    for (const Op<Atlas>& op : program_.root) {
      main_.input.place = {.field = op.name.c_str()};
      if (op.kind == Op<Atlas>::Kind::kStep)
        (op.index == 0 ? atlas_.vocabulary.name : atlas_.vocabulary.checksum) = main_.input.TakeString();
      else if (op.kind == Op<Atlas>::Kind::kMaps)
        ReadAtlas(members);
      else
        members.Take(op, atlas_);
    }
    members.Give(atlas_.carried);
    GiveCameras();
    ForkReading reading;
    reading.left = main_.input.AtEnd() ? 0 : main_.input.remaining();
    reading.implausible = implausible_;
    reading.part_bytes = main_.part_bytes();
    reading.exported = std::move(exported_);
    Derive(reading.derived);
    reading.atlas = std::move(atlas_);
    return reading;
  }

  // Of a damaged archive: records one by one.
  ForkRecords ReadRecords(std::span<const MapPlaces> places, RecordUse use) {
    all_met_.MeetAllBut(WireClass::kCount);
    use_ = use;
    ForkRecords records;
    for (const MapPlaces& of : places) {
      map_ = static_cast<std::uint32_t>(atlas_.maps.size());
      Map& map = atlas_.maps.emplace_back();
      map.id = MapId(map_);
      MapPlaces& readable = records.readable.emplace_back();
      ReadList(program_.keyframe, of.keyframes, WireClass::kKeyFrame, map.keyframes, readable.keyframes);
      ReadList(program_.point, of.points, WireClass::kMapPoint, map.points, readable.points);
    }
    records.atlas = std::move(atlas_);
    return records;
  }

 private:
  // ---- Records by themselves

  template <class Entity>
  void ReadList(const Program<Entity>& program, std::span<const RecordPlace> places, WireClass wire_class,
                Column<Entity>& list, std::vector<RecordPlace>& readable) {
    for (const RecordPlace& place : places)
      if (ReadRecord(program, place, wire_class, list) || place.end == 0) readable.push_back(place);
  }

  // A record that brings classes is read with what the table was in front of the first of all, or without one class.
  template <class Entity>
  bool ReadRecord(const Program<Entity>& program, const RecordPlace& place, WireClass wire_class,
                  Column<Entity>& list) {
    if (TryRecord(program, place, all_met_, list)) {
      if (!behind_first_) behind_first_ = all_met_;
      return true;
    }
    const ClassTable asked = main_.classes;  // without a class that was not asked for nothing is different
    if (behind_first_ != all_met_) {
      ClassTable first = behind_first_.value_or(ClassTable(main_.input.encoding()));
      first.FirstUse(wire_class);
      if (TryRecord(program, place, first, list)) {
        behind_first_ = main_.classes;
        return true;
      }
    }
    for (std::size_t slot = 0; slot < kMostWireClasses; ++slot) {
      const auto left_out = static_cast<WireClass>(slot);
      if (left_out == WireClass::kCount || !asked.Used(left_out)) continue;
      ClassTable all_but(main_.input.encoding());
      all_but.MeetAllBut(left_out);
      if (TryRecord(program, place, all_but, list)) return true;
    }
    return false;
  }

  template <class Entity>
  bool TryRecord(const Program<Entity>& program, const RecordPlace& place, const ClassTable& classes,
                 Column<Entity>& list) {
    main_.classes = classes;
    main_.input.Seek(place.begin);
    main_.KeepIndexes(use_ == RecordUse::kAtlas || place.end == 0);  // by which the last one looks whole
    try {
      Members members(*this);
      Entity entity;
      Run(program, entity, members);
      if (place.end == 0 ? !LooksWhole(entity) : main_.input.offset() != place.end) return false;
      members.Give(entity.carried);
      list.push_back(std::move(entity));
      return true;
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kDamaged && error.kind() != ErrorKind::kUnsupported) throw;
      return false;
    }
  }

  // What is packed of one entity.
  class Members {
   public:
    explicit Members(ForkReader& reader) : reader_(reader) {}

    template <class Entity>
    void Take(const Op<Entity>& op, Entity& entity) {
      reader_.main_.input.place.field = op.name.c_str();
      const std::size_t begin = bytes_.bytes().size();
      const auto pointers = [this](const TypeNode& node, ByteWriter& out) { reader_.ReadPointer(node, out); };
      ValueReader values(reader_.main_, bytes_, pointers);
      for (const TypeNode& node : op.nodes) values.Read(node);
      if (op.conversion && !op.conversion->Decode(bytes_.bytes().subspan(begin), entity)) ++reader_.implausible_;
    }
    void Give(Boxed<Carried>& carried) {
      const Bytes bytes = bytes_.bytes();
      if (!bytes.empty()) carried.Make().members.assign(bytes.begin(), bytes.end());
      bytes_.Clear();
    }

   private:
    ForkReader& reader_;
    ByteWriter bytes_;
  };

  static Input At(detail::FileStream& file, const ArchiveHeader& header) {
    Input input(&file, header.encoding);
    input.Seek(header.bytes);
    return input;
  }

  // Runs the program of an entity.
  template <class Entity>
  void Run(const Program<Entity>& program, Entity& entity, Members& members) {
    auto& of_steps = StepEntity(entity);
    using StepsOf = std::remove_reference_t<decltype(of_steps)>;
    const auto& steps = StepTable<Decoder<Input>, StepsOf>::Steps();
    Part part = Part::kOther;
    for (const Op<Entity>& op : program) {
      switch (op.kind) {
        case Op<Entity>::Kind::kStep: {
          const auto& step = steps[op.index];
          if (step.part != part) main_.Begin(part = step.part);
          step.run(main_, step.name, of_steps);
          break;
        }
        case Op<Entity>::Kind::kCarried:
          members.Take(op, entity);
          break;
        case Op<Entity>::Kind::kClassInfo:
          main_.ClassInfo(op.wire_class);
          break;
        default:
          RunPart(op, entity, members);
      }
    }
    main_.Begin(Part::kOther);
  }
  void RunPart(const Op<KeyFrame>&, KeyFrame& keyframe, Members& members) {
    Run(program_.preintegration, keyframe.preintegration, members);
  }
  void RunPart(const Op<Atlas>& op, Atlas&, Members&) {
    op.kind == Op<Atlas>::Kind::kMaps ? ReadMaps(op) : ReadCameras(op);
  }
  void RunPart(const Op<Map>& op, Map& map, Members&) {
    op.kind == Op<Map>::Kind::kKeyFrames ? ReadKeyFrames(op, map) : ReadPoints(op, map);
    main_.input.place.entity = nullptr;
  }
  template <class Entity>
  void RunPart(const Op<Entity>&, Entity&, Members&) {}

  // A pointer to an object of the class `expected`.
  Pointer TakePointer(WireClass expected) { return orbslam3::TakePointer(main_, objects_, {expected}); }

  void ReadAtlas(Members& members) {
    if (TakePointer(WireClass::kAtlas).kind != Pointer::Kind::kNew)
      main_.input.Fail("expected an atlas, found a null pointer: nothing was saved");
    objects_.Add(WireClass::kAtlas, 0, 0);
    for (const WireClass registered : program_.registered) main_.classes.Register(registered);
    Run(program_.atlas, atlas_, members);
  }

  void ReadMaps(const Op<Atlas>& op) {
    main_.input.place.field = "mvpBackupMaps";
    const std::uint64_t count = main_.ClassCount(op.wire_class, 2, 1);
    for (std::uint64_t position = 0; position < count; ++position) {
      main_.input.place = {.map = static_cast<std::int64_t>(position)};
      const Pointer pointer = TakePointer(WireClass::kMap);
      if (pointer.kind != Pointer::Kind::kNew) {
        atlas_.repeated_maps.push_back(Repeated(main_, objects_, pointer, position));
        continue;
      }
      map_ = static_cast<std::uint32_t>(atlas_.maps.size());
      objects_.Add(WireClass::kMap, 0, map_);
      Map& map = atlas_.maps.emplace_back();
      Members members(*this);
      Run(program_.map, map, members);
      members.Give(map.carried);
    }
    main_.input.place = {};
  }

  template <class Entity>
  void ReadList(const Op<Map>& op, const char* entity, WireClass wire_class, std::size_t least,
                const Program<Entity>& program, Column<Entity>& list, std::vector<RepeatedEntry>& repeated) {
    main_.input.place.field = op.name.c_str();
    const std::uint64_t count = main_.ClassCount(op.wire_class, 2, 1);
    list.reserve(std::min<std::uint64_t>(count, main_.input.remaining() / least));
    Members members(*this);
    for (std::uint64_t position = 0; position < count; ++position) {
      main_.input.place = {
          .map = main_.input.place.map, .entity = entity, .ordinal = position, .of = count, .field = op.name.c_str()};
      const Pointer pointer = TakePointer(wire_class);
      if (pointer.kind != Pointer::Kind::kNew) {
        repeated.push_back(Repeated(main_, objects_, pointer, position));
        continue;
      }
      objects_.Add(wire_class, map_, list.size());
      Entity& read = list.emplace_back();
      Run(program, read, members);
      members.Give(read.carried);
      if (position % 256 == 0) Report();
    }
  }
  void ReadKeyFrames(const Op<Map>& op, Map& map) {
    ReadList(op, "kf", WireClass::kKeyFrame, kLeastKeyFrameBytes, program_.keyframe, map.keyframes,
             map.repeated_keyframes);
  }
  void ReadPoints(const Op<Map>& op, Map& map) {
    ReadList(op, "mp", WireClass::kMapPoint, kLeastPointBytes, program_.point, map.points, map.repeated_points);
  }

  // ---- cameras, which any object may bring

  // A pointer to a camera; a new one is read. `declared` is kCount when that is abstract.
  Pointer TakeCamera(WireClass declared) {
    if (declared != WireClass::kCount) main_.classes.Register(declared);
    const auto class_id = main_.input.template Take<std::int16_t>();
    if (class_id == -1) return {Pointer::Kind::kNull};
    WireClass found = main_.classes.Find(class_id);
    if (found == WireClass::kCount && class_id == main_.classes.next()) found = TakeExported();
    const CameraClass* camera = program_.FindCamera(found);
    if (camera == nullptr)
      main_.input.Fail("class id " + std::to_string(class_id) +
                       " where a camera is expected: the file is damaged, or of another layout");
    if (!camera->model)
      main_.input.Fail("a camera of class " + camera->name +
                           ", which slamdb does not have; it has Pinhole, KannalaBrandt8 and Equirectangular",
                       ErrorKind::kUnsupported);
    main_.TakeClassInfo(found, /*tracking=*/1);
    const auto object = main_.input.template Take<std::uint32_t>();
    if (object > objects_.next())
      main_.input.Fail("object id " + std::to_string(object) + ", expected at most " + std::to_string(objects_.next()) +
                       ": the file is damaged");
    if (object < objects_.next()) return {Pointer::Kind::kKnown, found, object};
    objects_.Add(found, 0, cameras_.size());
    cameras_.emplace_back();
    listed_.push_back(kNotListed);
    Camera read{.model = *camera->model};
    Members members(*this);
    Run(camera->program, read, members);
    members.Give(read.carried);
    cameras_.back() = std::move(read);
    return {Pointer::Kind::kNew, found, object};
  }
  // The key of a class that nobody registered, which stands in front of its first object.
  WireClass TakeExported() {
    constexpr std::size_t kLongest = 256;
    const std::string key = main_.input.TakeString();
    const CameraClass* camera = key.size() > kLongest ? nullptr : program_.FindExported(key);
    if (camera == nullptr) main_.input.Fail("an object of a class that the layout does not have");
    if (key != camera->name) exported_[camera->name] = key;
    main_.classes.Register(camera->wire_class);
    return camera->wire_class;
  }
  // Which camera a pointer is about: a row of cameras_.
  std::size_t RowOf(const Pointer& pointer) const {
    const ObjectRange& range = objects_.Find(pointer.object);
    if (program_.FindCamera(range.wire_class) == nullptr)
      main_.input.Fail("a pointer to object " + std::to_string(pointer.object) +
                       ", which is no camera: the file is damaged");
    return range.first_row + (pointer.object - range.first);
  }

  void ReadCameras(const Op<Atlas>& op) {
    main_.input.place.field = "mvpCameras";
    const std::uint64_t count = main_.ClassCount(op.wire_class, 2, 1);
    for (std::uint64_t position = 0; position < count; ++position) {
      const Pointer pointer = TakeCamera(op.element_class);
      if (pointer.kind == Pointer::Kind::kNull) {
        atlas_.repeated_cameras.push_back({.position = position});
        continue;
      }
      std::size_t& listed = listed_[RowOf(pointer)];
      if (listed != kNotListed) {
        atlas_.repeated_cameras.push_back({position, 0, listed});
        continue;
      }
      listed = order_.size();
      order_.push_back(RowOf(pointer));
    }
  }
  // The atlas has cameras in the order of its list; those that only others point to come behind.
  void GiveCameras() {
    for (std::size_t row = 0; row < cameras_.size(); ++row)
      if (listed_[row] == kNotListed) order_.push_back(row);
    for (const std::size_t row : order_) atlas_.cameras.push_back(std::move(cameras_[row]));
  }

  // ---- pointers among carried members

  void ReadPointer(const TypeNode& node, ByteWriter& out) {
    if (node.to_camera) {
      const Pointer pointer = TakeCamera(node.wire_class);
      if (pointer.kind == Pointer::Kind::kNull) return out.Put(PackedPointer::kNull);
      return PutEntity(3, cameras_[RowOf(pointer)].id.value(), out);
    }
    const Pointer pointer = TakePointer(node.wire_class);
    if (pointer.kind == Pointer::Kind::kNull) return out.Put(PackedPointer::kNull);
    if (node.children.empty()) return ReadEntityPointer(pointer, out);
    if (pointer.kind == Pointer::Kind::kNew) objects_.Add(pointer.wire_class, 0, others_++);
    const ObjectRange& range = objects_.Find(pointer.object);
    if (range.wire_class != pointer.wire_class) main_.input.Fail("a pointer to an object of another class");
    out.Put(PackedPointer::kObject);
    out.Put(static_cast<std::uint32_t>(range.first_row + (pointer.object - range.first)));
    out.Put(static_cast<std::uint8_t>(pointer.kind == Pointer::Kind::kNew));
    if (pointer.kind != Pointer::Kind::kNew) return;
    const auto pointers = [this](const TypeNode& inner, ByteWriter& to) { ReadPointer(inner, to); };
    ValueReader(main_, out, pointers).Read(node.children[0]);
  }
  static void PutEntity(std::uint8_t kind, std::uint64_t id, ByteWriter& out) {
    out.Put(PackedPointer::kEntity);
    out.Put(kind);
    out.Put(id);
  }
  // Maps, keyframes and points are in their lists before others point to them.
  void ReadEntityPointer(const Pointer& pointer, ByteWriter& out) {
    if (pointer.kind == Pointer::Kind::kNew)
      main_.input.Fail("an object in the middle of another one: objects that hold each other are not read",
                       ErrorKind::kUnsupported);
    const ObjectRange& range = objects_.Find(pointer.object);
    const std::uint64_t row = range.first_row + (pointer.object - range.first);
    const auto& maps = atlas_.maps;
    if (range.wire_class == WireClass::kMap && row < maps.size()) return PutEntity(0, maps[row].id.value(), out);
    const bool has_map = range.map < maps.size();
    if (range.wire_class == WireClass::kKeyFrame && has_map && row < maps[range.map].keyframes.size())
      return PutEntity(1, maps[range.map].keyframes[row].id.value(), out);
    if (range.wire_class == WireClass::kMapPoint && has_map && row < maps[range.map].points.size())
      return PutEntity(2, maps[range.map].points[row].id.value(), out);
    main_.input.Fail("a pointer to an object of another class: the file is damaged");
  }

  // What the layout lacks and ORB-SLAM3 needs, as far as it follows from the rest.
  void Derive(std::vector<std::string>& derived) {
    if (program_.Lacks("Atlas.KeyFrame::nNextId") && RaiseCounters(atlas_) > 0)
      derived.emplace_back("the next ids, from the largest ids");
    if (program_.lacks_stereo) derived.emplace_back("stereo matches: none");
    if (program_.lacks_origins) derived.emplace_back("the maps that keyframes were made in: the one that they are in");
    for (Map& map : atlas_.maps)
      for (KeyFrame& keyframe : map.keyframes) DeriveLacking(program_, map, options_.features, keyframe);
  }

  void Report() {
    main_.input.stream().Release(main_.input.offset());
    if (options_.progress)
      options_.progress("reading " + file_.path(),
                        static_cast<double>(main_.input.offset()) / static_cast<double>(file_.size()));
  }

  static constexpr std::size_t kNotListed = static_cast<std::size_t>(-1);

  detail::FileStream& file_;
  const ForkProgram& program_;
  const ReadOptions& options_;
  Atlas atlas_;
  std::uint32_t map_ = 0;  // the row of the one that is read
  ObjectTable objects_;
  Decoder<Input> main_;
  std::vector<Camera> cameras_;      // as they were met
  std::vector<std::size_t> listed_;  // where in the atlas's list each of them is
  std::vector<std::size_t> order_;   // which of them that list has
  std::map<std::string, std::string> exported_;
  std::uint64_t others_ = 0;  // objects that are no entities
  std::uint64_t implausible_ = 0;
  RecordUse use_ = RecordUse::kAtlas;
  ClassTable all_met_{main_.input.encoding()};
  std::optional<ClassTable> behind_first_;  // behind the first record
};

}  // namespace

void DeriveLacking(const ForkProgram& program, const Map& map, FeatureColumns columns, KeyFrame& keyframe) {
  if (program.lacks_stereo && columns != FeatureColumns::kNone) {
    keyframe.features.right_x.assign(keyframe.features.keypoints.size(), -1.0F);
    keyframe.features.depth.assign(keyframe.features.keypoints.size(), -1.0F);
  }
  if (program.lacks_origins) keyframe.origin_map = static_cast<std::uint32_t>(map.id.value());
}

ForkReading ReadFork(detail::FileStream& file, const ArchiveHeader& header, const ForkProgram& program,
                     const ReadOptions& options) {
  if (header.encoding.text) return ForkReader<TextInput>(file, header, program, options).Read();
  return ForkReader<BinaryInput>(file, header, program, options).Read();
}

ForkRecords ReadForkRecords(detail::FileStream& file, const ArchiveHeader& header, const ForkProgram& program,
                            std::span<const MapPlaces> maps, RecordUse use) {
  return ForkReader<BinaryInput>(file, header, program, {}).ReadRecords(maps, use);
}

}  // namespace slamdb::orbslam3
