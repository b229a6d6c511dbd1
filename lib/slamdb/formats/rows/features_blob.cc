// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rows/detail/features_blob.h"

#include <algorithm>
#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/model/derive.h"

namespace slamdb::rows {
namespace {

// Of a picture, and of the blob that older stores have, with the links to points in it.
constexpr std::uint8_t kPictureLayout = 2, kWholeLayout = 1;
constexpr std::int64_t kMaxDerivedCells = 65536;  // ORB-SLAM3's grid has 3072; a damaged one must not cost memory

enum KeypointFlags : std::uint8_t {
  kOneClassId = 1,    // class_id is the same in all rows
  kByteOctaves = 2,   // octaves are 0 to 255
  kSizeByOctave = 4,  // size follows from the octave by a table
};
enum class Undistorted : std::uint8_t { kStored, kSame, kPositionsOnly };
enum class Grid : std::uint8_t { kStored, kDerived };

// ---- columns of numbers

template <class T, class Element, class Member>
void PutMember(ByteWriter& out, const Column<Element>& column, Member member) {
  char* to = out.Extend(column.size() * sizeof(T));
  for (const Element& element : column) {
    const T value = static_cast<T>(element.*member);
    std::memcpy(to, &value, sizeof(T));
    to += sizeof(T);
  }
}

template <class T, class Element, class Member>
void GetMember(ByteReader& in, Column<Element>& column, Member member) {
  const std::byte* from = in.TakeArray(column.size(), sizeof(T));
  for (Element& element : column) {
    T value;
    std::memcpy(&value, from, sizeof(T));
    element.*member = value;
    from += sizeof(T);
  }
}

// Unsigned numbers in 1, 2, 4 or 8 bytes each.
template <class T, class Narrow>
void PutAs(ByteWriter& out, const Column<T>& values) {
  char* to = out.Extend(values.size() * sizeof(Narrow));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto value = static_cast<Narrow>(values[i]);
    std::memcpy(to + i * sizeof(Narrow), &value, sizeof(Narrow));
  }
}

template <class T>
void PutUnsigned(ByteWriter& out, const Column<T>& values) {
  T all = 0;
  for (const T value : values) all |= value;
  out.Put(static_cast<std::uint32_t>(values.size()));
  const std::uint8_t width = all <= 0xff ? 1 : all <= 0xffff ? 2 : all <= 0xffffffff ? 4 : 8;
  out.Put(width);
  if (width == 1) PutAs<T, std::uint8_t>(out, values);
  if (width == 2) PutAs<T, std::uint16_t>(out, values);
  if (width == 4) PutAs<T, std::uint32_t>(out, values);
  if (width == 8) PutAs<T, std::uint64_t>(out, values);
}

template <class T, class Narrow>
void GetAs(ByteReader& in, std::uint32_t count, Column<T>& values) {
  const std::byte* from = in.TakeArray(count, sizeof(Narrow));
  values.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    Narrow value;
    std::memcpy(&value, from + i * sizeof(Narrow), sizeof(Narrow));
    values[i] = static_cast<T>(value);
  }
}

template <class T>
void GetUnsigned(ByteReader& in, Column<T>& values) {
  const auto count = in.Get<std::uint32_t>();
  const auto width = in.Get<std::uint8_t>();
  if (width > sizeof(T))
    throw Error(ErrorKind::kDamaged, "numbers of " + std::to_string(width) + " bytes in a narrower column");
  switch (width) {
    case 1:
      return GetAs<T, std::uint8_t>(in, count, values);
    case 2:
      return GetAs<T, std::uint16_t>(in, count, values);
    case 4:
      return GetAs<T, std::uint32_t>(in, count, values);
    case 8:
      return GetAs<T, std::uint64_t>(in, count, values);
    default:
      throw Error(ErrorKind::kDamaged, "numbers of " + std::to_string(width) + " bytes, expected 1, 2, 4 or 8");
  }
}

// Ids in 4 bytes each where they fit; none is all ones.
void PutIds(ByteWriter& out, const Column<MapPointId>& ids) {
  constexpr std::uint32_t kNone = 0xffffffff;
  const bool narrow = std::all_of(ids.begin(), ids.end(), [](MapPointId id) { return !id || id.value() < kNone; });
  out.Put(static_cast<std::uint32_t>(ids.size()));
  out.Put(static_cast<std::uint8_t>(narrow ? 4 : 8));
  if (!narrow) return out.PutBytes(std::as_bytes(std::span(ids)));
  char* to = out.Extend(ids.size() * 4);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto value = static_cast<std::uint32_t>(ids[i].value());
    std::memcpy(to + i * 4, &value, 4);
  }
}

void GetIds(ByteReader& in, Column<MapPointId>& ids) {
  const auto count = in.Get<std::uint32_t>();
  const auto width = in.Get<std::uint8_t>();
  if (width != 4 && width != 8)
    throw Error(ErrorKind::kDamaged, "ids of " + std::to_string(width) + " bytes, expected 4 or 8");
  const std::byte* from = in.TakeArray(count, width);
  ids.resize(count);
  if (width == 8) {
    if (count > 0) std::memcpy(ids.data(), from, count * sizeof(MapPointId));
    return;
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint32_t value;
    std::memcpy(&value, from + i * std::size_t{4}, 4);
    ids[i] = value == 0xffffffff ? MapPointId() : MapPointId(value);
  }
}

// 4-byte numbers, which are often one value throughout: -1 for what the sensor does not give. A value that is repeated
// takes no space, so its count has a limit: `rows`, which the keyframe has anyway.
template <class T>
void PutRepetitive(ByteWriter& out, const Column<T>& values, std::size_t rows) {
  static_assert(sizeof(T) == 4);
  const bool one = !values.empty() && values.size() <= rows &&
                   std::all_of(values.begin(), values.end(),
                               [&](const T& v) { return std::memcmp(&v, values.data(), sizeof(T)) == 0; });
  out.Put(static_cast<std::uint8_t>(one ? 1 : 0));
  if (!one) return out.PutVector(values);
  out.Put(static_cast<std::uint32_t>(values.size()));
  out.Put(values.front());
}

template <class T>
void GetRepetitive(ByteReader& in, Column<T>& values, std::size_t rows) {
  if (in.Get<std::uint8_t>() == 0) return in.GetVector(values);
  const auto count = in.Get<std::uint32_t>();
  const T value = in.Get<T>();
  if (count > rows)
    throw Error(ErrorKind::kDamaged,
                "a repeated value for " + std::to_string(count) + " rows, more than there are keypoints");
  values.assign(count, value);
}

// ---- keypoints

// The size of each octave's keypoints, when they are all alike; empty otherwise. Octaves fit a byte.
std::vector<float> SizesByOctave(const Column<Keypoint>& keypoints) {
  std::vector<float> sizes;
  std::vector<bool> known;
  for (const Keypoint& keypoint : keypoints) {
    const auto octave = static_cast<std::size_t>(keypoint.octave);
    if (octave >= sizes.size()) {
      sizes.resize(octave + 1, 0);
      known.resize(octave + 1, false);
    }
    if (!known[octave]) {
      sizes[octave] = keypoint.size;
      known[octave] = true;
    } else if (std::memcmp(&sizes[octave], &keypoint.size, sizeof(float)) != 0) {
      return {};
    }
  }
  return sizes;
}

void PutPositions(ByteWriter& out, const Column<Keypoint>& keypoints) {
  PutMember<float>(out, keypoints, &Keypoint::x);
  PutMember<float>(out, keypoints, &Keypoint::y);
}
void GetPositions(ByteReader& in, Column<Keypoint>& keypoints) {
  GetMember<float>(in, keypoints, &Keypoint::x);
  GetMember<float>(in, keypoints, &Keypoint::y);
}

void PutKeypoints(ByteWriter& out, const Column<Keypoint>& keypoints) {
  out.Put(static_cast<std::uint32_t>(keypoints.size()));
  if (keypoints.empty()) return;
  bool one_class_id = true, byte_octaves = true;
  for (const Keypoint& keypoint : keypoints) {
    one_class_id &= keypoint.class_id == keypoints.front().class_id;
    byte_octaves &= keypoint.octave >= 0 && keypoint.octave <= 255;
  }
  const std::vector<float> sizes = byte_octaves ? SizesByOctave(keypoints) : std::vector<float>();
  out.Put(static_cast<std::uint8_t>((one_class_id ? kOneClassId : 0) | (byte_octaves ? kByteOctaves : 0) |
                                    (sizes.empty() ? 0 : kSizeByOctave)));
  PutMember<float>(out, keypoints, &Keypoint::angle);
  PutMember<float>(out, keypoints, &Keypoint::response);
  PutPositions(out, keypoints);
  if (one_class_id) {
    out.Put(keypoints.front().class_id);
  } else {
    PutMember<std::int32_t>(out, keypoints, &Keypoint::class_id);
  }
  if (byte_octaves) {
    PutMember<std::uint8_t>(out, keypoints, &Keypoint::octave);
  } else {
    PutMember<std::int32_t>(out, keypoints, &Keypoint::octave);
  }
  if (!sizes.empty()) {
    out.PutVector(sizes);
  } else {
    PutMember<float>(out, keypoints, &Keypoint::size);
  }
}

void GetKeypoints(ByteReader& in, Column<Keypoint>& keypoints) {
  const auto count = in.Get<std::uint32_t>();
  keypoints.clear();
  if (count == 0) return;
  const auto flags = in.Get<std::uint8_t>();
  ByteReader(in).TakeArray(count, 4 * sizeof(float));  // throws before anything is allocated
  keypoints.resize(count);
  GetMember<float>(in, keypoints, &Keypoint::angle);
  GetMember<float>(in, keypoints, &Keypoint::response);
  GetPositions(in, keypoints);
  if ((flags & kOneClassId) != 0) {
    const auto class_id = in.Get<std::int32_t>();
    for (Keypoint& keypoint : keypoints) keypoint.class_id = class_id;
  } else {
    GetMember<std::int32_t>(in, keypoints, &Keypoint::class_id);
  }
  if ((flags & kByteOctaves) != 0) {
    GetMember<std::uint8_t>(in, keypoints, &Keypoint::octave);
  } else {
    GetMember<std::int32_t>(in, keypoints, &Keypoint::octave);
  }
  if ((flags & kSizeByOctave) == 0) return GetMember<float>(in, keypoints, &Keypoint::size);
  std::vector<float> sizes;
  in.GetVector(sizes);
  for (Keypoint& keypoint : keypoints) {
    if (static_cast<std::uint32_t>(keypoint.octave) >= sizes.size())
      throw Error(ErrorKind::kDamaged, "an octave without keypoint size");
    keypoint.size = sizes[static_cast<std::size_t>(keypoint.octave)];
  }
}

// How the undistorted keypoints differ from those as detected.
Undistorted Compare(const Column<Keypoint>& undistorted, const Column<Keypoint>& keypoints) {
  if (undistorted.size() != keypoints.size()) return Undistorted::kStored;
  if (undistorted.empty() ||
      std::memcmp(undistorted.data(), keypoints.data(), keypoints.size() * sizeof(Keypoint)) == 0) {
    return Undistorted::kSame;
  }
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    Keypoint moved = keypoints[i];
    moved.x = undistorted[i].x;
    moved.y = undistorted[i].y;
    if (std::memcmp(&moved, &undistorted[i], sizeof(Keypoint)) != 0) return Undistorted::kStored;
  }
  return Undistorted::kPositionsOnly;
}

// ---- grids

bool MayDerive(const ImageBounds& bounds) {
  return bounds.grid_columns > 0 && bounds.grid_rows > 0 &&
         std::int64_t{bounds.grid_columns} * bounds.grid_rows <= kMaxDerivedCells;
}

void PutGrid(ByteWriter& out, const FeatureGrid& grid, const Column<Keypoint>& keypoints, const ImageBounds& bounds) {
  const bool derived = !grid.empty() && MayDerive(bounds) && IsDerivedGrid(grid, keypoints, bounds);
  out.Put(static_cast<std::uint8_t>(derived ? Grid::kDerived : Grid::kStored));
  if (derived) return;
  PutUnsigned(out, grid.column_sizes);
  PutUnsigned(out, grid.cell_sizes);
  PutUnsigned(out, grid.keypoints);
}

void GetGrid(ByteReader& in, FeatureGrid& grid, const Column<Keypoint>& keypoints, const ImageBounds& bounds) {
  if (static_cast<Grid>(in.Get<std::uint8_t>()) == Grid::kDerived) {
    if (!MayDerive(bounds)) throw Error(ErrorKind::kDamaged, "a grid that is to be derived, but has no plausible size");
    grid = DeriveGrid(keypoints, bounds);
    return;
  }
  GetUnsigned(in, grid.column_sizes);
  GetUnsigned(in, grid.cell_sizes);
  GetUnsigned(in, grid.keypoints);
}

// ORB-SLAM3 bins the keypoints as detected in fisheye stereo, the undistorted ones otherwise.
const Column<Keypoint>& KeypointsOfGrid(const Features& features) {
  return features.is_fisheye_stereo() ? features.keypoints : features.undistorted;
}

// How often a repeated value may be repeated at no cost in bytes.
std::size_t RowsOf(const Features& features) {
  return features.descriptors.size() + features.keypoints.size() + features.right_keypoints.size();
}

// What stands before the links to points in a blob of layout 1, and behind them.
void PutFront(ByteWriter& out, const Features& features) {
  PutKeypoints(out, features.keypoints);
  const Undistorted undistorted = Compare(features.undistorted, features.keypoints);
  out.Put(static_cast<std::uint8_t>(undistorted));
  if (undistorted == Undistorted::kStored) PutKeypoints(out, features.undistorted);
  if (undistorted == Undistorted::kPositionsOnly) PutPositions(out, features.undistorted);
  PutKeypoints(out, features.right_keypoints);
  out.Put(static_cast<std::uint8_t>(features.descriptors_form));
  out.PutVector(features.descriptors);
}

void GetFront(ByteReader& in, Features& features) {
  GetKeypoints(in, features.keypoints);
  const auto undistorted = static_cast<Undistorted>(in.Get<std::uint8_t>());
  if (undistorted == Undistorted::kStored) {
    GetKeypoints(in, features.undistorted);
  } else {
    features.undistorted = features.keypoints;
    if (undistorted == Undistorted::kPositionsOnly) GetPositions(in, features.undistorted);
  }
  GetKeypoints(in, features.right_keypoints);
  features.descriptors_form = static_cast<MatrixForm>(in.Get<std::uint8_t>() & 3);
  in.GetVector(features.descriptors);
}

void PutBack(ByteWriter& out, const KeyFrame& keyframe) {
  const Features& features = keyframe.features;
  const std::size_t rows = RowsOf(features);
  PutRepetitive(out, features.right_x, rows);
  PutRepetitive(out, features.depth, rows);
  PutRepetitive(out, features.right_of_left, rows);
  PutRepetitive(out, features.left_of_right, rows);
  PutGrid(out, features.grid, KeypointsOfGrid(features), keyframe.bounds);
  PutGrid(out, features.right_grid, features.right_keypoints, keyframe.bounds);
  PutUnsigned(out, features.bag_of_words.words);
  out.PutVector(features.bag_of_words.weights);
  PutUnsigned(out, features.feature_vector.nodes);
  PutUnsigned(out, features.feature_vector.sizes);
  PutUnsigned(out, features.feature_vector.features);
}

void GetBack(ByteReader& in, KeyFrame& keyframe) {
  Features& features = keyframe.features;
  const std::size_t rows = RowsOf(features);
  GetRepetitive(in, features.right_x, rows);
  GetRepetitive(in, features.depth, rows);
  GetRepetitive(in, features.right_of_left, rows);
  GetRepetitive(in, features.left_of_right, rows);
  GetGrid(in, features.grid, KeypointsOfGrid(features), keyframe.bounds);
  GetGrid(in, features.right_grid, features.right_keypoints, keyframe.bounds);
  GetUnsigned(in, features.bag_of_words.words);
  in.GetVector(features.bag_of_words.weights);
  GetUnsigned(in, features.feature_vector.nodes);
  GetUnsigned(in, features.feature_vector.sizes);
  GetUnsigned(in, features.feature_vector.features);
  in.ExpectEnd();
}

void ExpectLayout(ByteReader& in, std::uint8_t layout) {
  if (const int found = in.Get<std::uint8_t>(); found != layout)
    throw Error(ErrorKind::kDamaged, detail::Concat("features of layout ", found, ", expected ", int{layout}));
}

// How many bytes of a blob stand before what `in` has yet to read.
std::size_t Behind(Bytes blob, const ByteReader& in) { return blob.size() - in.left(); }

}  // namespace

void EncodePicture(const KeyFrame& keyframe, ByteWriter& out) {
  out.Put(kPictureLayout);
  PutFront(out, keyframe.features);
  PutBack(out, keyframe);
}

void EncodePoints(const KeyFrame& keyframe, ByteWriter& out) { PutIds(out, keyframe.features.map_points); }

void DecodeFeatures(Bytes picture, Bytes points, KeyFrame& keyframe) {
  ByteReader in(picture);
  ExpectLayout(in, kPictureLayout);
  GetFront(in, keyframe.features);
  GetBack(in, keyframe);
  ByteReader ids(points);
  GetIds(ids, keyframe.features.map_points);
  ids.ExpectEnd();
}

void DecodeWholeFeatures(Bytes blob, KeyFrame& keyframe) {
  ByteReader in(blob);
  ExpectLayout(in, kWholeLayout);
  GetFront(in, keyframe.features);
  GetIds(in, keyframe.features.map_points);
  GetBack(in, keyframe);
}

SplitFeatures Split(Bytes whole) {
  try {
    Features features;
    ByteReader in(whole);
    ExpectLayout(in, kWholeLayout);
    GetFront(in, features);
    const std::size_t front = Behind(whole, in);
    GetIds(in, features.map_points);
    const std::size_t back = Behind(whole, in);
    ByteWriter picture;
    picture.Put(kPictureLayout);
    picture.PutBytes(whole.subspan(1, front - 1));
    picture.PutBytes(whole.subspan(back));
    return {picture.Take(), whole.subspan(front, back - front)};
  } catch (const Error&) {  // damaged: it stays as it is, and loading says so
    return {std::string(reinterpret_cast<const char*>(whole.data()), whole.size()), {}};
  }
}

std::string Join(Bytes picture, Bytes points) {
  ByteWriter whole;
  try {
    Features features;
    ByteReader in(picture);
    ExpectLayout(in, kPictureLayout);
    GetFront(in, features);
    const std::size_t front = Behind(picture, in);
    whole.Put(kWholeLayout);
    whole.PutBytes(picture.subspan(1, front - 1));
    whole.PutBytes(points);
    whole.PutBytes(picture.subspan(front));
  } catch (const Error&) {
    whole.Clear();
    whole.PutBytes(picture);
  }
  return whole.Take();
}

}  // namespace slamdb::rows
