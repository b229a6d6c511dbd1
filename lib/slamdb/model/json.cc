// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/detail/json.h"

namespace slamdb::detail {

Json JsonId(std::uint64_t id) { return id == MapId::kNone ? Json() : JsonNumber(id); }

Json JsonOf(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

Json JsonOf(const Similarity3d& transform) {
  const Eigen::Quaterniond& q = transform.rotation;
  return {{"translation", JsonOf(transform.translation)},
          {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}},
          {"scale", transform.scale}};
}

Json JsonOf(const Distribution& numbers) {
  return {{"count", numbers.count}, {"mean", numbers.mean}, {"median", numbers.median}, {"max", numbers.max}};
}

Json JsonOf(const Vocabulary& vocabulary) { return {{"name", vocabulary.name}, {"checksum", vocabulary.checksum}}; }

Json JsonOf(const ArchiveEncoding& encoding) {
  return {{"text", encoding.text},
          {"boost_version", encoding.boost_version},
          {"long_bytes", encoding.long_bytes},
          {"size_bytes", encoding.size_bytes}};
}

Json JsonOf(const Counters& next_ids) {
  return {{"map", JsonNumber(next_ids.map)},         {"keyframe", JsonNumber(next_ids.keyframe)},
          {"point", JsonNumber(next_ids.map_point)}, {"frame", JsonNumber(next_ids.frame)},
          {"camera", JsonNumber(next_ids.camera)},   {"initial_keyframe", JsonNumber(next_ids.initial_keyframe)}};
}

Json JsonOf(const ContentCounts& counts) {
  return {{"maps", counts.maps},
          {"keyframes", counts.keyframes},
          {"points", counts.points},
          {"landmarks", counts.landmarks},
          {"cameras", counts.cameras},
          {"features", counts.features},
          {"observations", counts.observations},
          {"slots", counts.slots},
          {"connections", counts.connections},
          {"parents", counts.parents},
          {"children", counts.children},
          {"loop_edges", counts.loop_edges},
          {"merge_edges", counts.merge_edges},
          {"temporal_links", counts.temporal_links},
          {"references", counts.references}};
}

}  // namespace slamdb::detail
