// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/stella/detail/message_pack.h"
#include "slamdb/formats/stella/detail/message_pack_format.h"

namespace slamdb::stella {
namespace {

using std::string_view_literals::operator""sv;
using Appender = MessagePackAppender;

// Keys stand in the order of their bytes, as std::map has them.

void Append(Appender& out, std::string_view key, double value) {
  out.Text(key);
  out.Real(value);
}
void Append(Appender& out, std::string_view key, std::uint64_t value) {
  out.Text(key);
  out.Integer(value);
}
void Append(Appender& out, std::string_view key, std::string_view text) {
  out.Text(key);
  out.Text(text);
}

template <class Reals>
void AppendReals(Appender& out, std::string_view key, const Reals& reals) {
  const auto count = static_cast<std::size_t>(reals.size());
  out.Text(key);
  out.List(count);
  out.Fill(count * Appender::kMostOfNumber, [&](char* at) {
    for (const auto value : reals) at = Appender::Put(at, value);
    return at;
  });
}

void AppendIds(Appender& out, std::string_view key, const std::vector<KeyFrameId>& ids) {
  out.Text(key);
  out.List(ids.size());
  for (const KeyFrameId id : ids) out.Integer(id.value());
}

void AppendLens(Appender& out, const LensCamera& camera) {
  const std::array<double, 5>& k = camera.distortion;
  const bool fisheye = camera.model == Model::kFisheye;
  Append(out, "fx", camera.fx);
  Append(out, "fy", camera.fy);
  Append(out, "k1", k[0]);
  Append(out, "k2", k[1]);
  Append(out, "k3", fisheye ? k[2] : k[4]);
  if (fisheye) Append(out, "k4", k[3]);
}

void AppendCamera(Appender& out, const LensCamera& camera) {
  const bool fisheye = camera.model == Model::kFisheye, panorama = camera.model == Model::kEquirectangular;
  out.Map(panorama ? 7 : fisheye ? 15 : 16);
  Append(out, "color_order", camera.color_order);
  Append(out, "cols", std::uint64_t{camera.columns});
  if (!panorama) Append(out, "cx", camera.cx);
  if (!panorama) Append(out, "cy", camera.cy);
  Append(out, "focal_x_baseline", camera.focal_x_baseline);
  Append(out, "fps", camera.fps);
  if (!panorama) AppendLens(out, camera);
  Append(out, "model_type", NameOf(camera.model));
  if (!panorama && !fisheye) Append(out, "p1", camera.distortion[2]);
  if (!panorama && !fisheye) Append(out, "p2", camera.distortion[3]);
  Append(out, "rows", std::uint64_t{camera.rows});
  Append(out, "setup_type", NameOf(camera.setup));
}

void AppendOrbParams(Appender& out, const OrbParams& params) {
  out.Map(5);
  Append(out, "ini_fast_threshold", std::uint64_t{params.ini_fast_threshold});
  Append(out, "min_fast_threshold", std::uint64_t{params.min_fast_threshold});
  Append(out, "name", params.name);
  Append(out, "num_levels", std::uint64_t{params.levels});
  Append(out, "scale_factor", static_cast<double>(params.scale_factor));
}

void AppendDescriptors(Appender& out, const Column<Descriptor>& descriptors, std::size_t rows) {
  static constexpr Descriptor kNone{};
  constexpr std::size_t kWords = sizeof(Descriptor) / sizeof(std::uint32_t), kMost = 1 + kWords * 5;
  out.Text("descs");
  out.List(rows);
  out.Fill(rows * kMost, [&](char* at) {
    for (std::size_t row = 0; row < rows; ++row) {
      std::array<std::uint32_t, kWords> words;
      std::memcpy(words.data(), row < descriptors.size() ? descriptors[row].data() : kNone.data(), sizeof words);
      at = Appender::Put(at, "\x98"sv);
      for (const std::uint32_t word : words) at = Appender::PutWord(at, word);
    }
    return at;
  });
}

// Links to points: most are -1.
void AppendSigned(Appender& out, std::string_view key, const std::vector<std::int32_t>& values) {
  out.Text(key);
  out.List(values.size());
  out.Fill(values.size() * Appender::kMostOfNumber, [&](char* at) {
    for (const std::int32_t value : values) at = Appender::Put(at, std::int64_t{value});
    return at;
  });
}

void AppendKeypoints(Appender& out, std::span<const Keypoint> keypoints) {
  constexpr std::size_t kMost = 64;
  out.Text("undist_keypts");
  out.List(keypoints.size());
  out.Fill(keypoints.size() * kMost, [&](char* at) {
    for (const Keypoint& keypoint : keypoints) {
      at = Appender::Put(at,
                         "\x83\xa3"
                         "ang"sv);
      at = Appender::Put(at, keypoint.angle);
      at = Appender::Put(at,
                         "\xa3"
                         "oct"sv);
      at = Appender::Put(at, std::uint64_t{static_cast<std::uint32_t>(keypoint.octave)});
      at = Appender::Put(at,
                         "\xa2"
                         "pt\x92"sv);
      at = Appender::Put(Appender::Put(at, keypoint.x), keypoint.y);
    }
    return at;
  });
}

void AppendKeyFrame(Appender& out, const Outgoing& map, const OutgoingKeyFrame& written) {
  const KeyFrame& keyframe = *written.keyframe;
  const OutgoingFeatures features = map.FeaturesOf(written);
  out.Text(std::to_string(keyframe.id.value()));
  out.Map(14);
  Append(out, "cam", map.cameras()[written.camera].name);
  AppendReals(out, "depths", features.depth);
  AppendDescriptors(out, keyframe.features.descriptors, written.rows);
  AppendSigned(out, "lm_ids", written.points);
  AppendIds(out, "loop_edges", written.loop_edges);
  Append(out, "n_keypts", std::uint64_t{written.rows});
  Append(out, "orb_params", map.orb_params()[written.orb_params].name);
  AppendReals(out, "rot_cw", keyframe.camera_from_world.rotation.coeffs());  // x y z w
  AppendIds(out, "span_children", written.children);
  out.Text("span_parent");
  out.Integer(written.parent ? static_cast<std::int64_t>(written.parent.value()) : -1);
  AppendReals(out, "trans_cw", keyframe.camera_from_world.translation);
  Append(out, "ts", keyframe.timestamp);
  AppendKeypoints(out, features.undistorted);
  AppendReals(out, "x_rights", features.right_x);
}

void AppendPoint(Appender& out, const OutgoingPoint& written) {
  constexpr std::size_t kMost = 160;
  const MapPoint& point = *written.point;
  out.Text(std::to_string(point.id.value()));
  out.Fill(kMost, [&](char* at) {
    at = Appender::Put(at,
                       "\x85\xaa"
                       "1st_keyfrm"sv);
    at = Appender::Put(at, FirstKeyFrameOf(point));
    at = Appender::Put(at,
                       "\xa5"
                       "n_fnd"sv);
    at = Appender::Put(at, CountOf(point.found_count));
    at = Appender::Put(at,
                       "\xa5"
                       "n_vis"sv);
    at = Appender::Put(at, CountOf(point.visible_count));
    at = Appender::Put(at,
                       "\xa5"
                       "pos_w\x93"sv);
    for (const float value : point.position) at = Appender::Put(at, value);
    at = Appender::Put(at,
                       "\xaa"
                       "ref_keyfrm"sv);
    return Appender::Put(at, written.reference.value());
  });
}

// Rows, which are in the order of their ids, in that of their ids as texts: 1, 10, 11, 2. Filled up with zeros to ten
// digits, which ids of 32 bits have at most, they stand in that order, and the shorter first. Those of one length do
// already.
template <class Rows, class IdOf>
std::vector<std::uint32_t> TextOrder(const Rows& rows, const IdOf& id_of) {
  constexpr std::uint64_t kTenDigits = 10'000'000'000;  // all are below
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
  keys.reserve(rows.size());
  std::uint64_t limit = 10;  // ids of this length are below
  std::ptrdiff_t merged = 0;
  const auto merge = [&] { std::inplace_merge(keys.begin(), keys.begin() + merged, keys.end()); };
  for (std::uint32_t row = 0; row < rows.size(); ++row) {
    const std::uint64_t id = id_of(rows[row]);
    if (id >= limit) {
      merge();
      merged = static_cast<std::ptrdiff_t>(keys.size());
    }
    while (id >= limit) limit *= 10;
    keys.push_back({id * (kTenDigits / limit), row});
  }
  merge();
  std::vector<std::uint32_t> order;
  order.reserve(keys.size());
  for (const auto& [key, row] : keys) order.push_back(row);
  return order;
}

template <class Append>
void Write(AtomicFile& file, const Append& append) {
  Column<char> bytes;
  {
    Appender out(bytes);
    append(out);
  }
  file.Write(std::as_bytes(std::span(bytes)));
}

template <class Items, class AppendItem>
void WriteTable(AtomicFile& file, std::string_view name, const Items& items, const AppendItem& append) {
  Write(file, [&](Appender& out) {
    out.Text(name);
    out.Map(items.size());
    for (const auto& item : items) {
      out.Text(item.name);
      append(out, item);
    }
  });
}

// A map with an entry for each row, in this order.
template <class AppendRow>
void WriteRows(AtomicFile& file, std::string_view name, const std::vector<std::uint32_t>& order, std::size_t grain,
               const WriteOptions& options, const AppendRow& append) {
  Write(file, [&](Appender& out) {
    out.Text(name);
    out.Map(order.size());
  });
  detail::WriteRows<Column<char>>(file, order.size(), grain, options,
                                  [&](std::size_t begin, std::size_t end, Column<char>& bytes) {
                                    Appender out(bytes);
                                    for (std::size_t i = begin; i < end; ++i) append(out, order[i]);
                                  });
}

}  // namespace

std::uint64_t WriteMessagePack(const Outgoing& map, const Target& target, const WriteOptions& options) {
  constexpr std::size_t kPointsPerBlock = 1024;
  AtomicFile file(target, detail::FileOptions(options));
  const auto keyframes = TextOrder(map.keyframes(), [](const auto& row) { return row.keyframe->id.value(); });
  const auto points = TextOrder(map.points(), [](const auto& row) { return row.point->id.value(); });
  std::atomic<std::uint64_t> shapes = 0;
  Write(file, [](Appender& out) { out.Map(6); });
  WriteTable(file, "cameras", map.cameras(), AppendCamera);
  Write(file, [&](Appender& out) { Append(out, "keyframe_next_id", map.next_keyframe()); });
  WriteRows(file, "keyframes", keyframes, 1, options, [&](Appender& out, std::uint32_t row) {
    AppendKeyFrame(out, map, map.keyframes()[row]);
    shapes += CountShapes(map.keyframes()[row]);  // whose keypoints are at hand
  });
  Write(file, [&](Appender& out) { Append(out, "landmark_next_id", map.next_point()); });
  WriteRows(file, "landmarks", points, kPointsPerBlock, options,
            [&](Appender& out, std::uint32_t row) { AppendPoint(out, map.points()[row]); });
  WriteTable(file, "orb_params", map.orb_params(), AppendOrbParams);
  file.Commit();
  return shapes;
}

}  // namespace slamdb::stella
