// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>

#include "slamdb/formats/mrpt/detail/landmarks.h"
#include "slamdb/formats/mrpt/detail/stream.h"

namespace slamdb::mrpt {
namespace {

constexpr std::size_t kRecord3 = 84;          // a landmark of MRPT 3
constexpr std::size_t kLeastLandmark2 = 130;  // of MRPT 2, without features

struct ObjectHeader {
  std::string_view name;
  std::uint8_t version = 0;
};

ObjectHeader ReadHeader(StreamReader& in) {
  const auto length = in.Get<std::uint8_t>("an object header");
  if ((length & 0x80) == 0)
    throw in.Bad("expected an object of MRPT, whose first byte is 0x80 + the length of its class name, found " +
                 std::to_string(length) + "; MRPT before 0.5.5 is not supported");
  const std::string_view name = in.Take(length & 0x7f, "a class name");
  return {name, in.Get<std::uint8_t>("a class version")};
}

void ExpectObject(StreamReader& in, std::string_view name, std::uint8_t newest, std::uint8_t oldest,
                  std::uint8_t& version) {
  const ObjectHeader header = ReadHeader(in);
  if (header.name != name) throw in.Bad("expected a " + std::string(name) + ", found a " + std::string(header.name));
  version = header.version;
  if (version < oldest || version > newest)
    throw in.Bad(std::string(name) + " of version " + std::to_string(version) + ", known are " +
                     std::to_string(oldest) + " to " + std::to_string(newest),
                 ErrorKind::kUnsupported);
}

bool ReadBool(StreamReader& in, std::string_view what) { return in.Get<std::uint8_t>(what) != 0; }

// The object of an optional whose class slamdb does not know. It ends with an end flag, `fixed` bytes before `next`,
// the first thing behind it that is always the same; the object may happen to hold that, too.
std::vector<std::uint8_t> TakeOpaque(StreamReader& in, std::string_view next, std::size_t fixed,
                                     std::string_view what) {
  const std::string_view rest = in.rest();
  std::size_t found = rest.find(next, fixed + 1);
  while (found != std::string_view::npos && rest[found - fixed - 1] != kEndFlag) found = rest.find(next, found + 1);
  if (found == std::string_view::npos) throw in.Bad("cannot find the end of " + std::string(what));
  const std::string_view bytes = in.Take(found - fixed, what);
  return {bytes.begin(), bytes.end()};
}

class FeatureReader {
 public:
  FeatureReader(StreamReader& in, LandmarkFeature& feature) : in_(in), feature_(feature) {}

  void Read() {
    std::uint8_t version = 0;
    ExpectObject(in_, kFeatureClass, kFeatureVersion, 0, version);
    feature_.x = in_.Get<float>("x");
    feature_.y = in_.Get<float>("y");
    feature_.keypoint_id = in_.Get<std::uint64_t>("a keypoint id");
    const std::size_t behind_patch = version == 0 ? 20 : 60;
    in_.Expect(kOptionalImage, "an image patch");
    feature_.has_patch = ReadBool(in_, "an image patch");
    if (feature_.has_patch) feature_.patch = TakeOpaque(in_, kOptionalBytes, behind_patch, "an image patch");
    ReadNumbers(version);
    ReadDescriptors(version);
    in_.ExpectEndFlag("a feature");
  }

 private:
  void ReadNumbers(std::uint8_t version) {
    feature_.patch_size = in_.Get<std::uint16_t>("a patch size");
    feature_.type = static_cast<FeatureType>(in_.Get<std::int32_t>("a feature type"));
    feature_.track_status = in_.Get<std::uint32_t>("a track status");
    feature_.response = in_.Get<float>("a response");
    feature_.orientation = in_.Get<float>("an orientation");
    feature_.octave = in_.Get<std::uint8_t>("an octave");
    feature_.user_flags = in_.Get<std::uint8_t>("user flags");
    if (version == 0) return;
    feature_.depth = in_.Get<double>("a depth");
    feature_.initial_depth = in_.Get<double>("an initial depth");
    for (double& value : feature_.position_in_camera) value = in_.Get<double>("a position in the camera");
  }

  void ReadDescriptors(std::uint8_t version) {
    AddNumbers(DescriptorKind::kSift, kOptionalBytes, 1);
    AddNumbers(DescriptorKind::kSurf, kOptionalFloats, sizeof(float));
    AddNumbers(DescriptorKind::kSpinImage, kOptionalFloats, sizeof(float));
    feature_.spin_image_rows = in_.Get<std::uint16_t>("spin image rows");
    AddMatrix(DescriptorKind::kPolarImage, kOptionalMatrix, 0);
    AddMatrix(DescriptorKind::kLogPolarImage, kOptionalBytes, 1);
    feature_.polar_images_without_rotation = ReadBool(in_, "a flag of polar images");
    // The slots that MRPT 2 writes as ORB, BLD, LATCH and reads as BLD, LATCH, ORB. A file by MRPT has an ORB
    // descriptor in the first; one that was made for its reader has it in the last, and nothing in the first.
    const bool first = AddNumbers(DescriptorKind::kOrb, kOptionalBytes, 1);
    AddNumbers(DescriptorKind::kBld, kOptionalBytes, 1);
    if (version < 2) return;
    const bool orb_is_last = !first && feature_.type == FeatureType::kOrb;
    AddNumbers(orb_is_last ? DescriptorKind::kOrb : DescriptorKind::kLatch, kOptionalBytes, 1);
    std::sort(feature_.descriptors.begin(), feature_.descriptors.end(),
              [](const FeatureDescriptor& a, const FeatureDescriptor& b) { return a.kind < b.kind; });
  }

  bool AddNumbers(DescriptorKind kind, std::string_view tag, std::size_t size) {
    in_.Expect(tag, "a descriptor");
    if (!ReadBool(in_, "a descriptor")) return false;
    const auto count = in_.Get<std::uint32_t>("the length of a descriptor");
    const std::string_view bytes = in_.Take(count * size, "a descriptor");
    feature_.descriptors.push_back({kind, {bytes.begin(), bytes.end()}});
    return true;
  }

  void AddMatrix(DescriptorKind kind, std::string_view next, std::size_t between) {
    in_.Expect(kOptionalMatrix, "a polar image");
    if (ReadBool(in_, "a polar image"))
      feature_.descriptors.push_back({kind, TakeOpaque(in_, next, between, "a polar image")});
  }

  StreamReader& in_;
  LandmarkFeature& feature_;
};

// The contents of a landmark of MRPT 2, behind its header.
Landmark ReadLandmark2(StreamReader& in) {
  Landmark landmark;
  in.Expect(kFeatureVector, "a vector of features");
  for (auto count = in.Get<std::uint32_t>("a number of features"); count > 0; --count)
    FeatureReader(in, landmark.features.emplace_back()).Read();
  for (double& value : landmark.mean) value = in.Get<double>("a position");
  for (double& value : landmark.normal) value = in.Get<double>("a normal");
  for (double* value :
       {&landmark.cov_11, &landmark.cov_22, &landmark.cov_33, &landmark.cov_12, &landmark.cov_13, &landmark.cov_23})
    *value = static_cast<double>(in.Get<float>("a covariance"));
  landmark.id = LandmarkId(in.Get<std::uint64_t>("an id"));
  landmark.last_seen = in.Get<std::uint64_t>("a time");
  landmark.seen_count = in.Get<std::uint32_t>("a count");
  in.ExpectEndFlag("a landmark");
  return landmark;
}

Landmark ReadLandmark3(StreamReader& in) {
  Landmark landmark;
  landmark.id = LandmarkId(in.Get<std::uint64_t>("an id"));
  for (double& value : landmark.mean) value = in.Get<double>("a position");
  for (double* value :
       {&landmark.cov_11, &landmark.cov_22, &landmark.cov_33, &landmark.cov_12, &landmark.cov_13, &landmark.cov_23})
    *value = in.Get<double>("a covariance");
  landmark.seen_count = in.Get<std::uint32_t>("a count");
  return landmark;
}

bool StartsLikeLandmark2(std::string_view bytes) {
  return bytes.starts_with(static_cast<char>(0x80 | kLandmarkClass.size())) &&
         bytes.substr(1).starts_with(kLandmarkClass);
}

// The objects of a stream, one behind the other.
class MapsReader {
 public:
  MapsReader(const std::string& path, std::string_view bytes, Salvage& into) : in_(path, bytes), into_(into) {}

  // What was read before an Error stays in `into`. With `all` an impossible count is an Error; otherwise what is there
  // is read until it ends.
  void Run(bool all) {
    while (in_.left() > 0) {
      const ObjectHeader header = ReadHeader(in_);
      const bool is_map = header.name == kMapClass && header.version == kMapVersion;
      const bool is_landmark = header.name == kLandmarkClass && header.version == kLandmarkVersion;
      if (!is_map && !is_landmark)
        throw in_.Bad("expected a landmarks map of MRPT 2 or 3, found a " + std::string(header.name) + " of version " +
                          std::to_string(header.version),
                      header.name.starts_with("mrpt::") ? ErrorKind::kUnsupported : ErrorKind::kDamaged);
      if (is_map || !bare_) AddMap();
      bare_ = is_landmark;
      if (is_map)
        ReadLandmarks(all);
      else
        Add(ReadLandmark2(in_), 1);
    }
  }

 private:
  void AddMap() {
    const MapId id(into_.maps.size());
    into_.atlas.maps.emplace_back().id = id;
    into_.maps.push_back({.id = id});
    into_.maps_listed = into_.maps.size();
  }

  void Add(Landmark landmark, std::uint64_t listed) {
    into_.atlas.maps.back().landmarks.push_back(std::move(landmark));
    ++into_.maps.back().landmarks.read;
    into_.maps.back().landmarks.listed += listed;
  }

  void ReadLandmarks(bool all) {
    const auto count = in_.Get<std::uint32_t>("a number of landmarks");
    const bool is_mrpt2 = StartsLikeLandmark2(in_.rest());
    const std::size_t most = in_.left() / (is_mrpt2 ? kLeastLandmark2 : kRecord3);
    if (all && count > most)
      throw in_.Bad("a count of " + std::to_string(count) + " landmarks does not fit into the " +
                    std::to_string(in_.left()) + " bytes left: the file is truncated");
    into_.maps.back().landmarks.listed = count;
    into_.atlas.maps.back().landmarks.reserve(std::min<std::size_t>(count, most));
    for (std::uint32_t i = 0; i < count; ++i) {
      in_.SetPlace("landmark " + std::to_string(i));
      std::uint8_t version = 0;
      if (is_mrpt2) ExpectObject(in_, kLandmarkClass, kLandmarkVersion, kLandmarkVersion, version);
      Add(is_mrpt2 ? ReadLandmark2(in_) : ReadLandmark3(in_), 0);
    }
    in_.SetPlace("");
    in_.ExpectEndFlag("the map");
  }

  StreamReader in_;
  Salvage& into_;
  bool bare_ = false;  // the last map is one of bare landmarks
};

}  // namespace

std::optional<Layout> LayoutOf(std::string_view bytes) {
  if (StartsLikeLandmark2(bytes)) return Layout::kMrpt2;
  const std::string header = HeaderOf(kMapClass, kMapVersion);
  if (!bytes.starts_with(header) || bytes.size() < header.size() + 5) return std::nullopt;
  const std::string_view count = bytes.substr(header.size(), 4);
  const bool is_mrpt2 = count == "\0\0\0\0"sv || StartsLikeLandmark2(bytes.substr(header.size() + 4));
  return is_mrpt2 ? Layout::kMrpt2 : Layout::kMrpt3;
}

std::vector<Map> ReadMaps(const std::string& path, std::string_view bytes) {
  Salvage read;
  MapsReader(path, bytes, read).Run(true);
  return std::move(read.atlas.maps);
}

Salvage SalvageMaps(const std::string& path, std::string_view bytes) {
  Salvage salvage;
  try {
    MapsReader(path, bytes, salvage).Run(false);
  } catch (const Error& error) {
    salvage.damage.push_back(error.place() + ": " + error.problem());
  }
  return salvage;
}

}  // namespace slamdb::mrpt
