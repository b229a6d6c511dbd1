// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <optional>
#include <unordered_map>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/orbslam3/detail/fork.h"
#include "slamdb/formats/orbslam3/detail/fork_steps.h"
#include "slamdb/formats/orbslam3/detail/fork_values.h"

// How an atlas is written in a fork's layout: the mirror of fork_reader.cc. What a fork's file had and the model does
// not know comes from Carried::members; where there is none, it is zeros.
namespace slamdb::orbslam3 {
namespace {

using detail::Concat;

template <class Output>
class ForkWriter {
 public:
  ForkWriter(const Atlas& atlas, const ArchiveEncoding& encoding, const ForkProgram& program, bool carried_fits,
             const Target::Sink& write)
      : atlas_(atlas),
        program_(program),
        carried_fits_(carried_fits),
        write_(write),
        encoder_(Output(buffer_, encoding), ClassTable(encoding)),
        cameras_(atlas.cameras.size()) {}

  ForkWriting Write(const std::string& header) {
    encoder_.output.PutRaw(header);
    const std::string place = "Atlas";
    Members members(*this, atlas_.carried, place, done_.filled_others);
    for (const Op<Atlas>& op : program_.root) {
      if (op.kind == Op<Atlas>::Kind::kStep)
        encoder_.output.PutString(op.index == 0 ? atlas_.vocabulary.name : atlas_.vocabulary.checksum);
      else if (op.kind == Op<Atlas>::Kind::kMaps)
        WriteAtlas(members);
      else
        members.Put(op, atlas_);
    }
    members.Finish();
    encoder_.output.PutEnd();
    Flush(0);
    return done_;
  }

 private:
  // The carried members of one entity, taken one by one.
  class Members {
   public:
    Members(ForkWriter& writer, const Boxed<Carried>& carried, const std::string& place, std::uint64_t& filled)
        : writer_(writer),
          has_(writer.carried_fits_ && carried && !carried->members.empty()),
          in_(has_ ? Bytes(carried->members) : Bytes()),
          place_(place),
          filled_(filled) {}

    template <class Entity>
    void Put(const Op<Entity>& op, const Entity& entity) {
      try {
        PutOp(op, entity);
      } catch (const Error& error) {
        if (error.kind() != ErrorKind::kDamaged || !has_) throw;
        throw Error(ErrorKind::kDamaged, "", Concat(place_, ", ", op.name),
                    Concat("the carried members are not of this layout: ", error.problem()));
      }
    }
    void Finish() {
      if (in_.left() > 0)
        throw Error(ErrorKind::kDamaged, "", place_,
                    Concat("the carried members are not of this layout: ", in_.left(), " bytes are left over"));
      if (is_filled_) ++filled_;
    }

   private:
    template <class Entity>
    void PutOp(const Op<Entity>& op, const Entity& entity) {
      if (!has_) {
        scratch_.Clear();
        if (op.conversion)
          op.conversion->Encode(entity, scratch_);
        else
          for (const TypeNode& node : op.nodes) PutNothing(node, scratch_);
        is_filled_ = is_filled_ || !op.conversion;
        return PutPacked(op, scratch_.bytes());
      }
      const Bytes rest = in_.rest();
      for (const TypeNode& node : op.nodes) SkipPacked(node, in_);
      const Bytes raw = rest.first(rest.size() - in_.left());
      if (!op.conversion || StillSays(op, raw, entity)) return PutPacked(op, raw);
      scratch_.Clear();
      op.conversion->Encode(entity, scratch_);
      ++writer_.done_.encoded_anew;
      PutPacked(op, scratch_.bytes());
    }
    // Whether the bytes mean what the entity has.
    template <class Entity>
    static bool StillSays(const Op<Entity>& op, Bytes raw, const Entity& entity) {
      Entity read;
      op.conversion->Decode(raw, read);
      return op.conversion->Same(read, entity);
    }
    template <class Entity>
    void PutPacked(const Op<Entity>& op, Bytes packed) {
      ByteReader in(packed);
      const auto pointers = [this](const TypeNode& node, ByteReader& from) { writer_.PutPackedPointer(node, from); };
      ValueWriter values(writer_.encoder_, in, pointers);
      for (const TypeNode& node : op.nodes) values.Write(node);
    }

    ForkWriter& writer_;
    bool has_;
    ByteReader in_;
    const std::string& place_;
    std::uint64_t& filled_;
    bool is_filled_ = false;
    ByteWriter scratch_;
  };

  template <class Entity>
  void Run(const Program<Entity>& program, const Entity& entity, Members& members) {
    const auto& of_steps = StepEntity(entity);
    using StepsOf = std::remove_reference_t<decltype(of_steps)>;
    const auto& steps = StepTable<Encoder<Output>, StepsOf>::Steps();
    for (const Op<Entity>& op : program) {
      switch (op.kind) {
        case Op<Entity>::Kind::kStep:
          steps[op.index].run(encoder_, steps[op.index].name, of_steps);
          break;
        case Op<Entity>::Kind::kCarried:
          members.Put(op, entity);
          break;
        case Op<Entity>::Kind::kClassInfo:
          encoder_.ClassInfo(op.wire_class);
          break;
        default:
          RunPart(op, entity, members);
      }
    }
  }
  void RunPart(const Op<KeyFrame>&, const KeyFrame& keyframe, Members& members) {
    Run(program_.preintegration, keyframe.preintegration, members);
  }
  void RunPart(const Op<Atlas>& op, const Atlas&, Members&) {
    op.kind == Op<Atlas>::Kind::kMaps ? WriteMaps(op) : WriteCameras(op);
  }
  void RunPart(const Op<Map>& op, const Map& map, Members&) {
    if (op.kind == Op<Map>::Kind::kKeyFrames)
      WriteList(op, WireClass::kKeyFrame, program_.keyframe, map.keyframes, map.repeated_keyframes,
                objects_.back().keyframes, &MapObjects::keyframes, done_.filled_keyframes);
    else
      WriteList(op, WireClass::kMapPoint, program_.point, map.points, map.repeated_points, objects_.back().points,
                &MapObjects::points, done_.filled_points);
  }
  template <class Entity>
  void RunPart(const Op<Entity>&, const Entity&, Members&) {}

  void WriteAtlas(Members& members) {
    PutPointer(WireClass::kAtlas, next_object_++, true);
    for (const WireClass registered : program_.registered) encoder_.classes.Register(registered);
    Run(program_.atlas, atlas_, members);
  }

  // visit(row) for each row and again(entry) for each irregular entry, in the order of a list.
  template <class New, class Again>
  static void ForEachEntry(std::size_t rows, const std::vector<RepeatedEntry>& repeated, const New& visit,
                           const Again& again) {
    std::size_t row = 0, position = 0;
    for (const RepeatedEntry& entry : repeated) {
      for (; row < rows && position < entry.position; ++position) visit(row++);
      again(entry);
      ++position;
    }
    while (row < rows) visit(row++);
  }

  void WriteMaps(const Op<Atlas>& op) {
    encoder_.ClassCount(op.wire_class, atlas_.maps.size() + atlas_.repeated_maps.size());
    ForEachEntry(
        atlas_.maps.size(), atlas_.repeated_maps, [this](std::size_t row) { WriteMap(atlas_.maps[row]); },
        [this](const RepeatedEntry& entry) {
          if (entry.owner_map == RepeatedEntry::kNull) return PutNull(WireClass::kMap);
          if (entry.row >= objects_.size())
            throw Error(ErrorKind::kNotPossible, "a repeated map entry refers to no map before it");
          PutPointer(WireClass::kMap, objects_[entry.row].map, false);
        });
  }
  void WriteMap(const Map& map) {
    objects_.push_back({.map = next_object_++, .keyframes = {}, .points = {}});
    PutPointer(WireClass::kMap, objects_.back().map, true);
    const std::string place = ToString(map.id);
    Members members(*this, map.carried, place, done_.filled_others);
    Run(program_.map, map, members);
    members.Finish();
  }

  struct MapObjects {
    std::uint32_t map = 0;  // object ids
    std::vector<std::uint32_t> keyframes, points;
  };

  template <class Entity>
  void WriteList(const Op<Map>& op, WireClass wire_class, const Program<Entity>& program, const Column<Entity>& list,
                 const std::vector<RepeatedEntry>& repeated, std::vector<std::uint32_t>& objects,
                 std::vector<std::uint32_t> MapObjects::*of_map, std::uint64_t& filled) {
    encoder_.ClassCount(op.wire_class, list.size() + repeated.size());
    std::string place;
    ForEachEntry(
        list.size(), repeated,
        [&](std::size_t row) {
          const Entity& entity = list[row];
          objects.push_back(next_object_++);
          PutPointer(wire_class, objects.back(), true);
          if (entity.carried) place = ToString(entity.id);
          Members members(*this, entity.carried, place, filled);
          Run(program, entity, members);
          members.Finish();
          Flush(kFlushBytes);
        },
        [&](const RepeatedEntry& entry) {
          if (entry.owner_map == RepeatedEntry::kNull) return PutNull(wire_class);
          const bool known =
              entry.owner_map < objects_.size() && entry.row < (objects_[entry.owner_map].*of_map).size();
          if (!known) throw Error(ErrorKind::kNotPossible, "a repeated list entry refers to nothing before it");
          PutPointer(wire_class, (objects_[entry.owner_map].*of_map)[entry.row], false);
        });
  }

  // ---- pointers

  void PutNull(WireClass declared) {
    if (declared != WireClass::kCount) encoder_.classes.Register(declared);
    encoder_.output.Put(std::int16_t{-1});
  }
  void PutPointer(WireClass wire_class, std::uint32_t object, bool is_new) {
    encoder_.output.Put(encoder_.classes.Register(wire_class));
    encoder_.PutClassInfo(wire_class, /*tracking=*/1);
    encoder_.output.PutObjectId(object, is_new);
  }
  // A camera where it is met first, a pointer to it later.
  void PutCamera(WireClass declared, std::size_t row) {
    if (declared != WireClass::kCount) encoder_.classes.Register(declared);
    const Camera& camera = atlas_.cameras[row];
    const CameraClass* of = program_.FindCamera(camera.model);
    if (of == nullptr)
      throw Error(ErrorKind::kNotPossible, "", ToString(camera.id),
                  Concat("the layout has no class for a camera of its kind"));
    const bool is_new = !cameras_[row];
    if (is_new) cameras_[row] = next_object_++;
    if (!encoder_.classes.Has(of->wire_class)) {
      const LayoutClass& exported = *program_.layout.Find(of->name);
      encoder_.output.Put(encoder_.classes.Register(of->wire_class));
      encoder_.output.PutString(exported.exported.empty() ? of->name : exported.exported);
      encoder_.PutClassInfo(of->wire_class, /*tracking=*/1);
      encoder_.output.PutObjectId(*cameras_[row], true);
    } else {
      PutPointer(of->wire_class, *cameras_[row], is_new);
    }
    if (!is_new) return;
    const std::string place = ToString(camera.id);
    Members members(*this, camera.carried, place, done_.filled_others);
    Run(of->program, camera, members);
    members.Finish();
  }
  void WriteCameras(const Op<Atlas>& op) {
    encoder_.ClassCount(op.wire_class, atlas_.cameras.size() + atlas_.repeated_cameras.size());
    ForEachEntry(
        atlas_.cameras.size(), atlas_.repeated_cameras, [&](std::size_t row) { PutCamera(op.element_class, row); },
        [&](const RepeatedEntry& entry) {
          if (entry.owner_map == RepeatedEntry::kNull) return PutNull(op.element_class);
          if (entry.row >= cameras_.size())
            throw Error(ErrorKind::kNotPossible, "a repeated camera entry refers to no camera");
          PutCamera(op.element_class, entry.row);
        });
  }

  void PutPackedPointer(const TypeNode& node, ByteReader& in) {
    const auto kind = static_cast<PackedPointer>(in.Get<std::uint8_t>());
    if (kind == PackedPointer::kNull) return PutNull(node.wire_class);
    if (kind == PackedPointer::kEntity) {
      const auto of = in.Get<std::uint8_t>();
      return PutEntity(node, of, in.Get<std::uint64_t>());
    }
    if (kind != PackedPointer::kObject || node.children.empty())
      throw Error(ErrorKind::kDamaged, "a pointer to an object of another kind");
    const auto number = in.Get<std::uint32_t>();
    const bool follows = in.Get<std::uint8_t>() != 0;
    const auto [known, is_new] = others_.try_emplace(number, next_object_);
    if (is_new && !follows) {  // what held its members is gone
      others_.erase(known);
      ++done_.dropped_pointers;
      return PutNull(node.wire_class);
    }
    if (!is_new && follows) throw Error(ErrorKind::kDamaged, "an object that stands there twice");
    next_object_ += is_new;
    PutPointer(node.wire_class, known->second, is_new);
    if (!follows) return;
    const auto pointers = [this](const TypeNode& inner, ByteReader& from) { PutPackedPointer(inner, from); };
    ValueWriter(encoder_, in, pointers).Write(node.children[0]);
  }
  // A pointer to an entity by its id; null where that is gone, or not written yet.
  void PutEntity(const TypeNode& node, std::uint8_t kind, std::uint64_t id) {
    if (kind != KindOf(node)) throw Error(ErrorKind::kDamaged, "a pointer to an entity of another kind");
    if (node.to_camera) {
      const auto found = std::ranges::find(atlas_.cameras, CameraId(id), &Camera::id);
      if (found != atlas_.cameras.end())
        return PutCamera(node.wire_class, static_cast<std::size_t>(found - atlas_.cameras.begin()));
    } else if (const auto object = FindObject(kind, id)) {
      return PutPointer(node.wire_class, *object, false);
    }
    ++done_.dropped_pointers;
    PutNull(node.wire_class);
  }
  // As PackedPointer::kEntity numbers them; none for pointers to anything else.
  static std::optional<std::uint8_t> KindOf(const TypeNode& node) {
    if (node.to_camera) return std::uint8_t{3};
    constexpr std::array<std::string_view, 3> kKinds{"Map", "KeyFrame", "MapPoint"};
    const auto found = std::ranges::find(kKinds, node.class_name);
    if (found == kKinds.end()) return std::nullopt;
    return static_cast<std::uint8_t>(found - kKinds.begin());
  }
  // Linear, for the few layouts that have such pointers.
  std::optional<std::uint32_t> FindObject(std::uint8_t kind, std::uint64_t id) const {
    for (std::size_t row = 0; row < objects_.size(); ++row) {
      const Map& map = atlas_.maps[row];
      if (kind == 0 && map.id.value() == id) return objects_[row].map;
      const auto in = [&](const auto& list, const std::vector<std::uint32_t>& objects) -> std::optional<std::uint32_t> {
        for (std::size_t i = 0; i < objects.size(); ++i)
          if (list[i].id.value() == id) return objects[i];
        return std::nullopt;
      };
      const auto found = kind == 1   ? in(map.keyframes, objects_[row].keyframes)
                         : kind == 2 ? in(map.points, objects_[row].points)
                                     : std::nullopt;
      if (found) return found;
    }
    return std::nullopt;
  }

  static constexpr std::size_t kFlushBytes = std::size_t{1} << 20;
  // Writes what was put, if it is more than `least` bytes.
  void Flush(std::size_t least) {
    if (buffer_.collected() <= least) return;
    buffer_.ForEach(write_);
    buffer_.clear();
  }

  const Atlas& atlas_;
  const ForkProgram& program_;
  bool carried_fits_;
  const Target::Sink& write_;
  detail::Pieces buffer_;
  Encoder<Output> encoder_;
  std::vector<std::optional<std::uint32_t>> cameras_;  // object ids of those that were written
  std::vector<MapObjects> objects_;
  std::unordered_map<std::uint32_t, std::uint32_t> others_;  // objects that are no entities, by their numbers
  std::uint32_t next_object_ = 0;
  ForkWriting done_;
};

}  // namespace

ForkWriting WriteFork(const Atlas& atlas, const ArchiveEncoding& encoding, const ForkProgram& program,
                      bool carried_fits, const Target::Sink& write) {
  const std::string header = WriteArchiveHeader(encoding);
  if (encoding.text) return ForkWriter<TextOutput>(atlas, encoding, program, carried_fits, write).Write(header);
  return ForkWriter<BinaryOutput>(atlas, encoding, program, carried_fits, write).Write(header);
}

}  // namespace slamdb::orbslam3
