// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/usual_classes.h"

#include "slamdb/formats/orbslam3/detail/encoder.h"
#include "slamdb/formats/orbslam3/detail/layout.h"
#include "slamdb/formats/orbslam3/detail/output.h"

namespace slamdb::orbslam3 {
namespace {

// The class table behind a keyframe that has everything that ORB-SLAM3 gives it.
ClassTable TableBehindKeyFrame(const ClassTable& in_front, bool measurements) {
  KeyFrame usual;
  usual.features.bag_of_words = {{0}, {1}};
  usual.features.feature_vector = {{0}, {1}, {0}};
  usual.features.grid = {{1}, {1}, {0}};
  usual.connections.push_back({KeyFrameId(0), 1});
  if (measurements) usual.preintegration.measurements.resize(1);
  Encoder<NoOutput> encoder(NoOutput(), in_front);
  LayoutKeyFrame(encoder, static_cast<const KeyFrame&>(usual));
  return encoder.classes;
}

}  // namespace

std::vector<ClassTable> TablesBehind(ClassTable classes, WireClass wire_class) {
  const bool first = classes.FirstUse(wire_class);
  std::vector<ClassTable> tables{classes};
  if (wire_class != WireClass::kKeyFrame) return tables;
  if (first) tables = {TableBehindKeyFrame(classes, false), TableBehindKeyFrame(classes, true)};
  ClassTable met_later = tables.front();
  if (met_later.FirstUse(WireClass::kMeasurement)) tables.push_back(met_later);
  return tables;
}

ClassTable TableOfFirstMap(const ArchiveEncoding& encoding) {
  ClassTable classes(encoding);
  classes.FirstUse(WireClass::kAtlas);
  classes.Register(WireClass::kPinhole);
  classes.Register(WireClass::kKannalaBrandt8);
  classes.FirstUse(WireClass::kMapList);
  classes.FirstUse(WireClass::kMap);
  return classes;
}

}  // namespace slamdb::orbslam3
