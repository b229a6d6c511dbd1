// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>

#include "slamdb/align/merge_aligned.h"
#include "slamdb/base/time_unit.h"
#include "slamdb/edit/frame/transform_atlas.h"
#include "slamdb/edit/ids/renumber.h"
#include "slamdb/edit/merge/merge.h"
#include "slamdb/edit/merge/three_way.h"
#include "slamdb/edit/part/extract.h"
#include "slamdb/edit/part/fragments.h"
#include "slamdb/edit/part/shrink.h"
#include "slamdb/edit/part/split.h"
#include "slamdb/evaluate/evaluate.h"
#include "slamdb/formats/colmap/options.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/formats/format.h"
#include "slamdb/optimize/optimize.h"
#include "slamdb/plot/plot.h"
#include "slamdb/synthetic/synthesize.h"
#include "slamdb/view/page.h"

// The words that options take and what they mean, and what they are for: for the command, and for keyword arguments in
// Python.
namespace slamdb::cli {

// Outputs that options are for.
inline bool IsColmap(const Format& format) { return format.id.starts_with("colmap"); }
inline bool NamesPictures(const Format& format) {
  return IsColmap(format) || format.id == "nerf" || format.id == "3dgs";
}
inline bool IsModel(const Format& format) { return IsColmap(format) && format.is_folder; }

template <class Value>
using Choices = std::map<std::string, Value>;

inline const Choices<Border> kBorders = {
    {"strict", Border::kStrict}, {"complete-points", Border::kCompletePoints}, {"smart", Border::kSmart}};
inline const Choices<PlanPlane> kPlanes = {
    {"auto", PlanPlane::kAuto}, {"xy", PlanPlane::kXy}, {"xz", PlanPlane::kXz}, {"yz", PlanPlane::kYz}};
inline const Choices<RegionOf> kRegions = {
    {"both", RegionOf::kBoth}, {"cameras", RegionOf::kCameras}, {"points", RegionOf::kPoints}};
inline const Choices<SplitBy> kSplitWays = {
    {"map", SplitBy::kMap}, {"session", SplitBy::kSession}, {"component", SplitBy::kComponent}};
inline const Choices<MapOrder> kMapOrders = {
    {"as-is", MapOrder::kAsIs}, {"size", MapOrder::kSize}, {"time", MapOrder::kTime}, {"id", MapOrder::kId}};
inline const Choices<bool ShrinkOptions::*> kPurposes = {{"localization", &ShrinkOptions::for_localization},
                                                         {"mapping", &ShrinkOptions::for_mapping}};
inline const Choices<IdOrder> kIdOrders = {{"id", IdOrder::kId}, {"time", IdOrder::kTime}, {"as-is", IdOrder::kAsIs}};

inline const Choices<SameMap> kConflicts = {
    {"renumber", SameMap::kKeepBoth}, {"error", SameMap::kError}, {"keep-first", SameMap::kKeepFirst}};
inline const Choices<BranchGeometry> kBranchGeometries = {{"ours", BranchGeometry::kOurs},
                                                          {"theirs", BranchGeometry::kTheirs},
                                                          {"align", BranchGeometry::kAlign},
                                                          {"optimize", BranchGeometry::kOptimize}};
inline const Choices<BranchSide> kBranchSides = {{"ours", BranchSide::kOurs}, {"theirs", BranchSide::kTheirs}};
inline const Choices<bool> kDivergedWays = {{"skip", false}, {"branch", true}};  // of stores: SyncOptions
inline const Choices<Tightening> kTightenings = {{"none", Tightening::kNone},
                                                 {"pose-graph", Tightening::kPoseGraph},
                                                 {"seam", Tightening::kSeam},
                                                 {"full", Tightening::kFull}};
inline const Choices<OptimizeMethod> kOptimizeMethods = {
    {"pose-graph", OptimizeMethod::kPoseGraph}, {"seam", OptimizeMethod::kSeam}, {"full", OptimizeMethod::kFull}};
inline const Choices<bool> kLoopOptimizations = {{"pose-graph", false}, {"full", true}};  // of the bundle, too

inline const Choices<std::optional<UpMethod>> kUpMethods = {{"auto", std::nullopt},
                                                            {"inertia", UpMethod::kInertia},
                                                            {"cameras", UpMethod::kCameras},
                                                            {"path", UpMethod::kPath}};
inline const Choices<AlignmentKind> kAlignments = {{"none", AlignmentKind::kNone},
                                                   {"origin", AlignmentKind::kOrigin},
                                                   {"scale", AlignmentKind::kScale},
                                                   {"se3", AlignmentKind::kSe3},
                                                   {"sim3", AlignmentKind::kSim3}};

inline const Choices<TimeUnit> kTimeUnits = {{"s", TimeUnit::kSeconds},
                                             {"ms", TimeUnit::kMilliseconds},
                                             {"us", TimeUnit::kMicroseconds},
                                             {"ns", TimeUnit::kNanoseconds}};

inline const Choices<PointColor> kColors = {{"map", PointColor::kMap},
                                            {"error", PointColor::kError},
                                            {"observations", PointColor::kObservations},
                                            {"height", PointColor::kHeight},
                                            {"age", PointColor::kAge}};
inline const Choices<PlotFormat> kPlotFormats = {{"svg", PlotFormat::kSvg}, {"png", PlotFormat::kPng}};
inline const Choices<ColmapSchema> kColmapSchemas = {{"old", ColmapSchema::kOld}, {"new", ColmapSchema::kNew}};

inline const Choices<Sensor> kSensors = {{"monocular", Sensor::kMonocular},
                                         {"stereo", Sensor::kStereo},
                                         {"rgbd", Sensor::kRgbd},
                                         {"fisheye", Sensor::kFisheyeStereo}};
inline const Choices<ViewKeypoints> kViewKeypoints = {{"auto", ViewKeypoints::kAuto},
                                                      {"all", ViewKeypoints::kAll},
                                                      {"matched", ViewKeypoints::kMatched},
                                                      {"none", ViewKeypoints::kNone}};

}  // namespace slamdb::cli
