// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/ndjson/detail/append.h"
#include "slamdb/formats/ndjson/detail/names.h"
#include "slamdb/formats/ndjson/json.h"

namespace slamdb {
namespace {

void AppendType(JsonAppender& json, FeatureType type) {
  const std::string_view name = NameOf(type);
  if (name.empty())
    json.Field("type", static_cast<std::int32_t>(type));
  else
    json.Field("type", name);
}

void AppendFeature(JsonAppender& json, const LandmarkFeature& feature) {
  json.BeginObject();
  AppendType(json, feature.type);
  json.Field("x", feature.x);
  json.Field("y", feature.y);
  json.Field("keypoint_id", feature.keypoint_id);
  json.Field("track_status", feature.track_status);
  json.Field("response", feature.response);
  json.Field("orientation", feature.orientation);
  json.Field("octave", feature.octave);
  json.Field("user_flags", feature.user_flags);
  json.Field("depth", feature.depth);
  json.Field("initial_depth", feature.initial_depth);
  json.Field("position_in_camera", feature.position_in_camera);
  json.Field("patch_size", feature.patch_size);
  if (feature.has_patch) json.Hex("patch", feature.patch.data(), feature.patch.size());
  json.Field("spin_image_rows", feature.spin_image_rows);
  json.Field("polar_images_without_rotation", feature.polar_images_without_rotation);
  json.BeginObject("descriptors");
  for (const FeatureDescriptor& descriptor : feature.descriptors)
    json.Hex(NameOf(descriptor.kind), descriptor.bytes.data(), descriptor.bytes.size());
  json.EndObject();
  json.EndObject();
}

}  // namespace

void AppendJson(std::string& out, const Landmark& landmark, std::optional<MapId> map) {
  JsonAppender json(out);
  json.BeginObject();
  json.Field("type", "landmark");
  if (map) json.Field("map", *map);
  json.Field("id", landmark.id);
  json.Field("mean", landmark.mean);
  json.Field("normal", landmark.normal);
  json.Field("cov_11", landmark.cov_11);
  json.Field("cov_22", landmark.cov_22);
  json.Field("cov_33", landmark.cov_33);
  json.Field("cov_12", landmark.cov_12);
  json.Field("cov_13", landmark.cov_13);
  json.Field("cov_23", landmark.cov_23);
  json.Field("last_seen", landmark.last_seen);
  json.Field("seen_count", landmark.seen_count);
  json.BeginArray("features");
  for (const LandmarkFeature& feature : landmark.features) AppendFeature(json, feature);
  json.EndArray();
  json.EndObject();
}

}  // namespace slamdb
