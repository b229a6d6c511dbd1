// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <memory>
#include <optional>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/formats/detail/select.h"
#include "slamdb/formats/orbslam3/detail/archive_header.h"
#include "slamdb/formats/orbslam3/detail/decode_jobs.h"
#include "slamdb/formats/orbslam3/detail/fork.h"
#include "slamdb/formats/orbslam3/detail/fork_files.h"
#include "slamdb/formats/orbslam3/detail/meaning.h"
#include "slamdb/formats/orbslam3/detail/part_sizes.h"
#include "slamdb/formats/orbslam3/detail/plausible.h"
#include "slamdb/formats/orbslam3/detail/pointers.h"
#include "slamdb/formats/orbslam3/detail/skipper.h"
#include "slamdb/formats/orbslam3/detail/transfer.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"

// How an atlas is read: the calling thread walks the file once from front to back, follows pointers and the class
// table, checks every count, and finds where each keyframe and map point begins; it passes over their contents.
// Decoding, which is most of the work, goes to a team of threads that follow behind and fill rows that are already
// allocated; in the end the caller helps. Places in the file depend on all that stands before them, so there is no
// other way to split the work.
namespace slamdb::orbslam3 {
namespace {

constexpr std::size_t kPointsPerJob = 1024;
constexpr std::size_t kSmallFile = std::size_t{1} << 20;  // not worth a second thread
// The least that a new object takes in a file with 4-byte longs, and so the most objects a file can hold.
constexpr std::size_t kLeastKeyFrameBytes = 2048, kLeastPointBytes = 100;
constexpr std::size_t kLeastKeyFrameTokens = 600, kLeastPointTokens = 25;

template <class Input>
class AtlasReader {
 public:
  AtlasReader(detail::FileStream& file, const ArchiveHeader& header, const ReadOptions& options)
      : file_(file),
        options_(options),
        main_(At(file, header), ClassTable(header.encoding), options.features),
        team_(main_.input, options.features, file.size() < kSmallFile ? 1 : detail::ThreadCount(options.threads)) {
    main_.Restart();
    atlas_.encoding = header.encoding;
  }

  Atlas Read(Notices& notices) {
    try {
      ReadPreamble();
      ReadMaps();
      ReadCameras();
      LayoutCounters(main_, atlas_.next_ids);
    } catch (...) {
      team_.Finish();  // throws instead what went wrong earlier in the file, if anything did
      DecodeOpen();    // and this, what goes wrong before the place where passing over it did
      throw;
    }
    team_.Finish();
    whole_ = main_.input.AtEnd();
    if (!whole_)
      notices.Lose(file_.path() + ": " + std::to_string(main_.input.remaining()) +
                   " bytes behind the end of the atlas are not part of it and were left out");
    return std::move(atlas_);
  }
  // Whether the atlas ends where the file does.
  bool whole() const { return whole_; }
  // Bytes of each part; what belongs to none is kOther.
  PartBytes part_bytes() const {
    PartBytes bytes = team_.part_bytes();
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] += main_.part_bytes()[i];
    return bytes;
  }

 private:
  static Input At(detail::FileStream& file, const ArchiveHeader& header) {
    Input input(&file, header.encoding);
    input.Seek(header.bytes);
    input.LeaveOutLarge();
    return input;
  }

  template <class Archive>
  Pointer TakePointer(Archive& archive, std::initializer_list<WireClass> expected) {
    return orbslam3::TakePointer(archive, objects_, expected);
  }
  template <class Archive>
  RepeatedEntry Repeated(const Archive& archive, const Pointer& pointer, std::uint64_t position) const {
    return orbslam3::Repeated(archive, objects_, pointer, position);
  }

  void ReadPreamble() {
    main_.input.place.field = "vocabulary";
    atlas_.vocabulary.name = main_.input.TakeString();
    atlas_.vocabulary.checksum = main_.input.TakeString();
    main_.input.place.field = "Atlas";
    if (TakePointer(main_, {WireClass::kAtlas}).kind != Pointer::Kind::kNew)
      main_.input.Fail("expected an atlas, found a null pointer: nothing was saved");
    objects_.Add(WireClass::kAtlas, 0, 0);
    main_.classes.Register(WireClass::kPinhole);
    main_.classes.Register(WireClass::kKannalaBrandt8);
  }

  void ReadMaps() {
    main_.input.place.field = "mvpBackupMaps";
    const std::uint64_t count = main_.ClassCount(WireClass::kMapList, 2, 1);
    for (std::uint64_t position = 0; position < count; ++position) {
      main_.input.place = {.map = static_cast<std::int64_t>(position)};
      const Pointer pointer = TakePointer(main_, {WireClass::kMap});
      if (pointer.kind != Pointer::Kind::kNew) {
        atlas_.repeated_maps.push_back(Repeated(main_, pointer, position));
        continue;
      }
      const auto row = static_cast<std::uint32_t>(atlas_.maps.size());
      objects_.Add(WireClass::kMap, 0, row);
      ReadMap(atlas_.maps.emplace_back(), row);
    }
    main_.input.place = {};
  }

  void ReadMap(Map& map, std::uint32_t row) {
    LayoutMapHead(main_, map);
    if (team_.size() == 0) {
      ReadLists(main_, map, row);
    } else {
      Skipper<Input> skipper(main_.input, main_.classes);
      ReadLists(skipper, map, row);
      main_.input = skipper.input;
      main_.classes = skipper.classes;
    }
    LayoutMapTail(main_, map);
  }

  // With a Decoder, which decodes each entity here and now, or a Skipper, which leaves them to the team.
  template <class Archive>
  void ReadLists(Archive& archive, Map& map, std::uint32_t row) {
    archive.input.place.field = "mvpBackupKeyFrames";
    const std::uint64_t keyframes = archive.ClassCount(WireClass::kKeyFrameList, 2, 1);
    map.keyframes.resize(Bounded(keyframes, kLeastKeyFrameBytes, kLeastKeyFrameTokens));
    ReadKeyFrames(archive, map, row, keyframes);
    archive.input.place.field = "mvpBackupMapPoints";
    const std::uint64_t points = archive.ClassCount(WireClass::kMapPointList, 2, 1);
    map.points.resize(Bounded(points, kLeastPointBytes, kLeastPointTokens));
    ReadPoints(archive, map, row, points);
  }

  // How many new objects a list of `count` pointers can hold at most, by the bytes left.
  std::size_t Bounded(std::uint64_t count, std::size_t bytes, std::size_t tokens) const {
    return std::min<std::uint64_t>(count, main_.input.remaining() / (Input::kText ? 2 * tokens : bytes));
  }

  template <class Archive>
  void ReadKeyFrames(Archive& archive, Map& map, std::uint32_t row, std::uint64_t count) {
    std::size_t found = 0;
    for (std::uint64_t position = 0; position < count; ++position) {
      Enter(archive, "kf", position, count);
      const Pointer pointer = TakePointer(archive, {WireClass::kKeyFrame});
      if (pointer.kind != Pointer::Kind::kNew) {
        map.repeated_keyframes.push_back(Repeated(archive, pointer, position));
        continue;
      }
      objects_.Add(WireClass::kKeyFrame, row, found);
      if (found == map.keyframes.size()) archive.input.FailCount(count);
      TakeKeyFrame(archive, map.keyframes[found++]);
      if (position % 32 == 0) Report(archive.input.offset());
    }
    map.keyframes.resize(found);
    archive.input.place.entity = nullptr;
  }

  template <class Archive>
  void ReadPoints(Archive& archive, Map& map, std::uint32_t row, std::uint64_t count) {
    std::size_t found = 0;
    for (std::uint64_t position = 0; position < count; ++position) {
      Enter(archive, "mp", position, count);
      const Pointer pointer = TakePointer(archive, {WireClass::kMapPoint});
      if (pointer.kind != Pointer::Kind::kNew) {
        EndPoints(archive);
        map.repeated_points.push_back(Repeated(archive, pointer, position));
        continue;
      }
      objects_.Add(WireClass::kMapPoint, row, found);
      if (found == map.points.size()) archive.input.FailCount(count);
      TakePoint(archive, map.points[found++]);
      if (found % kPointsPerJob == 0) Report(archive.input.offset());
    }
    EndPoints(archive);
    map.points.resize(found);
    archive.input.place.entity = nullptr;
  }

  void TakeKeyFrame(Decoder<Input>& decoder, KeyFrame& keyframe) {
    LayoutKeyFrame(decoder, keyframe);
    file_.Release(decoder.input.offset());
  }
  void TakeKeyFrame(Skipper<Input>& skipper, KeyFrame& keyframe) {
    open_ = JobAt(skipper);
    open_->keyframe = &keyframe;
    LayoutKeyFrame(skipper, keyframe);
    AddJob(EndOf(skipper));
  }

  void TakePoint(Decoder<Input>& decoder, MapPoint& point) {
    LayoutMapPoint(decoder, point);
    file_.Release(decoder.input.offset());
  }
  // Points that follow each other are one job.
  void TakePoint(Skipper<Input>& skipper, MapPoint& point) {
    if (!open_) {
      open_ = JobAt(skipper);
      open_->points = &point;
    }
    ++open_->point_count;
    LayoutMapPoint(skipper, point);
    open_->end = EndOf(skipper);
    if (open_->point_count == kPointsPerJob) EndPoints(skipper);
  }
  void EndPoints(const Decoder<Input>&) {}
  void EndPoints(const Skipper<Input>&) {
    if (open_) AddJob(open_->end);
  }
  // Only tokens can be passed over further than they can be decoded. The cursor of its own reads on, as the job has no
  // end yet.
  void DecodeOpen() {
    if (!Input::kText || !open_) return;
    Input input(&file_, main_.input.encoding());
    input.Seek(open_->offset);
    static_cast<void>(team_.Decode(*open_, input));
  }
  void AddJob(std::size_t end) {
    open_->end = end;
    team_.Add(*open_);
    open_.reset();
  }

  static DecodeJob JobAt(const Skipper<Input>& skipper) {
    return {.offset = skipper.input.offset(), .classes = skipper.classes, .place = skipper.input.place};
  }
  // Where the record behind the cursor ends; a text record includes the space that ends its last token.
  static std::size_t EndOf(const Skipper<Input>& skipper) { return skipper.input.offset() + (Input::kText ? 1 : 0); }

  template <class Archive>
  static void Enter(Archive& archive, const char* entity, std::uint64_t position, std::uint64_t count) {
    Place& place = archive.input.place;
    place.entity = entity;
    place.ordinal = position;
    place.of = count;
    place.id = Id<KeyFrame>::kNone;
  }

  void ReadCameras() {
    main_.input.place.field = "mvpCameras";
    const std::uint64_t count = main_.ClassCount(WireClass::kCameraList, 2, 1);
    for (std::uint64_t position = 0; position < count; ++position) {
      const Pointer pointer = TakePointer(main_, {WireClass::kPinhole, WireClass::kKannalaBrandt8});
      if (pointer.kind != Pointer::Kind::kNew) {
        atlas_.repeated_cameras.push_back(Repeated(main_, pointer, position));
        continue;
      }
      objects_.Add(pointer.wire_class, 0, atlas_.cameras.size());
      Camera& camera = atlas_.cameras.emplace_back();
      camera.model = pointer.wire_class == WireClass::kPinhole ? CameraModel::kPinhole : CameraModel::kKannalaBrandt8;
      LayoutCamera(main_, camera);
    }
  }

  void Report(std::size_t offset) const {
    if (options_.progress)
      options_.progress("reading " + file_.path(), static_cast<double>(offset) / static_cast<double>(file_.size()));
  }

  detail::FileStream& file_;
  const ReadOptions& options_;
  Atlas atlas_;
  bool whole_ = true;
  ObjectTable objects_;
  Decoder<Input> main_;            // the cursor of the calling thread
  std::optional<DecodeJob> open_;  // the job whose end is being looked for
  DecodeTeam<Input> team_;         // last: it stops before what it fills goes away
};

// What was read as of v1.0, and whether nothing stands behind it.
struct OwnReading {
  Atlas atlas;
  bool whole = true;
};

template <class Input>
OwnReading ReadArchive(detail::FileStream& file, const ArchiveHeader& header, const ReadOptions& options,
                       Notices& notices) {
  AtlasReader<Input> reader(file, header, options);
  OwnReading reading{reader.Read(notices), reader.whole()};
  if (options.part_sizes != nullptr) ListPartSizes(reader.part_bytes(), file.size(), *options.part_sizes);
  detail::Select(options.selection, reading.atlas);
  return reading;
}

// What makes a reading with other widths of long and size_t worth a try: a place in the file whose bytes cannot stand
// there; not that the disk fails or the user cancels.
bool IsOfTheBytes(const Error& error) {
  return (error.kind() == ErrorKind::kDamaged || error.kind() == ErrorKind::kUnsupported) && !error.place().empty();
}

// Text does not say how wide the writer's long and size_t were, which decides what vectors are of one class. Nearly
// every writer is a 64-bit Unix; what does not read as such may be from Windows or a 32-bit system. Nothing when it is
// not, and when the file has grown or shrunk since: what was read first is then only a part of it.
std::optional<OwnReading> ReadTextOfShorterLongs(const Source& source, std::size_t size, const ReadOptions& options,
                                                 Notices& notices) {
  for (const std::uint8_t size_bytes : {std::uint8_t{8}, std::uint8_t{4}}) {
    try {
      detail::FileStream file(source);
      if (file.size() != size) return std::nullopt;
      Notices known;
      ArchiveHeader header = ReadArchiveHeader(file, known);
      header.encoding.long_bytes = 4;
      header.encoding.size_bytes = size_bytes;
      return ReadArchive<TextInput>(file, header, options, notices);
    } catch (const Error& error) {
      if (!IsOfTheBytes(error)) throw;  // the error of the first reading tells more
    }
  }
  return std::nullopt;
}

OwnReading ReadEither(const Source& source, const ReadOptions& options, Notices& notices) {
  detail::FileStream file(source);
  const ArchiveHeader header = ReadArchiveHeader(file, notices);
  if (!header.encoding.text) return ReadArchive<BinaryInput>(file, header, options, notices);
  try {
    return ReadArchive<TextInput>(file, header, options, notices);
  } catch (const Error& error) {
    if (!IsOfTheBytes(error)) throw;
    if (auto reading = ReadTextOfShorterLongs(source, file.size(), options, notices)) return *std::move(reading);
    throw;
  }
}

// Throws the error of a binary archive with its likely cause, where that is a transfer as text.
void NameTransfer(const Source& source, const Error& error) {
  const WholeFile file(source);
  if (SniffArchive(file.text()) != false) return;
  const Transfers transfers = FindTransfers(file.text());
  std::string cause = transfers.undone;
  if (!transfers.left.empty()) cause += (cause.empty() ? "" : "; then ") + transfers.left;
  if (cause.empty()) return;
  throw Error(error.kind(), error.path(), error.place(),
              detail::Concat(error.problem(), "; ", cause, transfers.left.empty() ? "; SalvageAtlas undoes it" : ""));
}

// A fork's file that has as many bytes as one of v1.0 is read without an error, and as something else.
void WarnOfMeaning(const Source& source, const Atlas& atlas, const ReadOptions& options, Notices& notices) {
  if (options.features == FeatureColumns::kNone) return;
  const std::string doubt = DoubtOfPoses(atlas);
  if (!doubt.empty())
    notices.Warn(detail::Concat(source.path, ": ", doubt,
                                ": the map may be broken, or of a fork whose layout `InferLayout` finds"));
}

// In v1.0 or a known layout, when all of the file is of it.
std::optional<Atlas> ReadWhole(const Source& source, const ReadOptions& options, Notices& notices) {
  try {
    Notices own;
    OwnReading reading = ReadEither(source, options, own);
    if (reading.whole && !LooksLikeAnotherLayout(reading.atlas, CountImplausible(reading.atlas))) {
      notices.Add(own);
      notices.Note(
          detail::Concat(source.path, ": read as of ORB-SLAM3 v1.0, as it is not of the layout that is given"));
      return std::move(reading.atlas);
    }
  } catch (const Error& error) {
    if (!IsOfTheBytes(error)) throw;
  }
  return ReadInKnownLayout(source, options, notices);
}

// One layout is given for several inputs, of which some may be of none of a fork's.
Atlas ReadInGivenLayout(const Source& source, const std::string& layout, const ReadOptions& options, Notices& notices) {
  std::vector<PartSize> sizes;
  ReadOptions own = options;
  if (options.part_sizes != nullptr) own.part_sizes = &sizes;
  try {
    Notices given;
    LayoutReading reading = ReadInLayout(source, ForkProgram(LayoutOf(layout)), own, given);
    if (!reading.fits)
      if (auto other = ReadWhole(source, options, notices)) return *std::move(other);
    if (options.part_sizes != nullptr) *options.part_sizes = std::move(sizes);
    notices.Add(given);
    return std::move(reading.atlas);
  } catch (const Error& error) {
    if (!IsOfTheBytes(error)) throw;
    if (auto other = ReadWhole(source, options, notices)) return *std::move(other);
    throw;
  }
}

}  // namespace
}  // namespace slamdb::orbslam3

namespace slamdb {

Atlas ReadOrbslam3(const Source& given, const ReadOptions& options, Notices& notices) {
  const HeldSource held(given);
  const Source& source = held.source();
  const std::string& layout = options.of<Orbslam3ReadOptions>().layout;
  if (!orbslam3::IsOwnLayout(layout)) return orbslam3::ReadInGivenLayout(source, layout, options, notices);
  const auto as_fork = [&] {
    return layout.empty() ? orbslam3::ReadInKnownLayout(source, options, notices) : std::nullopt;
  };
  try {
    Notices own;
    orbslam3::OwnReading reading = orbslam3::ReadEither(source, options, own);
    const Atlas& atlas = reading.atlas;
    if (!reading.whole || orbslam3::LooksLikeAnotherLayout(atlas, orbslam3::CountImplausible(atlas)))
      if (auto fork = as_fork()) return *std::move(fork);
    notices.Add(own);
    orbslam3::WarnOfMeaning(source, atlas, options, notices);
    return std::move(reading.atlas);
  } catch (const Error& error) {
    if (!orbslam3::IsOfTheBytes(error)) throw;
    if (auto fork = as_fork()) return *std::move(fork);
    orbslam3::NameTransfer(source, error);
    if (error.kind() != ErrorKind::kDamaged || error.place().find(", map ") == std::string::npos) throw;
    // What a fork wrote has no end that is cut off.
    const bool cut = error.problem().find("truncated") != std::string::npos;
    throw Error(error.kind(), error.path(), error.place(),
                detail::Concat(error.problem(), "; `RecoverAtlas` saves what is whole",
                               cut ? "" : ", and `InferLayout` finds the layout of a fork"));
  }
}

}  // namespace slamdb
