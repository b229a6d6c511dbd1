// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/points/detail/point_set.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <functional>
#include <unordered_set>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/formats/detail/select.h"
#include "slamdb/model/counters.h"

namespace slamdb::detail {
namespace {

struct NamedField {
  std::string_view name;
  PointField field;
};
constexpr std::string_view kOfCloudCompare = "scalar_";
constexpr std::uint64_t kMostMaps = 65536;
constexpr NamedField kFields[] = {
    {"x", PointField::kX},
    {"y", PointField::kY},
    {"z", PointField::kZ},
    {"nx", PointField::kNormalX},
    {"ny", PointField::kNormalY},
    {"nz", PointField::kNormalZ},
    {"normal_x", PointField::kNormalX},
    {"normal_y", PointField::kNormalY},
    {"normal_z", PointField::kNormalZ},
    {"min_distance", PointField::kMinDistance},
    {"max_distance", PointField::kMaxDistance},
    {"map", PointField::kMap},
    {"id", PointField::kId},
    {"camera", PointField::kCamera},
    {"observations", PointField::kDerived},
    {"reprojection_error", PointField::kDerived},
    {"red", PointField::kColor},
    {"green", PointField::kColor},
    {"blue", PointField::kColor},
    {"rgb", PointField::kColor},
    {"_", PointField::kPadding},
};

template <class Number>
Number Load(const std::byte* bytes, bool swapped) {
  std::byte ordered[sizeof(Number)];
  std::copy_n(bytes, sizeof(Number), ordered);
  if (swapped) std::reverse(std::begin(ordered), std::end(ordered));
  Number number;
  std::memcpy(&number, ordered, sizeof number);
  return number;
}

// use(number) of the number's own type.
template <class Use>
void Visit(NumberType type, const std::byte* bytes, bool swapped, const Use& use) {
  switch (type) {
    case NumberType::kInt8:
      return use(Load<std::int8_t>(bytes, swapped));
    case NumberType::kUint8:
      return use(Load<std::uint8_t>(bytes, swapped));
    case NumberType::kInt16:
      return use(Load<std::int16_t>(bytes, swapped));
    case NumberType::kUint16:
      return use(Load<std::uint16_t>(bytes, swapped));
    case NumberType::kInt32:
      return use(Load<std::int32_t>(bytes, swapped));
    case NumberType::kUint32:
      return use(Load<std::uint32_t>(bytes, swapped));
    case NumberType::kInt64:
      return use(Load<std::int64_t>(bytes, swapped));
    case NumberType::kUint64:
      return use(Load<std::uint64_t>(bytes, swapped));
    case NumberType::kFloat:
      return use(Load<float>(bytes, swapped));
    case NumberType::kDouble:
      return use(Load<double>(bytes, swapped));
  }
}

bool IsWhole(PointField field) {
  return field == PointField::kMap || field == PointField::kId || field == PointField::kCamera;
}
bool IsLeftOut(PointField field) { return field >= PointField::kDerived; }

void AddName(std::string& names, const std::string& name) { names.append(names.empty() ? "" : ", ").append(name); }

// An id; nothing for numbers that are none.
template <class Number>
std::optional<std::uint64_t> WholeOf(Number value) {
  if constexpr (std::is_floating_point_v<Number>) {
    if (!(value >= 0) || value >= Number(0x1p64) || value != std::floor(value)) return std::nullopt;
  } else if constexpr (std::is_signed_v<Number>) {
    if (value < 0) return std::nullopt;
  }
  return static_cast<std::uint64_t>(value);
}

// How far a float is from its text. That of a float may have fewer digits than it takes: what is off by no more than a
// millimetre, or is the shortest text of the float, is it.
double OffIn(std::string_view number, float value) {
  const double exact = ParseNumber<double>(number).value_or(static_cast<double>(value));
  const double off = std::abs(static_cast<double>(value) - exact);
  if (!(off > Rounding::kMost)) return 0;
  std::array<char, 64> text;
  const char* end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return ParseNumber<double>(std::string_view(text.data(), end)) == exact ? 0 : off;
}

}  // namespace

std::size_t SizeOf(NumberType type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

PointField FieldByName(std::string_view name) {
  if (name.starts_with(kOfCloudCompare)) name.remove_prefix(kOfCloudCompare.size());
  const auto found = std::ranges::find(kFields, name, &NamedField::name);
  return found == std::end(kFields) ? PointField::kUnknown : found->field;
}

void RequireRoom(const std::string& path, std::uint64_t rows, std::uint64_t bytes_of_row, std::uint64_t left) {
  if (bytes_of_row > 0 && rows <= left / bytes_of_row) return;
  throw Error(ErrorKind::kDamaged, path, "",
              Concat("claims ", Counted(rows, "row"), " of ", bytes_of_row, " bytes or more, but ", left,
                     " bytes follow; the file is cut off, or its head is damaged"));
}

PointSet::PointSet(const std::string& path, const std::vector<CloudColumn>& columns) : path_(path) {
  for (const PointField axis : {PointField::kX, PointField::kY, PointField::kZ})
    if (std::ranges::find(columns, axis, &CloudColumn::field) == columns.end())
      throw Error(ErrorKind::kUnsupported, path, "", "is a point cloud without columns x, y and z");
  const bool is_ours = std::ranges::find(columns, PointField::kMinDistance, &CloudColumn::field) != columns.end();
  for (const CloudColumn& column : columns) {
    has_ids_ |= column.field == PointField::kId;
    if (column.field == PointField::kDerived) AddName(derived_, column.name);
    if (column.field == PointField::kUnknown || (column.field == PointField::kColor && !is_ours))
      AddName(unknown_, column.name);
  }
}

void PointSet::Set(const CloudColumn& column, const std::byte* number, bool swapped) {
  if (IsLeftOut(column.field)) return;
  Visit(column.type, number, swapped, [&](auto value) {
    if (IsWhole(column.field))
      SetWhole(column.field, WholeOf(value));
    else
      SetReal(column.field, static_cast<double>(value));
  });
}

bool PointSet::Set(const CloudColumn& column, std::string_view number) {
  if (column.type == NumberType::kFloat && !IsWhole(column.field)) {  // rounded once
    if (const auto value = ParseNumber<float>(number)) {
      if (column.field <= PointField::kZ) rounding_.Add(OffIn(number, *value));
      SetReal(column.field, *value);
      return true;
    }
  }
  if (const auto whole = ParseNumber<std::uint64_t>(number); whole && IsWhole(column.field)) {
    SetWhole(column.field, *whole);
    return true;
  }
  const auto value = ParseNumber<double>(number);
  if (!value) return false;
  if (IsWhole(column.field))
    SetWhole(column.field, WholeOf(*value));
  else
    SetReal(column.field, *value);
  return true;
}

void PointSet::SetReal(PointField field, double value) {
  const auto real = static_cast<float>(value);
  if (field <= PointField::kZ) {
    if (std::isfinite(value) && !std::isfinite(real))
      throw Error(ErrorKind::kDamaged, path_, Concat("point ", row_),
                  Concat("the coordinate ", value,
                         " does not fit into the 32-bit floats of an atlas; the file is "
                         "damaged, or its numbers are of another type"));
    now_.position[static_cast<int>(field)] = real;
    rounding_.Add(std::abs(static_cast<double>(real) - value));
  } else if (field <= PointField::kNormalZ) {
    now_.normal[static_cast<int>(field) - static_cast<int>(PointField::kNormalX)] = real;
  } else if (field == PointField::kMinDistance) {
    now_.min_distance = real;
  } else if (field == PointField::kMaxDistance) {
    now_.max_distance = real;
  }
}

void PointSet::SetWhole(PointField field, std::optional<std::uint64_t> value) {
  if (field == PointField::kMap)
    now_.map = value.value_or(0);
  else if (field == PointField::kId)
    now_.id = value;
  else
    now_.camera = value != std::uint64_t{0};
}

Map& PointSet::MapOf(std::uint64_t id) {
  std::vector<Map>& maps = atlas_.maps;
  if (!maps.empty() && maps.back().id == MapId(id)) return maps.back();
  const auto [found, is_new] = rows_of_maps_.try_emplace(id, maps.size());
  if (!is_new) return maps[found->second];
  if (maps.size() == kMostMaps)
    throw Error(ErrorKind::kUnsupported, path_, "",
                Concat("has points of more than ", kMostMaps,
                       " maps; its column `map` is something else, give it another name"));
  maps.emplace_back().id = MapId(id);
  if (maps.size() == 1) maps.back().points.reserve(expected_);
  return maps.back();
}

void PointSet::EndPoint() {
  const std::uint64_t row = row_++;
  if (now_.camera) {
    ++cameras_;
    return;
  }
  if (!has_ids_ && !now_.position.allFinite()) {
    ++empty_;
    return;
  }
  if (!has_ids_) now_.id = row;
  MapPoint& point = MapOf(now_.map).points.emplace_back();
  point.id = now_.id ? MapPointId(*now_.id) : MapPointId();
  point.position = now_.position;
  point.normal = now_.normal;
  point.min_distance = now_.min_distance;
  point.max_distance = now_.max_distance;
  point.descriptor_form = MatrixForm::kEmpty;
}

void PointSet::LeaveOutTwins() {
  for (Map& map : atlas_.maps) {
    if (std::ranges::adjacent_find(map.points, std::greater_equal(), &MapPoint::id) == map.points.end()) continue;
    std::unordered_set<std::uint64_t> seen;
    twins_ += std::erase_if(map.points,
                            [&](const MapPoint& point) { return point.id && !seen.insert(point.id.value()).second; });
  }
}

void PointSet::Tell(Notices& notices) const {
  if (!unknown_.empty()) notices.Lose("an atlas has no place for the columns " + unknown_ + "; they are left out");
  if (twins_ > 0)
    notices.Lose(Concat("left out, since an earlier point of the map has their id: ", Counted(twins_, "point"),
                        "; if the column `id` is something else, give it another name"));
  if (!derived_.empty()) notices.Note("left out what tells of keyframes, which are not there: " + derived_);
  if (cameras_ > 0) notices.Note("left out corners of cameras that are drawn: " + Thousands(cameras_));
  if (empty_ > 0) notices.Note("left out where nothing was measured: " + Counted(empty_, "point"));
  rounding_.Tell(notices);
}

Atlas PointSet::Finish(const Selection& selection, Notices& notices) {
  if (has_ids_) LeaveOutTwins();
  Select(selection, atlas_);
  RaiseCounters(atlas_);
  Tell(notices);
  return std::move(atlas_);
}

}  // namespace slamdb::detail
