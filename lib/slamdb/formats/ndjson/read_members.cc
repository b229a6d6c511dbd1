// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/ndjson/detail/read_members.h"

#include <span>

#include "slamdb/formats/ndjson/detail/names.h"
#include "slamdb/model/detail/matrix_types.h"

namespace slamdb::detail {
namespace {

constexpr Presence Needed(std::string_view name) { return {name, false}; }
constexpr Presence Optional(std::string_view name) { return {name, true}; }

// An enumerator by its name; false when none of `known` has it.
template <class Enum, std::size_t kCount>
bool FindNamed(std::string_view name, const std::array<Enum, kCount>& known, Enum& value) {
  const auto found = std::ranges::find_if(known, [&](Enum each) { return NameOf(each) == name; });
  if (found == known.end()) return false;
  value = *found;
  return true;
}

template <class Enum, std::size_t kCount>
void ReadNamed(JsonScanner& json, const std::array<Enum, kCount>& known, Enum& value) {
  if (FindNamed(json.RawString("a name"), known, value)) return;
  std::string names;
  for (const Enum each : known) names.append(names.empty() ? "" : ", ").append(NameOf(each));
  json.Refuse(Concat("is none of ", names));
}

constexpr int kNoDigit = -1;
constexpr int DigitOf(char letter) {
  if (letter >= '0' && letter <= '9') return letter - '0';
  if (letter >= 'a' && letter <= 'f') return letter - 'a' + 10;
  if (letter >= 'A' && letter <= 'F') return letter - 'A' + 10;
  return kNoDigit;
}
constexpr auto kDigits = [] {
  std::array<std::int8_t, 256> digits{};
  for (std::size_t i = 0; i < digits.size(); ++i)
    digits[i] = static_cast<std::int8_t>(DigitOf(static_cast<char>(static_cast<unsigned char>(i))));
  return digits;
}();

// False when `hex`, twice as long, is not all digits.
bool BytesOfHex(std::string_view hex, std::uint8_t* bytes) {
  int wrong = 0;
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    const int high = kDigits[static_cast<unsigned char>(hex[i])], low = kDigits[static_cast<unsigned char>(hex[i + 1])];
    wrong |= high | low;
    bytes[i / 2] = static_cast<std::uint8_t>((high & 15) << 4 | (low & 15));
  }
  return wrong >= 0;
}

}  // namespace

void ReadHex(JsonScanner& json, std::vector<std::uint8_t>& bytes) {
  const std::string_view hex = json.RawString("a string of hex digits");
  bytes.resize(hex.size() / 2);
  if (hex.size() % 2 != 0 || !BytesOfHex(hex, bytes.data())) json.Refuse("is not two hex digits for each byte");
}

void ReadMember(JsonScanner& json, Column<std::byte>& floats) {
  Column<float> values;
  ReadMember(json, values);
  const auto bytes = std::as_bytes(std::span(values));
  floats.assign(bytes.begin(), bytes.end());
}

void ReadMatrixBytes(JsonScanner& json, Column<std::byte>& bytes) {
  std::vector<std::uint8_t> read;
  ReadHex(json, read);
  const auto from = std::as_bytes(std::span(read));
  bytes.assign(from.begin(), from.end());
}

void RequireSound(JsonScanner& json, std::string_view name, const Matrix& matrix) {
  const std::uint64_t element = IsMatrixType(matrix.type) ? ElementBytes(matrix.type) : 0;
  if (matrix.rows < 0 || matrix.columns < 0 || element == 0)
    json.Refuse(Concat(name, "there is no matrix of such rows, columns and type"));
  const std::uint64_t cells = static_cast<std::uint64_t>(matrix.rows) * static_cast<std::uint64_t>(matrix.columns);
  if (cells != matrix.data.size() / element || matrix.data.size() % element != 0)
    json.Refuse(Concat(name, "a matrix of ", matrix.rows, " x ", matrix.columns, ", type ", matrix.type,
                       ", does not have ", matrix.data.size(), " bytes"));
}

void ReadMember(JsonScanner& json, Descriptor& descriptor) {
  const std::string_view hex = json.RawString("a string of 64 hex digits");
  if (hex.size() != 2 * descriptor.size() || !BytesOfHex(hex, descriptor.data())) json.Refuse("is not 64 hex digits");
}

void ReadMember(JsonScanner& json, bool& value) {
  if (!json.TakeFlag(value)) json.Fail("expected true or false");
}

void ReadMember(JsonScanner& json, Flag& flag) {
  bool value = false;
  if (json.TakeFlag(value))
    flag = value;
  else
    flag.recorded = json.Whole<std::uint8_t>();
}

void ReadMember(JsonScanner& json, MatrixForm& form) {
  constexpr std::array kForms{MatrixForm::kUsual, MatrixForm::kUsualNotContinuous, MatrixForm::kEmpty,
                              MatrixForm::kEmptyContinuous};
  ReadNamed(json, kForms, form);
}

void ReadMember(JsonScanner& json, CameraModel& model) {
  constexpr std::array kModels{CameraModel::kPinhole, CameraModel::kKannalaBrandt8, CameraModel::kEquirectangular};
  ReadNamed(json, kModels, model);
}

// By name, or by number where MRPT has no name for it.
void ReadMember(JsonScanner& json, FeatureType& type) {
  constexpr std::array kTypes{FeatureType::kNotDefined, FeatureType::kKlt,    FeatureType::kHarris, FeatureType::kSift,
                              FeatureType::kSurf,       FeatureType::kBeacon, FeatureType::kFast,   FeatureType::kOrb,
                              FeatureType::kAkaze,      FeatureType::kLsd};
  if (json.AtString())
    ReadNamed(json, kTypes, type);
  else
    type = static_cast<FeatureType>(json.Whole<std::int32_t>());
}

void ReadMember(JsonScanner& json, Rigid3f& transform) {
  constexpr std::array kMembers{Needed("rotation_xyzw"), Needed("translation")};
  ReadObject(json, kMembers, [&](std::size_t which) {
    if (which == 1) return ReadMember(json, transform.translation);
    Eigen::Vector4f coefficients;
    ReadMember(json, coefficients);
    transform.rotation.coeffs() = coefficients;
  });
}

void ReadMember(JsonScanner& json, Connection& connection) {
  constexpr std::array kMembers{Needed("keyframe"), Needed("weight")};
  ReadObject(json, kMembers, [&](std::size_t which) {
    which == 0 ? ReadMember(json, connection.keyframe) : ReadMember(json, connection.weight);
  });
}

void ReadMember(JsonScanner& json, Observation& observation) {
  constexpr std::array kMembers{Needed("keyframe"), Optional("left"), Optional("right")};
  observation.left = observation.right = Observation::kAbsent;
  ReadObject(json, kMembers, [&](std::size_t which) {
    if (which == 0) return ReadMember(json, observation.keyframe);
    ReadMember(json, which == 1 ? observation.left : observation.right);
  });
}

void ReadMember(JsonScanner& json, ImuMeasurement& measurement) {
  constexpr std::array kMembers{Needed("acceleration"), Needed("angular_velocity"), Needed("duration")};
  ReadObject(json, kMembers, [&](std::size_t which) {
    if (which == 2) return ReadMember(json, measurement.duration);
    ReadMember(json, which == 0 ? measurement.acceleration : measurement.angular_velocity);
  });
}

void ReadMember(JsonScanner& json, RepeatedEntry& entry) {
  constexpr std::array kMembers{Needed("position"), Optional("owner_map"), Optional("row")};
  ReadObject(json, kMembers, [&](std::size_t which) {
    if (which == 1) return ReadMember(json, entry.owner_map);
    ReadMember(json, which == 0 ? entry.position : entry.row);
  });
}

void ReadMember(JsonScanner& json, std::vector<FeatureDescriptor>& descriptors) {
  constexpr std::array kKinds{DescriptorKind::kSift,       DescriptorKind::kSurf,          DescriptorKind::kSpinImage,
                              DescriptorKind::kPolarImage, DescriptorKind::kLogPolarImage, DescriptorKind::kOrb,
                              DescriptorKind::kBld,        DescriptorKind::kLatch};
  descriptors.clear();
  json.Object([&](std::string_view name) {
    FeatureDescriptor& descriptor = descriptors.emplace_back();
    if (!FindNamed(name, kKinds, descriptor.kind)) json.Refuse("there is no such kind of descriptor");
    ReadHex(json, descriptor.bytes);
  });
  std::ranges::sort(descriptors, {}, &FeatureDescriptor::kind);
  if (std::ranges::adjacent_find(descriptors, {}, &FeatureDescriptor::kind) != descriptors.end())
    json.Refuse("has two descriptors of one kind");
}

void ReadMember(JsonScanner& json, LandmarkFeature& feature) {
  std::vector<std::string_view> seen;
  json.Object([&](std::string_view name) {
    bool known = false;
    if (std::ranges::find(seen, name) != seen.end()) json.Refuse("stands there twice");
    seen.push_back(name);
    ForEachField(&feature, [&](std::string_view field, auto member) {
      if (field != name || field == "has_patch") return;
      known = true;
      if constexpr (std::is_same_v<std::remove_cvref_t<decltype(feature.*member)>, std::vector<std::uint8_t>>) {
        feature.has_patch = true;
        ReadHex(json, feature.*member);
      } else {
        ReadMember(json, feature.*member);
      }
    });
    if (!known) json.Refuse("there is no such member");
  });
}

void ReadMember(JsonScanner& json, Boxed<Carried>& carried) {
  constexpr std::array kMembers{Needed("members"), Optional("descriptors")};
  constexpr std::array kOfMatrix{Needed("rows"), Needed("columns"), Needed("type"), Needed("continuous"),
                                 Needed("bytes")};
  Carried& read = carried.Make();
  ReadObject(json, kMembers, [&](std::size_t which) {
    if (which == 0) return ReadMatrixBytes(json, read.members);
    Matrix& matrix = read.descriptors;
    ReadObject(json, kOfMatrix, [&](std::size_t member) {
      if (member == 3) return ReadMember(json, matrix.continuous);
      if (member == 4) return ReadMatrixBytes(json, matrix.data);
      ReadMember(json, member == 0 ? matrix.rows : member == 1 ? matrix.columns : matrix.type);
    });
    RequireSound(json, "", matrix);
  });
}

// Columns; those behind the first have as many rows as it.
void ReadMember(JsonScanner& json, Column<Keypoint>& keypoints) {
  constexpr std::array kMembers{Needed("x"),        Needed("y"),          Optional("size"),    Optional("angle"),
                                Optional("octave"), Optional("class_id"), Optional("response")};
  constexpr std::array kFloats{&Keypoint::x, &Keypoint::y, &Keypoint::size, &Keypoint::angle};
  constexpr Keypoint kUsual{.angle = 0, .response = 0, .size = 31, .x = 0, .y = 0, .class_id = -1, .octave = 0};
  keypoints.clear();
  bool first = true;
  const auto read_column = [&](auto member) {
    std::size_t row = 0;
    json.Array([&] {
      if (first) keypoints.push_back(kUsual);
      if (row == keypoints.size()) json.Refuse("more elements than the column before");
      ReadMember(json, keypoints[row++].*member);
    });
    if (row != keypoints.size())
      json.Refuse(Concat("expected ", keypoints.size(), " elements, as the column before has, found ", row));
    first = false;
  };
  ReadObject(json, kMembers, [&](std::size_t which) {
    if (which < kFloats.size()) return read_column(kFloats[which]);
    if (which == 6) return read_column(&Keypoint::response);
    read_column(which == 4 ? &Keypoint::octave : &Keypoint::class_id);
  });
}

}  // namespace slamdb::detail
